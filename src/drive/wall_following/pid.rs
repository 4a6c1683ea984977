use super::memory::Median;
use super::{FollowsWalls, WallObservation, WallSensors, WallSide};
use crate::drive::{Pid, PidParameters};
use crate::geometry::Twist;
use crate::io::Result;
use crate::parameter::{require, require_positive};

/// Parameters of [`PidWallFollower`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PidWallFollowerParameters {
    /// Side of the wall.
    pub side: WallSide,
    /// Distance from the wall to the robot's centre (m).
    pub distance: f64,
    /// Speed along the wall (m/s).
    pub speed: f64,
    /// Turn rate on the spot (rad/s).
    pub turn_rate: f64,
    /// Gains from distance error (m) to turn rate towards the wall (rad/s).
    pub gains: PidParameters,
    /// Mounting poses of the sensors.
    pub sensors: WallSensors,
    /// Control period (s).
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

/// Follows a wall by a [`Pid`] controller on one side range: an exercise of chapter 6, suggested again in
/// section 9.3. At inner corners it turns on the spot until the way ahead is free, as the book does; at the
/// wall's end it drives an arc.
///
/// ```
/// use roverlab::drive::{AlongWall, PidWallFollower, PidWallFollowerParameters};
/// use roverlab::geometry::Pose;
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::world::{RobotSpec, Scene, World};
/// let scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(0.5, 1.7, 0.0));
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let mut drive = AlongWall::new(PidWallFollower::new(PidWallFollowerParameters::default())?);
/// run(&mut simulation.robot(0)?, &mut drive, 30.0, |_, _, _| {})?;
/// let truth = simulation.truth().robot(0)?;
/// assert!(truth.contacts == 0 && truth.path_length > 3.0);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PidWallFollower {
    parameters: PidWallFollowerParameters,
    pid: Pid,
    front: Median,
    turning: bool,
    met: bool,
}

/// Distance beyond which a wall has ended (desired distances).
const GONE: f64 = 1.6;
/// Lag of the wheels behind their commands (s).
const LAG: f64 = 0.2;

impl PidWallFollower {
    /// Creates a follower that has not met a wall. Fails for parameters out of range.
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

    /// The next velocity, `seconds` after the last step. Fails for a NaN range or a pose
    /// that is not finite.
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
        // A positive output turns towards the wall.
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
