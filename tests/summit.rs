//! Behaviours on unknown hills: the search for the highest place that can be reached, and crossings of
//! levels.

use roverlab::geometry::{Aabb, Point, Pose, math, units};
use roverlab::io::control::run;
use roverlab::io::sim::{Mishap, SimOptions, Simulation};
use roverlab::nav::elevation::{Climber, ElevationMap};
use roverlab::nav::{Fence, RampCrossing, RampOutcome, SummitOutcome, SummitParameters, SummitSearch};
use roverlab::random::Stream;
use roverlab::world::generate::{ReliefKind, ReliefOptions, relief};
use roverlab::world::{HeightField, RobotSpec, Scene, Terrain, Wall, World};

/// How a search ended.
#[derive(Debug)]
struct Trial {
    outcome: SummitOutcome,
    mishap: Option<Mishap>,
    contacts: u32,
    /// Metres from the highest reachable place over the map, and below it as a share of the relief.
    away: f64,
    below: f64,
    /// What it believes to be still unknown, in m².
    unknown: f64,
    looks: u32,
}

fn search(kind: ReliefKind, seed: u64, limit: f64) -> Trial {
    let made = relief(&mut Stream::new(seed), &ReliefOptions::of(kind)).unwrap();
    search_on(made.world, made.start, seed, limit)
}

