use std::ffi::c_int;

use roverlab::io::sim::TICK;

use super::memory::scatter;
use super::runtime::{code, enter};
use super::sleep::{may_block, sleep_for};

#[unsafe(no_mangle)]
extern "C" fn VWSetSpeed(linear: c_int, angular: c_int) -> c_int {
    code(enter("VWSetSpeed", |robios| robios.vw_set_speed(linear, angular)))
}

#[unsafe(no_mangle)]
extern "C" fn VWGetSpeed(linear: *mut c_int, angular: *mut c_int) -> c_int {
    let speed = enter("VWGetSpeed", |robios| robios.vw_get_speed());
    code(speed.filter(|&speed| scatter([linear, angular], speed)).map(|_| ()))
}

#[unsafe(no_mangle)]
extern "C" fn VWSetPosition(x: c_int, y: c_int, phi: c_int) -> c_int {
    code(enter("VWSetPosition", |robios| robios.vw_set_position([x, y, phi])))
}

#[unsafe(no_mangle)]
extern "C" fn VWGetPosition(x: *mut c_int, y: *mut c_int, phi: *mut c_int) -> c_int {
    let pose = enter("VWGetPosition", |robios| robios.vw_get_position());
    code(pose.filter(|&pose| scatter([x, y, phi], pose)).map(|_| ()))
}

#[unsafe(no_mangle)]
extern "C" fn VWStraight(distance: c_int, speed: c_int) -> c_int {
    code(enter("VWStraight", |robios| robios.vw_straight(distance, speed)))
}

#[unsafe(no_mangle)]
extern "C" fn VWTurn(angle: c_int, speed: c_int) -> c_int {
    code(enter("VWTurn", |robios| robios.vw_turn(angle, speed)))
}

#[unsafe(no_mangle)]
extern "C" fn VWCurve(length: c_int, angle: c_int, speed: c_int) -> c_int {
    code(enter("VWCurve", |robios| robios.vw_curve(length, angle, speed)))
}

#[unsafe(no_mangle)]
extern "C" fn VWDrive(forward: c_int, left: c_int, speed: c_int) -> c_int {
    code(enter("VWDrive", |robios| robios.vw_drive(forward, left, speed)))
}

#[unsafe(no_mangle)]
pub(super) extern "C" fn VWRemain() -> c_int {
    enter("VWRemain", |robios| robios.vw_remain()).unwrap_or(-1)
}

#[unsafe(no_mangle)]
pub(super) extern "C" fn VWDone() -> c_int {
    // A program must not wait for the end of a drive that does not exist.
    c_int::from(enter("VWDone", |robios| robios.vw_done()).unwrap_or(true))
}

#[unsafe(no_mangle)]
pub(super) extern "C" fn VWWait() -> c_int {
    if may_block() {
        return code(enter("VWWait", |robios| robios.vw_wait()));
    }
    loop {
        match enter("VWWait", |robios| robios.vw_arrived()) {
            Some(false) => {}
            arrived => return code(arrived.map(|_| ())),
        }
        if sleep_for("", TICK).is_none() {
            return 1;
        }
    }
}

#[unsafe(no_mangle)]
extern "C" fn VWStalled() -> c_int {
    enter("VWStalled", |robios| robios.vw_stalled()).unwrap_or(0)
}

#[unsafe(no_mangle)]
extern "C" fn VWControl(_linear_p: c_int, _linear_i: c_int, _angular_p: c_int, _angular_i: c_int) -> c_int {
    code(enter("VWControl", |robios| robios.charge()))
}

#[unsafe(no_mangle)]
extern "C" fn VWControlOff() -> c_int {
    code(enter("VWControlOff", |robios| robios.charge()))
}
