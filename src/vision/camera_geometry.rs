use crate::geometry::{Point, math};

/// Projection of a level camera that looks straight ahead: places on the floor to pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraGeometry {
    /// Horizontal field of view (rad).
    pub field_of_view: f64,
    /// Height above the floor (m).
    pub height: f64,
    /// Distance ahead of the robot's centre (m).
    pub ahead: f64,
}

impl CameraGeometry {
    /// Focal length (pixels) for an image width (pixels).
    pub fn focal(&self, width: u32) -> f64 {
        0.5 * f64::from(width) / math::tan(0.5 * self.field_of_view)
    }

    /// Bearing of a column, seen from the camera; positive to the left of straight ahead (rad).
    pub fn bearing(&self, column: f64, width: u32) -> f64 {
        math::atan((0.5 * f64::from(width) - column - 0.5) / self.focal(width))
    }

    /// Position on the floor, in the robot frame (m), of an object whose foot is at a column and row. `None`
    /// at the horizon and above.
    pub fn floor(&self, column: f64, row: f64, (width, height): (u32, u32)) -> Option<Point> {
        let below = row + 0.5 - 0.5 * f64::from(height);
        if below < 1.0 {
            return None;
        }
        let depth = self.height * self.focal(width) / below;
        Some(Point::new(self.ahead + depth, depth * math::tan(self.bearing(column, width))))
    }
}
