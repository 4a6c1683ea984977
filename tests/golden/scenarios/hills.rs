//! Hills: the search for a summit, the steepest way up, and plans.

use roverlab::drive::terrain::{Ascent, AscentParameters, SlopeSensor};
use roverlab::io::Result;
use roverlab::io::control::run;
use roverlab::nav::elevation::{Climber, ElevationMap, ElevationPlanner, Objective};
use roverlab::nav::{Fence, SummitParameters, SummitSearch};
use roverlab::random::Stream;
use roverlab::world::generate::{Relief, ReliefKind, ReliefOptions, relief};
use roverlab::world::{RobotSpec, Scene};

use super::{Scenario, noise, note, ride};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("summit", summit),
    Scenario::new("steepest-ascent", ascent),
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
