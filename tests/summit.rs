//! The search for the highest place that can be reached, on generated ranges.

use roverlab::geometry::{Pose, units};
use roverlab::io::control::run;
use roverlab::io::sim::{Mishap, SimOptions, Simulation};
use roverlab::nav::elevation::{Climber, ElevationMap, ElevationPlanner, Objective};
use roverlab::nav::{SummitOutcome, SummitParameters, SummitSearch};
use roverlab::random::Stream;
use roverlab::world::generate::{Relief, ReliefKind, ReliefOptions, relief};
use roverlab::world::{RobotSpec, Scene};

/// A search, and what is true about it.
#[derive(Debug)]
struct Trial {
    outcome: SummitOutcome,
    mishap: Option<Mishap>,
    /// Metres from the highest reachable place, and below it as a share of the relief.
    away: f64,
    below: f64,
    path: f64,
    /// The length of the way of who knows the map.
    best: f64,
    tilt: f64,
    time: f64,
    looks: u32,
}

impl Trial {
    fn is_reached(&self) -> bool {
        self.outcome == SummitOutcome::Highest && (self.away <= 0.1 || self.below <= 0.02)
    }
}

fn search(made: Relief, noise: f64, seed: u64) -> Trial {
    let spec = RobotSpec::blizzard();
    let climber = Climber::of(&spec);
    let ground = made.world.terrain.clone().unwrap().surface.unwrap();
    let map = ElevationMap::new(&ground, &climber).unwrap();
    let start = made.start;
    let top = map.highest_reachable(start.position()).expect("a place to stand");
    let way = ElevationPlanner::astar(&map, Objective::Length).unwrap().plan_any_angle(start.position(), top.xy());
    let parameters = SummitParameters::of(&spec).unwrap();
    let lowest = made.world.water_level.map(|water| water - ground.height(start.position()).unwrap());
    let parameters = SummitParameters { lowest, ..parameters };
    let simulation =
        Simulation::new(&Scene::with_robot(made.world, spec, start), SimOptions::with_noise(noise, seed)).unwrap();
    let truth = simulation.truth();
    let mut search = SummitSearch::new(parameters).unwrap();
    let mut tilt = 0.0_f64;
    let verbose = std::env::var("SUMMIT_TRACE").is_ok();
    let mut last = 0;
    let outcome = run(&mut simulation.robot(0).unwrap(), &mut search, 1200.0, |_, search, step| {
        tilt = tilt.max(truth.pose_in_space(0).unwrap().tilt());
        if verbose && search.looks() != last {
            last = search.looks();
            let (at, z) = search.pose();
            let believed = start.compose(&at);
            let pose = truth.pose_in_space(0).unwrap();
            println!(
                "{:6.1} look {last}: at {:.2} {:.2} {:.3}, true {:.2} {:.2} {:.3}; highest {:.3}, unknown {:.2}, way {}",
                step.time, believed.x, believed.y, z + ground.height(start.position()).unwrap(),
                pose.position.x, pose.position.y, pose.position.z,
                search.highest() + ground.height(start.position()).unwrap(), search.unknown_area(), search.way().len()
            );
        }
    })
    .unwrap();
    let end = truth.robot(0).unwrap();
    let height = truth.pose_in_space(0).unwrap().position.z;
    Trial {
        outcome,
        mishap: truth.mishap(0).unwrap(),
        away: (end.pose.position() - top.xy()).norm(),
        below: (top.z - height) / (ground.highest() - ground.lowest()),
        path: end.path_length,
        best: way.map_or(0.0, |way| way.cost),
        tilt,
        time: truth.time(),
        looks: search.looks(),
    }
}

fn range(seed: u64) -> Relief {
    relief(&mut Stream::new(seed), &ReliefOptions::of(ReliefKind::Range)).unwrap()
}

#[test]
#[ignore = "a campaign"]
fn campaign() {
    let read = |name: &str, usual: u64| std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(usual);
    let (first, runs) = (read("SUMMIT_FIRST", 1), read("SUMMIT_RUNS", 20));
    let (mut good, mut ratios) = (0, Vec::new());
    for seed in first..first + runs {
        let begun = std::time::Instant::now();
        let trial = search(range(seed), read("SUMMIT_NOISE", 1) as f64, seed);
        good += u64::from(trial.is_reached());
        ratios.push(trial.path / trial.best.max(0.1));
        println!(
            "{seed:4} {} {:?} {:?}: {:.0} mm away, {:.1} % below, path {:.1} m of {:.1}, tilt {:.0}, {:.0} s, {} looks, {:.1} s",
            if trial.is_reached() { "ok " } else { "BAD" },
            trial.outcome, trial.mishap, units::to_mm(trial.away), 100.0 * trial.below, trial.path, trial.best,
            units::to_deg(trial.tilt), trial.time, trial.looks, begun.elapsed().as_secs_f64()
        );
    }
    ratios.sort_by(f64::total_cmp);
    println!("{good} of {runs}, median ratio {:.2}", ratios[ratios.len() / 2]);
}

#[test]
fn the_start_is_the_origin() {
    assert_eq!(Pose::default().x, 0.0);
}
