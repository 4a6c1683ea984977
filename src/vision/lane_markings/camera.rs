use crate::ParameterError;
use crate::geometry::{Point, Vector, math};
use crate::parameter::{require, require_finite, require_positive};

/// Mount and lens of a camera that looks at the road. It maps points of level ground to pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadCamera {
    /// Horizontal field of view (rad).
    pub field_of_view: f64,
    /// Whether the lens is an equidistant fisheye rather than a pinhole.
    pub fisheye: bool,
    /// Tilt above the horizontal (rad); negative if it looks down.
    pub tilt: f64,
    /// Height above the ground (m).
    pub height: f64,
    /// Position ahead of the robot's origin (m).
    pub ahead: f64,
}

impl RoadCamera {
    /// Checks the fields.
    ///
    /// # Errors
    ///
    /// If a field is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let widest = if self.fisheye { std::f64::consts::TAU } else { std::f64::consts::PI };
        let view = self.field_of_view;
        require(
            "field of view",
            view,
            view > 0.0 && view < widest,
            "more than 0, and less than the lens can show",
        )?;
        require("camera tilt", self.tilt, self.tilt.abs() < 1.5, "between -1.5 and 1.5 rad")?;
        require_positive("camera height", self.height)?;
        require_finite("camera ahead", self.ahead)
    }

    /// Focal length (pixels; for a fisheye, pixels per radian).
    fn focal(&self, width: u32) -> f64 {
        let width = f64::from(width);
        if self.fisheye {
            width / self.field_of_view
        } else {
            0.5 * width / math::tan(0.5 * self.field_of_view)
        }
    }

    /// Projects a ground point in the robot's frame to column and row in an image of a given size. The centre
    /// of pixel (0, 0) is (0.5, 0.5). `pitch` is added to the tilt (rad). `None` behind the camera.
    pub fn project(&self, place: Point, pitch: f64, size: (u32, u32)) -> Option<(f64, f64)> {
        self.projection(pitch, size).of(place)
    }

    /// The projection to images of a size, for many points.
    pub(in crate::vision) fn projection(&self, pitch: f64, (width, height): (u32, u32)) -> Projection {
        let (sin, cos) = math::sin_cos(self.tilt + pitch);
        let middle = (0.5 * f64::from(width), 0.5 * f64::from(height));
        Projection { camera: *self, sin, cos, focal: self.focal(width), middle }
    }

    /// Apparent motion of a ground point per radian of upward pitch (m/rad).
    pub(super) fn lift(&self, place: Point) -> Vector {
        let ahead = place.x - self.ahead;
        Vector::new((ahead * ahead + self.height * self.height) / self.height, ahead * place.y / self.height)
    }
}

/// Mapping from level ground to pixels at a pitch, with its constants computed once.
#[derive(Debug, Clone, Copy)]
pub(in crate::vision) struct Projection {
    camera: RoadCamera,
    sin: f64,
    cos: f64,
    /// Pixels; for a fisheye, pixels per radian.
    focal: f64,
    middle: (f64, f64),
}

impl Projection {
    /// Column and row of a ground point in the robot's frame.
    #[inline]
    pub(in crate::vision) fn of(&self, place: Point) -> Option<(f64, f64)> {
        let (ahead, up) = (place.x - self.camera.ahead, -self.camera.height);
        // Right, down, and along the optical axis.
        let (x, y, z) = (-place.y, ahead * self.sin - up * self.cos, ahead * self.cos + up * self.sin);
        let scale = if self.camera.fisheye {
            let aside = math::hypot(x, y);
            let angle = math::atan2(aside, z);
            if aside > 1e-9 { self.focal * angle / aside } else { self.focal / z }
        } else if z > 1e-3 {
            self.focal / z
        } else {
            return None;
        };
        Some((self.middle.0 + scale * x, self.middle.1 + scale * y))
    }
}
