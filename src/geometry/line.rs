use nalgebra::Vector2;

use super::{Point, Vector, cross, direction, math};

/// Total least-squares fit of a straight line: minimises the squared perpendicular distances (K. Pearson, "On
/// lines and planes of closest fit to systems of points in space", 1901).
///
/// ```
/// use roverlab::geometry::{FittedLine, Point};
/// let points = (0..10).map(|i| Point::new(0.1 * f64::from(i), 1.0 + 0.05 * f64::from(i)));
/// let line = FittedLine::through(points).unwrap();
/// assert!((line.direction.y / line.direction.x - 0.5).abs() < 1e-9 && line.rms < 1e-6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedLine {
    /// Mean of the points.
    pub middle: Point,
    /// Unit vector along the line, from the first points to the last.
    pub direction: Vector,
    /// RMS distance of the points from the line (m).
    pub rms: f64,
    /// Extent of the points along the line (m).
    pub length: f64,
    /// Number of points.
    pub points: usize,
}

impl FittedLine {
    /// Fits a line to at least two points that are not all equal; otherwise `None`.
    pub fn through(points: impl Iterator<Item = Point> + Clone) -> Option<Self> {
        let mut count = 0_usize;
        let mut sum = Vector2::zeros();
        for point in points.clone() {
            count += 1;
            sum += point.coords;
        }
        if count < 2 {
            return None;
        }
        let middle = Point::from(sum / count as f64);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for point in points.clone() {
            let d = point - middle;
            xx += d.x * d.x;
            xy += d.x * d.y;
            yy += d.y * d.y;
        }
        if (xx + yy).is_nan() || xx + yy <= 1e-18 * count as f64 {
            return None;
        }
        // Direction of the eigenvector with the larger eigenvalue.
        let angle = 0.5 * math::atan2(2.0 * xy, xx - yy);
        let mut along_line = direction(angle);
        let spread = math::hypot(0.5 * (xx - yy), xy);
        let rms = ((0.5 * (xx + yy) - spread).max(0.0) / count as f64).sqrt();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        // Later points shall lie farther along the line.
        let mut trend = 0.0;
        for (index, point) in points.enumerate() {
            let along = (point - middle).dot(&along_line);
            low = low.min(along);
            high = high.max(along);
            trend += (index as f64 - 0.5 * (count - 1) as f64) * along;
        }
        if trend < 0.0 {
            along_line = -along_line;
        }
        Some(Self { middle, direction: along_line, rms, length: high - low, points: count })
    }

    /// Signed distance from the line to a point, positive to the left (m).
    pub fn distance_to(&self, point: Point) -> f64 {
        cross(self.direction, point - self.middle)
    }

    /// Angle of the direction (rad).
    pub fn angle(&self) -> f64 {
        math::atan2(self.direction.y, self.direction.x)
    }

    /// Intersection of two lines; `None` if they are parallel.
    pub fn crossing(&self, other: &Self) -> Option<Point> {
        let parallel = cross(self.direction, other.direction);
        if parallel.abs() < 1e-9 {
            return None;
        }
        let along = cross(other.middle - self.middle, other.direction) / parallel;
        Some(self.middle + self.direction * along)
    }

    /// Projection of a point onto the line.
    pub fn foot(&self, point: Point) -> Point {
        self.middle + self.direction * (point - self.middle).dot(&self.direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn no_other_line_fits_better(
            points in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 3..20), turn in -0.3..0.3f64, shift in -0.1..0.1f64,
        ) {
            let points: Vec<Point> = points.into_iter().map(|(x, y)| Point::new(x, y)).collect();
            let line = FittedLine::through(points.iter().copied()).unwrap();
            let sum = |line: &FittedLine| points.iter().map(|&p| line.distance_to(p) * line.distance_to(p)).sum::<f64>();
            prop_assert!((sum(&line) - points.len() as f64 * line.rms * line.rms).abs() < 1e-9);
            let turned = direction(line.angle() + turn);
            let aside = Vector::new(-turned.y, turned.x) * shift;
            let other = FittedLine { direction: turned, middle: line.middle + aside, ..line };
            prop_assert!(sum(&other) >= sum(&line) - 1e-12);
        }

        #[test]
        fn the_direction_follows_the_points(angle in -3.1..3.1f64) {
            let points = (0..7).map(|i| Point::origin() + direction(angle) * f64::from(i));
            let line = FittedLine::through(points).unwrap();
            prop_assert!((line.direction - direction(angle)).norm() < 1e-9 && (line.length - 6.0).abs() < 1e-9);
        }
    }

    #[test]
    fn crossings_and_feet() {
        let line = |a: (f64, f64), b: (f64, f64)| {
            FittedLine::through([Point::new(a.0, a.1), Point::new(b.0, b.1)].into_iter()).unwrap()
        };
        let (x, y) = (line((0.0, 1.0), (2.0, 1.0)), line((3.0, -1.0), (3.0, 4.0)));
        assert!((x.crossing(&y).unwrap() - Point::new(3.0, 1.0)).norm() < 1e-12);
        assert!(x.crossing(&x).is_none());
        assert_eq!(x.distance_to(Point::new(7.0, 3.0)), 2.0);
        assert!((x.foot(Point::new(7.0, 3.0)) - Point::new(7.0, 1.0)).norm() < 1e-12);
        assert!(FittedLine::through([Point::origin()].into_iter()).is_none());
        assert!(FittedLine::through([Point::origin(); 3].into_iter()).is_none());
    }
}
