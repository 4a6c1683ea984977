use std::ops::ControlFlow;

use crate::ParameterError;
use crate::geometry::units;
use crate::io::control::{Behaviour, Command, Decision, Halt, Senses};
use crate::io::{Lidar, LidarScan, Motors, Result, Servos};
use crate::parameter::require;

/// The book's cone track driver (section 14.5): it steers for the middle between the two cones nearest to the middle of the
/// scan, left and right of it.
#[derive(Debug, Clone, PartialEq)]
pub struct GapDriver {
    /// The share of the motor's full speed that it drives at.
    speed: f64,
    /// Beyond this range nothing is a cone, in metres.
    farthest: f64,
    /// Beams at each end of the scan that are not looked at, as a share of all.
    edge: f64,
    /// The beam in the middle of the last gap, counted from the left.
    middle: Option<usize>,
}

impl Default for GapDriver {
    /// The book's 9 m and 20 of 180 beams, at a tenth of the full speed.
    fn default() -> Self {
        Self { speed: 0.1, farthest: 9.0, edge: 20.0 / 180.0, middle: None }
    }
}

impl GapDriver {
    /// The book's driver at a share of the full speed, 1 at most.
    pub fn with_speed(speed: f64) -> std::result::Result<Self, ParameterError> {
        require("speed", speed, speed > 0.0 && speed <= 1.0, "more than 0 and at most 1")?;
        Ok(Self { speed, ..Self::default() })
    }

    /// The position of the steering servo, -1 for full left to 1 for full right, from a scan of 180 degrees. `None` without a
    /// cone on each side: the steering stays.
    ///
    /// ```
    /// use roverlab::race::GapDriver;
    /// use roverlab::io::LidarScan;
    /// let step = 1.0_f64.to_radians();
    /// let mut ranges = vec![f64::INFINITY; 180];
    /// // Counted from the right: cones at 20 degrees to the right and 40 to the left.
    /// (ranges[70], ranges[130]) = (4.0, 4.0);
    /// let scan = LidarScan { angle_min: -90.0 * step, angle_increment: step, range_max: 20.0, ranges, ..LidarScan::default() };
    /// let position = GapDriver::default().step(&scan).unwrap();
    /// assert!(position < 0.0, "to the left");
    /// ```
    pub fn step(&mut self, scan: &LidarScan) -> Option<f64> {
        let n = scan.ranges.len();
        // The book counts beams from the left.
        let near = |beam: &usize| scan.ranges[n - 1 - beam] < self.farthest;
        let edge = (self.edge * n as f64) as usize;
        let middle = self.middle.unwrap_or(n / 2).min(n.saturating_sub(1));
        let left = (edge + 1..middle).rev().find(near)?;
        let right = (middle + 1..n.saturating_sub(edge)).find(near)?;
        let middle = usize::midpoint(left, right);
        self.middle = Some(middle);
        // A servo goes by 128 steps to each side, and moves by one for each of 180 beams.
        let turned = units::to_deg(scan.angle_increment) * (middle as f64 - 0.5 * n as f64);
        Some((turned / 128.0).clamp(-1.0, 1.0))
    }
}

/// What a [`GapDriver`] tells motor 1 and servo 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapCommand {
    /// A share of the motor's full speed.
    pub motor: f64,
    /// The position of the steering servo, if it is to change.
    pub servo: Option<f64>,
}

impl<R: Motors + Servos + ?Sized> Command<R> for GapCommand {
    fn apply(&self, robot: &mut R) -> Result<()> {
        if let Some(position) = self.servo {
            robot.set_servo(1, position)?;
        }
        robot.set_motor(1, self.motor)
    }

    fn stop(robot: &mut R) -> Result<()> {
        robot.set_motor(1, 0.0)
    }
}

impl Behaviour for GapDriver {
    type Observation = LidarScan;
    type Command = GapCommand;
    type Outcome = Halt;

    /// Ten decisions a second.
    fn period(&self) -> f64 {
        0.1
    }

    fn step(&mut self, _time: f64, scan: &LidarScan) -> Decision<Self> {
        Ok(ControlFlow::Continue(GapCommand { motor: self.speed, servo: GapDriver::step(self, scan) }))
    }
}

impl<R: Lidar + ?Sized> Senses<R> for GapDriver {
    fn sense(&mut self, robot: &mut R, _time: f64, scan: &mut LidarScan) -> Result<()> {
        robot.scan_into(scan)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(near: &[usize]) -> LidarScan {
        let step = std::f64::consts::PI / 180.0;
        let mut ranges = vec![f64::INFINITY; 180];
        for beam in near {
            ranges[179 - beam] = 5.0;
        }
        LidarScan {
            angle_min: -90.0 * step,
            angle_increment: step,
            range_max: 20.0,
            ranges,
            ..LidarScan::default()
        }
    }

    #[test]
    fn it_steers_for_the_middle_of_the_gap() {
        let mut driver = GapDriver::default();
        assert_eq!(driver.step(&scan(&[80, 100])), Some(0.0));
        assert_eq!(driver.step(&scan(&[60, 80, 100, 120])), Some(0.0));
        assert!(driver.step(&scan(&[100, 130])).is_none(), "the gap lies beside the middle");
        let mut driver = GapDriver::default();
        assert!((driver.step(&scan(&[86, 120])).unwrap() - 13.0 / 128.0).abs() < 1e-9);
        // The middle is that of the last gap now, so the same cones stay left and right.
        assert!(driver.step(&scan(&[95, 125])).unwrap() > 0.0);
    }

    #[test]
    fn without_two_cones_nothing_is_decided() {
        let mut driver = GapDriver::default();
        for near in [&[][..], &[40], &[150], &[5, 175]] {
            assert!(driver.step(&scan(near)).is_none(), "{near:?}");
        }
        assert!(driver.step(&LidarScan::default()).is_none());
    }
}
