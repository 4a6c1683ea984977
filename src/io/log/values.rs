use image::RgbImage;
use nalgebra::{Quaternion, UnitQuaternion};

use super::wire::{self, Field, Fields, Reading};
use crate::geometry::{Point3, Pose, Pose3, Twist, Vector3};
use crate::io::{
    Attitude, DisplayImage, DisplayOption, Fill, Font, FontFamily, FontStyle, Key, LidarSettings, Mishap,
    Psd, RadioMessage, Resolution, TruthInSpace, Viewport,
};
use crate::world::Colour;

/// Arguments or results of a call, sorted by type: the message `roverlab.Values`.
///
/// A compound value is stored as its parts, in the order of the public types' fields. An option is a 0, or a
/// 1 and its value; the variants of an enumeration are numbered from 0.
#[derive(Debug, Clone, Default)]
pub(super) struct Values {
    pub(super) numbers: Vec<f64>,
    pub(super) integers: Vec<i64>,
    pub(super) texts: Vec<String>,
    pub(super) data: Vec<u8>,
}

/// Compares bits: NaN equals itself, and the two zeros differ.
impl PartialEq for Values {
    fn eq(&self, other: &Self) -> bool {
        let bits = |values: &Self| values.numbers.iter().copied().map(wire::bits).collect::<Vec<_>>();
        self.integers == other.integers
            && self.texts == other.texts
            && self.data == other.data
            && bits(self) == bits(other)
    }
}

impl Values {
    pub(super) fn clear(&mut self) {
        self.numbers.clear();
        self.integers.clear();
        self.texts.clear();
        self.data.clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.numbers.is_empty() && self.integers.is_empty() && self.texts.is_empty() && self.data.is_empty()
    }

    /// The values of one argument or result.
    pub(super) fn of(value: &impl Put) -> Self {
        let mut values = Self::default();
        value.put(&mut values);
        values
    }

    /// Appends the values as a field of a message; nothing if empty.
    pub(super) fn write(&self, out: &mut Fields<'_>, field: u32) {
        if self.is_empty() {
            return;
        }
        out.message(field, |values| {
            values.doubles(1, &self.numbers);
            values.integers(2, &self.integers);
            for text in &self.texts {
                values.text(3, text);
            }
            if !self.data.is_empty() {
                values.bytes(4, &self.data);
            }
        });
    }

    /// `None` if the message contains no values.
    pub(super) fn read(message: &[u8]) -> Option<Self> {
        let mut values = Self::default();
        let mut reading = Reading::new(message);
        for (number, field) in reading.by_ref() {
            match (number, field) {
                (1, Field::Bytes(list)) => values.numbers.extend(wire::doubles(list)?),
                (2, Field::Bytes(list)) => values.integers.extend(wire::integers(list)?),
                (3, Field::Bytes(text)) => values.texts.push(str::from_utf8(text).ok()?.to_owned()),
                (4, Field::Bytes(data)) => values.data.extend_from_slice(data),
                _ => {}
            }
        }
        (!reading.broken).then_some(values)
    }

    /// Text of the values, for messages.
    pub(super) fn shown(&self) -> String {
        let numbers = self.numbers.iter().map(|number| format!("{number:?}"));
        let integers = self.integers.iter().map(ToString::to_string);
        let texts = self.texts.iter().map(|text| format!("{text:?}"));
        let mut parts: Vec<String> = numbers.chain(integers).chain(texts).collect();
        match self.data.len() {
            0 => {}
            1..=16 => parts.push(format!("\"{}\"", self.data.escape_ascii())),
            length => parts.push(format!("{length} bytes {:08x}", crc32fast::hash(&self.data))),
        }
        parts.join(", ")
    }

    /// Converts the values back.
    pub(super) fn take<T: Take>(&self) -> Option<T> {
        T::take(&mut Taking {
            numbers: self.numbers.iter(),
            integers: self.integers.iter(),
            texts: self.texts.iter(),
            data: Some(&self.data),
        })
    }
}

