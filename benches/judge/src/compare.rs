use std::fmt;

use roverlab::geometry::{math, units};

use crate::course::{Course, Sample};

/// Differences between two drives along a course.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    number: u64,
    /// Steepest slope (degrees).
    steepest: f64,
    curved: bool,
    /// Length of the simulator's way (m).
    length: f64,
    /// Difference in height (mm): median along the way, and largest.
    height: [f64; 2],
    /// Angle between the upward axes (degrees), likewise.
    attitude: [f64; 2],
    /// Difference of the ways' lengths (%).
    distance: f64,
    /// Distance between the ends (mm).
    apart: f64,
}

/// Medians over terrains.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Medians {
    height: [f64; 2],
    attitude: [f64; 2],
    distance: f64,
    apart: f64,
}

/// Largest median of the difference in height (mm).
const HEIGHT: f64 = 3.0;
/// Largest median of the angle between the upward axes (degrees).
const ATTITUDE: f64 = 1.0;
/// Largest median of the difference in distance (%).
const DISTANCE: f64 = 2.0;
/// Length of a way below which a robot did not drive its course (m).
const DRIVEN: f64 = 1.8;

impl Row {
    /// Compares two drives along a course.
    pub(crate) fn compare(number: u64, course: &Course, ours: &[Sample], theirs: &[Sample]) -> Self {
        let pairs = || ours.iter().zip(theirs);
        let heights = pairs().map(|(a, b)| units::to_mm((a.place.z - b.place.z).abs()));
        let angles = pairs().map(|(a, b)| units::to_deg(math::acos(a.up.dot(&b.up).min(1.0))));
        let mut apart = pairs().map(|(a, b)| units::to_mm((a.place - b.place).norm()));
        let [length, other] = [ours, theirs].map(length);
        Self {
            number,
            steepest: units::to_deg(math::atan(course.steepest)),
            curved: course.is_curved(),
            length,
            height: median_and_most(heights.collect()),
            attitude: median_and_most(angles.collect()),
            distance: 100.0 * (length / other - 1.0).abs(),
            apart: apart.next_back().unwrap_or(f64::NAN),
        }
    }
}

impl Medians {
    /// Medians over some rows.
    pub(crate) fn of(rows: &[Row]) -> Self {
        let over = |value: fn(&Row) -> f64| median_and_most(rows.iter().map(value).collect())[0];
        Self {
            height: [over(|row| row.height[0]), over(|row| row.height[1])],
            attitude: [over(|row| row.attitude[0]), over(|row| row.attitude[1])],
            distance: over(|row| row.distance),
            apart: over(|row| row.apart),
        }
    }

    /// Whether they are within the limits: even those of the largest differences along each way.
    pub(crate) fn are_good(&self, rows: &[Row]) -> bool {
        let driven = rows.iter().all(|row| row.length > DRIVEN);
        driven && self.height[1] <= HEIGHT && self.attitude[1] <= ATTITUDE && self.distance <= DISTANCE
    }
}

/// Titles of the columns.
pub(crate) const TITLES: &str = "\
terrain  slope  way      length | height, mm      | attitude, deg | distance | ends apart
           deg                m | median  largest | median  largest|       % |         mm";

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([height, highest], [angle, widest]) = (self.height, self.attitude);
        let way = if self.curved { "curved" } else { "straight" };
        write!(f, "{:7}  {:5.1}  {way:8}  {:5.3} ", self.number, self.steepest, self.length)?;
        write!(f, "| {height:6.3} {highest:8.3} | {angle:6.3} {widest:7.3} ")?;
        write!(f, "| {:8.3} | {:10.2}", self.distance, self.apart)
    }
}

impl fmt::Display for Medians {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([height, highest], [angle, widest]) = (self.height, self.attitude);
        write!(
            f,
            "median                          | {height:6.3} {highest:8.3} | {angle:6.3} {widest:7.3} "
        )?;
        write!(f, "| {:8.3} | {:10.2}", self.distance, self.apart)
    }
}

/// Length of a way in space (m).
fn length(way: &[Sample]) -> f64 {
    way.windows(2).map(|pair| (pair[1].place - pair[0].place).norm()).sum()
}

/// Median, of an even number of values the mean of the two in the middle, and maximum; NaN of none.
fn median_and_most(mut values: Vec<f64>) -> [f64; 2] {
    values.sort_by(f64::total_cmp);
    let (Some(&most), half) = (values.last(), values.len() / 2) else { return [f64::NAN; 2] };
    let odd = values.len() % 2 == 1;
    [if odd { values[half] } else { 0.5 * (values[half - 1] + values[half]) }, most]
}
