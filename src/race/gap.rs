use std::ops::ControlFlow;

use crate::ParameterError;
use crate::geometry::units;
use crate::io::control::{Behaviour, Command, Decision, Halt, Senses};
use crate::io::reading::check_scan;
use crate::io::{Lidar, LidarScan, Motors, Result, Servos};
use crate::parameter::require;

/// The book's driver for cone tracks (section 14.5): it steers for the midpoint of the two cones nearest to
/// the middle of the scan, one on each side.
#[derive(Debug, Clone, PartialEq)]
pub struct GapDriver {
    /// Motor speed (fraction of full speed).
    speed: f64,
    /// Range beyond which nothing counts as a cone (m).
    farthest: f64,
    /// Fraction of the beams ignored at each end of the scan.
    edge: f64,
    /// Beam in the middle of the last gap, counted from the left.
    middle: Option<usize>,
}

impl Default for GapDriver {
    /// The book's values: 9 m, 20 of 180 beams, a tenth of full speed.
    fn default() -> Self {
        Self { speed: 0.1, farthest: 9.0, edge: 20.0 / 180.0, middle: None }
    }
}

impl GapDriver {
    /// The book's driver at a fraction of full speed.
    ///
    /// # Errors
    ///
    /// If `speed` is not between 0 (exclusive) and 1.
    pub fn with_speed(speed: f64) -> std::result::Result<Self, ParameterError> {
        require("speed", speed, speed > 0.0 && speed <= 1.0, "more than 0 and at most 1")?;
        Ok(Self { speed, ..Self::default() })
    }

    /// Position of the steering servo, -1 (full left) to 1 (full right), for a scan of 180 degrees. `None`
    /// without a cone on each side: the steering stays.
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
        // The servo has 128 steps on each side, and moves by one step per beam of 180.
        let turned = units::to_deg(scan.angle_increment) * (middle as f64 - 0.5 * n as f64);
        Some((turned / 128.0).clamp(-1.0, 1.0))
    }
}

/// Command of a [`GapDriver`] for motor 1 and servo 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapCommand {
    /// Motor speed (fraction of full speed).
    pub motor: f64,
    /// Position of the steering servo, if it changes.
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

    /// Ten decisions per second.
    fn period(&self) -> f64 {
        0.1
    }

    fn step(&mut self, _time: f64, scan: &LidarScan) -> Decision<Self> {
        check_scan(scan)?;
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
        // The middle is now that of the last gap, so the same cones stay left and right.
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
