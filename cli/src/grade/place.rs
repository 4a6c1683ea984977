use std::sync::Arc;

use roverlab::drive::{CoverageMap, CoverageMapParameters};
use roverlab::geometry::{Point, Pose, units};
use roverlab::nav::Reachability;
use roverlab::nav::grid::{AnyAngle, GridPlanner};
use roverlab::world::formats;
use roverlab::world::{BitGrid, GridCell, RobotPlacement, RobotSpec, Scene};

use super::rubric::{Rubric, Task};
use crate::common::{Failure, Origin};

/// A world of a rubric, with what has to be done in it.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub(super) task: Task,
    pub(super) scene: Scene,
    /// Length of the shortest way through all places to come to (m); none without such places.
    pub(super) shortest: Option<f64>,
}

impl Place {
    /// Loads a world. Fails for a place that the robot cannot come to.
    pub(super) fn load(rubric: &Rubric, task: &Task, origin: &Origin) -> Result<Self, Failure> {
        let name = task.file.display();
        let [x, y, heading] = task.start;
        let start = Pose::from_mm_deg(x, y, heading);
        let file = formats::load_scene(&task.file).map_err(Failure::input)?;
        let mut scene = origin.scene(&task.file, file, Some(start));
        let spec = Arc::new(robot(&rubric.robot)?);
        match scene.robots.first_mut() {
            Some(first) => (first.spec, first.pose) = (spec, start),
            None => scene.robots.push(RobotPlacement::new(spec, start)),
        }
        if let Some(found) = scene.robot_misplacement(0) {
            return Err(Failure::input(format!("{name}: found a start {found}; expected free floor")));
        }
        let shortest = shortest(&scene, task).ok_or_else(|| {
            Failure::input(format!(
                "{name}: found no way through the places; expected one for {}",
                rubric.robot
            ))
        })?;
        Ok(Self { task: task.clone(), scene, shortest: (shortest > 0.0).then_some(shortest) })
    }

    /// Whether a path does what it should. `is_at_rest`: the program has ended by itself.
    pub(super) fn is_done(&self, path: &[Point], is_at_rest: bool) -> bool {
        let mut rest = path.iter();
        let visited = self.task.visit.iter().all(|place| rest.any(|point| is_in(*point, place)));
        let ended = self
            .task
            .end
            .is_none_or(|place| is_at_rest && path.last().is_some_and(|point| is_in(*point, &place)));
        visited && ended && self.task.cover.is_none_or(|percent| 100.0 * self.covered(path) >= percent)
    }

    /// Fraction of the floor that a robot has passed over.
    fn covered(&self, path: &[Point]) -> f64 {
        let radius = self.scene.robots[0].spec.footprint.bounding_radius();
        let parameters = CoverageMapParameters { radius, ..CoverageMapParameters::default() };
        let start = self.scene.robots[0].pose.position();
        let Ok(mut map) = CoverageMap::new(&self.scene.world, start, parameters) else { return 0.0 };
        for point in path {
            map.cover(*point);
        }
        map.share()
    }
}

/// A built-in robot, or one of a file.
fn robot(name: &str) -> Result<RobotSpec, Failure> {
    match RobotSpec::predefined(name) {
        Some(spec) => Ok(spec),
        None => Ok(formats::load_robot_tolerantly(name).map_err(Failure::input)?.value),
    }
}

/// Middle of a place.
pub(super) fn middle(place: &[f64; 3]) -> Point {
    Point::new(units::from_mm(place[0]), units::from_mm(place[1]))
}

fn is_in(point: Point, place: &[f64; 3]) -> bool {
    (point - middle(place)).norm() <= units::from_mm(place[2])
}

/// The point of a place nearest to its middle where the robot can stand: there may be a thing in the middle.
fn free_in(ways: &Reachability, place: &[f64; 3]) -> Option<Point> {
    let (raster, away) = (ways.raster(), |point: &Point| (point - middle(place)).norm());
    let cells = (0..raster.columns() * raster.rows()).map(|cell| raster.centre(cell));
    let free = cells.filter(|point| is_in(*point, place) && ways.is_free(*point));
    free.min_by(|a, b| away(a).total_cmp(&away(b)))
}

/// Length of the shortest way from the start through all places (m); none if there is no way.
fn shortest(scene: &Scene, task: &Task) -> Option<f64> {
    const RESOLUTION: f64 = 0.02;
    let radius = scene.robots[0].spec.footprint.bounding_radius();
    let ways = Reachability::new(&scene.world, radius, RESOLUTION).ok()?;
    let raster = ways.raster();
    let columns = raster.columns();
    let is_free = |column, row| ways.is_free(raster.centre(row * columns + column));
    let floor = BitGrid::from_fn(columns, raster.rows(), is_free).ok()?;
    let start = scene.robots[0].pose.position();
    let places = task.visit.iter().chain(&task.end).map(|place| free_in(&ways, place));
    let stops: Vec<Point> = std::iter::once(Some(start)).chain(places).collect::<Option<_>>()?;
    let mut legs = stops.windows(2).map(|ends| {
        let [from, to] = [raster.cell_at(ends[0])?, raster.cell_at(ends[1])?];
        let [from, to] = [from, to].map(|cell| GridCell::new(cell % columns, cell / columns));
        let path = AnyAngle::new(&floor).plan(from, to).ok()?;
        Some(path.cost * raster.resolution())
    });
    legs.try_fold(0.0, |sum, leg| Some(sum + leg?))
}
