use nalgebra::{Quaternion, UnitQuaternion};

use super::{Point3, Pose, Vector3, math};

/// Position and attitude in space.
///
/// As a transformation it maps points of its own frame (x forward, y left, z up) to its parent frame. The
/// attitude is a unit quaternion; roll, pitch and yaw are fixed-axis rotations about x, y and z in this order
/// (ROS REP 103), so a positive pitch lowers the nose and a positive roll lifts the left side.
///
/// ```
/// use roverlab::geometry::{Point3, Pose, Pose3};
/// let on_a_ramp = Pose3::from_angles(Point3::new(1.0, 2.0, 0.1), 0.0, -0.2, 0.5);
/// assert!(on_a_ramp.to_world(Point3::new(0.3, 0.0, 0.0)).z > 0.1); // its nose is up
/// assert!((on_a_ramp.pose().heading - 0.5).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose3 {
    /// Coordinates, z upwards (m).
    pub position: Point3,
    /// Rotation from its own frame to the parent frame.
    pub attitude: UnitQuaternion<f64>,
}

/// Sine of the pitch above which roll and yaw are indistinguishable (gimbal lock).
const UPRIGHT: f64 = 1.0 - 1e-12;

impl Pose3 {
    /// A pose from position and rotation.
    pub fn new(position: Point3, attitude: UnitQuaternion<f64>) -> Self {
        Self { position, attitude }
    }

    /// A pose from position and angles (rad).
    pub fn from_angles(position: Point3, roll: f64, pitch: f64, yaw: f64) -> Self {
        let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(|angle| math::sin_cos(0.5 * angle));
        let attitude = Quaternion::new(
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        );
        Self { position, attitude: UnitQuaternion::new_unchecked(attitude) }
    }

    /// A level pose at an elevation (m) above a planar pose.
    pub fn level(pose: Pose, elevation: f64) -> Self {
        Self::from_angles(Point3::new(pose.x, pose.y, elevation), 0.0, 0.0, pose.heading)
    }

    /// Projection onto the plane.
    pub fn pose(&self) -> Pose {
        let [_, _, yaw] = self.roll_pitch_yaw();
        Pose::new(self.position.x, self.position.y, yaw)
    }

    /// Roll and yaw in `-pi..=pi`, pitch in `-pi/2..=pi/2` (rad).
    ///
    /// If the nose points straight up or down, the roll is 0.
    pub fn roll_pitch_yaw(&self) -> [f64; 3] {
        let [forward, left, up] = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| self.rotate(axis));
        if forward.z.abs() >= UPRIGHT {
            let pitch = -std::f64::consts::FRAC_PI_2.copysign(forward.z);
            return [0.0, pitch, math::atan2(-left.x, left.y)];
        }
        [math::atan2(left.z, up.z), math::asin(-forward.z), math::atan2(forward.y, forward.x)]
    }

    /// Angle between its z axis and the vertical, in `0..=pi` (rad).
    pub fn tilt(&self) -> f64 {
        let up = self.up();
        math::atan2(math::hypot(up.x, up.y), up.z)
    }

    /// Its z axis in the parent frame.
    pub fn up(&self) -> Vector3 {
        self.rotate(Vector3::z())
    }

    /// Rotates a vector from its own frame to the parent frame.
    pub fn rotate(&self, own: Vector3) -> Vector3 {
        self.attitude * own
    }

    /// Transforms a point from its own frame to the parent frame.
    pub fn to_world(&self, local: Point3) -> Point3 {
        self.position + self.rotate(local.coords)
    }

    /// Transforms a point from the parent frame to its own frame.
    pub fn to_local(&self, world: Point3) -> Point3 {
        Point3::from(self.attitude.inverse() * (world - self.position))
    }

    /// Transforms the pose `other` from this pose's own frame to the parent frame.
    #[must_use]
    pub fn compose(&self, other: &Pose3) -> Pose3 {
        Self { position: self.to_world(other.position), attitude: self.attitude * other.attitude }
    }

    /// Inverse transformation: `p.compose(&p.inverse())` is the origin.
    #[must_use]
    pub fn inverse(&self) -> Pose3 {
        Self { position: self.to_local(Point3::origin()), attitude: self.attitude.inverse() }
    }

    /// Whether all components are finite.
    pub fn is_finite(&self) -> bool {
        self.position.coords.iter().chain(self.attitude.coords.iter()).all(|part| part.is_finite())
    }
}

