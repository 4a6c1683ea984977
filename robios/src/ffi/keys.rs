use std::ffi::c_int;

use super::memory::scatter;
use super::runtime::{code, enter};
use super::sleep::wait_for;

#[unsafe(no_mangle)]
extern "C" fn KEYGet() -> c_int {
    wait_for("KEYGet", |robios| robios.key_wait(u32::MAX)).unwrap_or(0) as c_int
}

#[unsafe(no_mangle)]
extern "C" fn KEYRead() -> c_int {
    enter("KEYRead", |robios| robios.key_read()).unwrap_or(0)
}

/// Returns the key.
#[unsafe(no_mangle)]
extern "C" fn KEYWait(key: c_int) -> c_int {
    let mask = key as u32;
    loop {
        match wait_for("KEYWait", |robios| robios.key_wait(mask)) {
            Some(pressed) if pressed & mask == 0 => {}
            pressed => return pressed.unwrap_or(0) as c_int,
        }
    }
}

#[unsafe(no_mangle)]
extern "C" fn KEYGetXY(x: *mut c_int, y: *mut c_int) -> c_int {
    let place = wait_for("KEYGetXY", |robios| robios.key_wait_xy());
    code(place.filter(|&(px, py)| scatter([x, y], [px, py])).map(|_| ()))
}

/// Without a touch the coordinates are 0 and the return code is 1.
#[unsafe(no_mangle)]
extern "C" fn KEYReadXY(x: *mut c_int, y: *mut c_int) -> c_int {
    let place = enter("KEYReadXY", |robios| robios.key_read_xy()).flatten();
    let (px, py) = place.unwrap_or((0, 0));
    code(place.filter(|_| !x.is_null() && !y.is_null()).map(|_| ())) | c_int::from(!scatter([x, y], [px, py]))
}

#[unsafe(no_mangle)]
extern "C" fn IRTVGet() -> c_int {
    wait_for("IRTVGet", |robios| robios.irtv_wait()).unwrap_or(0)
}

#[unsafe(no_mangle)]
extern "C" fn IRTVRead() -> c_int {
    enter("IRTVRead", |robios| robios.irtv_read()).unwrap_or(0)
}

#[unsafe(no_mangle)]
extern "C" fn IRTVFlush() -> c_int {
    code(enter("IRTVFlush", |robios| {
        while robios.irtv_read()? != 0 {}
        Ok(())
    }))
}

#[unsafe(no_mangle)]
extern "C" fn IRTVGetStatus() -> c_int {
    enter("IRTVGetStatus", |robios| robios.charge().map(|()| 1)).unwrap_or(0)
}
