use super::Path;
use super::way::AHEAD;
use crate::ParameterError;
use crate::geometry::{Pose, Twist, angle_difference, math, normalize_angle};
use crate::io::Result;
use crate::parameter::require_positive;

/// Steering method of a [`PathFollower`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Steering {
    /// Pure pursuit: along the arc to the path point at the lookahead distance (R. C. Coulter,
    /// "Implementation of the pure pursuit path tracking algorithm", 1992). Exact on lines and circles; cuts
    /// bends shorter than the lookahead.
    PurePursuit {
        /// Lookahead distance (m).
        lookahead: f64,
    },
    /// The path's own curvature plus feedback of heading error and cross-track error, critically damped:
    /// errors decay within about three times `reach` (C. Samson, "Path following and time-varying feedback
    /// stabilization of a wheeled mobile robot", 1992).
    CrossTrack {
        /// Decay length of the errors (m).
        reach: f64,
    },
}

/// Parameters of [`PathFollower`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathFollowerParameters {
    /// Maximum speed (m/s).
    pub speed: f64,
    /// Maximum turn rate (rad/s); limits the speed in bends.
    pub turn_rate: f64,
    /// Deceleration before bends and the end (m/s²).
    pub deceleration: f64,
    /// Rate at which the remaining distance is closed (1/s).
    pub approach_rate: f64,
    /// Delay between command and turn (s), compensated by looking ahead.
    pub lag: f64,
    /// Steering law.
    pub steering: Steering,
}

impl Default for PathFollowerParameters {
    /// 0.25 m/s by heading and cross-track error, for a robot that turns as fast as an S4.
    fn default() -> Self {
        Self {
            speed: 0.25,
            turn_rate: 1.5,
            deceleration: 0.3,
            approach_rate: 2.0,
            lag: 0.2,
            steering: Steering::CrossTrack { reach: 0.1 },
        }
    }
}

impl PathFollowerParameters {
    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        require_positive("speed", self.speed)?;
        require_positive("turn rate", self.turn_rate)?;
        require_positive("deceleration", self.deceleration)?;
        require_positive("approach rate", self.approach_rate)?;
        require_positive("lag", self.lag)?;
        match self.steering {
            Steering::PurePursuit { lookahead } => require_positive("lookahead", lookahead),
            Steering::CrossTrack { reach } => require_positive("reach", reach),
        }
    }
}

/// Drives along a path with feedback: velocity from pose at each step.
///
/// ```
/// use roverlab::drive::{PathFollowerParameters, Path, PathFollower};
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::kinematics::{Displacement, advance};
/// let path = Path::arc(Pose::default(), Point::new(1.0, 0.5))?;
/// let mut follower = PathFollower::new(path, PathFollowerParameters::default())?;
/// // An ideal robot that starts beside the path.
/// let mut pose = Pose::new(0.0, 0.03, 0.0);
/// while follower.rest() > 0.01 {
///     let twist = follower.step(pose);
///     pose = advance(pose, Displacement { length: 0.05 * twist.linear, angle: 0.05 * twist.angular });
/// }
/// assert!(follower.cross_track_error().abs() < 0.002);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PathFollower {
    path: Path,
    parameters: PathFollowerParameters,
    /// Maximum speed at each point of the path (m/s).
    speeds: Vec<f64>,
    reverse: bool,
    travelled: f64,
    cross_track: f64,
    heading_error: f64,
    rest: f64,
}

/// Seconds without getting on after which a robot gives up.
pub(super) const PATIENCE: f64 = 3.0;
/// Maximum curvature that is driven (1/m): a spline can have a cusp, for which no speed is low enough.
const TIGHTEST: f64 = 30.0;

impl PathFollower {
    /// Creates a follower at the start of a path. Fails for parameters out of range.
    pub fn new(path: Path, parameters: PathFollowerParameters) -> Result<Self> {
        parameters.validate()?;
        let speeds = speed_profile(&path, &parameters);
        let rest = path.length();
        Ok(Self {
            path,
            parameters,
            speeds,
            reverse: false,
            travelled: 0.0,
            cross_track: 0.0,
            heading_error: 0.0,
            rest,
        })
    }

