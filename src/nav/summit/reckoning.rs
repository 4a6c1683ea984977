use super::align::Shift;
use crate::geometry::{
    Point, Point3, Pose, Pose3, Vector, angle_difference, direction, math, normalize_angle,
};
use crate::io::Attitude;

/// Dead reckoning on hills: wheels say how far along the ground, the inertial unit how steeply and which way.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Reckoning {
    /// The place above the map, from the start.
    pub(super) pose: Pose,
    /// Metres above the start.
    pub(super) elevation: f64,
    /// The constant error of roll and pitch.
    pub(super) bias: [f64; 2],
    /// Where odometry took the robot to be.
    before: Option<Pose>,
    /// The unit's yaw where the heading is 0.
    north: f64,
}

/// The share of a difference between the headings of wheels and unit that a step takes over: belts turn a
/// robot by a third more or less than they should, while the unit's error is half a degree.
const TRUST: f64 = 0.25;

impl Reckoning {
    /// Takes in how the wheels turned. In a turn of one radian belts slide so many metres downhill for a
    /// slope of 1.
    pub(super) fn update(&mut self, odometry: Pose, attitude: Attitude, slide: f64) {
        let Some(before) = self.before.replace(odometry) else {
            self.north = attitude.yaw;
            return;
        };
        let way = odometry.position() - before.position();
        let length = way.dot(&direction(before.heading));
        let turned = angle_difference(odometry.heading, before.heading);
        let heading = self.pose.heading + turned;
        let turned = turned + TRUST * angle_difference(attitude.yaw - self.north, heading);
        let (rise, run) = math::sin_cos(-(attitude.pitch - self.bias[1]));
        let place = self.pose.position() + direction(self.pose.heading + 0.5 * turned) * (length * run);
        let up = self.in_space(attitude).up();
        let downhill = Vector::new(up.x, up.y) / up.z.max(0.1);
        let place = place + downhill * (slide * turned.abs());
        self.pose = Pose::new(place.x, place.y, normalize_angle(self.pose.heading + turned));
        self.elevation += length * rise - downhill.norm_squared() * slide * turned.abs();
    }

    /// Moves the robot to where it has been found to be.
    pub(super) fn correct(&mut self, shift: &Shift) {
        let Pose { x, y, heading } = self.pose;
        let place = Point::new(x, y) + shift.place;
        self.pose = Pose::new(place.x, place.y, normalize_angle(heading + shift.turn));
        self.north -= shift.turn;
        self.elevation += shift.up;
    }

    /// Roll and pitch without their constant errors.
    pub(super) fn corrected(&self, attitude: Attitude) -> Attitude {
        let [roll, pitch] = self.bias;
        Attitude { roll: attitude.roll - roll, pitch: attitude.pitch - pitch, yaw: self.pose.heading }
    }

    /// The robot in the map's frame, turned as an attitude says.
    pub(super) fn in_space(&self, attitude: Attitude) -> Pose3 {
        let turned = self.corrected(attitude);
        let place = Point3::new(self.pose.x, self.pose.y, self.elevation);
        Pose3::from_angles(place, turned.roll, turned.pitch, turned.yaw)
    }
}
