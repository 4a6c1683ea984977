use std::collections::BTreeMap;

use nalgebra::{Matrix6, Vector6};

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
    /// Standard deviations of the place along x and y (m).
    pub sigma: Vector,
    /// Standard deviation of the datum (m): by this all depths of a survey may be wrong together.
    pub datum: f64,
    /// Standard deviation of the surface's level by waves (m): the soundings of a wave are wrong together.
    pub swell: f64,
    /// Half of the phase of these waves that passes until the next sounding (rad).
    pub phase: f64,
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
/// A cell's depth is the mean of its own soundings, each moved to where it should be by the quadratic surface
/// through the soundings around. Soundings that lie close together count as one. The standard deviation has
/// five parts: the sensor's noise, which is seen in how soundings differ from those just before and after;
/// the error of the place times the slope; that of the datum; the waves that pass while the cell is measured;
/// and what the quadratic surface does not say of the parts of the cell that were not. The last one is known
/// by how far the soundings around are off that surface in the mean of each part: the parts that were
/// measured are a sample of all.
///
/// ```
/// use roverlab::drive::marine::{DepthMap, Sounding};
/// use roverlab::geometry::{Aabb, Point, Vector};
/// let area = Aabb::new(Point::origin(), Point::new(4.0, 3.0));
/// let mut map = DepthMap::new(area, 1.0)?;
/// for i in 0..200 {
///     let place = Point::new(0.02 * f64::from(i), 0.2 + 0.7 * f64::from(i % 4));
///     map.add(Sounding { place, depth: 1.5 + 0.1 * place.x, sigma: Vector::repeat(0.02), datum: 0.0, swell: 0.0, phase: 0.0 });
/// }
/// let cell = map.cell(2, 1).expect("it was measured");
/// assert!((cell.depth - 1.75).abs() < 1e-4 && cell.sigma > 0.0);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct DepthMap {
    area: Aabb,
    cell: f64,
    columns: usize,
    rows: usize,
    soundings: Vec<Vec<Noted>>,
    /// The two soundings before the next one.
    before: [Option<Sounding>; 2],
}

/// A sounding, and the square of how much it differs from its neighbours on the way, in variances of the
/// noise.
#[derive(Debug, Clone, Copy)]
struct Noted {
    sounding: Sounding,
    ripple: Option<f64>,
}

/// A part of a cell, or of one beside it.
#[derive(Debug, Clone, Copy)]
struct Part {
    /// How much deeper than the surface its soundings are in the mean (m).
    off: f64,
    /// How much it counts: all in the middle of the cell.
    weight: f64,
    /// Number of its soundings.
    count: f64,
}

/// Parts by row and column, from the corner of the cell before.
type Parts = BTreeMap<[usize; 2], Part>;

/// A quadratic surface through soundings: what their weighted sums are multiplied by, and its coefficients.
#[derive(Debug, Clone, Copy)]
struct Surface {
    inverse: Matrix6<f64>,
    coefficients: Vector6<f64>,
}

/// The most cells.
const MOST: f64 = 1e6;
/// Soundings that a cell needs around it: as many as a quadratic surface has coefficients.
const LEAST: usize = 6;
/// Parts of a cell along each side; soundings in the same part count as one.
const PARTS: usize = 5;
/// The median of the square of a normal number.
const MEDIAN: f64 = 0.455;
/// How much too large the median of few ripples is, relative to it and times their number: it is the upper one
/// of two in the middle, of a skew distribution, where each ripple shares its soundings with those beside it.
/// The mean over 20,000 rows of 20 to 300 soundings with normal noise.
const OF_FEW: f64 = 5.7;

