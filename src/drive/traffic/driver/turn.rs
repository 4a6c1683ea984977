//! A turn by odometry, from one lane to another.

use crate::geometry::{Pose, angle_difference, math};

/// A turn that has begun.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turn {
    /// The middle of the lane that it leads to, in the frame of odometry.
    pub(super) lane: Pose,
    /// 1 to the left, -1 to the right.
    pub(super) side: f64,
    /// Distance from the other road's centre line to its edge lines (m): that of this road.
    pub(super) edge: f64,
    /// Number of images in which the new lane was where odometry expects it.
    pub(super) agreed: u32,
}

/// Curvatures of turns to the near side of the crossing and to the far side (1/m).
const CURVATURES: [f64; 2] = [1.9, 1.5];
/// Largest curvature (1/m): a car at a scale of 1:10 turns with 2.0.
const SHARPEST: f64 = 1.95;
/// Angle to the new lane below which the car settles on it (rad), and the distance in which it does (m).
const SETTLES: (f64, f64) = (0.35, 0.30);

impl Turn {
    /// The car on the new lane at a pose of odometry.
    pub(super) fn on_lane(&self, odometry: &Pose) -> Pose {
        let place = self.lane.to_local(odometry.position());
        Pose::new(place.x, place.y, angle_difference(odometry.heading, self.lane.heading))
    }

    /// Whether the car may settle on the lane.
    pub(super) fn is_nearly_over(car: &Pose) -> bool {
        car.heading.abs() < SETTLES.0
    }

    /// Curvature that leads to the lane: straight on, then an arc that ends on it.
    pub(super) fn curvature(&self, car: &Pose, far: bool) -> f64 {
        let angle = -self.side * car.heading;
        if angle < SETTLES.0 {
            let (back, sine) = (car.y / (SETTLES.1 * SETTLES.1), 2.0 * math::sin(car.heading) / SETTLES.1);
            return (-back - sine).clamp(-SHARPEST, SHARPEST);
        }
        let left = (self.side * car.y).max(1e-3);
        let bend = ((1.0 - math::cos(angle)) / left).min(SHARPEST);
        if bend < CURVATURES[usize::from(far)] && angle > 1.0 { 0.0 } else { self.side * bend }
    }
}
