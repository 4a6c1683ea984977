use super::{Point, Vector};

/// A line segment between two points.
///
/// ```
/// use roverlab::geometry::{Point, Segment};
/// let wall = Segment::new(Point::new(0.0, 0.0), Point::new(2.0, 0.0));
/// assert_eq!(wall.closest_point(Point::new(0.5, 1.0)), Point::new(0.5, 0.0));
/// assert_eq!(wall.distance_to(Point::new(5.0, 4.0)), 5.0, "to its end: a 3-4-5 triangle");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// One end.
    pub a: Point,
    /// The other end.
    pub b: Point,
}

impl Segment {
    /// A segment between two points, which may coincide.
    pub const fn new(a: Point, b: Point) -> Self {
        Self { a, b }
    }

    /// Length (m).
    pub fn length(&self) -> f64 {
        (self.b - self.a).norm()
    }

    /// Point of the segment closest to `point`.
    #[inline]
    pub fn closest_point(&self, point: Point) -> Point {
        let along = self.b - self.a;
        let squared = along.norm_squared();
        if squared == 0.0 {
            return self.a;
        }
        let t = ((point - self.a).dot(&along) / squared).clamp(0.0, 1.0);
        self.a + along * t
    }

    /// Distance to a point (m).
    #[inline]
    pub fn distance_to(&self, point: Point) -> f64 {
        (self.closest_point(point) - point).norm()
    }
}

/// An axis-aligned bounding box.
///
/// ```
/// use roverlab::geometry::{Aabb, Point, Vector};
/// let corners = [Point::new(2.0, 0.0), Point::new(0.0, 1.0)];
/// let room = Aabb::around(corners).expect("there are points");
/// assert_eq!(room.size(), Vector::new(2.0, 1.0));
/// assert!(!room.contains(Point::new(2.1, 0.5)) && room.inflated(0.2).contains(Point::new(2.1, 0.5)));
/// assert_eq!(room, Aabb::new(corners[1], corners[0]));
/// // The middle half of a line through it is in it.
/// let through = roverlab::geometry::Segment::new(Point::new(-1.0, 0.5), Point::new(3.0, 0.5));
/// assert_eq!(room.span(&through), Some([0.25, 0.75]));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Corner with the smallest coordinates.
    pub min: Point,
    /// Corner with the largest coordinates.
    pub max: Point,
}

impl Aabb {
    /// The box between two opposite corners, in any order.
    pub fn new(a: Point, b: Point) -> Self {
        Self { min: a.inf(&b), max: a.sup(&b) }
    }

    /// Bounding box of points; `None` without points.
    pub fn around(points: impl IntoIterator<Item = Point>) -> Option<Self> {
        points.into_iter().fold(None, |bounds: Option<Self>, point| match bounds {
            None => Some(Self { min: point, max: point }),
            Some(b) => Some(Self { min: b.min.inf(&point), max: b.max.sup(&point) }),
        })
    }

    /// Width and height (m).
    pub fn size(&self) -> Vector {
        self.max - self.min
    }

    /// Whether a point lies inside or on the border.
    pub fn contains(&self, point: Point) -> bool {
        self.min.x <= point.x && point.x <= self.max.x && self.min.y <= point.y && point.y <= self.max.y
    }

    /// The fractions of a segment between which it lies in the box; `None` if it misses the box, or an end is not
    /// finite.
    pub fn span(&self, line: &Segment) -> Option<[f64; 2]> {
        let (mut begin, mut end) = (0.0_f64, 1.0_f64);
        for axis in 0..2 {
            let (from, along) = (line.a[axis], line.b[axis] - line.a[axis]);
            if along == 0.0 {
                if !(self.min[axis]..=self.max[axis]).contains(&from) {
                    return None;
                }
                continue;
            }
            let [one, other] = [self.min[axis], self.max[axis]].map(|side| (side - from) / along);
            if one.is_nan() || other.is_nan() {
                return None;
            }
            begin = begin.max(one.min(other));
            end = end.min(one.max(other));
        }
        (begin <= end).then_some([begin, end])
    }

    /// The box extended by `margin` (m) on every side.
    #[must_use]
    pub fn inflated(&self, margin: f64) -> Self {
        let m = Vector::new(margin, margin);
        Self { min: self.min - m, max: self.max + m }
    }

    /// Bounding box of both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.inf(&other.min), max: self.max.sup(&other.max) }
    }
}