impl DepthMap {
    /// Creates an empty map of an area. Fails for a cell size that is not positive, and for more than a
    /// million cells.
    pub fn new(area: Aabb, cell: f64) -> Result<Self, ParameterError> {
        require_positive("cell", cell)?;
        let size = area.size();
        require_positive("area's width", size.x)?;
        require_positive("area's height", size.y)?;
        let [columns, rows] = [size.x, size.y].map(|length| (length / cell).ceil());
        require("cells", columns * rows, columns * rows <= MOST, "at most a million")?;
        let (columns, rows) = (columns as usize, rows as usize);
        Ok(Self { area, cell, columns, rows, soundings: vec![Vec::new(); columns * rows], before: [None; 2] })
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

    /// Adds a sounding, in the order in which they are measured. What is outside the area does not count.
    pub fn add(&mut self, sounding: Sounding) {
        if !sounding.depth.is_finite() {
            return;
        }
        let ripple = self.ripple(&sounding);
        self.before = [self.before[1], Some(sounding)];
        let off = (sounding.place - self.area.min) / self.cell;
        if off.x >= 0.0 && off.y >= 0.0 {
            let (column, row) = (off.x as usize, off.y as usize);
            if column < self.columns && row < self.rows {
                self.soundings[row * self.columns + column].push(Noted { sounding, ripple });
            }
        }
    }

    /// How far the sounding before is from the mean of its neighbours: this has six quarters of the noise's
    /// variance, and ground that slopes evenly no part in it.
    fn ripple(&self, last: &Sounding) -> Option<f64> {
        let [first, middle] = [self.before[0]?, self.before[1]?];
        let near = self.cell;
        let is_near = (first.place - middle.place).norm() < near && (last.place - middle.place).norm() < near;
        let off = middle.depth - 0.5 * (first.depth + last.depth);
        is_near.then_some(off * off / 1.5)
    }

    /// The depth of a cell; `None` where it was not measured. O(soundings of the cells around).
    pub fn cell(&self, column: usize, row: usize) -> Option<CellDepth> {
        let own = self.soundings.get(row * self.columns + column)?;
        if column >= self.columns || own.is_empty() {
            return None;
        }
        let surface = self.surface(column, row)?;
        let noise = self.noise(column, row)?;
        let parts = self.parts(column, row, &surface);
        let own_parts = || parts.iter().filter(|(place, _)| is_own(place)).map(|(_, part)| part);
        let known = own_parts().count() as f64;
        let off = own_parts().map(|part| part.off).sum::<f64>() / known;
        let random = noise * self.squares(column, row, &surface, &parts);
        // What parts are off besides the noise, and more than by chance: those measured are a sample of all.
        let swell = own.iter().map(|noted| noted.sounding.swell).fold(0.0, f64::max);
        let known_off = |part: &Part| noise / part.count + swell * swell;
        let weight: f64 = parts.values().map(|part| part.weight).sum();
        let mean_of = |square: &dyn Fn(&Part) -> f64| {
            parts.values().map(|part| part.weight * square(part)).sum::<f64>() / weight
        };
        let by_noise = mean_of(&known_off) * (1.0 + (2.0 / parts.len() as f64).sqrt());
        let rough = (mean_of(&|part| part.off * part.off) - by_noise).max(0.0);
        let unknown = rough / known * (1.0 - known / (PARTS * PARTS) as f64);
        let place: Vector = own.iter().map(|noted| noted.sounding.sigma / own.len() as f64).sum();
        let datum = own.iter().map(|noted| noted.sounding.datum).fold(0.0, f64::max);
        let mean = surface.coefficients.dot(&cell_mean());
        let slope = Vector::new(surface.coefficients[1], surface.coefficients[2]) / self.cell;
        let placed = slope.component_mul(&place).norm_squared();
        // The mean of a wave over a phase; where several waves pass, of their envelope.
        let phase: f64 = own.iter().map(|noted| noted.sounding.phase).sum();
        let rocked = swell * swell / (1.0 + 0.5 * phase * phase);
        let variance = random + placed + datum * datum + rocked + unknown;
        Some(CellDepth { depth: mean + off, sigma: variance.sqrt() })
    }

    /// The measured parts of a cell and of those beside it.
    fn parts(&self, column: usize, row: usize, surface: &Surface) -> Parts {
        let centre = self.centre(column, row);
        let mut parts = Parts::new();
        for Noted { sounding, .. } in self.around(column, row) {
            let powers = self.powers(centre, sounding);
            let part = parts.entry(part_of(&powers)).or_insert(Part { off: 0.0, weight: 0.0, count: 0.0 });
            part.off += sounding.depth - surface.coefficients.dot(&powers);
            part.weight += self.weight(centre, sounding);
            part.count += 1.0;
        }
        for part in parts.values_mut() {
            part.off /= part.count;
            part.weight /= part.count;
        }
        parts
    }

    /// A cell's depth is the sum of the soundings around, each times a factor: the sum of these factors'
    /// squares. Its own soundings count by their parts; all count by the surface, as far as this is not the
    /// same in the mean of these parts and of the cell.
    fn squares(&self, column: usize, row: usize, surface: &Surface, parts: &Parts) -> f64 {
        let centre = self.centre(column, row);
        let known = parts.keys().filter(|place| is_own(place)).count() as f64;
        let soundings = || {
            self.around(column, row).map(|Noted { sounding, .. }| {
                let powers = self.powers(centre, sounding);
                let place = part_of(&powers);
                let own = if is_own(&place) { 1.0 / (known * parts[&place].count) } else { 0.0 };
                (powers, own, self.weight(centre, sounding))
            })
        };
        let differs = soundings().fold(cell_mean(), |mean, (powers, own, _)| mean - powers * own);
        let by_surface = surface.inverse * differs;
        soundings()
            .map(|(powers, own, weight)| own + weight * by_surface.dot(&powers))
            .map(|factor| factor * factor)
            .sum()
    }

    /// The quadratic surface through the soundings of a cell and of those beside it, by least squares; what
    /// is farther off counts less.
    fn surface(&self, column: usize, row: usize) -> Option<Surface> {
        let centre = self.centre(column, row);
        let (mut square, mut right, mut count) = (Matrix6::zeros(), Vector6::zeros(), 0);
        for Noted { sounding, .. } in self.around(column, row) {
            let weight = self.weight(centre, sounding);
            if weight > 0.0 {
                let powers = self.powers(centre, sounding);
                square += powers * powers.transpose() * weight;
                right += powers * (sounding.depth * weight);
                count += 1;
            }
        }
        if count < LEAST {
            return None;
        }
        // A lane alone does not say how the ground goes on across it: little is better than anything.
        let slack = Vector6::new(0.0, 1.0, 1.0, 1.0, 1.0, 1.0) * (SLACK * square[(0, 0)]);
        let inverse = (square + Matrix6::from_diagonal(&slack)).try_inverse()?;
        Some(Surface { inverse, coefficients: inverse * right })
    }

    /// The variance of the sensor's noise: from the median of ripples, to which steps of the ground do not
    /// matter.
    fn noise(&self, column: usize, row: usize) -> Option<f64> {
        let mut ripples: Vec<f64> = self.around(column, row).filter_map(|noted| noted.ripple).collect();
        let (count, middle) = (ripples.len() as f64, ripples.len() / 2);
        let median = || *ripples.select_nth_unstable_by(middle, f64::total_cmp).1;
        (count > 0.0).then(median).map(|median| median / (MEDIAN * (1.0 + OF_FEW / count)))
    }

    /// The surface's functions at a sounding, in cells from a centre.
    fn powers(&self, centre: Point, sounding: &Sounding) -> Vector6<f64> {
        let off = (sounding.place - centre) / self.cell;
        Vector6::new(1.0, off.x, off.y, off.x * off.x, off.x * off.y, off.y * off.y)
    }

    /// How much a sounding counts: all in the middle of the cell, nothing one and a half cells away.
    fn weight(&self, centre: Point, sounding: &Sounding) -> f64 {
        let off = (sounding.place - centre) / self.cell;
        (1.0 - off.norm_squared() / 2.25).max(0.0)
    }

    fn around(&self, column: usize, row: usize) -> impl Iterator<Item = &Noted> {
        let columns = column.saturating_sub(1)..(column + 2).min(self.columns);
        let rows = row.saturating_sub(1)..(row + 2).min(self.rows);
        rows.flat_map(move |row| columns.clone().map(move |column| row * self.columns + column))
            .flat_map(|index| &self.soundings[index])
    }
}

/// What keeps coefficients small that soundings do not determine, as a share of the soundings' weight.
const SLACK: f64 = 1e-4;

/// The means of the surface's functions over a cell: of squares, a twelfth.
fn cell_mean() -> Vector6<f64> {
    Vector6::new(1.0, 0.0, 0.0, 1.0 / 12.0, 0.0, 1.0 / 12.0)
}

/// The part that a place is in, by the surface's functions there.
fn part_of(powers: &Vector6<f64>) -> [usize; 2] {
    [powers[2], powers[1]].map(|off| ((off + 1.5) * PARTS as f64).max(0.0) as usize)
}

/// Whether a part is one of the cell itself.
fn is_own(place: &[usize; 2]) -> bool {
    place.iter().all(|index| (PARTS..2 * PARTS).contains(index))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sounding(place: Point, depth: f64) -> Sounding {
        Sounding { place, depth, sigma: Vector::zeros(), datum: 0.0, swell: 0.0, phase: 0.0 }
    }

    #[test]
    fn what_was_not_measured_has_no_depth() {
        let area = Aabb::new(Point::origin(), Point::new(3.0, 2.0));
        let mut map = DepthMap::new(area, 1.0).unwrap();
        for i in 0..20 {
            map.add(sounding(Point::new(0.05 * f64::from(i), 0.5), 2.0));
        }
        map.add(sounding(Point::new(-1.0, 0.5), 9.0));
        map.add(sounding(Point::new(2.5, 0.5), f64::NAN));
        assert_eq!((map.columns(), map.rows()), (3, 2));
        assert!((map.cell(0, 0).unwrap().depth - 2.0).abs() < 1e-6);
        assert!(map.cell(2, 0).is_none() && map.cell(0, 1).is_none() && map.cell(5, 0).is_none());
        assert!(DepthMap::new(area, 0.0).is_err() && DepthMap::new(area, 1e-6).is_err());
    }

    /// Lanes over a bowl, whose rim and middle no quadratic surface is: in how many cells the true mean is
    /// within two standard deviations.
    #[test]
    fn what_is_between_lanes_is_uncertain() {
        let ground =
            |x: f64, y: f64| 1.0 + 0.02 * ((x - 20.0) * (x - 20.0) + (y - 20.0) * (y - 20.0)).min(40.0);
        let (mut inside, mut cells) = (0.0, 0.0);
        for spacing in [1.0, 2.0, 3.0, 4.0] {
            let mut map = DepthMap::new(Aabb::new(Point::origin(), Point::new(40.0, 40.0)), spacing).unwrap();
            let mut stream = crate::random::Stream::new(3);
            for lane in 0..(40.0 / spacing) as usize {
                let x = spacing * (lane as f64 + 0.3);
                for step in 0..800 {
                    let y = 0.05 * f64::from(step);
                    map.add(sounding(Point::new(x, y), ground(x, y) + 0.01 * stream.normal()));
                }
            }
            for (column, row) in
                (0..map.rows()).flat_map(|row| (0..map.columns()).map(move |column| (column, row)))
            {
                let (Some(cell), centre) = (map.cell(column, row), map.centre(column, row)) else { continue };
                let place = |index: u32| spacing * (0.05 * f64::from(index) - 0.475);
                let points = (0..400).map(|i| ground(centre.x + place(i % 20), centre.y + place(i / 20)));
                let off = cell.depth - points.sum::<f64>() / 400.0;
                inside += if off.abs() <= 2.0 * cell.sigma { 1.0 } else { 0.0 };
                cells += 1.0;
            }
        }
        assert!((0.92..0.98).contains(&(inside / cells)), "{inside} of {cells}");
    }

    /// Of a level ground, also where a cell has few soundings: errors and what is said of them agree.
    #[test]
    fn the_noise_is_known_from_few_soundings() {
        for soundings in [20_u32, 200] {
            let (mut squares, mut stream) = (0.0, crate::random::Stream::new(8));
            for _ in 0..1000 {
                let mut map = DepthMap::new(Aabb::new(Point::origin(), Point::new(1.0, 1.0)), 1.0).unwrap();
                for index in 0..soundings {
                    let place = Point::new(f64::from(index) / f64::from(soundings), 0.5);
                    map.add(sounding(place, 2.0 + 0.01 * stream.normal()));
                }
                squares += map.noise(0, 0).unwrap() / 1e-4 / 1000.0;
            }
            assert!((squares - 1.0).abs() < 0.04, "{soundings}: {squares}");
        }
    }

    #[test]
    fn a_noisier_ground_is_less_sure() {
        let sigma = |noise: f64| {
            let mut map = DepthMap::new(Aabb::new(Point::origin(), Point::new(1.0, 1.0)), 1.0).unwrap();
            let mut stream = crate::random::Stream::new(5);
            for _ in 0..100 {
                let place = Point::new(stream.uniform(), stream.uniform());
                map.add(sounding(place, 2.0 + noise * stream.normal()));
            }
            map.cell(0, 0).unwrap().sigma
        };
        assert!(sigma(0.1) > 3.0 * sigma(0.01));
    }
}
