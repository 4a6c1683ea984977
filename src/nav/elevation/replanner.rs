use super::costs::{GroundCosts, Objective};
use super::map::ElevationMap;
use super::planner::{ElevationPath, cell_of, cells};
use crate::geometry::{Point, Point3};
use crate::io::Result;
use crate::nav::grid::{DStarLite, End, PlanError};
use crate::parameter::require;
use crate::world::{BitGrid, GridCell, HeightField};

/// Replans the cheapest path while the robot discovers that the ground differs from its map: D\* Lite on an
/// [`ElevationMap`].
///
/// ```
/// use roverlab::geometry::{Aabb, Point};
/// use roverlab::nav::elevation::{Climber, ElevationMap, ElevationReplanner, Objective};
/// use roverlab::world::{GridCell, HeightField};
///
/// let area = Aabb::new(Point::origin(), Point::new(2.0, 2.0));
/// let flat = HeightField::from_fn(41, 41, area, |_| 0.0)?;
/// let map = ElevationMap::new(&flat, &Climber { slope: 0.3, step: 0.02, radius: 0.1 })?;
/// let (robot, goal) = (Point::new(0.5, 1.0), Point::new(1.5, 1.0));
/// let mut planner = ElevationReplanner::new(map, Objective::Length, robot, goal)?;
/// let before = planner.plan()?.cost;
/// planner.set_height(GridCell::new(20, 20), 0.3)?;
/// assert!(before == 1.0 && planner.plan()?.cost > 1.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ElevationReplanner {
    map: ElevationMap,
    planner: DStarLite<GroundCosts>,
}

impl ElevationReplanner {
    /// Creates a replanner from a map, the robot's position and its goal.
    ///
    /// # Errors
    ///
    /// If the objective is out of range, or an end lies outside the surface.
    pub fn new(map: ElevationMap, objective: Objective, robot: Point, goal: Point) -> Result<Self> {
        objective.validate()?;
        let costs = GroundCosts::new(map.field(), objective);
        let ends =
            cell_of(&map, End::Start, robot).and_then(|robot| Ok((robot, cell_of(&map, End::Goal, goal)?)));
        let planner = ends.and_then(|(robot, goal)| DStarLite::by(map.open(), costs, robot, goal));
        let planner =
            planner.map_err(|error| crate::io::Error::invalid_input("way", error, "ends on the surface"))?;
        Ok(Self { map, planner })
    }

    /// The grid of samples, free where the robot can stand as far as is known.
    pub fn open(&self) -> &BitGrid {
        self.planner.grid()
    }

    /// Updates the robot's position.
    ///
    /// # Errors
    ///
    /// If the position lies outside the surface.
    pub fn move_to(&mut self, robot: Point) -> std::result::Result<(), PlanError> {
        let cell = cell_of(&self.map, End::Start, robot)?;
        self.planner.move_to(cell)
    }

    /// Updates the elevation of a sample (m).
    ///
    /// # Errors
    ///
    /// If the sample lies outside the surface, or its elevation beyond 1000 km.
    pub fn set_height(&mut self, cell: GridCell, height: f64) -> Result<()> {
        let field: &HeightField = self.map.field();
        require("column", cell.column as f64, cell.column < field.columns(), "a column of the surface")?;
        require("row", cell.row as f64, cell.row < field.rows(), "a row of the surface")?;
        require("elevation", height, height.abs() <= 1e6, "at most 1000 km")?;
        let Self { map, planner } = self;
        planner.set_costs(cell, |costs| costs.set_height(cell, height as f32));
        map.set_height(cell, f64::from(height as f32), |near, open| planner.set_free(near, open));
        Ok(())
    }

    /// The cheapest path from the robot to the goal over the known ground, from sample to sample.
    ///
    /// # Errors
    ///
    /// If the robot or the goal is on closed ground, or no path joins them.
    pub fn plan(&mut self) -> std::result::Result<ElevationPath, PlanError> {
        let path = self.planner.plan()?;
        let costs = self.planner.costs();
        let point = |cell: GridCell| {
            let at = self.map.point(cell);
            Point3::new(at.x, at.y, costs.height(cell))
        };
        let points = cells(&path).map(point).collect();
        Ok(ElevationPath { points, cost: path.cost * costs.unit, statistics: path.statistics })
    }
}
