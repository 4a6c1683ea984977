use super::costs::{GroundCosts, Objective};
use super::map::ElevationMap;
use super::straight::straightened;
use crate::ParameterError;
use crate::geometry::{Point, Point3};
use crate::nav::grid::{End, GridPath, GridPlanner, GridSearch, PlanError, SearchStatistics};
use crate::world::{BitGrid, GridCell};

/// A path over hills.
#[derive(Debug, Clone, PartialEq)]
pub struct ElevationPath {
    /// Start, turning points and end, on the ground (m).
    pub points: Vec<Point3>,
    /// Cost, in the unit of the [`Objective`].
    pub cost: f64,
    /// Statistics of the search.
    pub statistics: SearchStatistics,
}

/// Plans on an [`ElevationMap`], from sample to sample by Dijkstra's algorithm or A\*, or at any angle.
///
/// Dijkstra's algorithm and A\* find paths of equal cost; A\*'s heuristic is the cost on level ground. An
/// any-angle path is A\*'s path with straight segments wherever these are cheaper, so it never costs more.
///
/// ```
/// use roverlab::geometry::{Aabb, Point};
/// use roverlab::nav::elevation::{Climber, ElevationMap, ElevationPlanner, Objective};
/// use roverlab::world::HeightField;
///
/// // A ridge across the way, lower at one end.
/// let area = Aabb::new(Point::origin(), Point::new(4.0, 4.0));
/// let ridge = HeightField::from_fn(81, 81, area, |at| 0.07 * at.y * (-8.0 * (at.x - 2.0).powi(2)).exp())?;
/// let map = ElevationMap::new(&ridge, &Climber { slope: 0.4, step: 0.02, radius: 0.15 })?;
/// let (start, goal) = (Point::new(0.5, 3.0), Point::new(3.5, 3.0));
/// let mut by_length = ElevationPlanner::astar(&map, Objective::Length)?;
/// let mut by_energy = ElevationPlanner::astar(&map, Objective::Energy { resistance: 0.05 })?;
/// let top = |path: Vec<roverlab::geometry::Point3>| path.iter().map(|point| point.z).fold(0.0, f64::max);
/// let (over, around) = (by_length.plan_any_angle(start, goal)?, by_energy.plan_any_angle(start, goal)?);
/// assert!(top(over.points) > 1.5 * top(around.points));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ElevationPlanner<'m> {
    map: &'m ElevationMap,
    costs: GroundCosts,
    search: GridSearch<GroundCosts>,
}

impl<'m> ElevationPlanner<'m> {
    /// Creates a planner by Dijkstra's algorithm. Fails for parameters out of range.
    pub fn dijkstra(map: &'m ElevationMap, objective: Objective) -> Result<Self, ParameterError> {
        Self::new(map, objective, GridSearch::dijkstra_by)
    }

    /// Creates a planner by A\*. Fails for parameters out of range.
    pub fn astar(map: &'m ElevationMap, objective: Objective) -> Result<Self, ParameterError> {
        Self::new(map, objective, GridSearch::astar_by)
    }

    fn new(
        map: &'m ElevationMap,
        objective: Objective,
        search: fn(&BitGrid, GroundCosts) -> GridSearch<GroundCosts>,
    ) -> Result<Self, ParameterError> {
        objective.validate()?;
        let costs = GroundCosts::new(map.field(), objective);
        Ok(Self { map, search: search(map.open(), costs.clone()), costs })
    }

    /// The cheapest path from sample to sample between those nearest to two positions.
    ///
    /// # Errors
    ///
    /// If an end is off the map or on closed ground, or no path joins them.
    pub fn plan(&mut self, start: Point, goal: Point) -> Result<ElevationPath, PlanError> {
        let path = self.search(start, goal)?;
        let points = cells(&path).map(|cell| self.map.point(cell)).collect();
        Ok(ElevationPath { points, cost: path.cost * self.costs.unit, statistics: path.statistics })
    }

    /// An any-angle path, which costs at most as much as the one from sample to sample.
    ///
    /// # Errors
    ///
    /// As [`plan`](Self::plan).
    pub fn plan_any_angle(&mut self, start: Point, goal: Point) -> Result<ElevationPath, PlanError> {
        let path = self.search(start, goal)?;
        let cells: Vec<GridCell> = cells(&path).collect();
        let (chain, cost) = straightened(&self.costs, self.map.open(), &cells);
        let points = chain.into_iter().map(|cell| self.map.point(cell)).collect();
        Ok(ElevationPath { points, cost, statistics: path.statistics })
    }

    fn search(&mut self, start: Point, goal: Point) -> Result<GridPath, PlanError> {
        let (start, goal) = (cell_of(self.map, End::Start, start)?, cell_of(self.map, End::Goal, goal)?);
        self.search.plan(start, goal)
    }
}

/// The sample nearest to an end of a way.
pub(super) fn cell_of(map: &ElevationMap, end: End, place: Point) -> Result<GridCell, PlanError> {
    let field = map.field();
    map.cell_at(place).ok_or_else(|| {
        let at = (place - field.area().min).component_div(&field.pitch());
        let cell = GridCell::new(at.x.max(0.0) as usize, at.y.max(0.0) as usize);
        PlanError::Outside { end, cell, width: field.columns(), height: field.rows() }
    })
}

/// The cells of a path that goes from cell to cell.
pub(super) fn cells(path: &GridPath) -> impl Iterator<Item = GridCell> + '_ {
    path.points.iter().filter_map(|&point| GridCell::at(point))
}
