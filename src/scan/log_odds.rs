use crate::ParameterError;
use crate::geometry::{Point, Pose, direction, math};
use crate::io::LidarScan;
use crate::parameter::require;
use crate::world::OccupancyGrid;

/// Sensor model: how much a single beam changes the cells that it hits and crosses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogOddsMapParameters {
    /// Probability that the cell at the end of a beam is occupied, between 0.5 and 1.
    pub hit: f64,
    /// Probability that a cell crossed by a beam is occupied, between 0 and 0.5.
    pub miss: f64,
    /// Maximum certainty of a cell, so that it can change again; between 0.5 and 1.
    pub most: f64,
}

impl Default for LogOddsMapParameters {
    fn default() -> Self {
        Self { hit: 0.7, miss: 0.4, most: 0.97 }
    }
}

/// An occupancy grid built from lidar scans (book, section 10.3; H. Moravec, A. Elfes, *High Resolution Maps
/// from Wide Angle Sonar*, ICRA 1985).
///
/// Each cell holds the log odds of being occupied. A scan increases them in the cells at the ends of its
/// beams and decreases them in the cells crossed, once per cell. A beam without an echo clears its path up to
/// the maximum range. Poses are taken as exact.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::io::LidarScan;
/// use roverlab::scan::{LogOddsMap, LogOddsMapParameters};
/// use roverlab::world::Occupancy;
/// let mut map = LogOddsMap::new(20, 10, 0.1, Pose::default(), LogOddsMapParameters::default()).unwrap();
/// let scan = LidarScan { range_max: 3.0, angle_increment: 0.01, ranges: vec![1.0], ..LidarScan::default() };
/// for _ in 0..5 {
///     map.add(Pose::new(0.55, 0.55, 0.0), &scan);
/// }
/// let grid = map.to_occupancy(0.3, 0.7);
/// assert_eq!((grid.cell(15, 5), grid.cell(10, 5), grid.cell(17, 5)), (Occupancy::Occupied, Occupancy::Free, Occupancy::Unknown));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LogOddsMap {
    grid: OccupancyGrid,
    odds: Vec<f64>,
    /// Twice the number of the scan that last changed a cell, plus one for a hit.
    touched: Vec<u32>,
    scans: u32,
    hit: f64,
    miss: f64,
    most: f64,
}

impl LogOddsMap {
    /// An unknown map; see [`OccupancyGrid::unknown`] for the parameters.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(
        width: usize,
        height: usize,
        resolution: f64,
        origin: Pose,
        parameters: LogOddsMapParameters,
    ) -> Result<Self, ParameterError> {
        let checked = |parameter, value: f64, low: f64, high: f64, expected: &'static str| {
            require(parameter, value, value > low && value < high, expected)
                .map(|()| math::ln(value / (1.0 - value)))
        };
        let hit = checked("hit", parameters.hit, 0.5, 1.0, "more than 0.5 and less than 1")?;
        let miss = checked("miss", parameters.miss, 0.0, 0.5, "more than 0 and less than 0.5")?;
        let most = checked("most", parameters.most, 0.5, 1.0, "more than 0.5 and less than 1")?;
        let grid = OccupancyGrid::unknown(width, height, resolution, origin)?;
        let cells = width * height;
        Ok(Self { grid, odds: vec![0.0; cells], touched: vec![0; cells], scans: 0, hit, miss, most })
    }

    /// Enters a scan made at a robot pose. Negative and NaN ranges are ignored.
    pub fn add(&mut self, robot: Pose, scan: &LidarScan) {
        self.scans = if self.scans >= u32::MAX / 2 - 1 {
            self.touched.fill(0);
            1
        } else {
            self.scans + 1
        };
        let origin = robot.to_world(scan.mount.position());
        let heading = robot.heading + scan.mount.heading;
        if !(origin.x.is_finite() && origin.y.is_finite() && heading.is_finite()) {
            return;
        }
        // Hits first, so that no grazing beam clears a cell in which another one ends.
        for hits in [true, false] {
            for (index, &range) in scan.ranges.iter().enumerate() {
                let ends = range <= scan.range_max;
                let length = if ends { range } else { scan.range_max };
                if range.is_nan() || !(length >= 0.0 && length.is_finite()) {
                    continue;
                }
                let end = origin + direction(heading + scan.angle(index)) * length;
                match (hits, ends) {
                    (true, true) => self.hit(end),
                    (true, false) => {}
                    (false, _) => self.clear(origin, end),
                }
            }
        }
    }

    /// Probability that a cell is occupied; `None` outside the map.
    pub fn probability(&self, column: usize, row: usize) -> Option<f64> {
        let inside = column < self.grid.width() && row < self.grid.height();
        inside.then(|| 1.0 / (1.0 + math::exp(-self.odds[row * self.grid.width() + column])))
    }

    /// The map with three states: free below one probability, occupied above another, unknown in between.
    pub fn to_occupancy(&self, free: f64, occupied: f64) -> OccupancyGrid {
        let mut grid = self.grid.clone();
        for row in 0..grid.height() {
            for column in 0..grid.width() {
                let percent = match self.probability(column, row) {
                    Some(p) if p < free => Some(0),
                    Some(p) if p > occupied => Some(100),
                    _ => None,
                };
                grid.set_occupancy(column, row, percent);
            }
        }
        grid
    }

    fn hit(&mut self, point: Point) {
        let Some((column, row)) = self.grid.cell_at(point) else { return };
        let index = row * self.grid.width() + column;
        if self.touched[index] < 2 * self.scans {
            self.touched[index] = 2 * self.scans + 1;
            self.odds[index] = (self.odds[index] + self.hit).min(self.most);
        }
    }

    /// Clears the cells between two points, except those that were hit.
    ///
    /// J. Amanatides, A. Woo, *A Fast Voxel Traversal Algorithm for Ray Tracing*, Eurographics 1987.
    fn clear(&mut self, from: Point, to: Point) {
        let scale = 1.0 / self.grid.resolution();
        let [a, b] = [from, to].map(|point| self.grid.origin().to_local(point) * scale);
        let (width, height) = (self.grid.width() as f64, self.grid.height() as f64);
        let Some((first, last)) = within(a, b, width, height) else { return };
        let along = |t: f64| a + (b - a) * t;
        let start = along(first);
        let cell = |x: f64, cells: f64| x.floor().clamp(0.0, cells - 1.0);
        let (mut x, mut y) = (cell(start.x, width), cell(start.y, height));
        let axis = |from: f64, d: f64, cell: f64| {
            let step = if d > 0.0 { 1.0 } else { -1.0 };
            let next = if d > 0.0 { cell + 1.0 } else { cell };
            if d == 0.0 {
                (step, f64::INFINITY, f64::INFINITY)
            } else {
                (step, (next - from) / d, (1.0 / d).abs())
            }
        };
        let d = b - a;
        let ((step_x, mut next_x, per_x), (step_y, mut next_y, per_y)) =
            (axis(a.x, d.x, x), axis(a.y, d.y, y));
        while x >= 0.0 && y >= 0.0 && x < width && y < height {
            self.pass(y as usize * self.grid.width() + x as usize);
            if next_x.min(next_y) > last {
                return;
            }
            if next_x < next_y {
                (x, next_x) = (x + step_x, next_x + per_x);
            } else {
                (y, next_y) = (y + step_y, next_y + per_y);
            }
        }
    }

    fn pass(&mut self, index: usize) {
        if self.touched[index] < 2 * self.scans {
            self.touched[index] = 2 * self.scans;
            self.odds[index] = (self.odds[index] + self.miss).max(-self.most);
        }
    }
}

