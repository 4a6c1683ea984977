//! Waiting of a program with one thread.

use roverlab::io::Result;

use super::runtime::enter;
use crate::keys::Waiting;
use crate::robios::Robios;

/// Time that passes at once while nothing is due (s).
const FOREVER: f64 = 60.0;

/// Lets the program wait for a time (s).
pub(super) fn sleep_for(call: &'static str, seconds: f64) -> Option<()> {
    let start = enter(call, |robios| Ok(robios.now()))?;
    sleep_until(start + seconds)
}

/// Lets the program wait until a time since the start (s). Timer functions are called in between.
fn sleep_until(end: f64) -> Option<()> {
    loop {
        let now = enter("", |robios| {
            let now = robios.now();
            if now < end {
                let next = robios.timers.next().map_or(end, |due| due.min(end));
                robios.pass(next - now)?;
            }
            Ok(robios.now())
        })?;
        if end <= now {
            return Some(());
        }
    }
}

/// Whether a call may block in the world, because the program has nothing else to do.
pub(super) fn may_block() -> bool {
    enter("", |robios| Ok(robios.timers.is_empty())).unwrap_or(true)
}

/// Waits until a query has an answer.
pub(super) fn wait_for<T>(
    call: &'static str,
    mut ask: impl FnMut(&mut Robios) -> Result<Waiting<T>>,
) -> Option<T> {
    loop {
        match enter(call, &mut ask)? {
            Waiting::Pressed(value) => return Some(value),
            Waiting::Until(time) => sleep_until(time)?,
            Waiting::Forever => sleep_for(call, FOREVER)?,
        }
    }
}
