use std::panic::resume_unwind;
use std::thread;

use roverlab::ParameterError;
use roverlab::geometry::{Aabb, Point, Vector};
use roverlab::nav::grid::{AnyAngle, GridPlanner};
use roverlab::nav::{BugKind, BugParameters, Reachability};
use roverlab::random::Stream;
use roverlab::world::generate::{Course, CourseFamily, CourseOptions, obstacle_course};
use roverlab::world::{BitGrid, BitGridError, GridCell, RobotSpec, Scene, World};

use super::ride::{Conditions, Ride, parameters, ride, ride_with};
use super::{Args, job};
use crate::common::{Driven, Failure, StageTruth, Trip, onlooker, share_out, threads};
use crate::driving::world_with_others;

/// A world with a robot and a goal, and its ground truth.
#[derive(Debug, Clone)]
pub(crate) struct Setting {
    /// Name of the family, or of the world.
    pub(crate) family: String,
    pub(crate) seed: u64,
    pub(crate) trip: Trip,
    /// Length of the shortest way of the robot's outline to the goal itself, if there is one (m).
    pub(crate) shortest: Option<f64>,
    /// Whether a way leads to within the goal's tolerance for the disc of the algorithms: the outline with
    /// the least clearance. `None` if a cell decides.
    pub(crate) reachable: Option<bool>,
}

/// Cell size of the grid for shortest ways (m).
const RESOLUTION: f64 = 0.010;
/// Least cell size (m) and approximate maximum number of cells of the grid for the ground truth of verdicts.
const TRUTH: (f64, f64) = (0.005, 4e6);
/// Time limit as a multiple of a generous one for DistBug: some algorithms see nothing ahead.
const PATIENCE: f64 = 4.0;

impl Setting {
    pub(crate) fn new(family: &str, seed: u64, trip: Trip) -> Result<Self, Failure> {
        let radius = trip.spec().footprint.bounding_radius();
        let ways = Reachability::new(&known(&trip), radius, RESOLUTION).map_err(Failure::run)?;
        let shortest = shortest_way(&ways, trip.start().position(), trip.goal).map_err(Failure::run)?;
        let reachable = reachable(&trip).map_err(Failure::run)?;
        Ok(Self { family: family.to_owned(), seed, trip, shortest, reachable })
    }

    /// A generated course.
    pub(crate) fn of_course(family: &str, seed: u64, course: &Course) -> Result<Self, Failure> {
        let scene = Scene::with_robot(course.world.clone(), RobotSpec::s4(), course.start);
        Self::new(family, seed, Trip { scene, goal: course.goal })
    }

    /// Driving conditions.
    pub(crate) fn conditions(&self, args: &Args) -> Conditions {
        let time_limit = args.common.time_limit.unwrap_or_else(|| PATIENCE * self.trip.generous_time_limit());
        Conditions { seed: self.seed, noise: args.common.noise, time_limit }
    }
}

/// The world of a trip, in which other robots stand, with a floor as far as its goal.
fn known(trip: &Trip) -> World {
    let (world, goal) = (world_with_others(&trip.scene), trip.goal);
    World { floor: world.floor.union(&Aabb::new(goal, goal)), ..world }
}

/// Whether a way leads to the goal; `None` if cells are too coarse to tell.
fn reachable(trip: &Trip) -> Result<Option<bool>, ParameterError> {
    let BugParameters { robot_radius, least_clearance, goal_tolerance, .. } = parameters(trip, 0.0);
    let world = &known(trip);
    let (finest, cells) = TRUTH;
    let size = world.site().size();
    let cell = finest.max((size.x * size.y / cells).sqrt());
    let start = trip.start().position();
    // The answers on a grid are those for a radius that differs by less than a cell.
    let by = |difference: f64| {
        let ways = Reachability::new(world, robot_radius + least_clearance + difference, cell)?;
        let tolerance = goal_tolerance - difference;
        let is_joined = |from: Point| around(trip.goal, tolerance, cell).any(|to| ways.connected(from, to));
        // A robot too close to something backs off first.
        Ok(around(start, goal_tolerance, cell).any(is_joined))
    };
    let (wider, narrower) = (by(cell)?, by(-cell)?);
    Ok((wider == narrower).then_some(wider))
}

/// A point and others within a distance of it, on a square grid (m).
fn around(centre: Point, far: f64, step: f64) -> impl Iterator<Item = Point> {
    let steps = (far / step).floor().max(0.0) as i32;
    let offsets = (-steps..=steps).flat_map(move |row| (-steps..=steps).map(move |column| (column, row)));
    offsets
        .map(move |(column, row)| Vector::new(f64::from(column), f64::from(row)) * step)
        .filter(move |offset| offset.norm() <= far.max(0.0))
        .map(move |offset| centre + offset)
}