/// A possible argument or result.
pub(super) trait Put {
    fn put(&self, out: &mut Values);
}

/// A value that can be read back from a result.
pub(super) trait Take: Sized {
    fn take(from: &mut Taking<'_>) -> Option<Self>;
}

/// Iterators over values being read back.
#[derive(Debug)]
pub(super) struct Taking<'a> {
    numbers: std::slice::Iter<'a, f64>,
    integers: std::slice::Iter<'a, i64>,
    texts: std::slice::Iter<'a, String>,
    data: Option<&'a [u8]>,
}

impl Put for f64 {
    fn put(&self, out: &mut Values) {
        out.numbers.push(*self);
    }
}

impl Take for f64 {
    fn take(from: &mut Taking<'_>) -> Option<Self> {
        from.numbers.next().copied()
    }
}

macro_rules! integers {
    ($($type:ty),*) => { $(
        impl Put for $type {
            fn put(&self, out: &mut Values) {
                out.integers.push(i64::from(*self));
            }
        }

        impl Take for $type {
            fn take(from: &mut Taking<'_>) -> Option<Self> {
                Self::try_from(*from.integers.next()?).ok()
            }
        }
    )* };
}

integers!(u8, u16, u32, i32, i64);

impl Put for usize {
    fn put(&self, out: &mut Values) {
        out.integers.push(*self as i64);
    }
}

impl Take for usize {
    fn take(from: &mut Taking<'_>) -> Option<Self> {
        Self::try_from(*from.integers.next()?).ok()
    }
}

impl Put for bool {
    fn put(&self, out: &mut Values) {
        out.integers.push(i64::from(*self));
    }
}

impl Take for bool {
    fn take(from: &mut Taking<'_>) -> Option<Self> {
        match from.integers.next()? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }
}

impl Put for &str {
    fn put(&self, out: &mut Values) {
        out.texts.push((*self).to_owned());
    }
}

impl Take for String {
    fn take(from: &mut Taking<'_>) -> Option<Self> {
        from.texts.next().cloned()
    }
}

impl Put for [u8] {
    fn put(&self, out: &mut Values) {
        out.data.extend_from_slice(self);
    }
}

impl Put for &[u8] {
    fn put(&self, out: &mut Values) {
        (**self).put(out);
    }
}

/// A call has at most one block of bytes.
struct Bytes(Vec<u8>);

impl Take for Bytes {
    fn take(from: &mut Taking<'_>) -> Option<Self> {
        from.data.take().map(|data| Self(data.to_vec()))
    }
}

impl<T: Put> Put for Option<T> {
    fn put(&self, out: &mut Values) {
        self.is_some().put(out);
        if let Some(value) = self {
            value.put(out);
        }
    }
}

impl<T: Take> Take for Option<T> {
    fn take(from: &mut Taking<'_>) -> Option<Self> {
        if bool::take(from)? { T::take(from).map(Some) } else { Some(None) }
    }
}

impl Put for Vec<u32> {
    fn put(&self, out: &mut Values) {
        for item in self {
            item.put(out);
        }
    }
}

impl Take for Vec<u32> {
    /// All remaining integers.
    fn take(from: &mut Taking<'_>) -> Option<Self> {
        from.integers.by_ref().map(|&item| u32::try_from(item).ok()).collect()
    }
}

impl Put for [&str; 4] {
    fn put(&self, out: &mut Values) {
        for item in self {
            item.put(out);
        }
    }
}

/// Values stored as their parts.
macro_rules! compounds {
    ($($type:ty: $value:ident => [$($part:expr),*], [$($taken:ident),*] => $made:expr;)*) => { $(
        impl Put for $type {
            fn put(&self, out: &mut Values) {
                let $value = self;
                let _ = &$value;
                $( $part.put(out); )*
                let _ = out;
            }
        }

        impl Take for $type {
            fn take(from: &mut Taking<'_>) -> Option<Self> {
                $( let $taken = Take::take(from)?; )*
                let _ = from;
                Some($made)
            }
        }
    )* };
}

