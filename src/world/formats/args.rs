//! Reads the arguments of a line in sequence, in SI units.

use std::ops::RangeInclusive;

use super::error::{FormatError, Notes};
use super::lexer::{Line, Word, shown};
use super::limits::{MAX_DEGREES, MAX_METRES};
use super::number::{self, MILLI};
use crate::geometry::units;
use crate::world::{Colour, Place3};

/// A cursor over the words of a line.
#[derive(Debug)]
pub(super) struct Args<'l, 'a> {
    line: &'l Line<'a>,
    next: usize,
}

impl<'l, 'a> Args<'l, 'a> {
    /// Starts at the word after the keyword.
    pub(super) fn after_keyword(line: &'l Line<'a>) -> Self {
        Self { line, next: 1 }
    }

    /// Starts at the first word.
    pub(super) fn all(line: &'l Line<'a>) -> Self {
        Self { line, next: 0 }
    }

    /// Number of remaining words.
    pub(super) fn left(&self) -> usize {
        self.line.words.len() - self.next
    }

    /// The next word, without consuming it; `None` at the end.
    pub(super) fn peek(&self) -> Option<Word<'a>> {
        self.line.words.get(self.next).copied()
    }

    /// Number of consecutive remaining words that are numbers.
    pub(super) fn numbers_ahead(&self) -> usize {
        let words = &self.line.words[self.next..];
        words.iter().take_while(|w| !w.quoted && number::parse(w.text, 0).is_some()).count()
    }

    /// A word.
    pub(super) fn word(&mut self, what: &str) -> Result<Word<'a>, FormatError> {
        let word = self.peek().ok_or_else(|| self.line.error(self.next, what))?;
        self.next += 1;
        Ok(word)
    }

    /// A file name with an allowed extension. Blanks outside quotes are accepted with a warning.
    pub(super) fn path(
        &mut self,
        what: &str,
        endings: &[&str],
        notes: &mut Notes<'_>,
    ) -> Result<&'a str, FormatError> {
        let at = self.next;
        let word = self.word(what)?;
        if word.text.is_empty() {
            return Err(self.line.error(at, what));
        }
        let rest = self.line.rest(at);
        let one_name = !rest.contains(['"', '\'']) && ends_with_any(rest, endings);
        if self.left() > 0 && one_name && !ends_with_any(word.text, endings) {
            notes.warn(self.line.location(at), format!("{} has blanks; read as one file name", shown(rest)));
            self.next = self.line.words.len();
            return Ok(rest);
        }
        Ok(word.text)
    }

    /// A length or coordinate of any sign (m).
    pub(super) fn length(&mut self, what: &str) -> Result<f64, FormatError> {
        self.number(what, "in millimetres", MILLI, -MAX_METRES..=MAX_METRES)
    }

    /// A non-negative length (m).
    pub(super) fn size(&mut self, what: &str) -> Result<f64, FormatError> {
        self.number(what, "in millimetres", MILLI, 0.0..=MAX_METRES)
    }

    /// A positive length (m).
    pub(super) fn positive_size(&mut self, what: &str) -> Result<f64, FormatError> {
        self.number(what, "in millimetres", MILLI, f64::MIN_POSITIVE..=MAX_METRES)
    }

    /// A direction from -180 to 180 degrees.
    pub(super) fn direction_degrees(&mut self, what: &str) -> Result<f64, FormatError> {
        self.degrees(what, number::ANGLES).map(number::normalize_degrees)
    }

    /// A direction from -pi to pi (rad).
    pub(super) fn direction(&mut self, what: &str) -> Result<f64, FormatError> {
        self.direction_degrees(what).map(units::from_deg)
    }

    /// An angle in degrees within a range.
    pub(super) fn degrees(&mut self, what: &str, range: RangeInclusive<f64>) -> Result<f64, FormatError> {
        self.number(what, "in degrees", 0, range)
    }

    /// A number without a unit, or in the SI unit named by `what`.
    pub(super) fn plain(&mut self, what: &str, range: RangeInclusive<f64>) -> Result<f64, FormatError> {
        self.number(what, "", 0, range)
    }

    /// An integer.
    pub(super) fn count(&mut self, what: &str, range: RangeInclusive<u32>) -> Result<u32, FormatError> {
        let at = self.next;
        let expected = format!("{what}, a whole number from {} to {}", range.start(), range.end());
        let value = self.plain(&expected, f64::MIN..=f64::MAX)?;
        let whole = value as u32;
        if f64::from(whole) != value || !range.contains(&whole) {
            return Err(self.line.error(at, expected));
        }
        Ok(whole)
    }

    /// Three channels from 0 to 255; fractions are rounded.
    pub(super) fn colour(&mut self, what: &str) -> Result<Colour, FormatError> {
        let mut channel = |name| self.channel(&format!("{what}'s {name}"));
        Ok(Colour::new(channel("red")?, channel("green")?, channel("blue")?))
    }

    /// A number from 0 to 255.
    pub(super) fn channel(&mut self, what: &str) -> Result<u8, FormatError> {
        Ok(self.plain(what, 0.0..=255.0)?.round() as u8)
    }

    /// Warns about remaining words.
    pub(super) fn finish(self, notes: &mut Notes<'_>) {
        if self.left() > 0 {
            let extra = shown(self.line.rest(self.next));
            notes.warn(
                self.line.location(self.next),
                format!("{extra} is more than belongs in this line; ignored"),
            );
        }
    }

    fn number(
        &mut self,
        what: &str,
        unit: &str,
        power: i32,
        range: RangeInclusive<f64>,
    ) -> Result<f64, FormatError> {
        let at = self.next;
        let what = [what, unit].join(" ");
        let what = what.trim_end();
        let word = self.word(what)?;
        let value = number::parse(word.text, power)
            .ok_or_else(|| self.line.error(at, format!("{what}, a number")))?;
        if !range.contains(&value) {
            return Err(self.line.error(at, format!("{what}, {}", shown_range(&range, power))));
        }
        Ok(value)
    }
}

