use std::ffi::{c_char, c_int};
use std::process::{Command, Stdio};

#[cfg(target_os = "linux")]
use super::cancelling::cancellable;
use super::memory::{output_text, scatter, text};
use super::runtime::{code, enter};
use super::sleep::sleep_for;

/// Maximum number of bytes written to memory of unstated size.
const ROOM: usize = 128;

/// Runs a command and returns the beginning of its output.
#[unsafe(no_mangle)]
extern "C" fn OSExecute(command: *const c_char, result: *mut c_char) -> c_int {
    code(text(command).and_then(|command| {
        enter("OSExecute", |robios| robios.charge())?;
        let run = Command::new("sh").arg("-c").arg(command).stdin(Stdio::null()).output().ok()?;
        output_text(result, &run.stdout, ROOM);
        run.status.success().then_some(())
    }))
}

fn tell(call: &'static str, buffer: *mut c_char, answer: &str) -> c_int {
    code(enter(call, |robios| robios.charge()).filter(|()| output_text(buffer, answer.as_bytes(), ROOM)))
}

#[unsafe(no_mangle)]
extern "C" fn OSVersion(buffer: *mut c_char) -> c_int {
    tell("OSVersion", buffer, "7.2")
}

#[unsafe(no_mangle)]
extern "C" fn OSVersionIO(buffer: *mut c_char) -> c_int {
    tell("OSVersionIO", buffer, "1.0")
}

#[unsafe(no_mangle)]
extern "C" fn OSMachineName(buffer: *mut c_char) -> c_int {
    tell("OSMachineName", buffer, "EyeBot")
}

/// Returns the speed in MHz.
#[unsafe(no_mangle)]
extern "C" fn OSMachineSpeed() -> c_int {
    enter("OSMachineSpeed", |robios| robios.charge()).map_or(0, |()| 1200)
}

/// Returns the type of a vehicle.
#[unsafe(no_mangle)]
extern "C" fn OSMachineType() -> c_int {
    enter("OSMachineType", |robios| robios.charge()).map_or(0, |()| 1)
}

#[unsafe(no_mangle)]
extern "C" fn OSMachineID() -> c_int {
    enter("OSMachineID", |robios| robios.charge().map(|()| robios.identity().id as i32)).unwrap_or(0)
}

#[unsafe(no_mangle)]
extern "C" fn OSError(message: *const c_char, _number: c_int, _dead: c_int) -> c_int {
    code(text(message).and_then(|message| enter("OSError", |robios| robios.lcd_print(&message))))
}

/// Elsewhere threads sleep in the system's own functions.
#[cfg(not(target_os = "linux"))]
fn cancellable(wait: impl Fn() -> c_int) -> c_int {
    wait()
}

#[unsafe(no_mangle)]
extern "C-unwind" fn OSWait(milliseconds: c_int) -> c_int {
    cancellable(|| {
        if milliseconds <= 0 {
            return code(enter("OSWait", |robios| robios.pass(0.0)));
        }
        code(sleep_for("OSWait", f64::from(milliseconds) / 1000.0))
    })
}

#[unsafe(no_mangle)]
extern "C" fn OSDetachTimer(timer: c_int) -> c_int {
    code(enter("OSDetachTimer", |robios| robios.os_detach_timer(timer)))
}

#[unsafe(no_mangle)]
extern "C" fn OSSetTime(hours: c_int, minutes: c_int, seconds: c_int) -> c_int {
    code(enter("OSSetTime", |robios| robios.os_set_time(hours, minutes, seconds)))
}

#[unsafe(no_mangle)]
extern "C" fn OSGetTime(
    hours: *mut c_int,
    minutes: *mut c_int,
    seconds: *mut c_int,
    ticks: *mut c_int,
) -> c_int {
    let time = enter("OSGetTime", |robios| robios.os_get_time());
    code(time.filter(|&time| scatter([hours, minutes, seconds, ticks], time)).map(|_| ()))
}

#[unsafe(no_mangle)]
extern "C" fn OSGetCount() -> c_int {
    enter("OSGetCount", |robios| robios.os_get_count()).unwrap_or(0)
}

/// Time since 1970 by the program's clock (s), for `eye.py`; negative without one.
#[unsafe(no_mangle)]
extern "C" fn eyesim_time() -> f64 {
    let time = enter("time", |robios| {
        robios.charge()?;
        Ok(robios.now())
    });
    time.map_or(-1.0, |now| crate::robios::EPOCH + now)
}

/// Waits, for `eye.py`. Returns 1 without a clock.
#[unsafe(no_mangle)]
extern "C" fn eyesim_sleep(seconds: f64) -> c_int {
    let sane = seconds.is_finite() && seconds >= 0.0;
    code(sane.then_some(()).and_then(|()| sleep_for("time", seconds.min(1e6))))
}

/// Programs for the X window system call it.
#[unsafe(no_mangle)]
extern "C" fn XInitThreads() -> c_int {
    1
}
