use super::Result;

/// A robot's clock, an algorithm's only source of time.
///
/// In the simulator it is virtual: it advances when the program waits, and slightly with every call.
///
/// # For implementers
///
/// Time never runs backwards, and `wait` advances it by at least the given number of seconds: control
/// loops end with an error if it stands still. Fail for a number that is not finite.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Clock {
    /// Time since the robot's start (s).
    fn now(&mut self) -> Result<f64>;

    /// Waits for a number of seconds. Returns at once for zero or less.
    fn wait(&mut self, seconds: f64) -> Result<()>;

    /// The same time as [`now`](Clock::now), for logs: reading it takes no simulated time and leaves no
    /// trace.
    ///
    /// A clock that costs nothing to read need not implement it.
    fn peek_time(&mut self) -> Result<f64> {
        self.now()
    }
}