fn ends_with_any(name: &str, endings: &[&str]) -> bool {
    let name = name.to_ascii_lowercase();
    endings.iter().any(|ending| name.ends_with(ending))
}

fn shown_range(range: &RangeInclusive<f64>, power: i32) -> String {
    let high = number::print(*range.end(), power);
    match *range.start() {
        low if low == f64::MIN_POSITIVE => format!("more than 0 and at most {high}"),
        low if low == -MAX_METRES || low == -MAX_DEGREES => format!("at most {high} either way"),
        low => format!("from {} to {high}", number::print(low, power)),
    }
}

/// Points and sizes of 3D models, whose axes point right, up and forwards.
impl Args<'_, '_> {
    /// A point: right, up, forward.
    pub(super) fn model_place(&mut self, what: &str) -> Result<Place3, FormatError> {
        let [right, up, forward] = self.three(what, Self::length)?;
        Ok([forward, -right, up])
    }

    /// Positive sizes: right, up, forward.
    pub(super) fn model_size(&mut self, what: &str) -> Result<Place3, FormatError> {
        let [right, up, forward] = self.three(what, Self::positive_size)?;
        Ok([forward, right, up])
    }

    fn three(
        &mut self,
        what: &str,
        mut read: impl FnMut(&mut Self, &str) -> Result<f64, FormatError>,
    ) -> Result<[f64; 3], FormatError> {
        let mut next = |axis| read(self, &format!("{what} {axis}"));
        Ok([next("x")?, next("y")?, next("z")?])
    }

    /// A non-empty name.
    pub(super) fn name(&mut self, what: &str) -> Result<String, FormatError> {
        let at = self.next;
        let word = self.word(what)?;
        if word.text.is_empty() { Err(self.line.error(at, what)) } else { Ok(word.text.into()) }
    }
}
