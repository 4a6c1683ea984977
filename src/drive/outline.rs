use crate::geometry::{Point, Pose, Vector, direction};

/// A rectangle on the ground: its corners, and the directions of its sides.
#[derive(Debug, Clone, Copy)]
pub(in crate::drive) struct Outline {
    pub(in crate::drive) corners: [Point; 4],
    sides: [Vector; 2],
}

impl Outline {
    /// From its ends along x and its half width, in the frame of a pose (m).
    pub(in crate::drive) fn new(pose: &Pose, (back, front): (f64, f64), half: f64) -> Self {
        let corners = [(back, -half), (front, -half), (front, half), (back, half)];
        let forward = direction(pose.heading);
        Self {
            corners: corners.map(|(x, y)| pose.to_world(Point::new(x, y))),
            sides: [forward, Vector::new(-forward.y, forward.x)],
        }
    }

    /// Whether two rectangles overlap: no side of either separates them.
    pub(in crate::drive) fn touches(&self, other: &Self) -> bool {
        self.sides.iter().chain(&other.sides).all(|axis| {
            let (low, high) = self.span(axis);
            let (other_low, other_high) = other.span(axis);
            low <= other_high && other_low <= high
        })
    }

    /// Extent along an axis (m).
    fn span(&self, axis: &Vector) -> (f64, f64) {
        let shares = self.corners.map(|corner| corner.coords.dot(axis));
        shares
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &share| (low.min(share), high.max(share)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_touch_at_corners_and_not_beyond() {
        let square = Outline::new(&Pose::default(), (-1.0, 1.0), 1.0);
        let turned = |x: f64| Outline::new(&Pose::new(x, 0.0, std::f64::consts::FRAC_PI_4), (-1.0, 1.0), 1.0);
        assert!(square.touches(&turned(2.41)) && !square.touches(&turned(2.42)));
        assert!(square.touches(&Outline::new(&Pose::default(), (-0.1, 0.1), 0.1)), "inside");
    }
}
