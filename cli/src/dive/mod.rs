//! The command `dive`.

mod campaign;

use std::sync::Arc;

use roverlab::drive::marine::{Dive, DiveOutcome, DiveParameters};
use roverlab::geometry::{Point, Point3, Pose, Pose3, Vector, units};
use roverlab::io::control;
use roverlab::io::sim::{RobotTruth, SimOptions};
use roverlab::kinematics::marine::CraftSpec;
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::{Colour, DriveSpec, RobotSpec, Scene, Water, World};

use crate::common::{
    CampaignArgs, CommonArgs, Failure, OF_A_CAMPAIGN, OF_ONE_RUN, Outcome, Report, Stage, millimetres,
    rounded,
};
use crate::driving::{RESERVE, paced};
use crate::water::{BOOK, LEVEL, WaterArgs, pool};

/// Command line of `dive`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Dives in a pool to a depth and holds it, level and on its heading, by pressure sensor and inertial unit",
    after_help = "\
Mako starts afloat in a pool of 25 x 50 m and 1.9 m depth. Depths are those of its sensor, at the middle of its hull.

With --campaign, 1000 craft whose mass differs from the model by up to 5 %, and their thrusters by up to 10 %, in currents of up to
0.1 m/s, hold a depth for 30 s and then step by 0.2 to 1.2 m.

JSON fields:
  settle_s                    time from which the true depth stays within 10 mm for 5 s; null if never
  overshoot_mm                largest distance beyond the depth
  within_10mm_percent         share of the 60 s after the first 20 s with the true depth within 10 mm
  heading_rms_deg             root mean square error of the true heading in these 60 s
  picture
  rows                        with --campaign only: the table
Outcomes: held, not_held, collided, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Depth to hold; Mako floats with its sensor about 150 mm deep.
    #[arg(long, value_name = "MM", default_value_t = 1000.0, value_parser = parse_depth, allow_hyphen_values = true)]
    pub(crate) depth: f64,

    #[command(flatten)]
    pub(crate) waters: WaterArgs,

    #[command(flatten)]
    pub(crate) trials: CampaignArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["world", "robot", "start", "goal"]),
    ("campaign", OF_ONE_RUN),
    ("campaign", &["water", "depth"]),
    ("!campaign", OF_A_CAMPAIGN),
]);

fn parse_depth(text: &str) -> Result<f64, String> {
    let depth = text.parse().ok().filter(|depth: &f64| (0.0..=1500.0).contains(depth));
    depth.ok_or_else(|| "expected 0 to 1500 mm: the pool is 1.9 m deep".into())
}

/// Seconds in which a dive is to settle, for which it is watched after them, and for which it is at its depth
/// when it has.
const SETTLING: f64 = 20.0;
const WATCHED: f64 = 60.0;
const SETTLED: f64 = 5.0;
/// Time limit (s).
const LIMIT: f64 = SETTLING + WATCHED + 5.0;
/// Seconds for which a craft of the campaign holds its depth before it steps.
const BEFORE: f64 = 30.0;
/// Metres from the depth that are good, and beyond it.
const GOOD: f64 = 0.010;
const MOST_OVERSHOOT: f64 = 0.050;

/// A dive: what is true and the controller does not know, and where it leads.
#[derive(Debug, Clone)]
struct Plan {
    noise: f64,
    seed: u64,
    /// Metres; afloat without a start.
    start: Option<f64>,
    depth: f64,
    /// Mass and thrust in terms of the model's.
    mass: f64,
    thrust: f64,
    water: Water,
}

/// What came of it.
#[derive(Debug, Clone)]
struct Dived {
    /// Time, true depth, true pose.
    trail: Vec<(f64, f64, Pose)>,
    /// The truth at the end; contacts count from when the depth was set.
    end: RobotTruth,
    in_space: Option<Pose3>,
    ending: Result<DiveOutcome, String>,
    settle: Option<f64>,
    overshoot: f64,
    within: f64,
    heading_rms: f64,
}

impl Dived {
    /// Whether it did as it should.
    fn is_good(&self) -> bool {
        self.ending == Ok(DiveOutcome::Over)
            && self.end.contacts == 0
            && self.settle.is_some_and(|seconds| seconds <= SETTLING)
            && self.overshoot <= MOST_OVERSHOOT
            && self.within >= 0.95
    }
}

