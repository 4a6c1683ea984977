use std::ops::ControlFlow;

use super::super::way::{ALIGNED, TURN_GAIN};
use crate::geometry::{Point, Pose, Twist, angle_difference, math};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::reading::{check_pose, point_in_words};
use crate::io::{Error, Odometry, Result};
use crate::parameter::require_positive;

/// Parameters of [`Tour`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TourParameters {
    /// Maximum speed (m/s).
    pub speed: f64,
    /// Maximum turn rate (rad/s).
    pub turn_rate: f64,
    /// Distance to a corner at which the next leg begins (m).
    pub arrival: f64,
    /// Decay length of the cross-track error (m).
    pub reach: f64,
    /// Delay of the robot's response to commands (s).
    pub lag: f64,
    /// Control period (s).
    pub period: f64,
}

impl Default for TourParameters {
    /// An S4.
    fn default() -> Self {
        Self { speed: 0.25, turn_rate: 2.0, arrival: 0.006, reach: 0.08, lag: 0.2, period: 0.04 }
    }
}

/// Drives straight legs with sharp corners: turns on the spot to the next corner, then drives straight, with
/// feedback.
///
/// ```
/// use roverlab::drive::{Tour, TourParameters};
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::kinematics::{Displacement, advance};
/// let corners = [Point::new(0.0, 0.0), Point::new(1.0, 0.0), Point::new(1.0, 1.0)];
/// let (mut tour, mut pose) = (Tour::new(&corners, TourParameters::default())?, Pose::default());
/// while let Some(twist) = tour.step(pose) {
///     pose = advance(pose, Displacement { length: 0.05 * twist.linear, angle: 0.05 * twist.angular });
/// }
/// assert!(pose.distance_to(corners[2]) < 0.05 && tour.progress() > 0.99);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Tour {
    parameters: TourParameters,
    corners: Vec<Point>,
    /// Index of the corner driven to.
    next: usize,
    turning: bool,
}

/// Heading error at which the robot turns on the spot again (rad).
const ASTRAY: f64 = 0.5;

impl Tour {
    /// Creates a tour through points, the first of which is the start. Fails for points that are not finite.
    pub fn new(points: &[Point], parameters: TourParameters) -> Result<Self> {
        require_positive("speed", parameters.speed)?;
        require_positive("turn rate", parameters.turn_rate)?;
        require_positive("arrival", parameters.arrival)?;
        require_positive("reach", parameters.reach)?;
        require_positive("lag", parameters.lag)?;
        require_positive("control period", parameters.period)?;
        let mut corners: Vec<Point> = Vec::with_capacity(points.len());
        for &point in points {
            if !(point.x.is_finite() && point.y.is_finite()) {
                return Err(Error::invalid_input("corner", point_in_words(point), "finite numbers"));
            }
            corners.push(point);
        }
        Ok(Self { parameters, corners, next: 1, turning: true })
    }

    /// Fraction of the corners passed, 0 to 1.
    pub fn progress(&self) -> f64 {
        let legs = self.corners.len().saturating_sub(1).max(1);
        ((self.next - 1) as f64 / legs as f64).min(1.0)
    }

    /// The next velocity; `None` at the end. Without a finite pose the robot stands.
    pub fn step(&mut self, pose: Pose) -> Option<Twist> {
        if !pose.is_finite() {
            return Some(Twist::STOP);
        }
        let TourParameters { speed, turn_rate, arrival, reach, lag, .. } = self.parameters;
        loop {
            let (&from, &to) = (self.corners.get(self.next - 1)?, self.corners.get(self.next)?);
            let along = to - from;
            let heading = math::atan2(along.y, along.x);
            let leg = Pose::new(to.x, to.y, heading);
            let place = leg.to_local(pose.position());
            // Remaining length of the leg, and cross-track error to the left.
            let (rest, aside) = (-place.x, place.y);
            if rest < arrival {
                self.next += 1;
                self.turning = true;
                continue;
            }
            let error = angle_difference(heading, pose.heading);
            if self.turning && error.abs() > ALIGNED {
                return Some(Twist::new(0.0, (TURN_GAIN * error).clamp(-turn_rate, turn_rate)));
            }
            self.turning = error.abs() > ASTRAY;
            let linear = speed.min(rest / (2.0 * lag)).max(0.01);
            let bend = (2.0 * math::sin(error) - (aside / reach).clamp(-1.0, 1.0)) / reach;
            return Some(Twist::new(linear, (linear * bend).clamp(-turn_rate, turn_rate)));
        }
    }
}

/// Outcome of a tour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum TourOutcome {
    /// The estimated pose is at the last corner.
    Finished,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(TourOutcome { Finished: "the tour is finished" });

impl Behaviour for Tour {
    /// Estimated pose; the robot stands while it is unknown.
    type Observation = Option<Pose>;
    type Command = Twist;
    type Outcome = TourOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, _time: f64, place: &Option<Pose>) -> Decision<Self> {
        let Some(place) = *place else { return Ok(ControlFlow::Continue(Twist::STOP)) };
        check_pose(&place)?;
        Ok(Tour::step(self, place).map_or(ControlFlow::Break(TourOutcome::Finished), ControlFlow::Continue))
    }
}

/// Reads odometry.
impl<R: Odometry + ?Sized> Senses<R> for Tour {
    fn sense(&mut self, robot: &mut R, _time: f64, place: &mut Option<Pose>) -> Result<()> {
        *place = Some(robot.pose()?);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::{Displacement, advance};

    #[test]
    fn the_legs_are_driven_one_after_the_other() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.11), (0.2, 0.11), (0.2, 0.11), (0.2, 0.8)];
        let points = corners.map(|(x, y)| Point::new(x, y));
        let mut tour = Tour::new(&points, TourParameters::default()).unwrap();
        let (mut pose, mut worst) = (Pose::new(0.0, 0.01, 2.0), 0.0_f64);
        let mut steps = 0;
        while let Some(twist) = tour.step(pose) {
            pose = advance(pose, Displacement { length: 0.05 * twist.linear, angle: 0.05 * twist.angular });
            let legs = points.windows(2).map(|two| crate::geometry::Segment::new(two[0], two[1]));
            worst = worst.max(legs.map(|leg| leg.distance_to(pose.position())).fold(f64::INFINITY, f64::min));
            steps += 1;
            assert!(steps < 2000, "{pose:?}");
        }
        assert!(worst < 0.012 && pose.distance_to(points[5]) < 0.015, "{worst} {pose:?}");
        assert_eq!(tour.progress(), 1.0);
        assert!(Tour::new(&points, TourParameters { speed: 0.0, ..TourParameters::default() }).is_err());
        assert!(Tour::new(&[Point::new(f64::NAN, 0.0)], TourParameters::default()).is_err());
        assert!(Tour::new(&[], TourParameters::default()).unwrap().step(pose).is_none());
    }
}
