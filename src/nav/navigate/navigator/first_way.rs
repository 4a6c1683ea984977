use super::super::chart::{COARSER, Chart, LEVELS, are_shut_in};
use super::Navigator;
use crate::geometry::units;
use crate::io::{Error, ErrorKind, Result};
use crate::world::World;

/// Number of times that cells are halved before no way is said to exist.
const HALVINGS: u32 = 2;

impl Navigator {
    /// Plans the first way. `false` if there is none. Fails if the cells are too large to tell.
    pub(super) fn find_way(&mut self, world: &World) -> Result<bool> {
        if self.chart.is_coarse() {
            if self.plan_nearby(world)? {
                return Ok(true);
            }
            let places = self.destination.places();
            if are_shut_in(world, places, self.start.position(), &self.parameters)? {
                return Ok(false);
            }
        }
        if !self.chart.is_open(self.start.position()) {
            return if self.chart.is_coarse() { Err(self.too_coarse()) } else { Ok(false) };
        }
        if !self.plan(LEVELS) {
            return self.plan_finer(world);
        }
        if self.chart.is_blind(&self.parameters) { Err(self.too_coarse()) } else { Ok(true) }
    }

    /// Plans within as much of a large world around start and goal as smaller cells cover, the smallest ones
    /// first. `false` if there is no way in it.
    fn plan_nearby(&mut self, world: &World) -> Result<bool> {
        let ends = [self.start.position(), self.goal];
        let mut resolution = self.parameters.resolution;
        while resolution < self.chart.resolution() {
            if let Some(part) = Chart::between(world, ends, &self.parameters, resolution)? {
                let whole = std::mem::replace(&mut self.chart, part);
                if self.chart.is_open(self.start.position()) && self.plan(LEVELS) {
                    return Ok(true);
                }
                self.chart = whole;
            }
            resolution *= COARSER;
        }
        Ok(false)
    }

    /// Plans with finer cells as long as those in use may close a way. `false` if there is none. Fails if the
    /// cells are larger than wished.
    fn plan_finer(&mut self, world: &World) -> Result<bool> {
        let (start, tolerance) = (self.start.position(), self.parameters.goal_tolerance);
        let mut halvings = 0..HALVINGS;
        while self.chart.may_hide_a_way(start, self.goal, tolerance) {
            if self.chart.is_coarse() {
                return Err(self.too_coarse());
            }
            let finer = 0.5 * self.chart.resolution();
            if halvings.next().is_none() {
                return Ok(false);
            }
            self.chart = Chart::new(world, [start, self.goal], &self.parameters, finer)?;
            if self.plan(LEVELS) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn too_coarse(&self) -> Error {
        let [cells, wished] = [self.chart.resolution(), self.parameters.resolution].map(units::to_mm);
        let found = format!("a world so large that cells of {cells:.0} mm may close a way to the goal");
        Error::new(
            ErrorKind::InvalidInput,
            format!("found {found}; expected one for cells of {wished:.0} mm"),
        )
    }
}
