use super::way::{AHEAD, BRAKING, TURN_GAIN, Way};
use crate::ParameterError;
use crate::geometry::{Point, Pose, Twist, math};
use crate::io::{Error, Result};
use crate::parameter::{require, require_positive, require_up_to};

/// A position in a formation kept by radio: the leader sends its pose, and each follower keeps its offset to
/// it (book, section 5.3, the first of its three methods).
///
/// ```
/// use roverlab::drive::Formation;
/// use roverlab::geometry::{Point, Pose};
/// // A place half a metre behind the leader.
/// let formation = Formation::at(Point::new(-0.5, 0.0));
/// let message = Formation::message(Pose::new(2.0, 0.0, 0.0), 0.2);
/// let (leader, speed) = Formation::read(&message)?;
/// let twist = formation.step(Pose::default(), leader, speed, &[]);
/// assert!(twist.linear > 0.2, "it is far behind and drives faster than the leader");
/// assert!(Formation::read(b"hello").is_err());
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Formation {
    /// Follower's position in the leader's frame (m).
    pub offset: Point,
    /// Maximum speed (m/s).
    pub speed: f64,
    /// Maximum turn rate (rad/s).
    pub turn_rate: f64,
    /// Radius of the robot (m).
    pub radius: f64,
    /// Clearance kept beside the robot (m).
    pub margin: f64,
}

impl Formation {
    /// A formation position for an S4, given in the leader's frame.
    pub fn at(offset: Point) -> Self {
        Self { offset, speed: 0.35, turn_rate: 2.0, radius: 0.06, margin: 0.06 }
    }

    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        require_positive("speed", self.speed)?;
        require_positive("turn rate", self.turn_rate)?;
        require_up_to("radius", self.radius, 1000.0)?;
        require_positive("margin", self.margin)?;
        let away = self.offset.coords.norm();
        let good = away >= 2.0 * self.radius && away.is_finite();
        require("length of the offset", away, good, "a place beside the leader")
    }

    /// The leader's message: its pose in the shared frame, and its speed (m/s).
    pub fn message(pose: Pose, speed: f64) -> Vec<u8> {
        [pose.x, pose.y, pose.heading, speed].iter().flat_map(|number| number.to_le_bytes()).collect()
    }

    /// Decodes a leader's message. Fails for any other message.
    pub fn read(message: &[u8]) -> Result<(Pose, f64)> {
        let numbers: Vec<f64> = message
            .chunks(8)
            .filter_map(|bytes| bytes.try_into().ok().map(f64::from_le_bytes))
            .filter(|number| number.is_finite())
            .collect();
        match numbers.as_slice() {
            &[x, y, heading, speed] if message.len() == 32 => Ok((Pose::new(x, y, heading), speed)),
            _ => Err(Error::invalid_input(
                "message",
                format!("{} bytes", message.len()),
                "a leader's pose and speed",
            )),
        }
    }

    /// The next velocity. Both poses are in the shared frame; `points` are obstacles in the robot's frame.
    pub fn step(&self, pose: Pose, leader: Pose, leader_speed: f64, points: &[Point]) -> Twist {
        let place = leader.to_world(self.offset);
        let behind = pose.to_local(place);
        // What is aimed at lies ahead of its place: the robot is not to turn about there.
        let aim = pose.to_local(place + leader.forward() * AHEAD);
        let bearing = math::atan2(aim.y, aim.x);
        let way = Way { radius: self.radius, margin: self.margin };
        let (towards, _) = way.towards(points, bearing, AHEAD);
        let most = ((way.free(points, 0.0) - self.margin) / BRAKING).max(0.0).min(self.speed.max(0.0));
        // A follower in position waits for a standing leader without turning.
        let waits = leader_speed.abs() < 0.01 && behind.coords.norm() < 0.05;
        if waits {
            return Twist::STOP;
        }
        let facing = math::cos(towards).max(0.0);
        let linear = ((leader_speed + behind.x / BRAKING) * facing).max(0.0).min(most);
        let rate = self.turn_rate.max(0.0);
        let twist = Twist::new(linear, (TURN_GAIN * towards).clamp(-rate, rate));
        // Without its own pose or the leader's there is no place to keep.
        if twist.is_finite() { twist } else { Twist::STOP }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::{Displacement, advance};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(48))]
        #[test]
        fn the_place_is_kept(x in -0.8..-0.2f64, y in -0.5..0.5f64, curvature in -0.4..0.4f64) {
            let formation = Formation::at(Point::new(x, y));
            formation.validate().unwrap();
            let mut leader = Pose::new(1.0, 1.0, 0.3);
            let start = leader.to_world(formation.offset);
            let mut robot = Pose::new(start.x + 0.1, start.y - 0.1, 0.0);
            for _ in 0..600 {
                let twist = formation.step(robot, leader, 0.15, &[]);
                robot = advance(robot, Displacement { length: 0.1 * twist.linear, angle: 0.1 * twist.angular });
                leader = advance(leader, Displacement { length: 0.015, angle: 0.015 * curvature });
            }
            let off = robot.distance_to(leader.to_world(formation.offset));
            prop_assert!(off < 0.12, "{}", off);
        }

        #[test]
        fn messages_say_what_was_meant(x in -9.0..9.0f64, y in -9.0..9.0f64, heading in -3.0..3.0f64, speed in 0.0..1.0f64) {
            let pose = Pose::new(x, y, heading);
            prop_assert_eq!(Formation::read(&Formation::message(pose, speed)).unwrap(), (pose, speed));
        }

        #[test]
        fn other_messages_are_refused(message in prop::collection::vec(any::<u8>(), 0..31)) {
            prop_assert!(Formation::read(&message).is_err());
        }
    }

    #[test]
    fn nonsense_is_refused() {
        assert!(Formation::at(Point::origin()).validate().is_err());
        assert!(Formation { speed: -1.0, ..Formation::at(Point::new(-1.0, 0.0)) }.validate().is_err());
        assert!(Formation::read(&Formation::message(Pose::new(f64::NAN, 0.0, 0.0), 1.0)).is_err());
    }
}
