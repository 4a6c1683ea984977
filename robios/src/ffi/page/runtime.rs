//! The robot of the program in a page, which has one thread, and which nobody waits for.

use std::cell::{Cell, RefCell};
use std::ffi::c_int;

use roverlab::io::{ErrorKind, Result};

use super::globals::publish_points;
use crate::report::Stage;
use crate::robios::{Callback, Robios};

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Ends the program by an exception of the page's.
    fn stop() -> !;
    /// Calls a timer function by its number.
    fn call_timer(function: u32);
}

thread_local! {
    /// The robot, until its run is over.
    static ROBOT: RefCell<Option<Box<Robios>>> = const { RefCell::new(None) };
    /// Whether a timer function is running.
    static IN_TIMER: Cell<bool> = const { Cell::new(false) };
}

/// Gives the program a robot.
pub(crate) fn begin(robios: Robios) {
    publish_points(robios.lidar_points());
    IN_TIMER.set(false);
    ROBOT.set(Some(Box::new(robios)));
}

/// Ends the robot's run and writes its report, unless the time limit has done so.
pub(crate) fn finish() {
    if let Some(mut robios) = ROBOT.take() {
        robios.finish(Stage::Ended);
    }
}

/// Calls the robot, then the due timer functions. `None` if the call fails. Ends the program at its time
/// limit, and again if it goes on calling after that. The call's name determines its cost and appears in the
/// report.
pub(super) fn enter<T>(name: &'static str, call: impl FnOnce(&mut Robios) -> Result<T>) -> Option<T> {
    let Some(mut robios) = ROBOT.take() else { end() };
    robios.begin(name);
    let answer = call(&mut robios);
    match &answer {
        Err(error) if error.kind() == ErrorKind::TimedOut => {
            robios.publish();
            robios.finish(Stage::TimedOut);
            end()
        }
        Err(error) => robios.note(&error.to_string()),
        Ok(_) => {}
    }
    robios.publish();
    let is_due = answer.is_ok() && !robios.timers.is_empty() && !IN_TIMER.replace(true);
    let due = if is_due {
        let now = robios.now();
        robios.timers.due(now)
    } else {
        Vec::new()
    };
    ROBOT.set(Some(robios));
    if is_due {
        for function in due {
            // SAFETY: the page takes any number, and may call the robot.
            unsafe { call_timer(function) };
        }
        IN_TIMER.set(false);
    }
    answer.ok()
}

fn end() -> ! {
    // SAFETY: no robot and no borrow is left behind by the exception.
    unsafe { stop() }
}

/// Returns the timer's handle, or 0.
#[unsafe(no_mangle)]
extern "C" fn OSAttachTimer(scale: c_int, function: Callback) -> c_int {
    enter("OSAttachTimer", |robios| robios.os_attach_timer(scale, function)).unwrap_or(0)
}

/// RoBIOS's return code for success or failure.
pub(super) fn code(done: Option<()>) -> c_int {
    c_int::from(done.is_none())
}
