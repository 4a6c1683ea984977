use super::solid::Span;
use crate::geometry::{Aabb, Point, Pose, Vector, cross};
use crate::world::Wall;

/// Extension of a wall beyond the ends of its line, so that no ray slips through where two lines of zero
/// thickness meet (m).
const OVERLAP: f64 = 1e-12;

/// A rectangle with any orientation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OrientedBox {
    /// Its centre.
    pub(super) centre: Point,
    /// Unit vector along its length.
    pub(super) axis: Vector,
    /// Half extents along and across the axis (m).
    pub(super) half: Vector,
}

impl OrientedBox {
    /// The foot of a wall. A wall of zero length is a transverse line of the wall's thickness.
    pub(super) fn of_wall(wall: &Wall) -> Self {
        let along = wall.line.b - wall.line.a;
        // Scaled to avoid overflow of squares.
        let scale = along.amax();
        let (axis, length) = if scale > 0.0 && scale.is_finite() {
            let scaled = along / scale;
            let length = scaled.norm();
            (scaled / length, length * scale)
        } else {
            (Vector::x(), 0.0)
        };
        let half = Vector::new(0.5 * length + OVERLAP, 0.5 * wall.thickness.max(0.0));
        Self { centre: wall.line.a + along * 0.5, axis, half }
    }

    /// A rectangle in the frame at `pose`.
    pub(super) fn placed(rectangle: &Aabb, pose: &Pose) -> Self {
        let axis = pose.forward();
        let middle = (rectangle.min.coords + rectangle.max.coords) * 0.5;
        let centre = Point::new(
            pose.x + axis.x * middle.x - axis.y * middle.y,
            pose.y + axis.y * middle.x + axis.x * middle.y,
        );
        Self { centre, axis, half: rectangle.size() * 0.5 }
    }

    /// A world point in the box's frame: along and across, from its centre.
    #[inline]
    pub(super) fn local(&self, point: Point) -> Vector {
        let from_centre = point - self.centre;
        Vector::new(self.axis.dot(&from_centre), cross(self.axis, from_centre))
    }

    /// A vector of the box's frame in the world's frame.
    #[inline]
    pub(super) fn turned(&self, local: Vector) -> Vector {
        let a = self.axis;
        Vector::new(a.x * local.x - a.y * local.y, a.y * local.x + a.x * local.y)
    }

    /// The four corners, counter-clockwise.
    #[inline]
    pub(super) fn corners(&self) -> [Point; 4] {
        let (h, t) = (self.half.x, self.half.y);
        [(h, t), (-h, t), (-h, -t), (h, -t)].map(|(u, s)| self.centre + self.turned(Vector::new(u, s)))
    }

    /// Half extents of its axis-aligned bounding box.
    #[inline]
    pub(super) fn reach(&self) -> Vector {
        let (a, h) = (self.axis.abs(), self.half);
        Vector::new(a.x * h.x + a.y * h.y, a.y * h.x + a.x * h.y)
    }
}

/// Floor area of an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shape {
    Disc { centre: Point, radius: f64 },
    Box(OrientedBox),
}

impl Shape {
    /// Axis-aligned bounding box.
    #[inline]
    pub(super) fn bounds(&self) -> Aabb {
        let (centre, reach) = match self {
            Shape::Disc { centre, radius } => (*centre, Vector::new(*radius, *radius)),
            Shape::Box(b) => (b.centre, b.reach()),
        };
        Aabb { min: centre - reach, max: centre + reach }
    }
}

/// A box between two heights: a wall or a mast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Block {
    pub(super) shape: OrientedBox,
    pub(super) span: Span,
}

impl Block {
    pub(super) fn of_wall(wall: &Wall) -> Self {
        Self { shape: OrientedBox::of_wall(wall), span: Span { bottom: 0.0, top: wall.height } }
    }

    /// Axis-aligned bounding box.
    pub(super) fn bounds(&self) -> Aabb {
        Shape::Box(self.shape).bounds()
    }
}
