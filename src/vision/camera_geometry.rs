use crate::geometry::{Point, math};

/// How a level camera that looks straight ahead maps places on the floor to pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraGeometry {
    /// The horizontal field of view in radians.
    pub field_of_view: f64,
    /// Metres above the floor.
    pub height: f64,
    /// Metres ahead of the robot's middle.
    pub ahead: f64,
}

impl CameraGeometry {
    /// Pixels that a metre covers at a distance of a metre, in an image of a width.
    pub fn focal(&self, width: u32) -> f64 {
        0.5 * f64::from(width) / math::tan(0.5 * self.field_of_view)
    }

    /// The direction of a column in radians to the left of straight ahead, from the camera.
    pub fn bearing(&self, column: f64, width: u32) -> f64 {
        math::atan((0.5 * f64::from(width) - column - 0.5) / self.focal(width))
    }

    /// Where on the floor, in the robot's frame, something stands whose foot is in a column and a row; `None` at the
    /// horizon and above.
    pub fn floor(&self, column: f64, row: f64, (width, height): (u32, u32)) -> Option<Point> {
        let below = row + 0.5 - 0.5 * f64::from(height);
        if below < 1.0 {
            return None;
        }
        let depth = self.height * self.focal(width) / below;
        Some(Point::new(self.ahead + depth, depth * math::tan(self.bearing(column, width))))
    }
}
