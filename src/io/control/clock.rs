use crate::io::{Clock, Error, ErrorKind, Result};

/// A robot's clock as a run reads it: time goes on from step to step, up to a limit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stopwatch {
    end: f64,
    /// What the clock showed last, and at the last step.
    last: f64,
    step: f64,
}

/// Seconds that clocks of finite resolution may lack at the end.
const RESOLUTION: f64 = 1e-9;

impl Stopwatch {
    /// Starts now, for at most so many seconds.
    pub(crate) fn start<R: Clock + ?Sized>(robot: &mut R, limit: f64) -> Result<Self> {
        Self::check_limit(limit)?;
        let mut clock = Self { end: f64::INFINITY, last: f64::NEG_INFINITY, step: f64::NEG_INFINITY };
        clock.end = clock.now(robot)? + limit;
        Ok(clock)
    }

    /// Fails for a time limit that is no number.
    pub(crate) fn check_limit(limit: f64) -> Result<()> {
        if limit.is_nan() {
            return Err(Error::invalid_input("time limit", limit, "seconds, or infinity for none"));
        }
        Ok(())
    }

    /// What the clock shows. Fails if it runs backwards or shows no number.
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

    /// The same at a new step: fails, too, if no time has passed since the last one. Such a run would not
    /// end.
    pub(crate) fn step<R: Clock + ?Sized>(&mut self, robot: &mut R) -> Result<f64> {
        let now = self.now(robot)?;
        if now <= self.step {
            return Err(fault("stands still"));
        }
        self.step = now;
        Ok(now)
    }

    /// What the clock showed last.
    pub(crate) fn time(&self) -> f64 {
        self.last
    }

    /// Whether the time is over.
    pub(crate) fn is_over(&self) -> bool {
        self.last >= self.end - RESOLUTION
    }

    /// Waits until a time, or until the time is over, if one of these is still to come. Returns when that was
    /// due: now, if it is late.
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
