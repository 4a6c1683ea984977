use roverlab::drive::motion_watch::{MotionWatch, MotionWatchParameters};
use roverlab::geometry::{Twist, angle_difference, math, units};
use roverlab::io::{self, Display, DisplayImage, Viewport, control};
use roverlab::picture::Picture;

use super::{Args, campaign, scene};
use crate::common::{Failure, Outcome, Report, rounded};
use crate::driving::{Conditions, drawn, paced};

/// Simulated seconds of watching.
const TIME_LIMIT: f64 = 10.0;
/// How the other robot drives: circles of a quarter of a metre.
const CIRCLE: Twist = Twist::new(0.2, 0.8);

/// What was seen.
#[derive(Debug, Clone, Default)]
struct Seen {
    images: u32,
    sectors: [u32; 3],
    strongest: f64,
}

/// The work of the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.campaign {
        args.common.check_placeless("the pairs of a campaign are drawn")?;
        if args.still {
            return Err(Failure::input(
                "--still: found --campaign, which has both kinds of pairs; expected one of them",
            ));
        }
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let scene = common.placed(scene::book)?;
    let spec = &scene.robots[0].spec;
    let Some(camera) = spec.camera else {
        return Err(Failure::input(format!(
            "found robot {} without a camera; expected one with one",
            spec.name
        )));
    };
    let moves = scene.robots.len() > 1 && !args.still;
    let conditions = Conditions {
        light: args.light,
        others: if moves { vec![(1, CIRCLE)] } else { Vec::new() },
        ..Conditions::new(common, TIME_LIMIT)?
    };
    let seconds = conditions.time_limit;
    let parameters = MotionWatchParameters::new(camera.field_of_view);
    let mut watch = MotionWatch::new(parameters).map_err(Failure::input)?;
    let run = conditions.run(&scene, paced(common), |robot, step| {
        let mut seen = Seen::default();
        control::run(robot, &mut watch, seconds, |robot, watch, at| {
            step();
            show(robot, watch, &at.seen.image)?;
            if let Some(motion) = watch.motion() {
                seen.images += 1;
                seen.strongest = seen.strongest.max(motion.largest());
                motion.strongest.iter().for_each(|&sector| seen.sectors[sector] += 1);
            }
            io::Result::Ok(())
        })?;
        Ok(seen)
    })?;
    let (file, trouble) = drawn(common, "motion.svg", || {
        let mut drawing = Picture::new(&scene.world);
        drawing.title("Watching for motion");
        for other in &scene.robots[1..] {
            drawing.robot(other.pose, &other.spec.footprint);
        }
        drawing.robot(run.truth.pose, &spec.footprint);
        drawing
    });
    let turned = angle_difference(run.truth.pose.heading, scene.robots[0].pose.heading);
    let seen = run.ending.clone().unwrap_or_default();
    let report = run
        .report(|_| Outcome::verdict("watched"))
        .field("images", seen.images)
        .field("alarms", seen.sectors.iter().sum::<u32>())
        .field("sectors", seen.sectors)
        .field("strongest", rounded(seen.strongest))
        .field("turned_deg", rounded(units::to_deg(turned)))
        .field("time_limit_s", seconds)
        .field("picture", file);
    Ok(Report { trouble, ..report })
}

/// The image on the display, with a bar under the sector where something moves.
fn show<R: Display + ?Sized>(robot: &mut R, watch: &MotionWatch, image: &image::GrayImage) -> io::Result<()> {
    robot.draw_image(DisplayImage::Gray(image), Viewport::default())?;
    let Some(sector) = watch.motion().and_then(|motion| motion.strongest) else { return Ok(()) };
    let left = (sector as i32) * 320 / 3;
    let colour = roverlab::world::Colour::RED;
    robot.draw_rectangle((left, 230), (left + 105, 239), colour, io::Fill::Solid)
}

/// The direction of one place from a pose, in radians to the left of straight ahead.
pub(super) fn bearing(from: roverlab::geometry::Pose, to: roverlab::geometry::Point) -> f64 {
    let place = from.to_local(to);
    math::atan2(place.y, place.x)
}
