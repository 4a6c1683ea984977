//! SVG elements, with numbers in a short and fixed form.

use svg::node::element::{Circle, Path, Rectangle, Text};

use super::frame::Pixel;
use super::text;
use crate::geometry::Aabb;
use crate::world::Colour;

/// Fonts with similar widths, the first of which is built into the PNG writer.
pub(super) const FONTS: &str = "DejaVu Sans, Verdana, Segoe UI, Helvetica, Arial, sans-serif";

/// A number with at most two decimals, finer than any screen, clamped to what renderers accept.
pub(super) fn number(value: f64) -> String {
    let value = if value.is_nan() { 0.0 } else { value.clamp(-1e6, 1e6) };
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Data of a path through pixels; a closed one returns to its start.
pub(super) fn path_data(points: &[Pixel], closed: bool) -> String {
    let mut data = String::new();
    for (i, p) in points.iter().enumerate() {
        data.push(if i == 0 { 'M' } else { 'L' });
        data.push_str(&number(p.x));
        data.push(' ');
        data.push_str(&number(p.y));
    }
    if closed {
        data.push('Z');
    }
    data
}

/// A line with round joins and caps.
pub(super) fn line(data: String, colour: Colour, width: f64) -> Path {
    Path::new()
        .set("d", data)
        .set("fill", "none")
        .set("stroke", colour.to_string())
        .set("stroke-width", number(width))
        .set("stroke-linejoin", "round")
        .set("stroke-linecap", "round")
}

/// An area without an outline.
pub(super) fn area(data: String, colour: Colour) -> Path {
    Path::new().set("d", data).set("fill", colour.to_string())
}

/// A filled circle.
pub(super) fn disc(centre: Pixel, radius: f64, colour: Colour) -> Circle {
    Circle::new()
        .set("cx", number(centre.x))
        .set("cy", number(centre.y))
        .set("r", number(radius))
        .set("fill", colour.to_string())
}

/// A filled rectangle.
pub(super) fn rectangle(bounds: Aabb, colour: Colour) -> Rectangle {
    let size = bounds.size();
    Rectangle::new()
        .set("x", number(bounds.min.x))
        .set("y", number(bounds.min.y))
        .set("width", number(size.x))
        .set("height", number(size.y))
        .set("fill", colour.to_string())
}

/// A line of text starting at `at`, on the baseline.
pub(super) fn words(content: &str, at: Pixel, size: f64, colour: Colour) -> Text {
    Text::new(text::clean(content))
        .set("x", number(at.x))
        .set("y", number(at.y))
        .set("font-size", number(size))
        .set("fill", colour.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let numbers = [1.0, 0.25, -0.001, 100.0, 1.999, -3.10].map(number);
        assert_eq!(numbers, ["1", "0.25", "0", "100", "2", "-3.1"]);
        assert_eq!([f64::NAN, f64::INFINITY].map(number), ["0", "1000000"]);
    }

    #[test]
    fn paths_close() {
        let corners = [Pixel::new(0.0, 1.0), Pixel::new(2.5, 1.0)];
        assert_eq!(path_data(&corners, true), "M0 1L2.5 1Z");
        assert_eq!(path_data(&[], false), "");
    }
}
