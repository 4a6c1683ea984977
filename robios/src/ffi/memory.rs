//! Access to the program's memory: its pointers are dereferenced only here.

use std::ffi::{CStr, c_char};

/// A zero-terminated text: UTF-8, otherwise Latin-1. `None` for a null pointer.
pub(super) fn text(pointer: *const c_char) -> Option<String> {
    bytes(pointer).map(|bytes| match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    })
}

/// The bytes of a zero-terminated text, without the zero.
pub(super) fn bytes<'a>(pointer: *const c_char) -> Option<&'a [u8]> {
    if pointer.is_null() {
        return None;
    }
    // SAFETY: the pointer is not null, and the program passes a zero-terminated text.
    Some(unsafe { CStr::from_ptr(pointer) }.to_bytes())
}

/// `count` values at a pointer; `None` if it is null.
pub(super) fn input<'a, T>(pointer: *const T, count: usize) -> Option<&'a [T]> {
    // SAFETY: the pointer is not null, and the program passes as many values as the function takes.
    (!pointer.is_null()).then(|| unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// Copies values to a pointer. Returns `false` if it is null.
pub(super) fn output<T: Copy>(pointer: *mut T, values: &[T]) -> bool {
    if pointer.is_null() {
        return false;
    }
    // SAFETY: the pointer is not null, the program has room for as many values as the function writes, and
    // the values do not overlap with it.
    unsafe { std::ptr::copy_nonoverlapping(values.as_ptr(), pointer, values.len()) };
    true
}

/// Writes each value to its own pointer, unless one of these is null. Returns whether it has written.
pub(super) fn scatter<const N: usize>(places: [*mut i32; N], values: [i32; N]) -> bool {
    if places.iter().any(|place| place.is_null()) {
        return false;
    }
    places.into_iter().zip(values).all(|(place, value)| output(place, &[value]))
}

/// Writes a zero-terminated text, truncated to `room` bytes.
pub(super) fn output_text(pointer: *mut c_char, text: &[u8], room: usize) -> bool {
    let mut line: Vec<c_char> =
        text.iter().take(room.saturating_sub(1)).map(|&byte| byte as c_char).collect();
    line.push(0);
    output(pointer, &line)
}
