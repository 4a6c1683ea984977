use std::fmt::Write;

use image::RgbImage;

use crate::geometry::{Pose, Twist, Vector3};
use crate::io::{
    Attitude, DisplayImage, DisplayOption, Fill, Font, Key, LidarScan, LidarSettings, Psd, RadioMessage,
    Resolution, Viewport,
};
use crate::world::Colour;

/// A running 64-bit FNV-1a digest (Fowler, Noll and Vo), equal on every platform.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Digest(pub(super) u64);

impl Digest {
    /// Empty digest: the 64-bit FNV-1a offset basis.
    pub(super) const EMPTY: Digest = Digest(0xcbf2_9ce4_8422_2325);

    pub(super) fn update(&mut self, bytes: impl IntoIterator<Item = u8>) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

/// Text of arguments and results. Equal values give equal text; floats have the fewest digits that parse back
/// to the same number.
pub(super) trait Token {
    fn put(&self, out: &mut String);
}

macro_rules! debug_tokens {
    ($($type:ty),*) => {
        $( impl Token for $type {
            fn put(&self, out: &mut String) {
                // Writing to a string cannot fail.
                let _ = write!(out, "{self:?}");
            }
        } )*
    };
}

debug_tokens!(
    f64,
    u8,
    u32,
    i32,
    i64,
    bool,
    &str,
    Vec<u32>,
    (i32, i32),
    [&str; 4],
    Key,
    Fill,
    DisplayOption,
    Resolution
);

macro_rules! list_tokens {
    ($($type:ty, $value:ident => [$($part:expr),*];)*) => {
        $( impl Token for $type {
            fn put(&self, out: &mut String) {
                let $value = self;
                put_list(out, &[$(&$part),*]);
            }
        } )*
    };
}

list_tokens! {
    Twist, t => [t.linear, t.angular];
    Pose, p => [p.x, p.y, p.heading];
    Vector3, v => [v.x, v.y, v.z];
    Attitude, a => [a.roll, a.pitch, a.yaw];
    LidarSettings, s => [s.field_of_view, s.tilt, Text(s.points)];
    Font, f => [Text(f.family), Text(f.style), f.size];
    Viewport, v => [v.corner, v.width, v.height];
    RadioMessage, m => [m.from, m.data.as_slice()];
}

/// A value in its `Debug` form.
struct Text<T>(T);

impl<T: std::fmt::Debug> Token for Text<T> {
    fn put(&self, out: &mut String) {
        let _ = write!(out, "{:?}", self.0);
    }
}

/// Several values in parentheses, which separate the arguments of a call from the parts of one.
fn put_list(out: &mut String, parts: &[&dyn Token]) {
    out.push('(');
    for (i, part) in parts.iter().enumerate() {
        out.push_str(if i == 0 { "" } else { ", " });
        part.put(out);
    }
    out.push(')');
}

impl Token for () {
    fn put(&self, out: &mut String) {
        out.push_str("ok");
    }
}

impl Token for Psd {
    fn put(&self, out: &mut String) {
        self.0.put(out);
    }
}

impl Token for Colour {
    fn put(&self, out: &mut String) {
        let _ = write!(out, "{self}");
    }
}

impl<T: Token> Token for Option<T> {
    fn put(&self, out: &mut String) {
        match self {
            Some(value) => value.put(out),
            None => out.push_str("none"),
        }
    }
}

impl Token for [u8] {
    fn put(&self, out: &mut String) {
        let _ = write!(out, "\"{}\"", self.escape_ascii());
    }
}

impl Token for &[u8] {
    fn put(&self, out: &mut String) {
        (**self).put(out);
    }
}

impl Token for RgbImage {
    fn put(&self, out: &mut String) {
        DisplayImage::Rgb(self).put(out);
    }
}

impl Token for DisplayImage<'_> {
    /// The kind of image, its size and a digest of its bytes.
    fn put(&self, out: &mut String) {
        let (kind, bytes) = match self {
            DisplayImage::Rgb(image) => ("rgb", image.as_raw()),
            DisplayImage::Gray(image) => ("gray", image.as_raw()),
            DisplayImage::Binary(image) => ("binary", image.as_raw()),
        };
        let (width, height) = self.dimensions();
        let mut digest = Digest::EMPTY;
        digest.update(bytes.iter().copied());
        let _ = write!(out, "{kind} {width}x{height} {:016x}", digest.0);
    }
}

/// The number of a scan's beams and a digest of its content, optionally followed by the whole scan.
pub(super) fn put_scan(out: &mut String, scan: &LidarScan, whole: bool) {
    let LidarScan { angle_min, angle_increment, range_max, mount, ranges } = scan;
    let head = [*angle_min, *angle_increment, *range_max, mount.x, mount.y, mount.heading];
    let mut digest = Digest::EMPTY;
    for &number in head.iter().chain(ranges) {
        // The bits of a NaN differ between processors.
        let number = if number.is_nan() { f64::NAN } else { number };
        digest.update(number.to_bits().to_le_bytes());
    }
    let _ = write!(out, "{} beams {:016x}", ranges.len(), digest.0);
    if whole {
        let _ = write!(out, " from {angle_min:?} by {angle_increment:?} to {range_max:?} at ");
        mount.put(out);
        let _ = write!(out, " {ranges:?}");
    }
}
