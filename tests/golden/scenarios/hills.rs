//! Hills: the search for a summit, the steepest way up, ramps, edges, and plans.

use roverlab::drive::terrain::{Ascent, AscentParameters, SlopeSensor};
use roverlab::geometry::{Pose, Twist};
use roverlab::io::control::run;
use roverlab::io::{Clock, Drive, Odometry, Result};
use roverlab::nav::elevation::{Climber, ElevationMap, ElevationPlanner, Objective};
use roverlab::nav::{Fence, RampCrossing, SummitParameters, SummitSearch};
use roverlab::random::Stream;
use roverlab::safety::{CliffGuard, CliffGuardParameters};
use roverlab::world::generate::{Relief, ReliefKind, ReliefOptions, relief};
use roverlab::world::{RobotSpec, Scene};

use super::{Scenario, noise, note, ride};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("summit", summit),
    Scenario::new("steepest-ascent", ascent),
    Scenario::new("ramp-crossing", crossing),
    Scenario::new("cliff-guard", guard),
    Scenario::new("terrain-plan", plan),
];

fn made(kind: ReliefKind, seed: u64) -> Relief {
    let options = ReliefOptions { samples: 65, ..ReliefOptions::of(kind) };
    relief(&mut Stream::new(seed), &options).expect("good options")
}

fn summit() -> Result<String> {
    let range = made(ReliefKind::Range, 3);
    let spec = RobotSpec::blizzard();
    let area = range.world.floor;
    let parameters = SummitParameters {
        fence: Some(Fence { area, start: range.start }),
        ..SummitParameters::of(&spec).expect("it has a lidar")
    };
    let mut verdict = String::new();
    let log = ride(&Scene::with_robot(range.world, spec, range.start), noise(1.0, 91), |robot| {
        let mut search = SummitSearch::new(parameters)?;
        let outcome = run(robot, &mut search, 40.0, |_, _, _| {})?;
        note(&mut verdict, "search", &(outcome, search.pose(), search.looks(), search.bias()));
        note(&mut verdict, "summit", &(search.highest(), search.unknown_area()));
        Ok(())
    })?;
    Ok(log + &verdict)
}

fn ascent() -> Result<String> {
    let range = made(ReliefKind::Range, 4);
    let spec = SlopeSensor::equip(RobotSpec::blizzard());
    let mut verdict = String::new();
    let mut log = String::new();
    for sensor in [SlopeSensor::psds(&spec), SlopeSensor::lidar(&spec)] {
        let scene = Scene::with_robot(range.world.clone(), spec.clone(), range.start);
        log += &ride(&scene, noise(1.0, 92), |robot| {
            let sensor = sensor.clone().expect("it has both");
            let mut ascent = Ascent::new(sensor, AscentParameters::of(&spec))?;
            let outcome = run(robot, &mut ascent, 20.0, |_, _, _| {})?;
            note(&mut verdict, "ascent", &(outcome, ascent.height()));
            Ok(())
        })?;
    }
    Ok(log + &verdict)
}

/// The beginning of a crossing: onto a level of 0.2 m, by the first ramp.
fn crossing() -> Result<String> {
    let levels = made(ReliefKind::Ramp, 1);
    let spec = RobotSpec::blizzard();
    let parameters = RampCrossing::parameters(&spec).expect("it has a lidar");
    let mut verdict = String::new();
    let log = ride(&Scene::with_robot(levels.world, spec, levels.start), noise(1.0, 93), |robot| {
        let mut crossing = RampCrossing::new(parameters)?;
        let outcome = run(robot, &mut crossing, 60.0, |_, _, _| {})?;
        note(&mut verdict, "crossing", &(outcome, crossing.phase(), crossing.pose(), crossing.looks()));
        Ok(())
    })?;
    Ok(log + &verdict)
}

/// Blindly over a level, forwards and backwards, to its edges.
fn guard() -> Result<String> {
    let levels = made(ReliefKind::Ramp, 1);
    let parameters = CliffGuardParameters::of(&RobotSpec::blizzard());
    let spec = CliffGuard::equip(RobotSpec::blizzard(), &parameters);
    let [_, up, across, _] = levels.way[..] else { unreachable!("the way of a ramp has four places") };
    let middle = up + 0.5 * (across - up);
    let start = Pose::new(middle.x, middle.y, levels.start.heading + 0.3);
    let mut verdict = String::new();
    let log = ride(&Scene::with_robot(levels.world, spec.clone(), start), noise(1.0, 94), |robot| {
        let mut guarded = CliffGuard::new(robot, &spec, parameters)?;
        for speed in [0.3, -0.3] {
            guarded.set_speed(Twist::new(speed, 0.1))?;
            for _ in 0..8 {
                guarded.wait(0.5)?;
                note(&mut verdict, "guard", &(guarded.speed()?, guarded.is_at_edge()));
            }
        }
        Ok(())
    })?;
    Ok(log + &verdict)
}

fn plan() -> Result<String> {
    let mut log = String::new();
    for kind in ReliefKind::ALL {
        let made = made(kind, 5);
        let ground = made.world.terrain.clone().and_then(|terrain| terrain.surface).expect("hills");
        let map = ElevationMap::new(&ground, &Climber { slope: 0.4, step: 0.05, radius: 0.12 })?;
        let start = made.start.position();
        let top = map.highest_reachable(start);
        note(&mut log, "hills", &(kind, made.start, &made.way, map.open().count_free(), top));
        let Some(top) = top else { continue };
        for objective in [
            Objective::Length,
            Objective::Energy { resistance: 0.1 },
            Objective::Time { speed: 0.3, climb: 0.05 },
        ] {
            let mut planner = ElevationPlanner::astar(&map, objective)?;
            note(&mut log, "plan", &planner.plan(start, top.xy()).map(|way| (way.cost, way.points.len())));
            note(&mut log, "any angle", &planner.plan_any_angle(start, top.xy()));
        }
    }
    Ok(log)
}
