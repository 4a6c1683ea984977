use std::ffi::c_int;

use super::runtime::{code, enter};

#[unsafe(no_mangle)]
extern "C" fn MOTORDrive(motor: c_int, speed: c_int) -> c_int {
    code(enter("MOTORDrive", |robios| robios.motor_drive(motor, speed)))
}

#[unsafe(no_mangle)]
extern "C" fn MOTORDriveRaw(motor: c_int, speed: c_int) -> c_int {
    MOTORDrive(motor, speed)
}

#[unsafe(no_mangle)]
extern "C" fn MOTORPID(motor: c_int, _p: c_int, _i: c_int, _d: c_int) -> c_int {
    code(enter("MOTORPID", |robios| robios.motor_pid(motor)))
}

#[unsafe(no_mangle)]
extern "C" fn MOTORPIDOff(motor: c_int) -> c_int {
    code(enter("MOTORPIDOff", |robios| robios.motor_pid(motor)))
}

/// Name of 2017.
#[unsafe(no_mangle)]
extern "C" fn MOTORPIDoff(motor: c_int) -> c_int {
    MOTORPIDOff(motor)
}

#[unsafe(no_mangle)]
extern "C" fn MOTORSpeed(motor: c_int, ticks: c_int) -> c_int {
    code(enter("MOTORSpeed", |robios| robios.motor_speed(motor, ticks)))
}

#[unsafe(no_mangle)]
extern "C" fn ENCODERRead(quad: c_int) -> c_int {
    enter("ENCODERRead", |robios| robios.encoder_read(quad)).unwrap_or(0)
}

#[unsafe(no_mangle)]
extern "C" fn ENCODERReset(quad: c_int) -> c_int {
    code(enter("ENCODERReset", |robios| robios.encoder_reset(quad)))
}

#[unsafe(no_mangle)]
extern "C" fn SERVOSet(servo: c_int, angle: c_int) -> c_int {
    code(enter("SERVOSet", |robios| robios.servo_set(servo, angle)))
}

#[unsafe(no_mangle)]
extern "C" fn SERVOSetRaw(servo: c_int, angle: c_int) -> c_int {
    SERVOSet(servo, angle)
}

#[unsafe(no_mangle)]
extern "C" fn SERVOSetAngle(servo: c_int, angle: c_int) -> c_int {
    SERVOSet(servo, angle)
}

#[unsafe(no_mangle)]
extern "C" fn SERVORange(servo: c_int, _low: c_int, _high: c_int) -> c_int {
    code(enter("SERVORange", |robios| robios.servo_check(servo)))
}

#[unsafe(no_mangle)]
extern "C" fn SERVOSetExtension(servo: c_int, _extension: c_int) -> c_int {
    code(enter("SERVOSetExtension", |robios| robios.servo_check(servo)))
}

#[unsafe(no_mangle)]
extern "C" fn SERVOGet(servo: c_int) -> c_int {
    enter("SERVOGet", |robios| robios.servo_get(servo)).unwrap_or(-1)
}

#[unsafe(no_mangle)]
extern "C" fn SERVODone(servo: c_int) -> c_int {
    c_int::from(enter("SERVODone", |robios| robios.servo_check(servo)).is_some())
}

#[unsafe(no_mangle)]
extern "C" fn SERVOWait(servo: c_int) -> c_int {
    code(enter("SERVOWait", |robios| robios.servo_check(servo)))
}

/// Simulated servos never stall.
#[unsafe(no_mangle)]
extern "C" fn SERVOStalled(servo: c_int) -> c_int {
    enter("SERVOStalled", |robios| robios.servo_check(servo)).map_or(0, |()| 0)
}