/// Part of a segment inside a box at the origin, as fractions of its length.
fn within(a: Point, b: Point, width: f64, height: f64) -> Option<(f64, f64)> {
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for (from, d, size) in [(a.x, b.x - a.x, width), (a.y, b.y - a.y, height)] {
        if d == 0.0 {
            if from < 0.0 || from >= size {
                return None;
            }
            continue;
        }
        let (one, other) = (-from / d, (size - from) / d);
        (first, last) = (first.max(one.min(other)), last.min(one.max(other)));
    }
    (first <= last).then_some((first, last))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Occupancy;
    use proptest::prelude::*;

    fn scan(ranges: Vec<f64>) -> LidarScan {
        let angle_increment = std::f64::consts::TAU / ranges.len() as f64;
        LidarScan {
            angle_min: -std::f64::consts::PI,
            angle_increment,
            range_max: 5.0,
            ranges,
            ..LidarScan::default()
        }
    }

    fn map() -> LogOddsMap {
        LogOddsMap::new(60, 60, 0.1, Pose::new(-3.0, -3.0, 0.0), LogOddsMapParameters::default()).unwrap()
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        let error =
            |parameters| LogOddsMap::new(2, 2, 0.1, Pose::default(), parameters).unwrap_err().to_string();
        let standard = LogOddsMapParameters::default();
        assert_eq!(
            error(LogOddsMapParameters { hit: 0.5, ..standard }),
            "hit is 0.5; expected more than 0.5 and less than 1"
        );
        assert!(error(LogOddsMapParameters { miss: f64::NAN, ..standard }).starts_with("miss is NaN"));
        assert!(LogOddsMap::new(2, 2, 0.0, Pose::default(), standard).is_err());
    }

    #[test]
    fn a_round_room_is_mapped() {
        let mut map = map();
        (0..10).for_each(|_| map.add(Pose::default(), &scan(vec![2.0; 720])));
        let grid = map.to_occupancy(0.3, 0.7);
        for row in 0..60 {
            for column in 0..60 {
                let distance = (grid.centre(column, row) - Point::origin()).norm();
                match grid.cell(column, row) {
                    Occupancy::Free => assert!(distance < 2.08, "{distance}"),
                    Occupancy::Occupied => assert!((distance - 2.0).abs() < 0.08, "{distance}"),
                    Occupancy::Unknown => assert!(distance > 1.9, "{distance}"),
                }
            }
        }
        // Observations may change: the room is opened.
        (0..20).for_each(|_| map.add(Pose::default(), &scan(vec![f64::INFINITY; 720])));
        assert_eq!(map.to_occupancy(0.3, 0.7).count(Occupancy::Occupied), 0);
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        /// Probabilities stay within their bounds for any input, and cells outside all beams do not change.
        #[test]
        fn odds_stay_within_bounds(
            x in -9.0..9.0f64, y in -9.0..9.0f64, heading in -9.0..9.0f64,
            ranges in proptest::collection::vec(prop_oneof![0.0..9.0f64, Just(f64::INFINITY), Just(f64::NAN), Just(-1.0)], 1..50)
        ) {
            let mut map = map();
            (0..30).for_each(|_| map.add(Pose::new(x, y, heading), &scan(ranges.clone())));
            for row in 0..60 {
                for column in 0..60 {
                    let p = map.probability(column, row).unwrap();
                    prop_assert!((0.03 - 1e-9..=0.97 + 1e-9).contains(&p));
                    let far = (map.grid.centre(column, row) - Point::new(x, y)).norm() > 5.1;
                    prop_assert!(!far || p == 0.5);
                }
            }
        }
    }
}
