use roverlab::geometry::Point;
use roverlab::nav::elevation::{ElevationMap, ElevationPlanner, ElevationReplanner};
use roverlab::random::Stream;
use roverlab::world::generate::{ReliefKind, ReliefOptions, relief};
use roverlab::world::{GridCell, HeightField};

use super::Args;
use super::args::{Cost, Planner, refused};
use super::job::{plan, surface};
use crate::common::{Failure, Outcome, Report, Stopwatch, portable};
use crate::terrain::median;

/// Results of the planners on some hills.
#[derive(Debug, Clone, Copy, Default)]
struct Trial {
    /// Number of compared plans, and of those with equal costs.
    compared: u32,
    equal: u32,
    changes: u32,
    /// Durations (s).
    time: f64,
}

portable!(struct Trial { compared, equal, changes, time });

/// Samples along a side for plans by A*, and for the smaller hills that change.
const SAMPLES: usize = 512;
const CHANGING: usize = 65;
/// Number of changes of some hills.
const CHANGES: u32 = 20;

/// Runs the campaign.
pub(super) fn campaign(args: &Args) -> Result<Report, Failure> {
    let trials = args.parts.share_out(&args.plain.origin, "hills", args.runs, args.threads, |index| {
        trial(args, args.plain.seed.wrapping_add(index))
    })?;
    let sum = |of: fn(&Trial) -> u32| trials.iter().map(of).sum::<u32>();
    let (compared, equal) = (sum(|trial| trial.compared), sum(|trial| trial.equal));
    let outcome = if compared == equal { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    let time = median(trials.iter().map(|trial| trial.time).collect());
    Ok(Report::new(outcome)
        .field("runs", args.runs)
        .field("changes", sum(|trial| trial.changes))
        .field("compared", compared)
        .field("equal", equal)
        .timing("median_plan_ms", 1000.0 * time))
}

fn trial(args: &Args, seed: u64) -> Result<Trial, Failure> {
    let mut trial = Trial::default();
    for cost in Cost::ALL {
        let ground = ground(seed, SAMPLES)?;
        let map = ElevationMap::new(&ground, &args.climber()).map_err(refused)?;
        let objective = cost.objective(&args.robot);
        let mut astar = ElevationPlanner::astar(&map, objective).map_err(refused)?;
        let mut dijkstra = ElevationPlanner::dijkstra(&map, objective).map_err(refused)?;
        let (start, goal) = ends(&map);
        let stopwatch = Stopwatch::start();
        let found = plan(&mut astar, Planner::Astar, start, goal);
        trial.time = trial.time.max(stopwatch.seconds());
        let expected = plan(&mut dijkstra, Planner::Dijkstra, start, goal);
        let any = plan(&mut astar, Planner::AnyAngle, start, goal);
        let costs = [&found, &expected].map(|way| way.as_ref().ok().map(|way| way.cost));
        let no_dearer = match (&any, &found) {
            (Ok(any), Ok(found)) => any.cost <= found.cost * (1.0 + 1e-4),
            (any, found) => any.is_err() == found.is_err(),
        };
        trial.compared += 1;
        trial.equal += u32::from(costs[0] == costs[1] && no_dearer);
    }
    changed(args, seed, &mut trial)?;
    Ok(trial)
}

fn ground(seed: u64, samples: usize) -> Result<HeightField, Failure> {
    let options = ReliefOptions { samples, ..ReliefOptions::of(ReliefKind::Range) };
    let made = relief(&mut Stream::new(seed), &options).map_err(refused)?;
    Ok(surface(&made.world).map(|surface| (*surface).clone()).expect("generated hills have a surface"))
}

/// The open samples nearest to two opposite corners.
fn ends(map: &ElevationMap) -> (Point, Point) {
    let area = map.field().area();
    let nearest = |corner: Point| {
        let away = |cell: GridCell| (map.point(cell).xy() - corner).norm();
        let cells = map.open().free_cells().min_by(|&a, &b| away(a).total_cmp(&away(b)));
        cells.map_or(corner, |cell| map.point(cell).xy())
    };
    (nearest(area.min), nearest(area.max))
}

/// Compares D* Lite with new plans while the hills change.
fn changed(args: &Args, seed: u64, trial: &mut Trial) -> Result<(), Failure> {
    let mut stream = Stream::new(seed).child("changes", 0);
    let first = ground(seed, CHANGING)?;
    let map = ElevationMap::new(&first, &args.climber()).map_err(refused)?;
    let (mut robot, goal) = ends(&map);
    let objective = Cost::ALL[seed as usize % Cost::ALL.len()].objective(&args.robot);
    let mut kept = ElevationReplanner::new(map, objective, robot, goal).map_err(refused)?;
    let sample = |index: usize| first.sample(index % CHANGING, index / CHANGING) as f32;
    let mut heights: Vec<f32> = (0..CHANGING * CHANGING).map(sample).collect();
    for _ in 0..CHANGES {
        let cell = GridCell::new(stream.below(CHANGING), stream.below(CHANGING));
        let height = first.sample(cell.column, cell.row) + stream.between(-0.08, 0.08);
        kept.set_height(cell, height).map_err(refused)?;
        heights[cell.row * CHANGING + cell.column] = height as f32;
        let now = HeightField::new(CHANGING, CHANGING, first.area(), heights.clone()).map_err(refused)?;
        let map = ElevationMap::new(&now, &args.climber()).map_err(refused)?;
        let fresh = ElevationPlanner::astar(&map, objective).map_err(refused)?.plan(robot, goal).ok();
        let way = kept.plan().ok();
        trial.changes += 1;
        trial.compared += 1;
        let cost = |way: &Option<roverlab::nav::elevation::ElevationPath>| way.as_ref().map(|way| way.cost);
        trial.equal += u32::from(cost(&way) == cost(&fresh));
        if let Some(next) = way.and_then(|way| way.points.get(2).map(nalgebra::OPoint::xy)) {
            robot = next;
            kept.move_to(robot).map_err(refused)?;
        }
    }
    Ok(())
}
