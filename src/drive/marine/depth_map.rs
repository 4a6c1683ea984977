use nalgebra::{Matrix3, Vector3};

use crate::ParameterError;
use crate::geometry::{Aabb, Point, Vector};
use crate::parameter::{require, require_positive};

/// A measured water depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sounding {
    /// Position of the measurement.
    pub place: Point,
    /// Water depth (m).
    pub depth: f64,
    /// Standard deviation of the position (m).
    pub sigma: f64,
}

/// A depth and its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellDepth {
    /// Mean water depth of the cell (m).
    pub depth: f64,
    /// Standard deviation (m).
    pub sigma: f64,
}

/// A map of depths in square cells, with the uncertainty of each (book, section 8.5).
///
/// A cell's depth is that of the least-squares plane through the soundings around it. Its standard deviation has
/// three parts: the uncertainty of the plane, the spread of the cell's soundings about it, and the position
/// error times the slope.
///
/// ```
/// use roverlab::drive::marine::{DepthMap, Sounding};
/// use roverlab::geometry::{Aabb, Point};
/// let area = Aabb::new(Point::origin(), Point::new(4.0, 3.0));
/// let mut map = DepthMap::new(area, 1.0)?;
/// for i in 0..200 {
///     let place = Point::new(0.02 * f64::from(i), 0.2 + 0.7 * f64::from(i % 4));
///     map.add(Sounding { place, depth: 1.5 + 0.1 * place.x, sigma: 0.02 });
/// }
/// let cell = map.cell(2, 1).expect("it was measured");
/// assert!((cell.depth - 1.75).abs() < 1e-6 && cell.sigma > 0.0);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct DepthMap {
    area: Aabb,
    cell: f64,
    columns: usize,
    rows: usize,
    soundings: Vec<Vec<Sounding>>,
}

/// The least error of a depth (m): the pressure sensor's, which is the same everywhere.
const COMMON: f64 = 0.003;
/// The most cells.
const MOST: f64 = 1e6;
/// Soundings that a cell needs around it.
const LEAST: usize = 6;

impl DepthMap {
    /// Creates an empty map of an area. Fails for a cell size that is not positive, and for more than a million
    /// cells.
    pub fn new(area: Aabb, cell: f64) -> Result<Self, ParameterError> {
        require_positive("cell", cell)?;
        let size = area.size();
        require_positive("area's width", size.x)?;
        require_positive("area's height", size.y)?;
        let [columns, rows] = [size.x, size.y].map(|length| (length / cell).ceil());
        require("cells", columns * rows, columns * rows <= MOST, "at most a million")?;
        let (columns, rows) = (columns as usize, rows as usize);
        Ok(Self { area, cell, columns, rows, soundings: vec![Vec::new(); columns * rows] })
    }

    /// Number of cells along x.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of cells along y.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The centre of a cell, by column along x and row along y.
    pub fn centre(&self, column: usize, row: usize) -> Point {
        let at = |index: usize| (index as f64 + 0.5) * self.cell;
        self.area.min + Vector::new(at(column), at(row))
    }

    /// Adds a sounding. Soundings outside the area are ignored.
    pub fn add(&mut self, sounding: Sounding) {
        let off = (sounding.place - self.area.min) / self.cell;
        if off.x >= 0.0 && off.y >= 0.0 && sounding.depth.is_finite() {
            let (column, row) = (off.x as usize, off.y as usize);
            if column < self.columns && row < self.rows {
                self.soundings[row * self.columns + column].push(sounding);
            }
        }
    }