/// The numbers of mishaps in recordings; 0 is none.
const MISHAPS: [Mishap; 5] = [Mishap::Tipped, Mishap::Fell, Mishap::Stuck, Mishap::Drowned, Mishap::Broken];

fn mishap_number(mishap: Mishap) -> u8 {
    MISHAPS.iter().position(|&known| known == mishap).map_or(0, |index| index as u8 + 1)
}

fn mishap_of(number: u8) -> Option<Mishap> {
    MISHAPS.get(usize::from(number.checked_sub(1)?)).copied()
}

compounds! {
    (): v => [], [] => ();
    (i32, i32): v => [v.0, v.1], [a, b] => (a, b);
    Twist: v => [v.linear, v.angular], [linear, angular] => Twist::new(linear, angular);
    Pose: v => [v.x, v.y, v.heading], [x, y, heading] => Pose::new(x, y, heading);
    Vector3: v => [v.x, v.y, v.z], [x, y, z] => Vector3::new(x, y, z);
    Attitude: v => [v.roll, v.pitch, v.yaw], [roll, pitch, yaw] => Attitude { roll, pitch, yaw };
    TruthInSpace: v => [v.pose.position.x, v.pose.position.y, v.pose.position.z, v.pose.attitude.i, v.pose.attitude.j, v.pose.attitude.k,
            v.pose.attitude.w, v.mishap.map_or(0, mishap_number)],
        [x, y, z, i, j, k, w, mishap] => TruthInSpace {
            pose: Pose3::new(Point3::new(x, y, z), unit([w, i, j, k])?),
            mishap: mishap_of(mishap),
        };
    Psd: v => [v.0], [number] => Psd(number);
    Colour: v => [v.red, v.green, v.blue], [red, green, blue] => Colour::new(red, green, blue);
    LidarSettings: v => [v.field_of_view, v.tilt, v.points],
        [field_of_view, tilt, points] => LidarSettings { field_of_view, tilt, points };
    Font: v => [v.family, v.style, v.size], [family, style, size] => Font { family, style, size };
    Viewport: v => [v.corner, v.width, v.height],
        [corner, width, height] => Viewport { corner, width, height };
    RadioMessage: v => [v.from, v.data.as_slice()],
        [from, data] => RadioMessage { from, data: Bytes::into_vec(data) };
    RgbImage: v => [v.width(), v.height(), v.as_raw().as_slice()],
        [width, height, data] => image(width, height, Bytes::into_vec(data))?;
}

/// A rotation from its quaternion; `None` if it is not a rotation.
fn unit([w, i, j, k]: [f64; 4]) -> Option<UnitQuaternion<f64>> {
    let quaternion = Quaternion::new(w, i, j, k);
    ((quaternion.norm() - 1.0).abs() < 1e-6).then(|| UnitQuaternion::new_unchecked(quaternion))
}

impl Bytes {
    fn into_vec(self) -> Vec<u8> {
        self.0
    }
}

/// An image from its bytes; `None` if their number does not match the size.
pub(super) fn image(width: u32, height: u32, data: Vec<u8>) -> Option<RgbImage> {
    let expected = u64::from(width).checked_mul(u64::from(height))?.checked_mul(3)?;
    (data.len() as u64 == expected).then(|| RgbImage::from_raw(width, height, data))?
}

/// Enumerations, numbered in the order of this list.
macro_rules! enumerations {
    ($($type:ty: [$($item:path),*];)*) => { $(
        impl Put for $type {
            fn put(&self, out: &mut Values) {
                let items = [$($item),*];
                // A variant missing from the list is read as unknown.
                out.integers.push(items.iter().position(|item| item == self).map_or(-1, |index| index as i64));
            }
        }

        impl Take for $type {
            fn take(from: &mut Taking<'_>) -> Option<Self> {
                let items = [$($item),*];
                items.get(usize::take(from)?).copied()
            }
        }
    )* };
}

