use crate::geometry::{Vector, direction, math};

/// A point in space: x, y and height (m).
pub(super) type Place = [f64; 3];

/// Distance of the near plane (m).
pub(super) const NEAR: f64 = 0.002;

/// A pinhole camera: how places in the world fall onto the columns and rows of its picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    pub(super) eye: Place,
    /// Horizontal unit vectors ahead and to the right.
    pub(super) ahead: Vector,
    pub(super) right: Vector,
    /// Sine and cosine of the elevation angle.
    pub(super) sin: f64,
    pub(super) cos: f64,
    /// Sine and cosine of the angle by which its left side is lifted about the line of sight.
    roll: (f64, f64),
    /// Pixels that one metre covers at a distance of one metre.
    pub(super) focal: f64,
    pub(super) width: usize,
    pub(super) height: usize,
}

/// A point in the camera's frame: metres to the right, down, and ahead along the line of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seen {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
}

impl Seen {
    pub(super) fn dot(self, other: Seen) -> f64 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    pub(super) fn minus(self, other: Seen) -> Seen {
        Seen { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }

    pub(super) fn cross(self, other: Seen) -> Seen {
        Seen {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    pub(super) fn norm(self) -> f64 {
        self.dot(self).sqrt()
    }
}

impl View {
    /// A camera at a point with a heading and an elevation angle (rad).
    pub(super) fn new(
        eye: Place,
        heading: f64,
        tilt: f64,
        field_of_view: f64,
        (width, height): (u32, u32),
    ) -> Self {
        let ahead = direction(heading);
        let (sin, cos) = math::sin_cos(tilt);
        let focal = 0.5 * f64::from(width) / math::tan(0.5 * field_of_view);
        Self {
            eye,
            ahead,
            right: Vector::new(ahead.y, -ahead.x),
            sin,
            cos,
            roll: (0.0, 1.0),
            focal,
            width: width as usize,
            height: height as usize,
        }
    }

    /// The camera with its left side lifted by some radians.
    pub(super) fn rolled(self, roll: f64) -> Self {
        Self { roll: math::sin_cos(roll), ..self }
    }

    /// A direction of the world in the camera's frame.
    pub(super) fn turned(&self, [x, y, up]: Place) -> Seen {
        let level = Vector::new(x, y);
        let (ahead, right) = (level.dot(&self.ahead), level.dot(&self.right));
        let down = ahead * self.sin - up * self.cos;
        let (sin, cos) = self.roll;
        let (x, y) =
            if sin == 0.0 { (right, down) } else { (right * cos + down * sin, down * cos - right * sin) };
        Seen { x, y, z: ahead * self.cos + up * self.sin }
    }

    /// A point of the world in the camera's frame.
    pub(super) fn see(&self, [x, y, z]: Place) -> Seen {
        self.turned([x - self.eye[0], y - self.eye[1], z - self.eye[2]])
    }

    /// Column and row of a point ahead of the camera; pixel (0, 0) covers 0 to 1.
    pub(super) fn project(&self, seen: Seen) -> (f64, f64) {
        let scale = self.focal / seen.z;
        (0.5 * self.width as f64 + scale * seen.x, 0.5 * self.height as f64 + scale * seen.y)
    }

    /// Offset to the right per metre ahead, at the centre of a column.
    pub(super) fn ray_x(&self, column: f64) -> f64 {
        (column + 0.5 - 0.5 * self.width as f64) / self.focal
    }

    /// Offset down per metre ahead, at the centre of a row.
    pub(super) fn ray_y(&self, row: f64) -> f64 {
        (row + 0.5 - 0.5 * self.height as f64) / self.focal
    }

    /// Whether no part of a ball can appear in the picture.
    pub(super) fn misses(&self, centre: Seen, radius: f64) -> bool {
        if centre.z + radius < NEAR {
            return true;
        }
        let beyond = |aside: f64, pixels: usize| {
            let edge = 0.5 * pixels as f64;
            let slant = (edge * edge + self.focal * self.focal).sqrt();
            aside.abs() * self.focal - centre.z * edge > radius * slant
        };
        beyond(centre.x, self.width) || beyond(centre.y, self.height)
    }
}
