use roverlab::drive::motion_watch::{MotionWatch, MotionWatchParameters};
use roverlab::geometry::{Twist, angle_difference, direction, math, units};
use roverlab::io::{self, Display, DisplayImage, Viewport, control};
use roverlab::picture::{Figure, Picture, SERIES, Style};
use roverlab::vision::motion::Motion;
use roverlab::world::{Colour, Scene};

use super::{Args, approach, campaign, scene};
use crate::common::{Failure, Outcome, Report, rounded};
use crate::driving::{Conditions, Run, paced};

/// Time of watching, and of an approach (s).
const TIME_LIMITS: [f64; 2] = [10.0, 60.0];
/// Motion of the other robot: circles with a radius of 0.25 m.
const CIRCLE: Twist = Twist::new(0.2, 0.8);

/// Result of watching.
#[derive(Debug, Clone, Default)]
pub(super) struct Seen {
    images: u32,
    sectors: [u32; 3],
    strongest: f64,
    /// Times and sectors of motion, with the robot's pose.
    alarms: Vec<(f64, usize)>,
    /// Whether what moves was reached.
    pub(super) is_reached: bool,
}

impl Seen {
    /// Takes the result of a comparison.
    pub(super) fn take(&mut self, time: f64, motion: Option<Motion>) {
        let Some(motion) = motion else { return };
        self.images += 1;
        self.strongest = self.strongest.max(motion.largest());
        if let Some(sector) = motion.strongest {
            self.sectors[sector] += 1;
            self.alarms.push((time, sector));
        }
    }
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.campaign {
        args.common.check_placeless("the pairs of a campaign are drawn")?;
        if args.still {
            return Err(Failure::input(
                "--still: found --campaign, which has both kinds of pairs; expected one of them",
            ));
        }
        return if args.approach { approach::campaign(args) } else { campaign(args) };
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
        ..Conditions::new(common, TIME_LIMITS[usize::from(args.approach)])?
    };
    let seconds = conditions.time_limit;
    if args.approach {
        let run = approach::run(&conditions, &scene, &camera, paced(common))?;
        let report = report(&run, &scene, seconds, |seen| approach::outcome(seen.is_reached))
            .field("distance_mm", approach::distance(&run, &scene).map(|metres| rounded(1e3 * metres)));
        let title = match &run.ending {
            Ok(seen) if seen.is_reached => "Driving to what moves: reached",
            Ok(_) => "Driving to what moves: timed out",
            Err(_) => "Driving to what moves: the robot failed",
        };
        return Ok(common.draw(report, "motion.svg", || picture(title, &scene, &run)));
    }
    let parameters = MotionWatchParameters::new(camera.field_of_view);
    let mut watch = MotionWatch::new(parameters).map_err(Failure::input)?;
    let run = conditions.run(&scene, paced(common), |robot, step| {
        let mut seen = Seen::default();
        control::run(robot, &mut watch, seconds, |robot, watch, at| {
            step();
            show(robot, watch.motion(), &at.seen.image)?;
            seen.take(at.time, watch.motion());
            io::Result::Ok(())
        })?;
        Ok(seen)
    })?;
    let run = run.lasting(seconds);
    let report = report(&run, &scene, seconds, |seen| match seen.images {
        0 => Outcome::failure("timed_out"),
        _ => Outcome::verdict("watched"),
    });
    Ok(common.draw(report, "motion.svg", || picture("Watching for motion", &scene, &run)))
}

/// Report on a run.
fn report(run: &Run<Seen>, scene: &Scene, seconds: f64, outcome: impl Fn(&Seen) -> Outcome) -> Report {
    let turned = angle_difference(run.truth.pose.heading, scene.robots[0].pose.heading);
    let seen = run.ending.clone().unwrap_or_default();
    run.report(outcome)
        .field("images", seen.images)
        .field("alarms", seen.sectors.iter().sum::<u32>())
        .field("sectors", seen.sectors)
        .field("strongest", rounded(seen.strongest))
        .field("turned_deg", rounded(units::to_deg(turned)))
        .field("time_limit_s", seconds)
}

/// The other robot's path, and the sector of each alarm at the robot's pose.
fn picture(title: &str, scene: &Scene, run: &Run<Seen>) -> Picture {
    let spec = &scene.robots[0].spec;
    let mut drawing = Picture::new(&scene.world);
    let alarms = run.ending.as_ref().map_or(&[][..], |seen| &seen.alarms);
    drawing.title(title).caption(format!(
        "{} alarms, turned by {:.0} deg in {:.0} s",
        alarms.len(),
        units::to_deg(angle_difference(run.truth.pose.heading, scene.robots[0].pose.heading)),
        run.sim_time
    ));
    for trail in &run.others {
        let way = trail.iter().map(|(time, pose)| (*time, pose.position()));
        drawing.trace(way, Style::new(SERIES[1]).labelled("moving object"));
    }
    let red = Style::new(Colour::from_hex(0xc8_3e_4d)).width(0.6).labelled("sector of an alarm");
    let angle = spec.camera.map_or(0.0, |camera| camera.field_of_view);
    for &(time, sector) in alarms {
        let before = run.trail.partition_point(|(then, _)| *then <= time);
        let (_, pose) = run.trail[before.saturating_sub(1)];
        let left = pose.heading + angle * (0.5 - sector as f64 / 3.0);
        let rim = [left, left - angle / 6.0, left - angle / 3.0];
        let corners = || rim.map(|bearing| pose.position() + direction(bearing) * REACH);
        drawing
            .during(time..time + 0.4)
            .polygon([pose.position()].into_iter().chain(corners()), red.clone().filled(0.3));
        drawing.during(time..).line(corners(), red.clone().width(2.0));
    }
    drawing.during(..);
    for (index, other) in scene.robots.iter().enumerate().skip(1) {
        let still = vec![(0.0, other.pose)];
        let poses = run.others.get(index - 1).cloned().unwrap_or(still);
        drawing.add(Figure::Robot { poses, footprint: other.spec.footprint }, Style::new(SERIES[1]));
    }
    run.draw(&mut drawing, spec);
    drawing
}

/// Radius of the alarm sectors (m).
const REACH: f64 = 0.6;

/// Shows the image on the display, with a bar below the sector in motion.
pub(super) fn show<R: Display + ?Sized>(
    robot: &mut R,
    motion: Option<Motion>,
    image: &image::GrayImage,
) -> io::Result<()> {
    robot.draw_image(DisplayImage::Gray(image), Viewport::default())?;
    let Some(sector) = motion.and_then(|motion| motion.strongest) else { return Ok(()) };
    let left = (sector as i32) * 320 / 3;
    let colour = roverlab::world::Colour::RED;
    robot.draw_rectangle((left, 230), (left + 105, 239), colour, io::Fill::Solid)
}

/// Bearing of a place from a pose, positive to the left (rad).
pub(super) fn bearing(from: roverlab::geometry::Pose, to: roverlab::geometry::Point) -> f64 {
    let place = from.to_local(to);
    math::atan2(place.y, place.x)
}
