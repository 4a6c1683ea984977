use crate::io::{Clock, Error, ErrorKind, Result};

/// A robot's clock during a run: strictly increasing from step to step, with a time limit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stopwatch {
    end: f64,
    /// Last reading, and reading at the last step (s).
    last: f64,
    step: f64,
}

/// Time that clocks of finite resolution may lack at the end (s).
const RESOLUTION: f64 = 1e-9;

impl Stopwatch {
    /// Starts now, with a time limit (s).
    pub(crate) fn start<R: Clock + ?Sized>(robot: &mut R, limit: f64) -> Result<Self> {
        Self::check_limit(limit)?;
        let mut clock = Self { end: f64::INFINITY, last: f64::NEG_INFINITY, step: f64::NEG_INFINITY };
        clock.end = clock.now(robot)? + limit;
        Ok(clock)
    }

    /// Fails if the time limit is NaN.
    pub(crate) fn check_limit(limit: f64) -> Result<()> {
        if limit.is_nan() {
            return Err(Error::invalid_input("time limit", limit, "seconds, or infinity for none"));
        }
        Ok(())
    }

    /// Reads the clock. Fails if it runs backwards or is not finite.
    pub(crate) fn now<R: Clock + ?Sized>(&mut self, robot: &mut R) -> Result<f64> {
        let now = robot.now()?;
        if !now.is_finite() {
            return Err(fault(&format!("shows {now} s; expected a finite number")));
        }
        if now < self.last {
            return Err(fault(&format!("runs backwards: {now} s after {} s", self.last)));
        }
        self.last = now;
        Ok(now)
    }

    /// Reads the clock at a new step. Also fails if no time has passed since the last one, as such a run
    /// would never end.
    pub(crate) fn step<R: Clock + ?Sized>(&mut self, robot: &mut R) -> Result<f64> {
        let now = self.now(robot)?;
        if now <= self.step {
            return Err(fault("stands still"));
        }
        self.step = now;
        Ok(now)
    }

    /// Last reading (s).
    pub(crate) fn time(&self) -> f64 {
        self.last
    }

    /// Time from the last reading to the time limit (s).
    pub(crate) fn left(&self) -> f64 {
        self.end - self.last
    }

    /// Whether the time limit is reached.
    pub(crate) fn is_over(&self) -> bool {
        self.left() <= RESOLUTION
    }

    /// Waits until `due` or the time limit, whichever comes first, unless it is past. Returns `due`, or the
    /// current time if late.
    pub(crate) fn wait_until<R: Clock + ?Sized>(&mut self, robot: &mut R, due: f64) -> Result<f64> {
        let now = self.now(robot)?;
        let due = due.max(now);
        robot.wait(due.min(self.end) - now)?;
        Ok(due)
    }
}

fn fault(what: &str) -> Error {
    Error::new(ErrorKind::Other, format!("the robot's clock {what}"))
}
