use std::ffi::{c_char, c_int};

use super::memory::{input, scatter, text};
use super::runtime::{code, enter};
use crate::robios::Frame;

#[unsafe(no_mangle)]
extern "C" fn LCDClear() -> c_int {
    code(enter("LCDClear", |robios| robios.lcd_clear()))
}

#[unsafe(no_mangle)]
extern "C" fn LCDSetPos(row: c_int, column: c_int) -> c_int {
    code(enter("LCDSetPos", |robios| robios.lcd_set_pos(row, column)))
}

#[unsafe(no_mangle)]
extern "C" fn LCDGetPos(row: *mut c_int, column: *mut c_int) -> c_int {
    let found = enter("LCDGetPos", |robios| robios.lcd_get_pos());
    code(found.filter(|&(r, c)| scatter([row, column], [r, c])).map(|_| ()))
}

#[unsafe(no_mangle)]
extern "C" fn LCDSetColor(foreground: c_int, background: c_int) -> c_int {
    code(enter("LCDSetColor", |robios| robios.lcd_set_color(foreground, background)))
}

#[unsafe(no_mangle)]
extern "C" fn LCDSetFont(font: c_int, variation: c_int) -> c_int {
    code(enter("LCDSetFont", |robios| robios.lcd_set_font(font, variation)))
}

#[unsafe(no_mangle)]
extern "C" fn LCDSetFontSize(size: c_int) -> c_int {
    code(enter("LCDSetFontSize", |robios| robios.lcd_set_font_size(size)))
}

#[unsafe(no_mangle)]
extern "C" fn LCDFontSize(size: c_int) -> c_int {
    LCDSetFontSize(size)
}

#[unsafe(no_mangle)]
extern "C" fn LCDSetMode(mode: c_int) -> c_int {
    code(enter("LCDSetMode", |robios| robios.lcd_set_mode(mode)))
}

#[unsafe(no_mangle)]
extern "C" fn LCDMenu(
    first: *const c_char,
    second: *const c_char,
    third: *const c_char,
    fourth: *const c_char,
) -> c_int {
    let labels = [first, second, third, fourth].map(|label| text(label).unwrap_or_default());
    code(enter("LCDMenu", |robios| robios.lcd_menu(labels)))
}

#[unsafe(no_mangle)]
extern "C" fn LCDMenuI(key: c_int, label: *const c_char, foreground: c_int, background: c_int) -> c_int {
    let label = text(label).unwrap_or_default();
    code(enter("LCDMenuI", |robios| robios.lcd_menu_i(key, &label, foreground, background)))
}

#[unsafe(no_mangle)]
extern "C" fn LCDGetSize(x: *mut c_int, y: *mut c_int) -> c_int {
    let found = enter("LCDGetSize", |robios| robios.lcd_get_size());
    code(found.filter(|&(width, height)| scatter([x, y], [width, height])).map(|_| ()))
}

#[unsafe(no_mangle)]
extern "C" fn LCDPixel(x: c_int, y: c_int, colour: c_int) -> c_int {
    code(enter("LCDPixel", |robios| robios.lcd_pixel(x, y, colour)))
}

#[unsafe(no_mangle)]
extern "C" fn LCDGetPixel(x: c_int, y: c_int) -> c_int {
    enter("LCDGetPixel", |robios| robios.lcd_get_pixel(x, y)).unwrap_or(0)
}

#[unsafe(no_mangle)]
extern "C" fn LCDLine(x1: c_int, y1: c_int, x2: c_int, y2: c_int, colour: c_int) -> c_int {
    code(enter("LCDLine", |robios| robios.lcd_line((x1, y1), (x2, y2), colour)))
}

#[unsafe(no_mangle)]
extern "C" fn LCDArea(x1: c_int, y1: c_int, x2: c_int, y2: c_int, colour: c_int, fill: c_int) -> c_int {
    code(enter("LCDArea", |robios| robios.lcd_area((x1, y1), (x2, y2), colour, fill != 0)))
}

#[unsafe(no_mangle)]
extern "C" fn LCDCircle(x: c_int, y: c_int, size: c_int, colour: c_int, fill: c_int) -> c_int {
    code(enter("LCDCircle", |robios| robios.lcd_circle((x, y), size, colour, fill != 0)))
}

#[unsafe(no_mangle)]
extern "C" fn LCDImageSize(resolution: c_int) -> c_int {
    code(enter("LCDImageSize", |robios| robios.lcd_image_size(resolution)))
}

#[unsafe(no_mangle)]
extern "C" fn LCDImageStart(x: c_int, y: c_int, width: c_int, height: c_int) -> c_int {
    code(enter("LCDImageStart", |robios| robios.lcd_image_start((x, y), width, height)))
}

/// Copies an image with `channels` bytes per pixel and shows it.
fn show(call: &'static str, image: *const u8, channels: usize, frame: fn(Vec<u8>) -> Frame) -> c_int {
    code(enter(call, |robios| {
        let (width, height) = robios.lcd_image_dimensions();
        // A null pointer gives an image that is too short, which is an error.
        let data = input(image, width * height * channels).map(<[u8]>::to_vec).unwrap_or_default();
        robios.lcd_image(frame(data))
    }))
}

#[unsafe(no_mangle)]
extern "C" fn LCDImage(image: *const u8) -> c_int {
    show("LCDImage", image, 3, Frame::Colour)
}

#[unsafe(no_mangle)]
extern "C" fn LCDImageGray(image: *const u8) -> c_int {
    show("LCDImageGray", image, 1, Frame::Gray)
}

#[unsafe(no_mangle)]
extern "C" fn LCDImageBinary(image: *const u8) -> c_int {
    show("LCDImageBinary", image, 1, Frame::Binary)
}

#[unsafe(no_mangle)]
extern "C" fn LCDRefresh() -> c_int {
    code(enter("LCDRefresh", |robios| robios.lcd_refresh()))
}
