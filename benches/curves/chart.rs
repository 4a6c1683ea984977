//! The curves as a picture: both axes by their logarithms.

use roverlab::geometry::Point;
use roverlab::picture::{Picture, Style};
use roverlab::world::{Colour, World};

use crate::curve::{Curve, Sample};

/// Metres of the sheet for a decade of sizes and of times.
const DECADE: (f64, f64) = (0.5, 0.3);
/// Smallest and largest decade of sizes and of times (s).
const SIZES: (i32, i32) = (0, 7);
const TIMES: (i32, i32) = (-6, 1);
/// Metres on the left and below, for the numbers.
const MARGIN: f64 = 0.3;

/// Colours of the curves, in turn.
const COLOURS: [u32; 10] = [
    0x001f_6fb4,
    0x00c0_7a1b,
    0x002b_8a3e,
    0x00b0_2a4c,
    0x006f_42c1,
    0x0010_8080,
    0x0080_6000,
    0x0050_5050,
    0x00d0_5090,
    0x0060_a0ff,
];

pub(crate) fn chart(curves: &[Curve]) -> Picture {
    let width = DECADE.0 * f64::from(SIZES.1 - SIZES.0);
    let height = DECADE.1 * f64::from(TIMES.1 - TIMES.0);
    let mut picture = Picture::new(&World::empty(width + 2.0 * MARGIN, height + 2.0 * MARGIN));
    picture.title("Time against the size of the task").without_scale();
    for decade in SIZES.0..=SIZES.1 {
        let x = MARGIN + DECADE.0 * f64::from(decade - SIZES.0);
        picture.line([Point::new(x, MARGIN), Point::new(x, MARGIN + height)], Style::aid().opacity(0.4));
        picture.text(Point::new(x, 0.5 * MARGIN), format!("10^{decade}"));
    }
    for decade in TIMES.0..=TIMES.1 {
        let y = MARGIN + DECADE.1 * f64::from(decade - TIMES.0);
        picture.line([Point::new(MARGIN, y), Point::new(MARGIN + width, y)], Style::aid().opacity(0.4));
        picture.text(Point::new(0.5 * MARGIN, y), format!("10^{decade} s"));
    }
    for (curve, colour) in curves.iter().zip(COLOURS.into_iter().cycle()) {
        let style = Style::new(Colour::from_hex(colour)).width(2.0);
        picture
            .line(curve.points.iter().map(place), style.labelled(format!("{} ({})", curve.name, curve.unit)));
    }
    picture
}

/// Where a sample is on the sheet.
#[allow(clippy::disallowed_methods, reason = "for a picture that people look at")]
fn place(sample: &Sample) -> Point {
    let right = sample.size.log10() - f64::from(SIZES.0);
    let up = sample.seconds.log10() - f64::from(TIMES.0);
    Point::new(MARGIN + DECADE.0 * right, MARGIN + DECADE.1 * up)
}
