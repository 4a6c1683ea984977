use super::way::Way;
use crate::geometry::{Point, Pose, Twist, math};
use crate::io::reading::check_pose;
use crate::io::{Error, Result};
use crate::parameter::require_positive;

/// Parameters of [`Cruise`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CruiseParameters {
    /// Driving speed (m/s).
    pub speed: f64,
    /// Maximum turn rate (rad/s).
    pub turn_rate: f64,
    /// Radius of the robot (m).
    pub radius: f64,
    /// Clearance kept beside the robot (m).
    pub margin: f64,
    /// Free distance required ahead (m); with less the robot goes round the obstacle.
    pub ahead: f64,
    /// Distance to a waypoint at which the robot turns to the next one (m).
    pub arrival: f64,
}

impl Default for CruiseParameters {
    /// A slow LabBot.
    fn default() -> Self {
        Self { speed: 0.15, turn_rate: 0.8, radius: 0.09, margin: 0.08, ahead: 0.6, arrival: 0.3 }
    }
}

/// Drives past waypoints in an endless loop, round obstacles on the way: the leader of a swarm (book, chapter
/// 5).
///
/// ```
/// use roverlab::drive::{Cruise, CruiseParameters};
/// use roverlab::geometry::{Point, Pose};
/// let posts = vec![Point::new(2.0, 0.0), Point::new(2.0, 2.0)];
/// let mut cruise = Cruise::new(posts, CruiseParameters::default())?;
/// let free = cruise.step(Pose::default(), &[])?;
/// assert!(free.linear > 0.0 && free.angular.abs() < 1e-6, "straight at the first waypoint");
/// let blocked = cruise.step(Pose::default(), &[Point::new(0.25, 0.02)])?;
/// assert!(blocked.angular.abs() > 0.1, "around the obstacle");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Cruise {
    parameters: CruiseParameters,
    waypoints: Vec<Point>,
    next: usize,
}

impl Cruise {
    /// Creates a cruise past waypoints in the frame of the observed poses. Fails without a waypoint.
    pub fn new(waypoints: Vec<Point>, parameters: CruiseParameters) -> Result<Self> {
        require_positive("speed", parameters.speed)?;
        require_positive("turn rate", parameters.turn_rate)?;
        require_positive("radius", parameters.radius)?;
        require_positive("margin", parameters.margin)?;
        require_positive("way ahead", parameters.ahead)?;
        require_positive("arrival", parameters.arrival)?;
        if waypoints.is_empty() {
            return Err(Error::invalid_input("number of waypoints", 0, "at least one"));
        }
        Ok(Self { parameters, waypoints, next: 0 })
    }

    /// The next velocity; `points` are the obstacles in the robot's frame (m). Fails if the pose is not
    /// finite.
    pub fn step(&mut self, pose: Pose, points: &[Point]) -> Result<Twist> {
        check_pose(&pose)?;
        let CruiseParameters { speed, turn_rate, radius, margin, ahead, arrival } = self.parameters;
        if pose.distance_to(self.waypoints[self.next]) < arrival {
            self.next = (self.next + 1) % self.waypoints.len();
        }
        let way = Way { radius, margin };
        let wished = pose.bearing_to(self.waypoints[self.next]);
        let (towards, _) = way.towards(points, wished, ahead);
        let free = way.free(points, 0.0);
        let along = speed.min((free - margin).max(0.0) / 1.5) * math::cos(towards).max(0.0);
        Ok(Twist::new(along, (2.0 * towards).clamp(-turn_rate, turn_rate)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::{Displacement, advance};

    #[test]
    fn waypoints_are_passed_one_after_the_other_and_obstacles_round() {
        let waypoints = [(2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (0.0, 0.0)].map(|(x, y)| Point::new(x, y));
        let mut cruise = Cruise::new(waypoints.to_vec(), CruiseParameters::default()).unwrap();
        let (mut pose, can) = (Pose::default(), Point::new(1.0, 0.02));
        let mut passed = [false; 4];
        for _ in 0..1200 {
            let twist = cruise.step(pose, &[pose.to_local(can)]).unwrap();
            pose = advance(pose, Displacement { length: 0.1 * twist.linear, angle: 0.1 * twist.angular });
            assert!(pose.distance_to(can) > 0.09, "{pose:?}");
            for (passed, place) in passed.iter_mut().zip(waypoints) {
                *passed |= pose.distance_to(place) < 0.31;
            }
        }
        assert_eq!(passed, [true; 4]);
    }

    #[test]
    fn nonsense_is_refused() {
        assert!(Cruise::new(Vec::new(), CruiseParameters::default()).is_err());
        let parameters = CruiseParameters { speed: 0.0, ..CruiseParameters::default() };
        assert!(Cruise::new(vec![Point::origin()], parameters).is_err());
        let mut cruise = Cruise::new(vec![Point::origin()], CruiseParameters::default()).unwrap();
        assert!(cruise.step(Pose::new(0.0, f64::NAN, 0.0), &[]).is_err());
    }
}
