use std::sync::Arc;

use roverlab::geometry::{Point, Point3, units};
use roverlab::nav::elevation::{ElevationPath, ElevationPlanner};
use roverlab::nav::grid::PlanError;
use roverlab::picture::{Mark, Picture, Style};
use roverlab::random::Stream;
use roverlab::world::generate::{ReliefKind, ReliefOptions, relief};
use roverlab::world::{HeightField, World, formats};

use super::Args;
use super::args::{Planner, refused};
use super::campaign::campaign;
use crate::common::{Failure, Outcome, Report, Stopwatch, millimetres, rounded};
use crate::terrain::{degrees, elevation_map, percent, unfit};

/// Runs the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.campaign {
        return campaign(args);
    }
    args.plain.check_picture()?;
    let (world, start) = hills(args)?;
    let ground = surface(&world).ok_or_else(|| {
        Failure::input("found a world without hills; expected a line `terrain WIDTH HEIGHT TOP FILE`")
    })?;
    let stopwatch = Stopwatch::start();
    let map = elevation_map(&world, &ground, &args.climber())?;
    let top = map.highest_reachable(start).ok_or_else(|| unfit(start))?;
    let goal = args.goal.unwrap_or(top.xy());
    check_inside(&ground, goal)?;
    let objective = args.cost.objective(&args.robot);
    let mut planner = match args.planner {
        Planner::Dijkstra => ElevationPlanner::dijkstra(&map, objective),
        Planner::Astar | Planner::AnyAngle => ElevationPlanner::astar(&map, objective),
    }
    .map_err(refused)?;
    let prepared = stopwatch.seconds();
    let path = plan(&mut planner, args.planner, start, goal);
    let planned = stopwatch.seconds() - prepared;
    let back = plan(&mut planner, args.planner, goal, start).ok();
    let report = match &path {
        Ok(path) => found(args, &ground, path, back.as_ref()),
        Err(PlanError::Unreachable { .. } | PlanError::Blocked { .. }) => {
            Report::new(Outcome::verdict("unreachable"))
        }
        Err(error) => return Err(Failure::input(format!("--goal: {error}"))),
    };
    let open = map.open().count_free() as f64 / (ground.columns() * ground.rows()) as f64;
    let report = report
        .field("samples", [ground.columns(), ground.rows()])
        .field("open_percent", percent(open))
        .field("highest_reachable_mm", millimetres(top.z))
        .field("slope_limit_deg", degrees(args.climber().slope))
        .timing("prepare_ms", 1000.0 * prepared)
        .timing("plan_ms", 1000.0 * planned);
    Ok(args.plain.draw(report, "terrain_plan.svg", || picture(&world, args, path.as_ref().ok(), start, goal)))
}

/// The world and the start of the path.
fn hills(args: &Args) -> Result<(World, Point), Failure> {
    let Some(file) = &args.world else {
        let options = ReliefOptions::of(ReliefKind::Range);
        let made = relief(&mut Stream::new(args.plain.seed), &options).map_err(refused)?;
        return Ok((made.world, args.start.unwrap_or(made.start).position()));
    };
    let scene = formats::load_scene(file).map_err(Failure::input)?;
    let scene = args.plain.origin.scene(file, scene, args.start);
    let start = scene.world.start.ok_or_else(|| {
        Failure::input(format!(
            "{}: found no start; expected --start X,Y,DEG or a robot in a .sim",
            file.display()
        ))
    })?;
    Ok((scene.world, start.position()))
}

fn check_inside(ground: &HeightField, goal: Point) -> Result<(), Failure> {
    let area = ground.area();
    if area.contains(goal) {
        return Ok(());
    }
    let [low, high] = [area.min, area.max].map(|corner| corner.coords.map(units::to_mm));
    Err(Failure::input(format!(
        "--goal: found {:.0},{:.0}, outside of the hills; expected {:.0} to {:.0} and {:.0} to {:.0} mm",
        units::to_mm(goal.x),
        units::to_mm(goal.y),
        low.x,
        high.x,
        low.y,
        high.y
    )))
}

pub(super) fn surface(world: &World) -> Option<Arc<HeightField>> {
    world.terrain.as_ref().and_then(|terrain| terrain.surface.clone())
}

pub(super) fn plan(
    planner: &mut ElevationPlanner<'_>,
    how: Planner,
    start: Point,
    goal: Point,
) -> Result<ElevationPath, PlanError> {
    match how {
        Planner::Dijkstra | Planner::Astar => planner.plan(start, goal),
        Planner::AnyAngle => planner.plan_any_angle(start, goal),
    }
}

fn found(args: &Args, ground: &HeightField, path: &ElevationPath, back: Option<&ElevationPath>) -> Report {
    let (factor, unit) = args.cost.unit(&args.robot);
    let along = along_ground(ground, path);
    let steps = || along.windows(2).map(|pair| pair[1] - pair[0]);
    let climb: f64 = steps().map(|step| step.z.max(0.0)).sum();
    Report::new(Outcome::verdict("found"))
        .field("cost", rounded(factor * path.cost))
        .field("unit", unit)
        .field("cost_back", back.map(|back| rounded(factor * back.cost)))
        .field("length_mm", millimetres(steps().map(|step| step.norm()).sum()))
        .field("climb_mm", millimetres(climb))
        .field("turns", path.points.len())
        .field("expanded", path.statistics.expanded)
}

/// Points of a path, a sample apart at most: between its turns the ground rises and falls.
fn along_ground(ground: &HeightField, path: &ElevationPath) -> Vec<Point3> {
    let mut along: Vec<Point3> = path.points.first().copied().into_iter().collect();
    for pair in path.points.windows(2) {
        let way = pair[1] - pair[0];
        let parts = (way.xy().norm() / ground.pitch().min()).ceil().max(1.0) as usize;
        along.extend((1..=parts).map(|part| {
            let at = pair[0] + way * (part as f64 / parts as f64);
            Point3::new(at.x, at.y, ground.height(at.xy()).unwrap_or(at.z))
        }));
    }
    along
}

fn picture(world: &World, args: &Args, path: Option<&ElevationPath>, start: Point, goal: Point) -> Picture {
    let mut picture = Picture::new(world);
    let (factor, unit) = args.cost.unit(&args.robot);
    let title = match path {
        Some(path) => format!("A way over hills: {:.0} {unit}", factor * path.cost),
        None => "No way over the hills".to_owned(),
    };
    let limit = units::to_deg(args.climber().slope);
    picture.title(title).caption(format!("{}, slopes up to {limit:.0} degrees", args.robot.name));
    if let Some(path) = path {
        picture.line(path.points.iter().map(nalgebra::OPoint::xy), Style::plan().width(3.0));
    }
    picture.mark(Mark::Start, start).mark(Mark::Goal, goal);
    picture
}
