//! The lines of a world's water.

use std::fmt::{Result as Written, Write as _};
use std::str::FromStr;

use super::args::Args;
use super::error::FormatError;
use super::lexer::{self, Line};
use super::number::{self, degrees, millimetres};
use super::source::check_length;
use crate::geometry::Vector;
use crate::world::{Water, Waves};

impl FromStr for Water {
    type Err = FormatError;

    /// Reads the lines of a world's file that describe its water.
    ///
    /// ```
    /// use roverlab::world::Water;
    /// let water: Water = "current 100 0\nturbidity 0.5".parse()?;
    /// assert_eq!((water.current[0].1.x, water.turbidity), (0.1, 0.5));
    /// let error = "current fast".parse::<Water>().unwrap_err().to_string();
    /// assert!(error.starts_with("water:1:9: found `fast`; expected the current's speed along x"));
    /// # Ok::<(), roverlab::world::formats::FormatError>(())
    /// ```
    fn from_str(text: &str) -> Result<Self, FormatError> {
        check_length(text, NAME)?;
        let mut water = Self::default();
        for (number, text) in lexer::numbered(text) {
            let Some(words) = lexer::line(NAME, number, text)? else { continue };
            let mut args = Args::after_keyword(&words);
            if !line(&words.words[0].text.to_ascii_lowercase(), &words, &mut args, &mut water)? {
                return Err(words.error(0, format!("one of {}", KEYWORDS.join(", "))));
            }
            if args.left() > 0 {
                return Err(words.error(words.words.len() - args.left(), "the end of the line"));
            }
        }
        Ok(water)
    }
}

/// Name of a text without a file.
const NAME: &str = "water";
/// First words of the lines of water.
const KEYWORDS: [&str; 5] = ["water_density", "current", "waves", "turbidity", "wind"];

/// Reads a line into a world's water. Returns whether the keyword is one of water.
pub(super) fn line(
    keyword: &str,
    line: &Line<'_>,
    args: &mut Args<'_, '_>,
    water: &mut Water,
) -> Result<bool, FormatError> {
    match keyword {
        "water_density" => {
            water.density = args.plain("the water's density", f64::MIN_POSITIVE..=Water::DENSEST)?;
        }
        "current" => current(line, args, water)?,
        "waves" => water.waves = Some(waves(line, args)?),
        "turbidity" => {
            water.turbidity = args.plain("the water's turbidity in 1/m", 0.0..=Water::MURKIEST)?;
        }
        "wind" => water.wind = speed(args, "the wind's speed")?,
        _ => return Ok(false),
    }
    Ok(true)
}

fn current(line: &Line<'_>, args: &mut Args<'_, '_>, water: &mut Water) -> Result<(), FormatError> {
    let speed = speed(args, "the current's speed")?;
    let depth = if args.left() > 0 { args.length("the current's depth")? } else { 0.0 };
    if water.current.last().is_some_and(|above| above.0 >= depth) {
        return Err(line.error(line.words.len() - 1, "a depth below that of the `current` line before"));
    }
    water.current.push((depth, speed));
    Ok(())
}

fn waves(line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<Waves, FormatError> {
    let mut waves = Waves {
        height: args.size("the waves' height")?,
        period: args.plain("the waves' period in seconds", 0.5..=30.0)?,
        direction: args.direction("the waves' direction")?,
        irregular: false,
    };
    let expected = "`jonswap` or the end of the line";
    if args.left() > 0 {
        waves.irregular = args.word(expected)?.text.eq_ignore_ascii_case("jonswap");
        if !waves.irregular {
            return Err(line.error(line.words.len() - 1, expected));
        }
    }
    let most = 0.1 * waves.length();
    if waves.height > most {
        let most = millimetres(most);
        return Err(
            line.error(1, format!("at most a tenth of the waves' length, {most} mm: higher ones break"))
        );
    }
    Ok(waves)
}

fn speed(args: &mut Args<'_, '_>, what: &str) -> Result<Vector, FormatError> {
    let most = 1000.0 * Water::FASTEST;
    let mut part = |axis| args.plain(&format!("{what} along {axis} in mm/s"), -most..=most);
    Ok(Vector::new(part("x")?, part("y")?) / 1000.0)
}

/// Writes the properties that differ from still fresh water.
pub(super) fn write(text: &mut String, water: &Water) -> Written {
    let plain = Water::default();
    if water.density != plain.density {
        writeln!(text, "water_density {}", number::print(water.density, 0))?;
    }
    let speed = |speed: Vector| format!("{} {}", millimetres(speed.x), millimetres(speed.y));
    for &(depth, flow) in &water.current {
        writeln!(text, "current {} {}", speed(flow), millimetres(depth))?;
    }
    if let Some(waves) = &water.waves {
        let (height, period) = (millimetres(waves.height), number::print(waves.period, 0));
        let kind = if waves.irregular { " jonswap" } else { "" };
        writeln!(text, "waves {height} {period} {}{kind}", degrees(waves.direction))?;
    }
    if water.turbidity != plain.turbidity {
        writeln!(text, "turbidity {}", number::print(water.turbidity, 0))?;
    }
    if water.wind != plain.wind {
        writeln!(text, "wind {}", speed(water.wind))?;
    }
    Ok(())
}
