//! Image processing. Images have the size set by `CAMInit` or `IPSetSize`. Input is copied before output is
//! written, so that a program may use the same memory for both.

use std::ffi::{c_char, c_int};
use std::path::PathBuf;

use super::memory::{input, output, text};
use super::runtime::{code, enter};
use crate::robios::images::{self, Pnm, Size};
use crate::screen::colour;

/// Number of columns and rows of the images.
fn size(call: &'static str) -> Option<Size> {
    enter(call, |robios| robios.charge().map(|()| robios.image_size()))
}

/// Copies an image with `channels` bytes per pixel.
fn copied(image: *const u8, channels: usize, (width, height): Size) -> Option<Vec<u8>> {
    input(image, width * height * channels).map(<[u8]>::to_vec)
}

/// Applies a function from one image to another. With a null pointer nothing happens.
fn map(
    call: &'static str,
    (source, from): (*const u8, usize),
    (target, to): (*mut u8, usize),
    filter: fn(&[u8], &mut [u8], Size),
) {
    let Some(size) = size(call) else { return };
    let Some(image) = copied(source, from, size) else { return };
    let mut result = vec![0; size.0 * size.1 * to];
    filter(&image, &mut result, size);
    output(target, &result);
}

#[unsafe(no_mangle)]
extern "C" fn IPLaplace(gray: *const u8, edges: *mut u8) {
    map("IPLaplace", (gray, 1), (edges, 1), images::laplace);
}

#[unsafe(no_mangle)]
extern "C" fn IPSobel(gray: *const u8, edges: *mut u8) {
    map("IPSobel", (gray, 1), (edges, 1), images::sobel);
}

#[unsafe(no_mangle)]
extern "C" fn IPCol2Gray(image: *const u8, gray: *mut u8) {
    map("IPCol2Gray", (image, 3), (gray, 1), images::gray);
}

#[unsafe(no_mangle)]
extern "C" fn IPGray2Col(gray: *const u8, image: *mut u8) {
    map("IPGray2Col", (gray, 1), (image, 3), images::colour);
}

#[unsafe(no_mangle)]
extern "C" fn IPRGB2Col(red: *const u8, green: *const u8, blue: *const u8, image: *mut u8) {
    let Some(size) = size("IPRGB2Col") else { return };
    let [Some(r), Some(g), Some(b)] = [red, green, blue].map(|plane| copied(plane, 1, size)) else { return };
    let mut result = vec![0; 3 * size.0 * size.1];
    images::merge([&r, &g, &b], &mut result);
    output(image, &result);
}

#[unsafe(no_mangle)]
extern "C" fn IPCol2HSI(image: *const u8, hues: *mut u8, saturations: *mut u8, intensities: *mut u8) {
    let Some(size) = size("IPCol2HSI") else { return };
    let Some(image) = copied(image, 3, size) else { return };
    let mut planes = [(); 3].map(|()| vec![0; size.0 * size.1]);
    let [h, s, i] = &mut planes;
    images::split_hsi(&image, [h, s, i]);
    for (target, plane) in [hues, saturations, intensities].into_iter().zip(&planes) {
        output(target, plane);
    }
}

#[unsafe(no_mangle)]
extern "C" fn IPOverlay(base: *const u8, top: *const u8, image: *mut u8) {
    let Some(size) = size("IPOverlay") else { return };
    let [Some(base), Some(top)] = [base, top].map(|image| copied(image, 3, size)) else { return };
    let mut result = vec![0; 3 * size.0 * size.1];
    images::overlay(&base, &top, &mut result, size);
    output(image, &result);
}

#[unsafe(no_mangle)]
extern "C" fn IPOverlayGray(base: *const u8, marks: *const u8, mark: c_int, image: *mut u8) {
    let Some(size) = size("IPOverlayGray") else { return };
    let [Some(base), Some(marks)] = [base, marks].map(|image| copied(image, 1, size)) else { return };
    let mut result = vec![0; 3 * size.0 * size.1];
    images::overlay_gray(&base, &marks, colour(mark), &mut result, size);
    output(image, &result);
}

/// Returns 1 for a binary image of black (1) and white (0), 2 for grayscale, 3 for colour, -1 on failure.
#[unsafe(no_mangle)]
extern "C" fn IPReadFile(name: *const c_char, image: *mut u8) -> c_int {
    let Some((name, size)) = text(name).zip(size("IPReadFile")) else { return -1 };
    let (kind, data) = match images::read_file(&PathBuf::from(name), size) {
        Ok(Pnm::Binary(data)) => (1, data),
        Ok(Pnm::Gray(data)) => (2, data),
        Ok(Pnm::Colour(data)) => (3, data),
        Err(error) => {
            enter("IPReadFile", |_| Err::<(), _>(error));
            return -1;
        }
    };
    if output(image, &data) { kind } else { -1 }
}

fn write(call: &'static str, name: *const c_char, image: *const u8, channels: usize) -> c_int {
    let written = text(name).zip(size(call)).and_then(|(name, size)| {
        let data = copied(image, channels, size)?;
        enter(call, |_| images::write_file(&PathBuf::from(name), &data, size))
    });
    code(written)
}

#[unsafe(no_mangle)]
extern "C" fn IPWriteFile(name: *const c_char, image: *const u8) -> c_int {
    write("IPWriteFile", name, image, 3)
}

#[unsafe(no_mangle)]
extern "C" fn IPWriteFileGray(name: *const c_char, gray: *const u8) -> c_int {
    write("IPWriteFileGray", name, gray, 1)
}

#[unsafe(no_mangle)]
extern "C" fn IPPRGB2Col(red: u8, green: u8, blue: u8) -> c_int {
    c_int::from(red) << 16 | c_int::from(green) << 8 | c_int::from(blue)
}

fn channels(colour: c_int) -> [u8; 3] {
    [(colour >> 16) as u8, (colour >> 8) as u8, colour as u8]
}

#[unsafe(no_mangle)]
extern "C" fn IPPCol2RGB(colour: c_int, red: *mut u8, green: *mut u8, blue: *mut u8) {
    for (target, value) in [red, green, blue].into_iter().zip(channels(colour)) {
        output(target, &[value]);
    }
}

#[unsafe(no_mangle)]
extern "C" fn IPPCol2HSI(colour: c_int, hue: *mut u8, saturation: *mut u8, intensity: *mut u8) {
    let [red, green, blue] = channels(colour);
    IPPRGB2HSI(red, green, blue, hue, saturation, intensity);
}

#[unsafe(no_mangle)]
extern "C" fn IPPRGB2Hue(red: u8, green: u8, blue: u8) -> u8 {
    images::hue_of([red, green, blue])
}

#[unsafe(no_mangle)]
extern "C" fn IPPRGB2HSI(
    red: u8,
    green: u8,
    blue: u8,
    hue: *mut u8,
    saturation: *mut u8,
    intensity: *mut u8,
) {
    let values = images::hsi([red, green, blue]);
    for (target, value) in [hue, saturation, intensity].into_iter().zip(values) {
        output(target, &[value]);
    }
}
