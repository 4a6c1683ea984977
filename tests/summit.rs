//! The search for the highest place that can be reached, on generated ranges and a crater.

use roverlab::io::control::run;
use roverlab::io::sim::{Mishap, SimOptions, Simulation};
use roverlab::nav::elevation::{Climber, ElevationMap};
use roverlab::nav::{Fence, SummitOutcome, SummitParameters, SummitSearch};
use roverlab::random::Stream;
use roverlab::world::generate::{ReliefKind, ReliefOptions, relief};
use roverlab::world::{RobotSpec, Scene};

/// How a search ended.
#[derive(Debug)]
struct Trial {
    outcome: SummitOutcome,
    mishap: Option<Mishap>,
    /// Metres from the highest reachable place over the map, and below it as a share of the relief.
    away: f64,
    below: f64,
    /// What it believes to be still unknown, in m².
    unknown: f64,
    looks: u32,
}

fn search(kind: ReliefKind, seed: u64, limit: f64) -> Trial {
    let made = relief(&mut Stream::new(seed), &ReliefOptions::of(kind)).unwrap();
    let (spec, start) = (RobotSpec::blizzard(), made.start);
    let ground = made.world.terrain.clone().unwrap().surface.unwrap();
    let map = ElevationMap::new(&ground, &Climber::of(&spec)).unwrap();
    let top = map.highest_reachable(start.position()).expect("a place to stand");
    let lowest = made.world.water_level.map(|water| 0.02 + water - ground.height(start.position()).unwrap());
    let fence = Some(Fence { area: ground.area(), start });
    let parameters = SummitParameters { lowest, fence, ..SummitParameters::of(&spec).unwrap() };
    let scene = Scene::with_robot(made.world, spec, start);
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, seed)).unwrap();
    let mut search = SummitSearch::new(parameters).unwrap();
    let outcome = run(&mut simulation.robot(0).unwrap(), &mut search, limit, |_, _, _| {}).unwrap();
    let truth = simulation.truth();
    let end = truth.pose_in_space(0).unwrap().position;
    Trial {
        outcome,
        mishap: truth.mishap(0).unwrap(),
        away: (end.xy() - top.xy()).norm(),
        below: (top.z - end.z) / (ground.highest() - ground.lowest()),
        unknown: search.unknown_area(),
        looks: search.looks(),
    }
}

#[test]
fn the_highest_place_of_a_range_is_found() {
    for seed in SEEDS {
        let trial = search(ReliefKind::Range, seed, 1200.0);
        assert_eq!((trial.outcome, trial.mishap), (SummitOutcome::Highest, None), "{seed}: {trial:?}");
        assert!(trial.away <= 0.1 || trial.below <= 0.02, "{seed}: {trial:?}");
        assert!(trial.unknown == 0.0 && trial.looks > 3, "{seed}: {trial:?}");
    }
}

/// Seeds of ranges: two with a way to the top of moderate length, two with hollows in which belts do not turn
/// the robot, and one whose top can be given up too early.
const SEEDS: [u64; 5] = [1, 2, 14, 187, 111];

#[test]
fn what_is_unknown_is_told_when_the_time_is_over() {
    let trial = search(ReliefKind::Range, SEEDS[0], 15.0);
    assert_eq!(trial.outcome, SummitOutcome::TimedOut);
    assert!(trial.unknown > 1.0, "{trial:?}");
}

mod campaigns {
    use super::*;

    /// `cargo test --release --all-features --test summit -- --ignored --nocapture`.
    #[test]
    #[ignore = "a campaign: roverlab summit --campaign is the whole one"]
    fn thirty_ranges() {
        let trials: Vec<Trial> = (1..31).map(|seed| search(ReliefKind::Range, seed, 1200.0)).collect();
        for (seed, trial) in (1..).zip(&trials) {
            println!("{seed} {trial:?}");
        }
        let is_reached = |trial: &&Trial| {
            trial.outcome == SummitOutcome::Highest && (trial.away <= 0.1 || trial.below <= 0.02)
        };
        let reached = trials.iter().filter(is_reached).count();
        let lost = trials.iter().filter(|trial| trial.mishap.is_some()).count();
        assert!(reached >= 29 && lost == 0, "{reached} reached, {lost} lost");
    }
}
