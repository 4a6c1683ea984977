use super::Result;

/// A robot's clock, the only source of time that an algorithm has.
///
/// In the simulator it is virtual: it moves when the program waits, and a little with every call.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Clock {
    /// Seconds since the robot was started.
    fn now(&mut self) -> Result<f64>;

    /// Lets the given number of seconds pass. Zero or less returns at once.
    fn wait(&mut self, seconds: f64) -> Result<()>;

    /// The time as [`now`](Clock::now) tells it, for logs: asking takes no time of the robot's and leaves no trace.
    ///
    /// A clock that costs nothing to read need not implement it.
    fn peek_time(&mut self) -> Result<f64> {
        self.now()
    }
}