/// Work of the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.trials.campaign {
        return campaign::campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let plan = Plan {
        noise: common.noise,
        seed: common.seed,
        start: None,
        depth: units::from_mm(args.depth),
        mass: 1.0,
        thrust: 1.0,
        water: args.waters.water.clone().unwrap_or_default(),
    };
    let scene = scene(&plan);
    let limit = common.time_limit.unwrap_or(LIMIT);
    let stage = common.stage(&scene, options(&plan, limit))?;
    let done = dive(&plan, &scene, &stage, limit, paced(common))?;
    let outcome = match &done.ending {
        Err(_) => Outcome::failure("failed"),
        Ok(_) if done.is_good() => Outcome::verdict("held"),
        Ok(_) => Outcome::failure("not_held"),
    };
    let report = Report {
        sim_time: done.trail.last().map(|point| point.0),
        collisions: Some(done.end.contacts.into()),
        path_length: Some(done.end.path_length),
        pose: Some(done.end.pose),
        in_space: done.in_space,
        odometry: Some(scene.robots[0].pose.compose(&done.end.odometry)),
        error: done.ending.clone().err(),
        ..Report::new(outcome)
    };
    let report = report
        .field("settle_s", done.settle.map(rounded))
        .field("overshoot_mm", millimetres(done.overshoot))
        .field("within_10mm_percent", rounded(100.0 * done.within))
        .field("heading_rms_deg", rounded(units::to_deg(done.heading_rms)));
    Ok(common.draw(report, "dive.svg", || picture(&plan, &done)))
}

/// Metres from Mako's origin to its depth sensor.
fn sensor(spec: &RobotSpec) -> f64 {
    spec.depth_sensor.map_or(0.0, |sensor| sensor.z)
}

/// The craft as it truly is.
fn craft(plan: &Plan) -> RobotSpec {
    let mut spec = RobotSpec::mako();
    if let DriveSpec::Craft(craft) = &mut spec.drive {
        let craft = Arc::make_mut(craft);
        craft.mass *= plan.mass;
        for thruster in &mut craft.thrusters {
            thruster.force *= plan.thrust;
            thruster.back *= plan.thrust;
        }
    }
    spec
}

/// The pool, and the craft in it.
fn scene(plan: &Plan) -> Scene {
    let spec = craft(plan);
    let up = sensor(&spec);
    let world = World { water: plan.water.clone(), ..pool(BOOK, |_| 0.0) };
    let mut scene = Scene::with_robot(world, spec, Pose::new(12.5, 25.0, 0.0));
    if let Some(depth) = plan.start {
        scene.robots[0].elevation = LEVEL - depth - up;
    }
    scene
}

/// What a dive is simulated by.
fn options(plan: &Plan, limit: f64) -> SimOptions {
    let before = plan.start.map_or(0.0, |_| BEFORE);
    SimOptions { time_limit: Some(before + limit + RESERVE), ..SimOptions::with_noise(plan.noise, plan.seed) }
}

/// Dives as planned, for a time at most (s). `watch` is called with the time at each step.
fn dive(
    plan: &Plan,
    scene: &Scene,
    stage: &Stage,
    limit: f64,
    mut watch: impl FnMut(f64),
) -> Result<Dived, Failure> {
    let (up, level) = (sensor(&scene.robots[0].spec), LEVEL);
    let mut truth = stage.truth(0)?;
    let before = plan.start.map_or(0.0, |_| BEFORE);
    let parameters = DiveParameters {
        depth: plan.start.unwrap_or(plan.depth),
        duration: before + SETTLING + WATCHED,
        ..DiveParameters::default()
    };
    let mut behaviour = Dive::new(&CraftSpec::mako(), parameters).map_err(Failure::input)?;
    let mut robot = stage.robot(0)?;
    let (mut trail, mut in_space) = (Vec::new(), None);
    let first = if before > 0.0 {
        control::run(&mut robot, &mut behaviour, before, |_, _, _| {}).map(|_| ())
    } else {
        Ok(())
    };
    // What its unknown weight leads to before it is learnt is no part of the step.
    let contacts_before = truth.robot(0).map_err(Failure::run)?.contacts;
    let ending = first.and_then(|()| behaviour.set_depth(plan.depth)).and_then(|()| {
        control::run(&mut robot, &mut behaviour, limit, |_, _, step| {
            if let Ok(seen) = truth.in_space(0) {
                let place = seen.pose.to_world(Point3::new(0.0, 0.0, up));
                trail.push((step.time - before, level - place.z, seen.pose.pose()));
                in_space = Some(seen.pose);
            }
            watch(step.time);
        })
    });
    drop(robot);
    let ending = ending.map_err(|error| error.to_string());
    let mut end = truth.robot(0).map_err(Failure::run)?;
    end.contacts -= contacts_before;
    Ok(Dived { in_space, ..judged(plan, trail, end, ending) })
}

