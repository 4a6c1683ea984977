//! The wire format of Protocol Buffers, as far as needed.

use crate::geometry::math;

/// Appends fields of a message to a buffer.
#[derive(Debug)]
pub(super) struct Fields<'a>(pub(super) &'a mut Vec<u8>);

/// Protobuf's wire type of integers.
const VARINT: u32 = 0;
/// Wire type of eight-byte numbers.
const FIXED64: u32 = 1;
/// Wire type of length-delimited bytes.
const LENGTH: u32 = 2;
/// Wire type of four-byte numbers.
const FIXED32: u32 = 5;

/// The bit patterns of NaN differ between processors; recordings use this one.
const NAN: u64 = 0x7ff8_0000_0000_0000;

pub(super) fn bits(value: f64) -> u64 {
    if value.is_nan() { NAN } else { value.to_bits() }
}

fn varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// Maps small numbers of either sign to small numbers.
fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

fn unzigzag(value: u64) -> i64 {
    (value >> 1) as i64 ^ -((value & 1) as i64)
}

impl Fields<'_> {
    fn key(&mut self, field: u32, kind: u32) {
        varint(self.0, u64::from(field << 3 | kind));
    }

    pub(super) fn integer(&mut self, field: u32, value: u64) {
        self.key(field, VARINT);
        varint(self.0, value);
    }

    pub(super) fn double(&mut self, field: u32, value: f64) {
        self.key(field, FIXED64);
        self.0.extend_from_slice(&bits(value).to_le_bytes());
    }

    pub(super) fn fixed32(&mut self, field: u32, value: u32) {
        self.key(field, FIXED32);
        self.0.extend_from_slice(&value.to_le_bytes());
    }

    pub(super) fn text(&mut self, field: u32, value: &str) {
        self.bytes(field, value.as_bytes());
    }

    pub(super) fn bytes(&mut self, field: u32, value: &[u8]) {
        self.key(field, LENGTH);
        varint(self.0, value.len() as u64);
        self.0.extend_from_slice(value);
    }

    /// A packed list of doubles; omitted if empty.
    pub(super) fn doubles(&mut self, field: u32, values: &[f64]) {
        if values.is_empty() {
            return;
        }
        self.key(field, LENGTH);
        varint(self.0, 8 * values.len() as u64);
        self.0.reserve(8 * values.len());
        for &value in values {
            self.0.extend_from_slice(&bits(value).to_le_bytes());
        }
    }

    /// A packed list of signed integers; omitted if empty.
    pub(super) fn integers(&mut self, field: u32, values: &[i64]) {
        if !values.is_empty() {
            self.message(field, |list| values.iter().for_each(|&value| varint(list.0, zigzag(value))));
        }
    }

    /// A nested message.
    pub(super) fn message(&mut self, field: u32, fill: impl FnOnce(&mut Fields<'_>)) {
        self.key(field, LENGTH);
        let start = self.0.len();
        self.0.push(0);
        fill(&mut Fields(self.0));
        let length = self.0.len() - start - 1;
        if let Ok(short @ 0..0x80) = u8::try_from(length) {
            self.0[start] = short;
            return;
        }
        // The length takes more than the one byte reserved for it: the content moves up.
        let mut head = Vec::with_capacity(5);
        varint(&mut head, length as u64);
        self.0.splice(start..=start, head);
    }

    /// A `google.protobuf.Timestamp` or `Duration`.
    pub(super) fn time(&mut self, field: u32, nanoseconds: u64) {
        self.message(field, |time| {
            time.integer(1, nanoseconds / 1_000_000_000);
            time.integer(2, nanoseconds % 1_000_000_000);
        });
    }

    /// A `foxglove.Vector3` or `Point3`.
    pub(super) fn vector(&mut self, field: u32, x: f64, y: f64, z: f64) {
        self.message(field, |vector| {
            vector.double(1, x);
            vector.double(2, y);
            vector.double(3, z);
        });
    }

    /// A `foxglove.Quaternion` about the vertical axis.
    pub(super) fn heading(&mut self, field: u32, heading: f64) {
        let (sin, cos) = math::sin_cos(0.5 * heading);
        self.quaternion(field, [0.0, 0.0, sin, cos]);
    }

    /// A `foxglove.Quaternion`: its three imaginary parts and the real one.
    pub(super) fn quaternion(&mut self, field: u32, parts: [f64; 4]) {
        self.message(field, |quaternion| {
            for (number, part) in (1..).zip(parts) {
                quaternion.double(number, part);
            }
        });
    }
}