    /// The same follower in reverse: the path's directions are those of the robot's back.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self { reverse: true, ..self }
    }

    /// The velocity for a robot at a pose.
    pub fn step(&mut self, pose: Pose) -> Twist {
        let pose = if self.reverse {
            Pose { heading: normalize_angle(pose.heading + std::f64::consts::PI), ..pose }
        } else {
            pose
        };
        self.locate(pose);
        let speed = self.speed();
        let curvature = match self.parameters.steering {
            Steering::PurePursuit { lookahead } => self.pursue(pose, lookahead),
            Steering::CrossTrack { reach } => self.correct(speed, reach),
        };
        let angular = speed * curvature;
        // A turn above the maximum rate scales the speed as well: the curvature stays.
        let scale = if angular.abs() > self.parameters.turn_rate {
            self.parameters.turn_rate / angular.abs()
        } else {
            1.0
        };
        // One that points elsewhere turns first.
        let along = speed * math::cos(self.heading_error).max(0.0);
        Twist::new(scale * if self.reverse { -along } else { along }, scale * angular)
    }

    /// Projects the robot's position onto the path.
    fn locate(&mut self, pose: Pose) {
        let nearest = self.path.nearest(pose.position(), self.travelled, self.travelled + AHEAD);
        self.travelled = self.travelled.max(nearest);
        let place = self.path.at(self.travelled).pose;
        self.cross_track = place.to_local(pose.position()).y;
        self.heading_error = angle_difference(pose.heading, place.heading);
        self.rest = self.path.length() - self.travelled;
        if self.rest <= 0.0 {
            // Beyond the end the remaining distance is negative.
            self.rest = -self.path.end().to_local(pose.position()).x;
        }
    }

    fn speed(&self) -> f64 {
        let points = self.path.points();
        let index = points.partition_point(|point| point.distance < self.travelled).min(points.len() - 1);
        let (next, gap) = (self.speeds[index], points[index].distance - self.travelled);
        let braking = (next * next + 2.0 * self.parameters.deceleration * gap.max(0.0)).sqrt();
        braking.min(self.parameters.speed).min(self.parameters.approach_rate * self.rest)
    }

    fn pursue(&self, pose: Pose, lookahead: f64) -> f64 {
        let target = pose.to_local(self.path.at(self.travelled + lookahead).pose.position());
        let squared = target.coords.norm_squared();
        if squared > 0.0 { 2.0 * target.y / squared } else { 0.0 }
    }

    fn correct(&self, speed: f64, reach: f64) -> f64 {
        let ahead = self.path.at((self.travelled + speed * self.parameters.lag).min(self.path.length()));
        // Far from the path the robot approaches it at about 45 degrees.
        let aside = (self.cross_track / reach).clamp(-1.5, 1.5);
        let bend = ahead.curvature.clamp(-TIGHTEST, TIGHTEST);
        bend - (2.0 * self.heading_error + aside) / reach
    }

    /// Remaining path length (m); negative beyond the end.
    pub fn rest(&self) -> f64 {
        self.rest
    }

    /// Path length travelled (m).
    pub fn travelled(&self) -> f64 {
        self.travelled
    }

    /// Cross-track error (m); positive to the left of the path.
    pub fn cross_track_error(&self) -> f64 {
        self.cross_track
    }

    /// Heading error (rad); positive when the robot points to the left of the path.
    pub fn heading_error(&self) -> f64 {
        self.heading_error
    }

    /// The path.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Maximum speed at each point that allows braking before bends and the end.
