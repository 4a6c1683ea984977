use std::ffi::c_int;
use std::sync::atomic::{AtomicI32, Ordering};

use super::memory::output;
use super::runtime::{code, enter};

/// Variables of the library read by programs.
macro_rules! variables {
    ($($name:ident),*) => {
        $(#[unsafe(no_mangle)] static $name: AtomicI32 = AtomicI32::new(0);)*
    };
}

variables!(CAMWIDTH, CAMHEIGHT, CAMPIXELS, CAMSIZE, CAMMODE, IP_WIDTH, IP_HEIGHT, IP_PIXELS, IP_SIZE);

fn publish([width, height, pixels, size]: [&AtomicI32; 4], (w, h): (usize, usize)) {
    for (variable, value) in [(width, w), (height, h), (pixels, w * h), (size, 3 * w * h)] {
        variable.store(value as i32, Ordering::Relaxed);
    }
}

#[unsafe(no_mangle)]
extern "C" fn CAMInit(resolution: c_int) -> c_int {
    let size = enter("CAMInit", |robios| robios.cam_init(resolution));
    if let Some(size) = size {
        publish([&CAMWIDTH, &CAMHEIGHT, &CAMPIXELS, &CAMSIZE], size);
        publish([&IP_WIDTH, &IP_HEIGHT, &IP_PIXELS, &IP_SIZE], size);
        CAMMODE.store(resolution, Ordering::Relaxed);
    }
    code(size.map(|_| ()))
}

#[unsafe(no_mangle)]
extern "C" fn CAMRelease() -> c_int {
    code(enter("CAMRelease", |robios| robios.cam_release()))
}

#[unsafe(no_mangle)]
extern "C" fn CAMGet(image: *mut u8) -> c_int {
    code(enter("CAMGet", |robios| robios.cam_get()).filter(|data| output(image, data)).map(|_| ()))
}

#[unsafe(no_mangle)]
extern "C" fn CAMGetGray(image: *mut u8) -> c_int {
    code(enter("CAMGetGray", |robios| robios.cam_get_gray()).filter(|data| output(image, data)).map(|_| ()))
}

#[unsafe(no_mangle)]
extern "C" fn IPSetSize(resolution: c_int) -> c_int {
    let size = enter("IPSetSize", |robios| robios.ip_set_size(resolution));
    if let Some(size) = size {
        publish([&IP_WIDTH, &IP_HEIGHT, &IP_PIXELS, &IP_SIZE], size);
    }
    code(size.map(|_| ()))
}