/// Length of the shortest any-angle way between two places, if there is one (m).
fn shortest_way(ways: &Reachability, start: Point, goal: Point) -> Result<Option<f64>, BitGridError> {
    let raster = ways.raster();
    let (Some(from), Some(to)) = (raster.cell_at(start), raster.cell_at(goal)) else { return Ok(None) };
    let columns = raster.columns();
    let is_free = |column, row| ways.is_free(raster.centre(row * columns + column));
    let floor = BitGrid::from_fn(columns, raster.rows(), is_free)?;
    let [from, to] = [from, to].map(|cell| GridCell::new(cell % columns, cell / columns));
    Ok(AnyAngle::new(&floor).plan(from, to).ok().map(|path| path.cost * raster.resolution()))
}

/// Runs of all algorithms in one setting.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) setting: Setting,
    pub(crate) rides: Vec<Ride>,
}

/// Drives all algorithms in all settings, in order.
pub(crate) fn entries(args: &Args) -> Result<Vec<Entry>, Failure> {
    let runs = args.runs.unwrap_or(10);
    let own = args.common.world.is_some().then(|| job::own_trip(args)).transpose()?;
    let families = if own.is_some() { 1 } else { args.families().len() as u64 };
    share_out("courses", families * runs, threads(args.threads), |index| {
        let seed = args.common.seed.wrapping_add(index % runs);
        let setting = match &own {
            Some(trip) => Setting::new("world", seed, trip.clone())?,
            None => of_family(args.families()[(index / runs) as usize], seed)?,
        };
        enter(args, setting)
    })
}

/// The setting to show and record: the world of `--world`, otherwise the first course of the campaign or of
/// the first family.
pub(crate) fn shown(args: &Args) -> Result<Setting, Failure> {
    if args.campaign {
        return of_campaign(args.common.seed);
    }
    if args.common.world.is_some() {
        return Setting::new("world", args.common.seed, job::own_trip(args)?);
    }
    of_family(args.families()[0], args.common.seed)
}

/// Drives all algorithms in the shown setting, in one recording.
pub(crate) fn recorded(args: &Args) -> Result<Entry, Failure> {
    let setting = shown(args)?;
    let (trip, conditions, bugs) = (&setting.trip, setting.conditions(args), args.bugs());
    let stage = args.common.stage_apart(&trip.scene, &conditions.sim_options(), bugs.len())?;
    let robots = (0..bugs.len()).map(|index| Ok((stage.robot(index)?, stage.truth(index)?)));
    let robots: Vec<(Driven, StageTruth)> = robots.collect::<Result<_, Failure>>()?;
    if onlooker::stands_in() {
        return looked_at(setting, conditions, bugs, robots);
    }
    let rides = thread::scope(|scope| {
        let drive = |(&kind, (robot, mut truth)): (&BugKind, (Driven, StageTruth))| {
            scope.spawn(move || ride_with(trip, kind, conditions, robot, &mut truth))
        };
        let threads: Vec<_> = bugs.iter().zip(robots).map(drive).collect();
        let rides =
            threads.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic)));
        rides.collect::<Result<_, Failure>>()
    })?;
    Ok(Entry { setting, rides })
}

/// The run of the single algorithm shown to an onlooker.
fn looked_at(
    setting: Setting,
    conditions: Conditions,
    bugs: &[BugKind],
    robots: Vec<(Driven, StageTruth)>,
) -> Result<Entry, Failure> {
    let (&[kind], Some((robot, mut truth))) = (bugs, robots.into_iter().next()) else {
        return Err(Failure::input(format!("--bugs: found {} to look at; expected one", bugs.len())));
    };
    let ride = ride_with(&setting.trip, kind, conditions, robot, &mut truth)?;
    Ok(Entry { setting, rides: vec![ride] })
}

/// The course of a family and a seed.
pub(crate) fn of_family(family: CourseFamily, seed: u64) -> Result<Setting, Failure> {
    let course = family.course(&mut Stream::new(seed)).map_err(Failure::run)?;
    Setting::of_course(family.name(), seed, &course)
}

/// The campaign's course of a seed.
pub(crate) fn of_campaign(seed: u64) -> Result<Setting, Failure> {
    let course = obstacle_course(&mut Stream::new(seed), &campaign_options()).map_err(Failure::run)?;
    Setting::of_course("course", seed, &course)
}

/// Options of the campaign's courses, for the robot in use.
pub(crate) fn campaign_options() -> CourseOptions {
    let robot_radius = RobotSpec::s4().footprint.bounding_radius();
    CourseOptions { robot_radius, ..CourseOptions::default() }
}

fn enter(args: &Args, setting: Setting) -> Result<Entry, Failure> {
    let conditions = setting.conditions(args);
    let drive = |&kind| {
        let ride = ride(&setting.trip, kind, conditions)?;
        // Pictures drive anew; the paths of many runs would fill the memory.
        Ok(Ride { path: Vec::new(), ..ride })
    };
    let rides = args.bugs().iter().map(drive).collect::<Result<_, Failure>>()?;
    Ok(Entry { setting, rides })
}
