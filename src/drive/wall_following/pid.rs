use super::memory::Median;
use super::{FollowsWalls, WallObservation, WallSensors, WallSide};
use crate::drive::{Pid, PidParameters};
use crate::geometry::Twist;
use crate::io::Result;
use crate::parameter::{require, require_positive};

/// What [`PidWallFollower`] goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PidWallFollowerParameters {
    /// On which side the wall is to be.
    pub side: WallSide,
    /// Metres between the wall and the robot's middle.
    pub distance: f64,
    /// Metres per second along the wall.
    pub speed: f64,
    /// Radians per second on the spot.
    pub turn_rate: f64,
    /// Gains from metres off the line to radians per second towards the wall.
    pub gains: PidParameters,
    /// Where the sensors sit.
    pub sensors: WallSensors,
    /// Seconds from one step to the next.
    pub period: f64,
}

impl Default for PidWallFollowerParameters {
    /// A wall to the left at 0.2 m, passed at 0.2 m/s.
    fn default() -> Self {
        Self {
            side: WallSide::Left,
            distance: 0.2,
            speed: 0.2,
            turn_rate: 1.5,
            gains: PidParameters {
                proportional: 6.0,
                integral: 0.8,
                derivative: 12.0,
                derivative_filter: 0.12,
                limits: [-1.2, 1.2],
            },
            sensors: WallSensors::default(),
            period: 0.02,
        }
    }
}

/// Follows a wall by a [`Pid`] controller on the range to one side alone: what chapter 6 leaves as an exercise, and section
/// 9.3 hints at. At corners it does as the book does: it turns on the spot until the way ahead is free; where the wall ends
/// it drives an arc.
#[derive(Debug, Clone, PartialEq)]
pub struct PidWallFollower {
    parameters: PidWallFollowerParameters,
    pid: Pid,
    front: Median,
    turning: bool,
    met: bool,
}

/// A wall that is farther away than this many distances has ended.
const GONE: f64 = 1.6;
/// The seconds by which wheels follow their commands.
const LAG: f64 = 0.2;

impl PidWallFollower {
    /// A follower that has not met a wall.
    pub fn new(parameters: PidWallFollowerParameters) -> Result<Self> {
        require_positive("speed", parameters.speed)?;
        require_positive("turn rate", parameters.turn_rate)?;
        require_positive("control period", parameters.period)?;
        parameters.sensors.validate()?;
        let least = parameters.sensors.left.y.abs();
        let good = parameters.distance > least && parameters.distance.is_finite();
        let expected = format!("more than {least} m, where the sensor sits");
        require("distance", parameters.distance, good, expected)?;
        let pid = Pid::new(parameters.gains)?;
        Ok(Self { parameters, pid, front: Median::new(), turning: false, met: false })
    }

    /// The next speed, `seconds` after the last one.
    pub fn step(&mut self, observation: &WallObservation, seconds: f64) -> Result<Twist> {
        observation.check()?;
        let PidWallFollowerParameters { side, distance, speed, turn_rate, sensors, .. } = self.parameters;
        let (range, mount, towards) = match side {
            WallSide::Left => (observation.left, sensors.left, 1.0),
            WallSide::Right => (observation.right, sensors.right, -1.0),
        };
        let beside = range + mount.y.abs();
        let ahead = self.front.add(observation.front) + sensors.front.x;
        self.turning = if self.turning { ahead < GONE * beside } else { ahead < distance + LAG * speed };
        if self.turning {
            self.met = true;
            self.pid.reset();
            return Ok(Twist::new(0.0, -towards * turn_rate));
        }
        if !self.met {
            self.met = beside < distance;
            return Ok(Twist::new(speed, 0.0));
        }
        if beside > GONE * distance {
            self.pid.reset();
            return Ok(Twist::new(speed, towards * speed / distance));
        }
        // The output turns towards the wall if the robot is too far from it.
        let output = self.pid.step(-distance, -beside, seconds.max(1e-3))?;
        Ok(Twist::new(speed, towards * output))
    }
}

impl FollowsWalls for PidWallFollower {
    type Observation = WallObservation;

    fn steer(&mut self, seen: &WallObservation, seconds: f64) -> Result<Twist> {
        self.step(seen, seconds)
    }

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn is_beside_wall(&self) -> bool {
        self.met && !self.turning
    }

    fn wall_side(&self) -> Option<WallSide> {
        Some(self.parameters.side)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;

    fn seen(front: f64, left: f64, right: f64) -> WallObservation {
        WallObservation { pose: Pose::default(), front, left, right }
    }

    #[test]
    fn it_steers_towards_its_line_on_either_side() {
        for side in [WallSide::Left, WallSide::Right] {
            let mut follower = PidWallFollower::new(PidWallFollowerParameters {
                side,
                ..PidWallFollowerParameters::default()
            })
            .unwrap();
            let mut beside = |range: f64| {
                let (left, right) = if side == WallSide::Left { (range, 9.0) } else { (9.0, range) };
                (0..50).map(|_| follower.step(&seen(9.0, left, right), 0.02).unwrap()).last().unwrap().angular
            };
            let away = if side == WallSide::Left { -1.0 } else { 1.0 };
            assert!(beside(0.10) * away > 0.0);
            assert!(beside(0.20) * away < 0.0);
        }
    }

    #[test]
    fn it_turns_before_a_wall_ahead() {
        let mut follower = PidWallFollower::new(PidWallFollowerParameters::default()).unwrap();
        for _ in 0..5 {
            follower.step(&seen(0.15, 0.155, 9.0), 0.02).unwrap();
        }
        let twist = follower.step(&seen(0.15, 0.155, 9.0), 0.02).unwrap();
        assert!(twist.linear == 0.0 && twist.angular < 0.0);
        assert!(follower.step(&seen(f64::NAN, 0.155, 9.0), 0.02).is_err());
        let near = PidWallFollowerParameters { distance: 0.01, ..PidWallFollowerParameters::default() };
        assert!(PidWallFollower::new(near).is_err());
    }
}