    /// The depth of a cell; `None` where it was not measured. O(soundings of the cells around).
    pub fn cell(&self, column: usize, row: usize) -> Option<CellDepth> {
        let centre = self.centre(column, row);
        let own = self.soundings.get(row * self.columns + column)?;
        if column >= self.columns || own.is_empty() {
            return None;
        }
        // From the cell itself and those beside it; what is farther off counts less.
        let (mut square, mut right, mut count) = (Matrix3::zeros(), Vector3::zeros(), 0);
        let near = || self.around(column, row).filter(move |sounding| self.weight(centre, sounding) > 0.0);
        for sounding in near() {
            let (powers, weight) = (self.powers(centre, sounding), self.weight(centre, sounding));
            square += powers * powers.transpose() * weight;
            right += powers * (sounding.depth * weight);
            count += 1;
        }
        if count < LEAST {
            return None;
        }
        // A lane alone does not say how the ground slopes across it: little is better than anything.
        let slack = Matrix3::from_diagonal(&Vector3::new(0.0, 1.0, 1.0)) * (1e-3 * square[(0, 0)]);
        let inverse = (square + slack).try_inverse()?;
        let plane = inverse * right;
        let (mut squares, mut weights, mut sigma) = (0.0, 0.0, 0.0);
        for sounding in near() {
            let weight = self.weight(centre, sounding);
            let off = sounding.depth - plane.dot(&self.powers(centre, sounding));
            squares += weight * off * off;
            sigma += weight * sounding.sigma;
            weights += weight;
        }
        let (spread, sigma) = (squares / weights, sigma / weights);
        let slope = Vector::new(plane.y, plane.z).norm() / self.cell;
        let known = spread * inverse[(0, 0)];
        let placed = slope * sigma;
        let bent = self.bent(own, &plane, centre);
        Some(CellDepth { depth: plane.x, sigma: (known + placed * placed + bent + COMMON * COMMON).sqrt() })
    }

    /// The square of what the ground of a cell is off its plane in the mean.
    fn bent(&self, own: &[Sounding], plane: &Vector3<f64>, centre: Point) -> f64 {
        let off = |sounding: &Sounding| sounding.depth - plane.dot(&self.powers(centre, sounding));
        let mean = own.iter().map(off).sum::<f64>() / own.len() as f64;
        mean * mean
    }

    /// The plane's functions at a sounding, in cells from a centre.
    fn powers(&self, centre: Point, sounding: &Sounding) -> Vector3<f64> {
        let off = (sounding.place - centre) / self.cell;
        Vector3::new(1.0, off.x, off.y)
    }

    /// How much a sounding counts: all in the middle of the cell, nothing one and a half cells away.
    fn weight(&self, centre: Point, sounding: &Sounding) -> f64 {
        let off = (sounding.place - centre) / self.cell;
        (1.0 - off.norm_squared() / 2.25).max(0.0)
    }

    fn around(&self, column: usize, row: usize) -> impl Iterator<Item = &Sounding> {
        let columns = column.saturating_sub(1)..(column + 2).min(self.columns);
        let rows = row.saturating_sub(1)..(row + 2).min(self.rows);
        rows.flat_map(move |row| columns.clone().map(move |column| row * self.columns + column))
            .flat_map(|index| &self.soundings[index])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_measured_has_no_depth() {
        let area = Aabb::new(Point::origin(), Point::new(3.0, 2.0));
        let mut map = DepthMap::new(area, 1.0).unwrap();
        for i in 0..20 {
            map.add(Sounding { place: Point::new(0.05 * f64::from(i), 0.5), depth: 2.0, sigma: 0.0 });
        }
        map.add(Sounding { place: Point::new(-1.0, 0.5), depth: 9.0, sigma: 0.0 });
        map.add(Sounding { place: Point::new(2.5, 0.5), depth: f64::NAN, sigma: 0.0 });
        assert_eq!((map.columns(), map.rows()), (3, 2));
        assert!((map.cell(0, 0).unwrap().depth - 2.0).abs() < 1e-6);
        assert!(map.cell(2, 0).is_none() && map.cell(0, 1).is_none() && map.cell(5, 0).is_none());
        assert!(DepthMap::new(area, 0.0).is_err() && DepthMap::new(area, 1e-6).is_err());
    }

    #[test]
    fn a_noisier_ground_is_less_sure() {
        let sigma = |noise: f64| {
            let mut map = DepthMap::new(Aabb::new(Point::origin(), Point::new(1.0, 1.0)), 1.0).unwrap();
            let mut stream = crate::random::Stream::new(5);
            for _ in 0..100 {
                let place = Point::new(stream.uniform(), stream.uniform());
                map.add(Sounding { place, depth: 2.0 + noise * stream.normal(), sigma: 0.0 });
            }
            map.cell(0, 0).unwrap().sigma
        };
        assert!(sigma(0.1) > 3.0 * sigma(0.01));
    }
}