fn judged(
    plan: &Plan,
    trail: Vec<(f64, f64, Pose)>,
    end: RobotTruth,
    ending: Result<DiveOutcome, String>,
) -> Dived {
    let direction = (plan.depth - trail.first().map_or(plan.depth, |point| point.1)).signum();
    let overshoot = trail.iter().map(|point| (point.1 - plan.depth) * direction).fold(0.0, f64::max);
    let good = |point: &&(f64, f64, Pose)| (point.1 - plan.depth).abs() <= GOOD;
    let mut settle = None;
    for point in &trail {
        match settle {
            _ if !good(&point) => settle = None,
            None => settle = Some(point.0),
            Some(since) if point.0 - since >= SETTLED => break,
            Some(_) => {}
        }
    }
    // A run that ends sooner has not shown that it stays.
    let last = trail.last().map_or(0.0, |point| point.0);
    let settle = settle.filter(|since| last - since >= SETTLED);
    let watched = || trail.iter().filter(|point| point.0 >= SETTLING);
    let count = watched().count().max(1) as f64;
    let squares: f64 = watched().map(|point| point.2.heading * point.2.heading).sum();
    Dived {
        within: watched().filter(good).count() as f64 / count,
        heading_rms: (squares / count).sqrt(),
        end,
        in_space: None,
        ending,
        settle,
        overshoot,
        trail,
    }
}

/// The way from above, and the depth over time.
fn picture(plan: &Plan, done: &Dived) -> Picture {
    let mut above = Picture::new(&World::empty(6.0, 3.0));
    above.title("From above: 6 m of the pool").without_scale();
    let origin = Vector::new(12.5 - 2.0, 25.0 - 1.5);
    let place = |pose: &Pose| Point::new(pose.x - origin.x, pose.y - origin.y);
    let moved = |&(time, _, pose): &(f64, f64, Pose)| {
        let at = place(&pose);
        (time, Pose::new(at.x, at.y, pose.heading))
    };
    let trail: Vec<_> = done.trail.iter().map(moved).collect();
    if !trail.is_empty() {
        above.drive(&trail, &RobotSpec::mako().footprint);
    }
    above.mark(Mark::Start, Point::new(2.0, 1.5));
    let mut side = Picture::new(&World::empty(6.0, 3.0));
    // Twenty seconds are 1.4 m, and the pool's depth 2.4 m.
    side.title("From the side, over 80 s").without_scale();
    let at = |time: f64, depth: f64| Point::new(0.2 + 5.6 * time / 80.0, 2.7 - 2.4 * depth / LEVEL);
    side.line([at(0.0, 0.0), at(80.0, 0.0)], Style::new(Colour::from_hex(0x70_c0_d8)).labelled("surface"));
    side.line([at(0.0, LEVEL), at(80.0, LEVEL)], Style::new(Colour::from_hex(0x60_50_40)).labelled("floor"));
    side.line([at(0.0, plan.depth), at(80.0, plan.depth)], Style::plan());
    side.trace(done.trail.iter().map(|(time, depth, _)| (*time, at(*time, *depth))), Style::true_path());
    let mut both = Picture::panels(&[above, side], 1);
    both.title(format!("Dive to {:.0} mm", units::to_mm(plan.depth)));
    let settle =
        done.settle.map_or("never settled".into(), |seconds| format!("settled after {seconds:.1} s"));
    both.caption(format!(
        "{settle}, {:.0} mm beyond, {:.1} % within 10 mm",
        units::to_mm(done.overshoot),
        100.0 * done.within
    ));
    both
}