impl Default for Pose3 {
    /// The origin.
    fn default() -> Self {
        Self { position: Point3::origin(), attitude: UnitQuaternion::identity() }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use proptest::prelude::*;

    use super::*;
    use crate::geometry::{Point, angle_difference};

    fn place() -> impl Strategy<Value = Point3> {
        (-9.0..9.0, -9.0..9.0, -9.0..9.0).prop_map(|(x, y, z)| Point3::new(x, y, z))
    }

    fn pose() -> impl Strategy<Value = Pose3> {
        let angles = (-PI..PI, -1.57..1.57, -PI..PI);
        (place(), angles).prop_map(|(at, (roll, pitch, yaw))| Pose3::from_angles(at, roll, pitch, yaw))
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn composing_with_the_inverse_is_the_identity(p in pose()) {
            let id = p.compose(&p.inverse());
            prop_assert!(id.position.coords.norm() < 1e-12 && id.tilt() < 1e-12 && id.pose().heading.abs() < 1e-12);
        }

        #[test]
        fn composing_is_mapping_twice(a in pose(), b in pose(), point in place()) {
            prop_assert!((a.compose(&b).to_world(point) - a.to_world(b.to_world(point))).norm() < 1e-12);
            prop_assert!((a.to_local(a.to_world(point)) - point).norm() < 1e-12);
        }

        #[test]
        fn rotating_keeps_lengths_and_angles(p in pose(), a in place(), b in place()) {
            let (a, b) = (a.coords, b.coords);
            prop_assert!((p.rotate(a).dot(&p.rotate(b)) - a.dot(&b)).abs() < 1e-11);
            prop_assert!((p.rotate(a).cross(&p.rotate(b)) - p.rotate(a.cross(&b))).norm() < 1e-11);
        }

        #[test]
        fn angles_are_turns_about_fixed_axes_one_after_the_other(
            roll in -PI..PI, pitch in -1.57..1.57, yaw in -PI..PI, point in place(),
        ) {
            let turn = |roll, pitch, yaw| Pose3::from_angles(Point3::origin(), roll, pitch, yaw);
            let p = turn(roll, pitch, yaw);
            let in_turn = [turn(roll, 0.0, 0.0), turn(0.0, pitch, 0.0), turn(0.0, 0.0, yaw)];
            let turned = in_turn.iter().fold(point, |point, turn| turn.to_world(point));
            prop_assert!((p.to_world(point) - turned).norm() < 1e-12);
            let [r, q, y] = p.roll_pitch_yaw();
            prop_assert!((q - pitch).abs() < 1e-6);
            let (dr, dy) = (angle_difference(r, roll), angle_difference(y, yaw));
            // Near gimbal lock, only the sum or difference of roll and yaw is well determined.
            prop_assert!(p.to_world(point).coords.metric_distance(&turn(r, q, y).to_world(point).coords) < 1e-10);
            prop_assert!(pitch.abs() > 1.5 || (dr.abs() < 1e-10 && dy.abs() < 1e-10));
        }

        #[test]
        fn level_poses_are_those_of_the_plane(
            x in -9.0..9.0, y in -9.0..9.0, heading in -PI..PI, z in -1.0..1.0, point in place(),
        ) {
            let flat = Pose::new(x, y, heading);
            let level = Pose3::level(flat, z);
            let back = level.pose();
            prop_assert!(back.position() == flat.position() && (back.heading - heading).abs() < 1e-12);
            let mapped = level.to_world(point);
            let expected = flat.to_world(Point::new(point.x, point.y));
            prop_assert!((mapped.xy() - expected).norm() < 1e-12 && (mapped.z - z - point.z).abs() < 1e-12);
            prop_assert!(level.tilt() == 0.0);
        }
    }

    #[test]
    fn signs_are_those_of_right_hands() {
        let ahead = Pose3::from_angles(Point3::origin(), 0.0, 0.3, 0.0).rotate(Vector3::x());
        assert!((ahead.z + math::sin(0.3)).abs() < 1e-15, "a positive pitch lowers the nose");
        let left = Pose3::from_angles(Point3::origin(), 0.3, 0.0, 0.0).rotate(Vector3::y());
        assert!((left.z - math::sin(0.3)).abs() < 1e-15, "a positive roll lifts the left side");
    }

    #[test]
    fn a_nose_straight_up_or_down_has_no_roll() {
        for pitch in [FRAC_PI_2, -FRAC_PI_2] {
            let p = Pose3::from_angles(Point3::origin(), 0.0, pitch, 0.7);
            let [roll, q, yaw] = p.roll_pitch_yaw();
            assert!(roll == 0.0 && q == pitch && (yaw - 0.7).abs() < 1e-12, "{roll} {q} {yaw}");
        }
    }
}