/// A field of a message being read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Field<'a> {
    Integer(u64),
    Fixed64(u64),
    Fixed32(u32),
    Bytes(&'a [u8]),
}

/// Reads the fields of a message one by one. Ends at the first invalid byte and reports it.
#[derive(Debug, Clone)]
pub(super) struct Reading<'a> {
    rest: &'a [u8],
    pub(super) broken: bool,
}

impl<'a> Reading<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, broken: false }
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let (&byte, rest) = self.rest.split_first()?;
            self.rest = rest;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }

    fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let (head, rest) = self.rest.split_at_checked(length)?;
        self.rest = rest;
        Some(head)
    }

    fn field(&mut self) -> Option<(u32, Field<'a>)> {
        let key = u32::try_from(self.varint()?).ok()?;
        let value = match key & 7 {
            VARINT => Field::Integer(self.varint()?),
            FIXED64 => Field::Fixed64(u64::from_le_bytes(self.take(8)?.try_into().ok()?)),
            LENGTH => {
                let length = usize::try_from(self.varint()?).ok()?;
                Field::Bytes(self.take(length)?)
            }
            FIXED32 => Field::Fixed32(u32::from_le_bytes(self.take(4)?.try_into().ok()?)),
            _ => return None,
        };
        Some((key >> 3, value))
    }
}

impl<'a> Iterator for Reading<'a> {
    type Item = (u32, Field<'a>);

    fn next(&mut self) -> Option<Self::Item> {
        if self.broken || self.rest.is_empty() {
            return None;
        }
        let field = self.field();
        self.broken = field.is_none();
        field
    }
}

/// Content of the first length-delimited field with a number.
pub(super) fn bytes_of(message: &[u8], number: u32) -> Option<&[u8]> {
    Reading::new(message).find_map(|(found, field)| match field {
        Field::Bytes(bytes) if found == number => Some(bytes),
        _ => None,
    })
}

/// A packed list of doubles.
pub(super) fn doubles(bytes: &[u8]) -> Option<impl Iterator<Item = f64> + '_> {
    let (whole, rest) = bytes.as_chunks::<8>();
    rest.is_empty().then(|| whole.iter().map(|&bytes| f64::from_le_bytes(bytes)))
}

/// A packed list of signed integers.
pub(super) fn integers(bytes: &[u8]) -> Option<Vec<i64>> {
    let mut reading = Reading::new(bytes);
    let mut values = Vec::new();
    while !reading.rest.is_empty() {
        values.push(unzigzag(reading.varint()?));
    }
    Some(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn what_is_written_is_read(
            integer: u64, double: f64, text in ".{0,300}", list: Vec<i64>, numbers: Vec<f64>,
        ) {
            let mut out = Vec::new();
            let mut fields = Fields(&mut out);
            fields.integer(1, integer);
            fields.double(2, double);
            fields.message(3, |inner| {
                inner.text(1, &text);
                inner.integers(2, &list);
            });
            fields.doubles(4, &numbers);
            fields.fixed32(20, integer as u32);
            let mut reading = Reading::new(&out);
            prop_assert_eq!(reading.next(), Some((1, Field::Integer(integer))));
            prop_assert_eq!(reading.next(), Some((2, Field::Fixed64(bits(double)))));
            let Some((3, Field::Bytes(inner))) = reading.next() else { panic!() };
            prop_assert_eq!(bytes_of(inner, 1), Some(text.as_bytes()));
            prop_assert_eq!(integers(bytes_of(inner, 2).unwrap_or_default()), Some(list));
            let same: Vec<u64> = doubles(bytes_of(&out, 4).unwrap_or_default()).unwrap().map(bits).collect();
            prop_assert_eq!(same, numbers.iter().copied().map(bits).collect::<Vec<_>>());
        }

        #[test]
        fn any_bytes_come_to_an_end(bytes: Vec<u8>) {
            let mut reading = Reading::new(&bytes);
            let fields = reading.by_ref().count();
            prop_assert!(fields <= bytes.len());
            let _ = (integers(&bytes), doubles(&bytes).map(Iterator::count));
        }
    }
}
