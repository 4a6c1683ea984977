use nalgebra::{Matrix3, Vector3};

use super::sight_map::SightMap;
use crate::geometry::{Point, Point3, Vector};

/// Planes through what has been seen around each cell of a map, to compare a look with.
pub(super) struct Relief<'m> {
    map: &'m SightMap,
    planes: Vec<Option<Plane>>,
}

/// The ground around a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    /// What was measured of the cell, in the mean.
    at: Point3,
    /// By how much it rises in a metre along both axes.
    pub(super) rise: Vector,
    /// Variance of each part of it.
    pub(super) noise: f64,
    /// How well the robot knew its place when it saw the cell (m).
    pub(super) doubt: f64,
}

impl Plane {
    /// The elevation of the ground at a place.
    pub(super) fn height(&self, place: Point) -> f64 {
        self.at.z + self.rise.dot(&(place - self.at.xy()))
    }
}

/// Cells around one that its plane goes through, along both axes: what is measured of single cells errs by
/// centimetres, so that slopes from one to the next are mostly noise.
const AROUND: usize = 2;
/// The fewest cells of a plane: more than half of them, so that they are not all on one side.
const ENOUGH: usize = 14;

impl<'m> Relief<'m> {
    pub(super) fn of(map: &'m SightMap) -> Self {
        let planes = (0..map.cells()).map(|index| plane(map, index)).collect();
        Self { map, planes }
    }

    /// The ground at a place around which it has been seen, and is no face.
    pub(super) fn at(&self, place: Point) -> Option<Plane> {
        self.planes[self.map.index_of(self.map.cell_at(place)?)]
    }
}

/// The least squares of the cells around one.
fn plane(map: &SightMap, index: usize) -> Option<Plane> {
    let at = map.known(index)?;
    let (column, row) = (index % map.side, index / map.side);
    if column.min(row) < AROUND || column.max(row) + AROUND >= map.side {
        return None;
    }
    let columns = column - AROUND..=column + AROUND;
    let rows = row - AROUND..=row + AROUND;
    let around = rows.flat_map(|y| columns.clone().map(move |x| y * map.side + x));
    let (mut normal, mut right, mut square, mut count) = (Matrix3::zeros(), Vector3::zeros(), 0.0, 0);
    for near in around.filter_map(|near| map.known(near)) {
        let arm = near - at;
        let parts = Vector3::new(arm.x, arm.y, 1.0);
        normal += parts * parts.transpose();
        right += parts * arm.z;
        square += arm.z * arm.z;
        count += 1;
    }
    if count < ENOUGH {
        return None;
    }
    let inverse = normal.try_inverse()?;
    let fit = inverse * right;
    let variance = (square - fit.dot(&right)).max(0.0) / (count - 3) as f64;
    let noise = variance * inverse[(0, 0)].max(inverse[(1, 1)]);
    Some(Plane { at, rise: Vector::new(fit.x, fit.y), noise, doubt: map.doubt(index) })
}
