use super::{Clock, Error, ErrorKind, Result};

/// The beat of a control loop: its steps are a period apart by the robot's clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Beat {
    begin: f64,
    next: f64,
    last: f64,
    period: f64,
}

impl Beat {
    /// A loop that begins now.
    pub(crate) fn start<R: Clock + ?Sized>(robot: &mut R, period: f64) -> Result<Self> {
        let begin = robot.now()?;
        Ok(Self { begin, next: begin, last: f64::NEG_INFINITY, period })
    }

    /// Seconds since the begin, at a new step. Fails if no time has passed since the last one: such a loop would not end.
    pub(crate) fn step<R: Clock + ?Sized>(&mut self, robot: &mut R) -> Result<f64> {
        let now = robot.now()?;
        if now <= self.last {
            return Err(Error::new(ErrorKind::Other, "the robot's clock stands still"));
        }
        self.last = now;
        Ok(now - self.begin)
    }

    /// When the present step began, by the robot's clock.
    pub(crate) fn now(&self) -> f64 {
        self.last
    }

    /// Waits until the next step is due.
    pub(crate) fn rest<R: Clock + ?Sized>(&mut self, robot: &mut R) -> Result<()> {
        self.next += self.period;
        let pause = self.next - robot.now()?;
        robot.wait(pause)
    }
}