fn search_on(world: World, start: Pose, seed: u64, limit: f64) -> Trial {
    let spec = RobotSpec::blizzard();
    let ground = world.terrain.clone().unwrap().surface.unwrap();
    let shore = world.water_level.map_or(f64::NEG_INFINITY, |water| water + 0.02);
    let map = ElevationMap::new(&ground, &Climber::of(&spec)).unwrap().above(shore).unwrap();
    let map = map.clear_of(&world).unwrap();
    let top = map.highest_reachable(start.position()).expect("a place to stand");
    let lowest = Some(shore - ground.height(start.position()).unwrap()).filter(|lowest| lowest.is_finite());
    let fence = Some(Fence { area: ground.area(), start });
    let parameters = SummitParameters { lowest, fence, ..SummitParameters::of(&spec).unwrap() };
    let scene = Scene::with_robot(world, spec, start);
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, seed)).unwrap();
    let mut search = SummitSearch::new(parameters).unwrap();
    let outcome = run(&mut simulation.robot(0).unwrap(), &mut search, limit, |_, _, _| {}).unwrap();
    let truth = simulation.truth();
    let end = truth.pose_in_space(0).unwrap().position;
    Trial {
        outcome,
        mishap: truth.mishap(0).unwrap(),
        contacts: truth.robot(0).unwrap().contacts,
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

/// Seeds of ranges: one with a way to the top of moderate length, and two with hollows in which belts do not
/// turn the robot, so that it could be cut off from the top by what it takes for too steep.
const SEEDS: [u64; 3] = [1, 115, 187];

#[test]
fn what_is_unknown_is_told_when_the_time_is_over() {
    let trial = search(ReliefKind::Range, SEEDS[0], 15.0);
    assert_eq!(trial.outcome, SummitOutcome::TimedOut);
    assert!(trial.unknown > 1.0, "{trial:?}");
}

/// Hills by a formula.
fn hills(width: f64, depth: f64, height: impl FnMut(Point) -> f64) -> World {
    let area = Aabb::new(Point::origin(), Point::new(width, depth));
    let [columns, rows] = [width, depth].map(|side| (32.0 * side) as usize + 1);
    let surface = HeightField::from_fn(columns, rows, area, height).unwrap();
    World { terrain: Some(Terrain::new("hills.png", surface)), ..World::empty(width, depth) }
}

fn hill(at: Point, middle: [f64; 2], height: f64, width: f64) -> f64 {
    height * math::exp(-(at - Point::from(middle)).norm_squared() / (width * width))
}

/// Belts hold on its shore, and do not turn the robot: it must not drive on into the water.
#[test]
fn an_island_is_searched_without_getting_wet() {
    let height = |at: Point| hill(at, [1.0, 1.0], 0.3, 0.7) + hill(at, [3.0, 3.0], 0.4, 0.8);
    let world = World { water_level: Some(0.1), ..hills(4.0, 4.0, height) };
    let trial = search_on(world, Pose::new(1.0, 1.0, 0.0), 1, 600.0);
    assert_eq!((trial.outcome, trial.mishap), (SummitOutcome::Highest, None), "{trial:?}");
    assert!(trial.away <= 0.1, "{trial:?}");
}

/// The hills rise up to their border, behind which the robot would fall.
#[test]
fn a_robot_keeps_away_from_the_border_of_its_hills() {
    let world = hills(4.0, 4.0, |at| 0.02 + 0.05 * at.x + hill(at, [4.0, 4.0], 0.2, 1.0));
    let trial = search_on(world, Pose::new(1.0, 1.0, 0.0), 1, 600.0);
    assert_eq!((trial.outcome, trial.mishap), (SummitOutcome::Highest, None), "{trial:?}");
    assert!(trial.away <= 0.2, "{trial:?}");
}

/// A wall parts the hills, and the higher one is behind it.
#[test]
fn a_hill_behind_a_wall_cannot_be_reached() {
    let height = |at: Point| hill(at, [1.2, 1.2], 0.2, 0.7) + hill(at, [3.8, 3.8], 0.35, 0.8);
    let wall = Wall::new(Point::new(0.0, 2.6), Point::new(5.0, 2.4));
    let world = World { walls: vec![wall], ..hills(5.0, 5.0, height) };
    for seed in [1, 2] {
        let trial = search_on(world.clone(), Pose::new(0.6, 0.8, 0.0), seed, 600.0);
        assert_eq!((trial.outcome, trial.mishap), (SummitOutcome::Highest, None), "{seed}: {trial:?}");
        assert!(trial.away <= 0.1 && trial.contacts == 0, "{seed}: {trial:?}");
    }
}

/// Ramps lead up to a level on two sides. Where they begin, their sides are no higher than what is between
/// two beams, and too high for the robot; the ground around tells little of where it is.
#[test]
fn a_robot_keeps_off_the_sides_of_ramps() {
    let height = |at: Point| {
        let beyond = (at.x - 3.0).abs() - 0.8;
        let on_level = beyond <= 0.0 && (at.y - 3.0).abs() <= 0.8;
        let on_ramp = (at.y - 3.0).abs() <= 0.5;
        if on_level || on_ramp { (0.3 - 0.287 * beyond.max(0.0)).max(0.0) } else { 0.0 }
    };
    for (seed, start) in [(5, Pose::new(3.0, 0.9, 0.8)), (6, Pose::new(3.0, 5.1, 0.2))] {
        let trial = search_on(hills(6.0, 6.0, height), start, seed, 600.0);
        assert_eq!((trial.outcome, trial.mishap), (SummitOutcome::Highest, None), "{seed}: {trial:?}");
        assert!(trial.below <= 0.02 && trial.looks < 40, "{seed}: {trial:?}");
    }
}

/// The bank of a straight river is the same everywhere: nothing there tells how far belts have slipped
/// along it, so that the robot must not trust its place beside the border.
#[test]
fn a_robot_that_does_not_know_its_place_keeps_away_from_the_border() {
    let height = |at: Point| 0.2 - 0.25 * math::exp(-((at.x - 2.5) / 0.5) * ((at.x - 2.5) / 0.5));
    let world = World { water_level: Some(0.06), ..hills(5.0, 5.0, |at| height(at).max(0.0)) };
    for seed in [1, 3] {
        let trial = search_on(world.clone(), Pose::new(0.8, 1.0, 0.0), seed, 300.0);
        assert_eq!(trial.mishap, None, "{seed}: {trial:?}");
    }
}

/// Crosses a level of 0.15 m, 1.6 m wide; its height along x is a function of the place.
fn cross(height: impl Fn(f64) -> f64) -> (RampOutcome, Option<Mishap>, Pose) {
    let level = |at: Point| if (1.2..=2.8).contains(&at.y) { height(at.x).clamp(0.0, 0.15) } else { 0.0 };
    let (world, spec) = (hills(6.0, 4.0, level), RobotSpec::blizzard());
    let fence = Some(Fence {
        area: Aabb::new(Point::origin(), Point::new(6.0, 4.0)),
        start: Pose::new(0.8, 2.0, 0.0),
    });
    let parameters = SummitParameters { fence, ..RampCrossing::parameters(&spec).unwrap() };
    let scene = Scene::with_robot(world, spec, Pose::new(0.8, 2.0, 0.0));
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1)).unwrap();
    let mut crossing = RampCrossing::new(parameters).unwrap();
    let outcome = run(&mut simulation.robot(0).unwrap(), &mut crossing, 400.0, |_, _, _| {}).unwrap();
    let truth = simulation.truth();
    (outcome, truth.mishap(0).unwrap(), truth.pose(0).unwrap())
}

#[test]
fn a_ramp_down_straight_ahead_is_another_one() {
    for degrees in [12.0, 20.0] {
        let rise = math::tan(units::from_deg(degrees));
        let (outcome, mishap, end) = cross(|x| (rise * (x - 1.5)).min(rise * (5.0 - x)));
        assert_eq!((outcome, mishap), (RampOutcome::Crossed, None), "{degrees}: {end:?}");
        assert!(end.x > 4.8, "{degrees}: {end:?}");
    }
}

/// Parts of the ramp that it came by are no other ramp, from wherever they are seen.
#[test]
fn a_level_with_one_ramp_only_is_a_dead_end() {
    let (outcome, mishap, end) = cross(|x| if x < 4.5 { 0.25 * (x - 1.5) } else { 0.0 });
    assert_eq!((outcome, mishap), (RampOutcome::NoWayDown, None), "{end:?}");
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
