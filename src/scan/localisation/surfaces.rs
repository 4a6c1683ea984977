use std::f64::consts::FRAC_1_SQRT_2;

use crate::geometry::Point;
use crate::world::{Clearance, Raster};

/// Lower bound of the distance to the nearest surface from any place. One raster replaces all levels of a
/// pyramid: whether a surface lies within a given distance is read directly.
#[derive(Debug, Clone)]
pub(super) struct Surfaces {
    corner: Point,
    per_metre: f64,
    columns: usize,
    rows: usize,
    /// Distances in steps of [`STEP`], rounded down; the maximum value includes all larger ones.
    steps: Vec<u8>,
}

/// Length of a step (m).
pub(super) const STEP: f64 = 0.025;

impl Surfaces {
    /// Measures from the cells that contain a surface. `clearance` must cover at least half a cell diagonal.
    pub(super) fn new(clearance: &Clearance) -> Self {
        let raster = clearance.raster();
        let (columns, rows) = (raster.columns(), raster.rows());
        let slack = FRAC_1_SQRT_2 * raster.resolution();
        let mut squares: Vec<f32> = (0..raster.cells())
            .map(|cell| if clearance.at(cell) <= slack { 0.0 } else { f32::INFINITY })
            .collect();
        square_distances(&mut squares, columns);
        // Allow for the offsets of surface and place from the centres of their cells.
        let steps = squares.iter().map(|square| {
            let metres = f64::from(square.sqrt()) * raster.resolution() - 2.0 * slack;
            (metres.max(0.0) / STEP).floor().min(f64::from(u8::MAX)) as u8
        });
        let steps = steps.collect();
        Self { corner: corner(raster), per_metre: 1.0 / raster.resolution(), columns, rows, steps }
    }

    /// Lower bound of the distance to the nearest surface (steps). Places outside count as the nearest one
    /// inside.
    #[inline]
    pub(super) fn at(&self, x: f64, y: f64) -> u8 {
        let index = |along: f64, count: usize| ((along * self.per_metre) as usize).min(count - 1);
        let (column, row) = (index(x - self.corner.x, self.columns), index(y - self.corner.y, self.rows));
        self.steps[row * self.columns + column]
    }
}

/// Lower left corner of a raster.
fn corner(raster: &Raster) -> Point {
    let half = 0.5 * raster.resolution();
    let first = raster.centre(0);
    Point::new(first.x - half, first.y - half)
}

/// Replaces 0 at seeds and infinity elsewhere by the squared distance to the nearest seed (cells), along
/// columns and then along rows (P. Felzenszwalb, D. Huttenlocher, *Distance Transforms of Sampled Functions*,
/// 2012).
fn square_distances(squares: &mut [f32], columns: usize) {
    let rows = squares.len() / columns;
    let mut since = vec![f32::INFINITY; columns];
    let mut sweep = |squares: &mut [f32], order: &mut dyn Iterator<Item = usize>| {
        since.fill(f32::INFINITY);
        for row in order {
            for (cell, since) in squares[row * columns..][..columns].iter_mut().zip(&mut since) {
                *since = if *cell == 0.0 { 0.0 } else { *since + 1.0 };
                *cell = cell.min(*since * *since);
            }
        }
    };
    sweep(squares, &mut (0..rows));
    sweep(squares, &mut (0..rows).rev());
    let mut values = vec![0.0; columns];
    let mut envelope = Vec::new();
    for row in squares.chunks_exact_mut(columns) {
        values.copy_from_slice(row);
        lower_envelope(&values, &mut envelope, row);
    }
}

/// For each place of a row, the minimum over the columns of a column's value plus the squared distance to it.
/// `envelope` holds the parabolas of the lower envelope, each with its start.
fn lower_envelope(values: &[f32], envelope: &mut Vec<(usize, f32)>, out: &mut [f32]) {
    envelope.clear();
    for (column, &value) in values.iter().enumerate().filter(|(_, value)| value.is_finite()) {
        let mut from = f32::NEG_INFINITY;
        while let Some(&(lowest, its)) = envelope.last() {
            let (a, b) = (lowest as f32, column as f32);
            from = 0.5 * ((value - values[lowest]) / (b - a) + a + b);
            if from > its {
                break;
            }
            envelope.pop();
            from = f32::NEG_INFINITY;
        }
        envelope.push((column, from));
    }
    let mut index = 0;
    for (place, cell) in out.iter_mut().enumerate() {
        while envelope.get(index + 1).is_some_and(|next| next.1 <= place as f32) {
            index += 1;
        }
        let Some(&(column, _)) = envelope.get(index) else { return };
        let apart = place as f32 - column as f32;
        *cell = values[column] + apart * apart;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Segment;
    use crate::random::Stream;
    use crate::world::{Wall, World};

    /// Bounds never exceed the true distance, and are below it by no more than the cell size explains.
    #[test]
    fn distances_bound_the_true_ones_from_below() {
        let mut world = World::empty(4.0, 3.0);
        for (a, b) in [((0.5, 0.4), (2.0, 2.6)), ((3.0, 0.2), (3.0, 1.0)), ((3.5, 2.5), (3.6, 2.5))] {
            let wall = Wall::new(Point::new(a.0, a.1), Point::new(b.0, b.1));
            world.walls.push(Wall { thickness: 0.0, ..wall });
        }
        let surfaces = Surfaces::new(&Clearance::new(&world, 0.05, 0.3).unwrap());
        let lines: Vec<Segment> = world.walls.iter().map(|wall| wall.line).collect();
        let mut stream = Stream::new(1);
        for _ in 0..20_000 {
            let place = Point::new(stream.between(-2.0, 6.0), stream.between(-2.0, 5.0));
            let truth = lines.iter().map(|line| line.distance_to(place)).fold(f64::INFINITY, f64::min);
            let bound = f64::from(surfaces.at(place.x, place.y)) * STEP;
            assert!(bound <= truth, "{bound} for {truth} at {place}");
            let is_inside = world.floor.contains(place);
            assert!(
                !is_inside || bound > truth - 0.05 * 4.0 * FRAC_1_SQRT_2 - STEP,
                "{bound} for {truth} at {place}"
            );
        }
    }

    #[test]
    fn a_world_without_surfaces_is_far_from_all() {
        let surfaces = Surfaces::new(&Clearance::new(&World::empty(1.0, 1.0), 0.05, 0.3).unwrap());
        assert_eq!(surfaces.at(0.5, 0.5), u8::MAX);
    }
}
