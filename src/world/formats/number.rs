//! Decimal numbers, read and written without loss.
//!
//! Conversion between millimetres and metres shifts the decimal point of the text instead of dividing: `22.7`
//! is the `f64` nearest to 0.0227, and every `f64` in metres has a text in millimetres that reads back as the
//! same value.

use std::ops::RangeInclusive;

use winnow::ascii::{digit0, digit1};
use winnow::combinator::{alt, opt};
use winnow::prelude::*;
use winnow::token::one_of;

use super::limits::MAX_DEGREES;
use crate::geometry::units;

/// Power of ten from millimetres to metres.
pub(super) const MILLI: i32 = -3;

/// Reads a decimal number times a power of ten. `None` if it is not a number; infinite on overflow.
pub(super) fn parse(text: &str, power: i32) -> Option<f64> {
    let (mantissa, exponent) = decimal.parse(text).ok()?;
    // More digits than any exponent needs; the value is zero or infinite anyway.
    let exponent =
        exponent.map_or(0, |e| e.parse::<i64>().unwrap_or(if e.starts_with('-') { -99_999 } else { 99_999 }));
    let exponent = exponent.clamp(-99_999, 99_999) + i64::from(power);
    format!("{mantissa}e{exponent}").parse().ok()
}

fn decimal<'s>(input: &mut &'s str) -> ModalResult<(&'s str, Option<&'s str>)> {
    let sign = || opt(one_of(['+', '-']));
    let digits = alt(((digit1, opt(('.', digit0))).void(), ('.', digit1).void()));
    let mantissa = (sign(), digits).take();
    let exponent = (one_of(['e', 'E']), (sign(), digit1).take()).map(|(_, digits)| digits);
    (mantissa, opt(exponent)).parse_next(input)
}

/// Whether a word is intended as a number, even a malformed one; world files distinguish walls from keywords
/// by it.
pub(super) fn looks_like_number(word: &str) -> bool {
    let bare = word.trim_start_matches(['+', '-']);
    bare.strip_prefix('.').unwrap_or(bare).starts_with(|c: char| c.is_ascii_digit())
        || ["nan", "inf", "infinity"].iter().any(|special| bare.eq_ignore_ascii_case(special))
}

/// Shortest text that [`parse`] reads back as `value` for the same power.
pub(super) fn print(value: f64, power: i32) -> String {
    let scientific = format!("{value:e}");
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return scientific };
    let exponent = exponent.parse::<i32>().unwrap_or(0) - power;
    let (sign, mantissa) = mantissa.strip_prefix('-').map_or(("", mantissa), |rest| ("-", rest));
    let digits = mantissa.replace('.', "");
    if digits == "0" {
        return "0".into();
    }
    let point = exponent + 1;
    let count = digits.len() as i32;
    match point {
        _ if !(-5..=20).contains(&point) => format!("{sign}{mantissa}e{exponent}"),
        ..=0 => format!("{sign}0.{}{digits}", "0".repeat(-point as usize)),
        _ if point >= count => format!("{sign}{digits}{}", "0".repeat((point - count) as usize)),
        _ => {
            let (whole, fraction) = digits.split_at(point as usize);
            format!("{sign}{whole}.{fraction}")
        }
    }
}

/// A length in metres as text in millimetres.
pub(super) fn millimetres(metres: f64) -> String {
    print(metres, MILLI)
}

/// An angle in radians as text in degrees.
///
/// Angles read from text are written as text for the same radians; others may change by one unit in the last
/// place, because not every angle in radians has an `f64` in degrees.
pub(super) fn degrees(radians: f64) -> String {
    let exact = units::to_deg(radians);
    let rounded: f64 = format!("{exact:.11e}").parse().unwrap_or(exact);
    let (mut up, mut down) = (exact, exact);
    let mut candidates = vec![rounded, exact];
    for _ in 0..4 {
        (up, down) = (up.next_up(), down.next_down());
        candidates.extend([up, down]);
    }
    let best = candidates.into_iter().find(|&d| units::from_deg(d) == radians).unwrap_or(exact);
    print(best, 0)
}

/// The number that gives `value` after subtraction of `shift`, so that it survives writing and reading.
pub(super) fn undo_shift(value: f64, shift: f64) -> f64 {
    let sum = value + shift;
    let (mut up, mut down) = (sum, sum);
    let mut candidates = vec![sum];
    for _ in 0..8 {
        (up, down) = (up.next_up(), down.next_down());
        candidates.extend([up, down]);
    }
    candidates.into_iter().find(|&candidate| candidate - shift == value).unwrap_or(sum)
}

/// Range of angles in files (degrees).
pub(super) const ANGLES: RangeInclusive<f64> = -MAX_DEGREES..=MAX_DEGREES;

/// The same direction from -180 to 180 degrees. Exact, because degrees are multiples of small binary
/// fractions.
pub(super) fn normalize_degrees(degrees: f64) -> f64 {
    if (-180.0..=180.0).contains(&degrees) { degrees } else { degrees - 360.0 * (degrees / 360.0).round() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn millimetres_move_the_point() {
        for (text, metres) in
            [("22.7", 0.0227), ("-360", -0.36), ("1e3", 1.0), ("+.5", 0.0005), ("7.", 0.007)]
        {
            assert_eq!(parse(text, MILLI), Some(metres), "{text}");
        }
        assert_eq!(millimetres(0.0227), "22.7");
        assert_eq!(millimetres(-0.36), "-360");
        assert_eq!(millimetres(0.0), "0");
        assert_eq!(millimetres(12.5), "12500");
    }

    #[test]
    fn what_is_no_number_is_refused() {
        for text in ["", "-", ".", "1.2.3", "1e", "0x10", "nan", "inf", "1_000", " 1", "1mm", "--1"] {
            assert_eq!(parse(text, 0), None, "{text}");
        }
        assert_eq!(parse("1e999999999999999999999", 0), Some(f64::INFINITY));
        assert_eq!(parse("1e-999999999999999999999", 0), Some(0.0));
    }

    #[test]
    fn right_angles_print_as_such() {
        use std::f64::consts::{FRAC_PI_2, PI};
        assert_eq!(degrees(FRAC_PI_2), "90");
        assert_eq!(degrees(-PI), "-180");
        assert_eq!(degrees(units::from_deg(22.5)), "22.5");
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn any_number_survives_in_millimetres(value in proptest::num::f64::NORMAL | proptest::num::f64::ZERO) {
            prop_assert_eq!(parse(&millimetres(value), MILLI), Some(value));
        }

        #[test]
        fn any_angle_in_degrees_survives(value in -1e6..1e6f64) {
            let angle = units::from_deg(normalize_degrees(value));
            let text = degrees(angle);
            prop_assert_eq!(parse(&text, 0).map(units::from_deg), Some(angle));
        }
    }
}
