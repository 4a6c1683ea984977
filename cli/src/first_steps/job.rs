use std::f64::consts::PI;

use roverlab::drive::{FirstSteps, FirstStepsOutcome, FirstStepsParameters};
use roverlab::geometry::{Point, Pose, angle_difference, units};
use roverlab::io::control;
use roverlab::picture::{Picture, Style};
use roverlab::world::Scene;
use roverlab::world::space::{Solid, Space};

use super::Args;
use super::args::Task;
use super::campaign::campaign;
use super::scene::scene;
use crate::common::{Failure, Outcome, Report, millimetres, rounded};
use crate::driving::{Conditions, Run, paced, pale};

/// Time limit (s).
const SECONDS: f64 = 60.0;

/// A drive and how well it went.
#[derive(Debug, Clone)]
pub(super) struct Drive {
    pub(super) run: Run<FirstStepsOutcome>,
    /// Distance to the start at the end (m), and error of the heading (rad).
    pub(super) position_error: f64,
    pub(super) heading_error: f64,
    /// Distance to the wall at the turn, or largest distance to the circle (m).
    pub(super) on_the_way: f64,
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.trials.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let scene = common.placed(|| scene(common.seed))?;
    common.check_turning_with_lidar(&scene.robots[0].spec)?;
    let conditions = Conditions::new(common, SECONDS)?;
    let drive = drive(&scene, args.task, &conditions, paced(common))?;
    let way = if args.task == Task::Wall { "gap_mm" } else { "max_deviation_mm" };
    let report = drive
        .run
        .report(|outcome| match outcome {
            FirstStepsOutcome::Returned => Outcome::verdict("returned"),
            FirstStepsOutcome::NoRoom => Outcome::failure("no_room"),
            _ => Outcome::failure("timed_out"),
        })
        .field("task", args.task.name())
        .field("position_error_mm", millimetres(drive.position_error))
        .field("heading_error_deg", rounded(units::to_deg(drive.heading_error)))
        .field(way, millimetres(drive.on_the_way))
        .field("time_limit_s", conditions.time_limit);
    Ok(common.draw(report, "first_steps.svg", || picture(&scene, args.task, &drive)))
}

/// Drives a task in a scene, and measures the errors.
pub(super) fn drive(
    scene: &Scene,
    task: Task,
    conditions: &Conditions,
    watch: impl FnMut(f64),
) -> Result<Drive, Failure> {
    let radius = scene.robots[0].spec.footprint.bounding_radius();
    let parameters = FirstStepsParameters { radius, ..FirstStepsParameters::default() };
    let mut steps = FirstSteps::new(task.of_library(), parameters).map_err(Failure::input)?;
    let run = conditions.run(scene, watch, |robot, step| {
        control::run(robot, &mut steps, conditions.time_limit, |_, _, _| step())
    })?;
    let start = scene.robots[0].pose;
    let end = start.inverse().compose(&run.truth.pose);
    let turned = if task == Task::Wall { PI } else { 0.0 };
    let on_the_way = match task {
        Task::Wall => gap(scene, &run, radius),
        Task::Circle => deviation(start, parameters.diameter, &run),
    };
    Ok(Drive {
        position_error: end.position().coords.norm(),
        heading_error: angle_difference(end.heading, turned).abs(),
        on_the_way,
        run,
    })
}

/// Distance between the robot's front and what is straight ahead where it is farthest from its start (m).
fn gap<T>(scene: &Scene, run: &Run<T>, radius: f64) -> f64 {
    let mut space = Space::new(&scene.world.walls);
    for solid in scene.world.objects.iter().map(Solid::from) {
        space.add(solid);
    }
    let (start, height) = (scene.robots[0].pose, 0.5 * scene.robots[0].spec.height);
    let size = scene.world.site().size();
    let turn = farthest(run).position();
    space.cast_ray(turn, start.forward(), height, size.x + size.y, None) - radius
}

/// The pose farthest from the start.
fn farthest<T>(run: &Run<T>) -> Pose {
    let start = run.trail[0].1;
    let away = |pose: &Pose| pose.distance_to(start.position());
    let poses = run.trail.iter().map(|(_, pose)| *pose);
    poses.max_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(start)
}

/// Largest distance of the path from the circle to the left of a start (m).
fn deviation<T>(start: Pose, diameter: f64, run: &Run<T>) -> f64 {
    let centre = start.to_world(Point::new(0.0, 0.5 * diameter));
    run.positions().map(|place| ((place - centre).norm() - 0.5 * diameter).abs()).fold(0.0, f64::max)
}

/// The way out and back.
fn picture(scene: &Scene, task: Task, drive: &Drive) -> Picture {
    let Drive { run, position_error, heading_error, on_the_way } = drive;
    let outline = scene.robots[0].spec.footprint;
    let start = scene.robots[0].pose;
    let mut picture = Picture::new(&scene.world);
    let way = units::to_mm(*on_the_way);
    picture.title(match task {
        Task::Wall => format!("To {way:.0} mm before a wall, and back"),
        Task::Circle => format!("A circle of 1 m, {way:.0} mm off at most"),
    });
    picture.caption(format!(
        "{:.1} mm and {:.1} degrees off at the end, after {:.0} s",
        units::to_mm(*position_error),
        units::to_deg(*heading_error),
        run.sim_time
    ));
    if task == Task::Circle {
        let radius = 0.5 * FirstStepsParameters::default().diameter;
        picture.disc(start.to_world(Point::new(0.0, radius)), radius, Style::plan());
    }
    picture.robot_with(farthest(run), &outline, pale());
    picture.robot_with(start, &outline, pale());
    run.draw(&mut picture, &scene.robots[0].spec);
    picture
}