enumerations! {
    Key: [Key::Key1, Key::Key2, Key::Key3, Key::Key4];
    Fill: [Fill::Outline, Fill::Solid];
    FontFamily: [FontFamily::Helvetica, FontFamily::Times, FontFamily::Courier];
    FontStyle: [FontStyle::Normal, FontStyle::Bold, FontStyle::Italic];
    DisplayOption: [
        DisplayOption::AutoRefresh, DisplayOption::Scrolling, DisplayOption::LineFeed, DisplayOption::Menu,
        DisplayOption::TransparentText, DisplayOption::InvertedForeground, DisplayOption::InvertedBackground
    ];
    Resolution: [
        Resolution::Qqvga, Resolution::Qvga, Resolution::Vga, Resolution::Cam1Mp, Resolution::CamHd,
        Resolution::Cam5Mp
    ];
}

impl Put for DisplayImage<'_> {
    /// The kind of image, its size and its bytes.
    fn put(&self, out: &mut Values) {
        let (kind, data) = match self {
            DisplayImage::Rgb(image) => (0, image.as_raw()),
            DisplayImage::Gray(image) => (1, image.as_raw()),
            DisplayImage::Binary(image) => (2, image.as_raw()),
        };
        let (width, height) = self.dimensions();
        out.integers.extend([kind, i64::from(width), i64::from(height)]);
        out.data.extend_from_slice(data);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;
    use proptest::prelude::*;

    fn survives<T: Put + Take + PartialEq + std::fmt::Debug>(value: &T) {
        let values = Values::of(value);
        let mut out = Vec::new();
        values.write(&mut Fields(&mut out), 1);
        let read = Values::read(wire::bytes_of(&out, 1).unwrap_or_default()).unwrap();
        assert_eq!(read, values);
        assert_eq!(read.take::<T>().as_ref(), Some(value));
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn values_survive(x: f64, n: i64, from: u32, data: Vec<u8>, peers: Vec<u32>) {
            prop_assume!(!x.is_nan());
            survives(&x);
            survives(&n);
            survives(&peers);
            survives(&RadioMessage { from, data });
            survives(&Some(Pose::new(x, -x, 0.5 * x)));
            survives(&Vector3::new(x, -x, 0.5 * x));
            let pose = Pose3::from_angles(Point3::new(x, 1.0, -x), 0.1, x % 1.0, 2.0);
            for mishap in [None, Some(Mishap::Fell), Some(Mishap::Drowned)] {
                survives(&TruthInSpace { pose, mishap });
            }
            survives(&Attitude { roll: x, pitch: -x, yaw: 0.5 * x });
            survives(&LidarSettings { field_of_view: x, tilt: -x, points: from as usize });
        }
    }

    #[test]
    fn each_kind_of_value_survives() {
        survives(&());
        survives(&true);
        survives(&None::<Colour>);
        survives(&Some(Colour::new(1, 2, 255)));
        survives(&Font { family: FontFamily::Courier, style: FontStyle::Italic, size: -3 });
        survives(&Viewport::default());
        survives(&RgbImage::from_fn(3, 2, |x, y| Rgb([x as u8, y as u8, 7])));
        Key::ALL.iter().for_each(survives);
        Resolution::ALL.iter().for_each(survives);
    }

    #[test]
    fn values_of_another_kind_are_none() {
        assert_eq!(Values::of(&2.0).take::<bool>(), None);
        assert_eq!(Values::of(&2_i64).take::<bool>(), None);
        assert_eq!(Values::of(&4_i64).take::<Key>(), None);
        assert_eq!(Values { integers: vec![3, 2], ..Values::default() }.take::<RgbImage>(), None);
    }

    #[test]
    fn what_is_no_number_equals_itself() {
        assert_eq!(Values::of(&f64::NAN), Values::of(&-f64::NAN));
        assert_ne!(Values::of(&0.0), Values::of(&-0.0));
    }
}
