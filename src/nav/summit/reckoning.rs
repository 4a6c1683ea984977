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
    /// Distance by which the place may be wrong, as belts slip on slopes (m).
    pub(super) doubt: f64,
    /// Turn of the last seconds by the wheels that the robot did not make (rad).
    unturned: f64,
    locked: bool,
    /// Turns of a step by the wheels and by the robot, smoothed (rad).
    turning: [f64; 2],
}

/// The share of a difference between the headings of wheels and unit that a step takes over: belts turn a
/// robot by a third more or less than they should, while the unit's error is half a degree.
const TRUST: f64 = 0.25;
/// How far belts slide ahead on ground that falls ahead, as a multiple of how far they slide aside on such
/// that falls to the side. Measured on planes of 5 to 25 degrees, as the next one.
const AHEAD: f64 = 1.8;
/// How far belts slide backwards in a turn to the left on ground that falls to the left, as such a multiple.
const ACROSS: f64 = 0.46;
/// The share of a step's turn that its smoothed value takes over: what the unit's noise adds to single steps
/// would add up, as robots slide downhill in turns to either side.
const SMOOTH: f64 = 0.15;
/// Turn by the wheels that the robot does not make, up to which that is noise (rad).
const NOISE: f64 = 0.1;
/// Distance by which the place may be wrong, per metre that belts run on a slope of 1. Where a robot cannot
/// turn, it errs by 0.4 m in 4 m on 15 to 20 degrees.
const SLIP: f64 = 0.5;
/// Rise per metre from which the lower belt holds.
const HELD: f64 = 0.1;
/// The share of a turn not made that a step remembers: half of it for 1.4 s.
const MEMORY: f64 = 0.975;
/// Turn not made from which a robot is locked, and below which it is free again (rad). Steady turns by a
/// third too little do not add up to so much.
const LOCKED: [f64; 2] = [0.6, 0.3];

impl Reckoning {
    /// Takes in how the wheels turned. In a turn of one radian belts slide `slide` metres downhill for a
    /// slope of 1; they are two of `half_track` apart.
    ///
    /// In a hollow a robot stands on the ends of its belts, which may hold too well sideways for it to turn.
    /// Then one belt slips and the robot moves as the other one does: on a slope, the one that runs downhill.
    pub(super) fn update(&mut self, odometry: Pose, attitude: Attitude, slide: f64, half_track: f64) {
        let Some(before) = self.before.replace(odometry) else {
            self.north = attitude.yaw;
            return;
        };
        let way = odometry.position() - before.position();
        let length = way.dot(&direction(before.heading));
        let told = angle_difference(odometry.heading, before.heading);
        let heading = self.pose.heading + told;
        let turned = told + TRUST * angle_difference(attitude.yaw - self.north, heading);
        self.unturned = MEMORY * (self.unturned + told - turned);
        self.locked = self.unturned.abs() > LOCKED[usize::from(self.locked)];
        for (mean, new) in self.turning.iter_mut().zip([told, turned]) {
            *mean += SMOOTH * (new - *mean);
        }
        let (rise, run) = math::sin_cos(-(attitude.pitch - self.bias[1]));
        let up = self.in_space(attitude).up();
        let downhill = Vector::new(up.x, up.y) / up.z.max(0.1);
        let ahead = direction(self.pose.heading + 0.5 * turned);
        let left = Vector::new(-ahead.y, ahead.x);
        let slid = self.slid(downhill.dot(&ahead), downhill.dot(&left), told, slide, half_track);
        let slid = ahead * slid.x + left * slid.y;
        self.doubt += SLIP * downhill.norm() * (length.abs() + half_track * told.abs());
        self.elevation += length * rise - downhill.dot(&slid);
        let place = self.pose.position() + ahead * (length * run) + slid;
        self.pose = Pose::new(place.x, place.y, normalize_angle(self.pose.heading + turned));
    }

    /// How far belts that turn by `told` slide ahead and to the left, on ground that falls by so much ahead
    /// and to the left per metre.
    fn slid(&self, falls_ahead: f64, falls_left: f64, told: f64, slide: f64, half_track: f64) -> Vector {
        let [wheels, robot] = self.turning.map(f64::abs);
        let free = (AHEAD * slide * falls_ahead.abs()).min(half_track) * wheels;
        // Of a steady turn that is not made, `unturned` remembers that of so many steps.
        let not_made = (1.0 - MEMORY) * (self.unturned.abs() - NOISE).max(0.0);
        let held = (falls_ahead.abs() / HELD).min(1.0) * half_track * not_made;
        let ahead = free.max(held).copysign(falls_ahead) - ACROSS * slide * falls_left * told;
        Vector::new(ahead, slide * falls_left * robot)
    }

    /// Whether the wheels do not turn the robot.
    pub(super) fn is_locked(&self) -> bool {
        self.locked
    }

    /// Moves the robot to where it has been found to be.
    pub(super) fn correct(&mut self, shift: &Shift) {
        let Pose { x, y, heading } = self.pose;
        let place = Point::new(x, y) + shift.place;
        self.pose = Pose::new(place.x, place.y, normalize_angle(heading + shift.turn));
        self.north -= shift.turn;
        self.elevation += shift.up;
        self.doubt = self.doubt.min(shift.doubt);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::Tracked;
    use crate::nav::SummitParameters;
    use crate::world::RobotSpec;

    /// Belts are to turn a robot on the spot, and it stands in a hollow: it slides with the lower one.
    #[test]
    fn a_robot_that_does_not_turn_moves_with_its_lower_belt() {
        let parameters = SummitParameters::of(&RobotSpec::blizzard()).unwrap();
        let half = 0.5 * Tracked::new(0.185, 0.260, 0.070).unwrap().equivalent().track;
        assert!((parameters.half_track - half).abs() < 1e-9);
        let (rate, period) = (0.8, parameters.period);
        for pitch in [0.15, -0.15] {
            let mut reckoning = Reckoning::default();
            for step in 0..161 {
                let odometry = Pose::new(0.0, 0.0, rate * period * f64::from(step));
                let attitude = Attitude { roll: 0.0, pitch, yaw: 0.0 };
                reckoning.update(odometry, attitude, parameters.slide, half);
            }
            assert!(reckoning.is_locked());
            // Of its 8 s, it takes two to notice, and then errs by its noise.
            let way = half * rate * 8.0 * pitch.signum();
            let found = reckoning.pose.x;
            assert!(found / way > 0.6 && found / way < 1.1, "{found} {way}");
            assert!(reckoning.elevation < 0.0 && reckoning.pose.heading.abs() < 0.2);
        }
    }

    /// Turns as odometry counts them leave it free.
    #[test]
    fn a_robot_that_turns_is_free() {
        let mut reckoning = Reckoning::default();
        for step in 0..200 {
            let heading = normalize_angle(0.04 * f64::from(step));
            let attitude = Attitude { roll: 0.0, pitch: 0.15, yaw: heading };
            reckoning.update(Pose::new(0.0, 0.0, heading), attitude, 0.0, 0.187);
            assert!(!reckoning.is_locked());
        }
        assert!(reckoning.pose.position().coords.norm() < 0.01, "{:?}", reckoning.pose);
    }
}
