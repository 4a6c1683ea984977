use super::chart::Chart;
use super::explorer::Explorer;
use crate::geometry::{Point, Vector};
use crate::nav::grid::GridComponents;
use crate::world::{BitGrid, GridCell};

/// A ramp, as a look shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ramp {
    /// Lower and upper end of the visible part, in the middle of the ramp.
    pub(super) foot: Point,
    pub(super) top: Point,
    /// Half the width over which a robot's middle can drive (m).
    half_width: f64,
    /// Mean elevation.
    pub(super) height: f64,
}

/// Rise per metre from which ground is a ramp: 4 degrees, five errors of the map.
const RISES: f64 = 0.07;
/// Number of cells on both sides over which a rise is measured.
const OVER: usize = 2;
/// Area of the smallest ramp (m²).
const AREA: f64 = 0.02;
/// Deviation of a rise from the ramp's, as a part of that, up to which a cell is part of the ramp.
const ALIKE: f64 = 0.5;

impl Ramp {
    /// The ramps among cells to which a safe path leads.
    pub(super) fn all(explorer: &Explorer, chart: &Chart, reached: &[GridCell]) -> Vec<Self> {
        let mut sloped = BitGrid::blocked(chart.safe.width(), chart.safe.height()).expect("a map's size");
        for &cell in reached {
            sloped.set_free(cell, is_sloped(explorer, cell));
        }
        let parts = GridComponents::new(&sloped);
        let mut cells = vec![Vec::new(); parts.count()];
        for cell in sloped.free_cells() {
            if let Some(part) = parts.region(cell) {
                cells[part].push(cell);
            }
        }
        cells.iter().filter_map(|cells| Self::of(explorer, cells)).collect()
    }

    /// The ramp of a patch of sloped ground. Beside it the map slopes as well, down to the floor; so the
    /// median rise is that of the ramp, and cells that rise otherwise do not count.
    fn of(explorer: &Explorer, cells: &[GridCell]) -> Option<Self> {
        let rises: Vec<(GridCell, Vector)> =
            cells.iter().filter_map(|&cell| Some((cell, rise(explorer, cell)?))).collect();
        let median = Vector::new(
            middle_of(rises.iter().map(|(_, rise)| rise.x)),
            middle_of(rises.iter().map(|(_, rise)| rise.y)),
        );
        let up = median.try_normalize(1e-9)?;
        let left = Vector::new(-up.y, up.x);
        let even = || rises.iter().filter(|(_, rise)| (rise - median).norm() < ALIKE * median.norm());
        let ends = |axis: Vector| {
            let along = even().map(|(cell, _)| explorer.map.place(*cell).coords.dot(&axis));
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
        };
        let ((low, high), (right, far_left)) = (ends(up), ends(left));
        let middle = left * (0.5 * (right + far_left));
        let heights = even().map(|(cell, _)| explorer.height(*cell));
        let (sum, count) = heights.fold((0.0, 0.0), |(sum, count), height| (sum + height, count + 1.0));
        let ends = (Point::from(middle + up * low), Point::from(middle + up * high));
        let resolution = explorer.parameters.resolution;
        (count * resolution * resolution > AREA && low < high).then_some(Self {
            foot: ends.0,
            top: ends.1,
            half_width: 0.5 * (far_left - right),
            height: sum / count,
        })
    }

    /// Direction uphill.
    pub(super) fn uphill(&self) -> Vector {
        (self.top - self.foot).normalize()
    }

    /// Whether it may be a part of a known ramp: it rises the same way, and a robot of a radius on one of
    /// them could touch the other. A ramp opposite to the known one, straight ahead, rises the other way.
    pub(super) fn is(&self, known: &Self, radius: f64) -> bool {
        let aside = known.aside(nalgebra::center(&self.foot, &self.top)).abs();
        let touching = self.half_width + known.half_width + 2.0 * radius;
        self.uphill().dot(&known.uphill()) > 0.0 && aside < touching
    }

    /// Distance of a place from the middle line, to the left of it (m).
    pub(super) fn aside(&self, place: Point) -> f64 {
        self.uphill().perp(&(place - self.foot))
    }
}

/// Median; 0 of no numbers.
fn middle_of(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut numbers: Vec<f64> = numbers.collect();
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(0.0)
}

/// Whether a cell is part of a ramp.
pub(super) fn is_sloped(explorer: &Explorer, cell: GridCell) -> bool {
    rise(explorer, cell).is_some_and(|rise| rise.norm() > RISES)
}

/// Rise of the map at a cell per metre, along both axes; `None` beside unseen ground.
fn rise(explorer: &Explorer, cell: GridCell) -> Option<Vector> {
    let height = |x: isize, y: isize| {
        let column = cell.column.checked_add_signed(x)?;
        explorer.map.smoothed(GridCell::new(column, cell.row.checked_add_signed(y)?))
    };
    let (over, width) = (OVER as isize, 2.0 * OVER as f64 * explorer.parameters.resolution);
    let along = (height(over, 0)? - height(-over, 0)?) / width;
    Some(Vector::new(along, (height(0, over)? - height(0, -over)?) / width))
}
