use roverlab::io::Key;
use roverlab::picture::Picture;
use roverlab::vision::{CameraGeometry, ColourFinder};
use roverlab::vision::{HueRange, HueScale, hue};
use roverlab::world::{Colour, Footprint, Object, Scene};

use super::drive::{Ended, Options, drive, nearest, teach};
use super::{Args, Job, campaign, scene};
use crate::common::{Failure, Outcome, Report, millimetres};
use crate::driving::{Conditions, Run, paced};

/// Colour of the card that teaches the default hue: red.
const CARD: Colour = Colour::new(200, 24, 24);
/// Time limit (s).
const TIME_LIMIT: f64 = 300.0;

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let scene = common.placed(|| scene::drawn(common.seed))?;
    let conditions = Conditions {
        light: args.light.unwrap_or(1.0),
        pushing: args.job == Job::Home,
        ..Conditions::new(common, TIME_LIMIT)?
    };
    let (hue, run) = one(args, &scene, &conditions, &mut paced(common))?;
    let report = report(args, &scene, (hue, &run))?.field("time_limit_s", conditions.time_limit);
    Ok(common.draw(report, "color_tracking.svg", || picture(&scene, &run)))
}

/// Teaches the robot the card's hue unless one is given, then lets it drive. Also returns the hue.
pub(crate) fn one(
    args: &Args,
    scene: &Scene,
    conditions: &Conditions,
    watch: &mut dyn FnMut(f64),
) -> Result<(u8, Run<Ended>), Failure> {
    let spec = &scene.robots[0].spec;
    let (Some(camera), Some(_)) = (&spec.camera, &spec.lidar) else {
        return Err(Failure::input(format!(
            "found robot {} without a camera or a lidar; expected one with both",
            spec.name
        )));
    };
    let options = Options {
        job: args.job,
        method: args.method.method(),
        tolerance: args.tolerance,
        camera: CameraGeometry::from(camera),
        radius: match spec.footprint {
            Footprint::Disc { radius } => radius,
            other => other.bounding_radius(),
        },
        time_limit: conditions.time_limit,
    };
    let hue = match args.hue {
        Some(hue) => hue,
        None => taught(scene, conditions)?,
    };
    let run = conditions.run(scene, watch, |robot, step| drive(robot, hue, &options, step))?;
    Ok((hue, run))
}

/// The hue of a card held in front of the camera at a key press.
fn taught(scene: &Scene, conditions: &Conditions) -> Result<u8, Failure> {
    let mut lesson = scene.clone();
    lesson.world.billboards.push(scene::card(scene.robots[0].pose, CARD));
    let conditions = Conditions { keys: vec![(0.5, Key::Key1)], common: None, ..conditions.clone() };
    let run = conditions.run(&lesson, |_| {}, |robot, _| teach(robot))?;
    run.ending.map_err(Failure::run)?.ok_or_else(|| {
        let light = conditions.light;
        Failure::input(format!("--light: in light of {light} a red card has no hue; expected about 0.2 to 8"))
    })
}

/// Indices of the objects with the wanted colour.
pub(crate) fn wanted(scene: &Scene, hue_wanted: u8, tolerance: u8) -> Result<Vec<usize>, Failure> {
    let range = HueRange::around(hue_wanted, tolerance, HueScale::Robios).map_err(Failure::input)?;
    let is_it = |object: &Object| {
        let Colour { red, green, blue } = object.kind.colour;
        range.contains(hue([red, green, blue], HueScale::Robios, ColourFinder::LIMITS))
    };
    let objects = scene.world.objects.iter().enumerate();
    Ok(objects.filter(|(_, object)| is_it(object)).map(|(index, _)| index).collect())
}

/// Distance between the centres of robot and object that counts as reached, and from home that counts as home
/// (m).
const REACHED: f64 = 0.2;
const HOME: f64 = 0.2;

/// True position of the object at the end.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Truth {
    /// Distance of the nearest object of the colour from the robot's centre, and from the robot's start (m).
    pub(crate) distance: Option<f64>,
    pub(crate) home: Option<f64>,
}

impl Truth {
    pub(crate) fn new(objects: &[usize], scene: &Scene, run: &Run<Ended>) -> Self {
        let places = || objects.iter().filter_map(|&index| run.objects.get(index).copied());
        Self {
            distance: nearest(places(), run.truth.pose.position()),
            home: nearest(places(), scene.robots[0].pose.position()),
        }
    }

    /// Outcome of a run: the robot's claim, if it is true.
    pub(crate) fn verdict(&self, ended: Ended) -> Outcome {
        let within = |distance: Option<f64>, limit| distance.is_some_and(|distance| distance <= limit);
        match ended {
            Ended::Reached if within(self.distance, REACHED) => Outcome::verdict("reached"),
            Ended::Home if within(self.home, HOME) => Outcome::verdict("home"),
            Ended::Reached | Ended::Home => Outcome::failure("missed"),
            Ended::Blocked => Outcome::failure("blocked"),
            Ended::TimedOut => Outcome::failure("timed_out"),
        }
    }
}

fn report(args: &Args, scene: &Scene, (hue, run): (u8, &Run<Ended>)) -> Result<Report, Failure> {
    let truth = Truth::new(&wanted(scene, hue, args.tolerance)?, scene, run);
    let report = run.report(|&ended| truth.verdict(ended));
    let home = truth.home.filter(|_| args.job == Job::Home);
    Ok(report
        .field("job", args.job.name())
        .field("method", args.method.name())
        .field("light", args.light.unwrap_or(1.0))
        .field("hue", hue)
        .field("distance_mm", truth.distance.map(millimetres))
        .field("home_mm", home.map(millimetres)))
}

fn picture(scene: &Scene, run: &Run<Ended>) -> Picture {
    // Objects are where they were pushed.
    let mut world = scene.world.clone();
    for (object, place) in world.objects.iter_mut().zip(&run.objects) {
        (object.pose.x, object.pose.y) = (place.x, place.y);
    }
    let mut picture = Picture::new(&world);
    picture.title("Driving by colour");
    run.draw(&mut picture, &scene.robots[0].spec);
    picture
}
