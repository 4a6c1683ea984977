use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::iter;

use super::chart::Chart;
use super::parameters::NavigatorParameters;
use super::report::NavigatorOutcome;
use crate::ParameterError;
use crate::geometry::{Aabb, Point};
use crate::world::{BitGrid, Clearance, GridCell, World};

/// The places that count as the goal: where the robot has room in the known world within the goal's
/// tolerance, the nearest to the goal first.
#[derive(Debug, Clone)]
pub(super) struct Destination {
    places: Vec<Point>,
    /// Whether the goal itself is in no wall and no object.
    is_free: bool,
}

/// Number of places tried on a line from the goal to its tolerance.
const TRIED: f64 = 25.0;
/// Maximum distance to the nearest free cell from a robot or a goal in an occupied one (m).
pub(super) const REACH: f64 = 0.12;

impl Destination {
    pub(super) fn new(
        world: &World,
        goal: Point,
        parameters: &NavigatorParameters,
    ) -> Result<Self, ParameterError> {
        let (room, spacing) = (parameters.room(), parameters.goal_tolerance / TRIED);
        let middles = Aabb::new(goal, goal).inflated((TRIED + 0.5) * spacing);
        let clearance = Clearance::over(world, middles, spacing, room + spacing)?;
        let raster = clearance.raster();
        let away = |place: &Point| (place - goal).norm();
        let roomy = (0..raster.cells()).filter(|&cell| clearance.at(cell) >= room);
        let within = |place: &Point| away(place) <= parameters.goal_tolerance;
        let mut places: Vec<Point> = roomy.map(|cell| raster.centre(cell)).filter(within).collect();
        places.sort_by(|a, b| away(a).total_cmp(&away(b)));
        let is_free = clearance.at_point(goal).is_some_and(|distance| distance > 0.0);
        Ok(Self { places, is_free })
    }

    /// The places.
    pub(super) fn places(&self) -> &[Point] {
        &self.places
    }

    /// Why no way can lead there, if the robot has room nowhere.
    pub(super) fn verdict(&self) -> Option<NavigatorOutcome> {
        let why = if self.is_free { NavigatorOutcome::NoRoom } else { NavigatorOutcome::Unreachable };
        self.places.is_empty().then_some(why)
    }

    /// The nearest place to the goal that a way through free cells leads to from one of them, and the cell in
    /// which that way ends.
    pub(super) fn in_reach_of(
        &self,
        chart: &Chart,
        grid: &BitGrid,
        from: GridCell,
        parameters: &NavigatorParameters,
    ) -> Option<(GridCell, Point)> {
        let regions = chart.regions(grid);
        let own = regions[chart.index(from)];
        let open = self.places.iter().filter(|place| chart.is_clear_of_seen(**place, parameters));
        let mut ends = open.filter_map(|&place| Some((nearest_free(chart, grid, place)?, place)));
        ends.find(|(cell, _)| regions[chart.index(*cell)] == own)
    }
}

/// The free cell nearest to a point that no wall is before, if one is near.
pub(super) fn nearest_free(chart: &Chart, grid: &BitGrid, point: Point) -> Option<GridCell> {
    let at = chart.cell(point)?;
    if grid.is_free(at) {
        return Some(at);
    }
    let reach = (REACH / chart.resolution()).ceil() as usize;
    let (columns, rows) =
        (at.column.saturating_sub(reach)..=at.column + reach, at.row.saturating_sub(reach)..=at.row + reach);
    let cells = rows.flat_map(|row| columns.clone().map(move |column| GridCell::new(column, row)));
    // Distances are not negative, so their bits are in the same order. Few of the cells are looked at.
    let away = |cell: GridCell| (chart.centre(cell) - point).norm_squared().to_bits();
    let free = cells.filter(|&cell| grid.is_free(cell));
    let mut nearest: BinaryHeap<_> = free.map(|cell| Reverse((away(cell), cell.row, cell.column))).collect();
    iter::from_fn(|| nearest.pop())
        .map(|Reverse((_, row, column))| GridCell::new(column, row))
        .find(|&cell| chart.is_straight_way(point, chart.centre(cell)))
}