fn speed_profile(path: &Path, parameters: &PathFollowerParameters) -> Vec<f64> {
    let points = path.points();
    let mut speeds = vec![0.0; points.len()];
    let (mut next, mut at) = (0.0_f64, path.length());
    for (speed, point) in speeds.iter_mut().zip(points).rev() {
        let bend = parameters.turn_rate / point.curvature.abs().clamp(1e-9, TIGHTEST);
        let braking = (next * next + 2.0 * parameters.deceleration * (at - point.distance)).sqrt();
        *speed = parameters.speed.min(bend).min(braking);
        (next, at) = (*speed, point.distance);
    }
    speeds
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::kinematics::{Displacement, advance};
    use proptest::prelude::*;

    /// A robot that turns with a delay of 0.2 s. Returns its end and the largest cross-track error after the
    /// first 0.5 m.
    fn drive(path: Path, start: Pose, steering: Steering, reverse: bool) -> (Pose, f64) {
        let parameters = PathFollowerParameters { steering, ..PathFollowerParameters::default() };
        let mut follower = PathFollower::new(path, parameters).unwrap();
        if reverse {
            follower = follower.reversed();
        }
        let (mut pose, mut actual, mut worst) = (start, Twist::STOP, 0.0_f64);
        for _ in 0..4000 {
            let told = follower.step(pose);
            if follower.rest() < 0.005 {
                break;
            }
            if follower.travelled() > 0.5 {
                worst = worst.max(follower.cross_track_error().abs());
            }
            let share = 0.02 / 0.2;
            actual = Twist::new(
                actual.linear + share * (told.linear - actual.linear),
                actual.angular + share * (told.angular - actual.angular),
            );
            pose = advance(pose, Displacement { length: 0.02 * actual.linear, angle: 0.02 * actual.angular });
        }
        (pose, worst)
    }

    const BOTH: [Steering; 2] =
        [Steering::CrossTrack { reach: 0.1 }, Steering::PurePursuit { lookahead: 0.12 }];

    proptest! {
        #![proptest_config(crate::testing::cases(32))]
        #[test]
        fn splines_are_followed_to_their_ends(
            y in -1.0..1.0f64, heading in -1.0..1.0f64, aside in -0.05..0.05f64,
        ) {
            let goal = Pose::new(1.8, y, heading);
            for steering in BOTH {
                let path = Path::hermite(Pose::default(), goal, 1.0).unwrap();
                let (end, worst) = drive(path, Pose::new(0.0, aside, 0.0), steering, false);
                let limit = if matches!(steering, Steering::PurePursuit { .. }) { 0.02 } else { 0.005 };
                prop_assert!(worst < limit, "{steering:?}: {worst}");
                prop_assert!(end.distance_to(goal.position()) < 0.02, "{end:?}");
            }
        }
    }

    #[test]
    fn backwards_it_follows_as_well() {
        let goal = Point::new(-1.5, 0.4);
        let path = Path::arc(Pose::new(0.0, 0.0, std::f64::consts::PI), goal).unwrap();
        let (end, worst) = drive(path, Pose::default(), BOTH[0], true);
        assert!(worst < 0.003 && end.distance_to(goal) < 0.01, "{end:?} {worst}");
    }

    #[test]
    fn bends_and_ends_are_met_slowly() {
        let path = Path::of_arcs(Pose::default(), &[(1.0, 0.0), (0.2, 10.0), (1.0, 0.0)]).unwrap();
        let parameters = PathFollowerParameters::default();
        let speeds = speed_profile(&path, &parameters);
        for (point, speed) in path.points().iter().zip(&speeds) {
            assert!(speed * point.curvature.abs().min(TIGHTEST) <= parameters.turn_rate + 1e-9);
            assert!(speed * speed <= 2.0 * parameters.deceleration * (path.length() - point.distance) + 1e-9);
        }
        assert_eq!(speeds[0], parameters.speed);
    }

    #[test]
    fn parameters_that_make_no_sense_are_refused() {
        let path = Path::straight(Point::origin(), Point::new(1.0, 0.0)).unwrap();
        for parameters in [
            PathFollowerParameters { speed: 0.0, ..PathFollowerParameters::default() },
            PathFollowerParameters {
                steering: Steering::PurePursuit { lookahead: -1.0 },
                ..PathFollowerParameters::default()
            },
        ] {
            assert!(PathFollower::new(path.clone(), parameters).is_err());
        }
    }
}
