//! Functions of early RoBIOS-7 versions that programs still call: drives, inverted pixels, tones, threads and
//! semaphores.

use std::ffi::{c_int, c_long, c_uint, c_void};

use libc::{pthread_t, sem_t};

use super::cancelling::pthread_cancel;
use super::drive::{VWDone, VWRemain, VWWait};
use super::lines::{AUBeep, AUDone};
use super::locks::{sem_post, sem_wait};
use super::runtime::{code, enter};
use super::sleep::sleep_for;

#[unsafe(no_mangle)]
extern "C" fn VWDriveRemain() -> c_int {
    VWRemain()
}

#[unsafe(no_mangle)]
extern "C" fn VWDriveDone() -> c_int {
    VWDone()
}

#[unsafe(no_mangle)]
extern "C" fn VWDriveWait() -> c_int {
    VWWait()
}

/// The display needs no initialisation.
#[unsafe(no_mangle)]
extern "C" fn LCDInit() -> c_int {
    code(enter("LCDInit", |robios| robios.charge()))
}

/// Upper limit of a display's size (pixels).
const FAR: c_int = 2000;

fn near(coordinate: c_int) -> c_int {
    coordinate.clamp(-FAR, FAR)
}

#[unsafe(no_mangle)]
extern "C" fn LCDPixelInvert(x: c_int, y: c_int) -> c_int {
    code(enter("LCDPixelInvert", |robios| robios.lcd_invert([(x, y)])))
}

#[unsafe(no_mangle)]
extern "C" fn LCDLineInvert(x1: c_int, y1: c_int, x2: c_int, y2: c_int) -> c_int {
    let [x1, y1, x2, y2] = [x1, y1, x2, y2].map(near);
    let steps = (x2 - x1).abs().max((y2 - y1).abs()).max(1);
    let at = |from: c_int, to: c_int, step: c_int| from + (2 * (to - from) * step + steps) / (2 * steps);
    code(enter("LCDLineInvert", |robios| {
        robios.lcd_invert((0..=steps).map(|step| (at(x1, x2, step), at(y1, y2, step))))
    }))
}

#[unsafe(no_mangle)]
extern "C" fn LCDAreaInvert(x1: c_int, y1: c_int, x2: c_int, y2: c_int) -> c_int {
    let [x1, y1, x2, y2] = [x1, y1, x2, y2].map(near);
    let rows = y1.min(y2)..=y1.max(y2);
    let pixels = rows.flat_map(|y| (x1.min(x2)..=x1.max(x2)).map(move |x| (x, y)));
    code(enter("LCDAreaInvert", |robios| robios.lcd_invert(pixels)))
}

#[unsafe(no_mangle)]
extern "C" fn LCDCircleInvert(x: c_int, y: c_int, size: c_int) -> c_int {
    let (x, y, radius) = (near(x), near(y), near(size).abs());
    let square = (-radius..=radius).flat_map(|dy| (-radius..=radius).map(move |dx| (dx, dy)));
    let disc = square.filter(|(dx, dy)| dx * dx + dy * dy <= radius * radius);
    code(enter("LCDCircleInvert", |robios| robios.lcd_invert(disc.map(|(dx, dy)| (x + dx, y + dy)))))
}

#[unsafe(no_mangle)]
extern "C" fn AUTone(_frequency: c_int, _time: c_int) -> c_int {
    AUBeep()
}

#[unsafe(no_mangle)]
extern "C" fn AUCheckTone() -> c_int {
    AUDone()
}

#[unsafe(no_mangle)]
extern "C" fn AUCheckPlay() -> c_int {
    AUDone()
}

/// There is no sound to record, so nothing is written.
#[unsafe(no_mangle)]
extern "C" fn AURecord(_buffer: *mut u8, _time: c_int, _frequency: c_long) -> c_int {
    code(enter("AURecord", |robios| {
        robios.note("there is no sound to record, so nothing is written");
        robios.charge()
    }))
}

#[unsafe(no_mangle)]
extern "C" fn AUCheckRecord() -> c_int {
    c_int::from(enter("AUCheckRecord", |robios| robios.charge()).is_some())
}

/// Handle of a thread.
#[derive(Clone, Copy)]
#[repr(C)]
struct Task {
    thread: pthread_t,
    identifier: c_int,
}

type Body = extern "C" fn(*mut c_void) -> *mut c_void;

#[unsafe(no_mangle)]
extern "C" fn MTInit() -> c_int {
    code(enter("MTInit", |robios| robios.charge()))
}

/// Sleeps for hundredths of a second.
#[unsafe(no_mangle)]
extern "C" fn MTSleep(time: c_int) -> c_int {
    code(sleep_for("MTSleep", f64::from(time.max(0)) / 100.0))
}

/// Starts a thread with its identifier as argument.
#[unsafe(no_mangle)]
extern "C" fn MTSpawn(function: Option<Body>, identifier: c_int) -> Task {
    super::threads::note_thread();
    let mut thread: pthread_t = 0;
    if let Some(function) = function {
        let argument = std::ptr::without_provenance_mut(identifier as usize);
        // SAFETY: the handle outlives the call, there are no attributes, and the function gets a number that
        // it does not dereference.
        unsafe { libc::pthread_create(&raw mut thread, std::ptr::null(), function, argument) };
    }
    Task { thread, identifier }
}

#[unsafe(no_mangle)]
extern "C" fn MTGetUID(task: Task) -> c_int {
    task.identifier
}

/// Cancels a thread at its next cancellation point.
#[unsafe(no_mangle)]
extern "C" fn MTKill(task: Task) -> c_int {
    if task.thread == 0 {
        return 1;
    }
    c_int::from(pthread_cancel(task.thread) != 0)
}

#[unsafe(no_mangle)]
extern "C" fn SEMAInit(semaphore: *mut sem_t, value: c_int) -> c_int {
    let Ok(value) = c_uint::try_from(value) else { return 1 };
    // SAFETY: the pointer is not null and refers to a semaphore of the program.
    c_int::from(semaphore.is_null() || unsafe { libc::sem_init(semaphore, 0, value) } != 0)
}

#[unsafe(no_mangle)]
extern "C-unwind" fn SEMALock(semaphore: *mut sem_t) -> c_int {
    c_int::from(semaphore.is_null() || sem_wait(semaphore.cast()) != 0)
}

#[unsafe(no_mangle)]
extern "C" fn SEMAUnlock(semaphore: *mut sem_t) -> c_int {
    c_int::from(semaphore.is_null() || sem_post(semaphore.cast()) != 0)
}
