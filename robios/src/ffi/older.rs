//! Functions of early RoBIOS-7 versions that programs still call: drives, inverted pixels and tones.

use std::ffi::{c_int, c_long};

use super::drive::{VWDone, VWRemain, VWWait};
use super::lines::{AUBeep, AUDone};
use super::runtime::{code, enter};

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
