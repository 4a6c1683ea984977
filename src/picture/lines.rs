//! Areas, point clouds and lines.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::ops::Range;

use svg::node::element::{Group, Mask};

use super::Style;
use super::canvas::{disc, line, number, path_data};
use super::colours::{PAGE, ramp};
use super::film::{Film, TOLERANCE, in_time, simplified};
use super::frame::{Frame, Pixel};
use super::items::is_finite;
use crate::geometry::{Aabb, Point};

/// Number of colours along a path.
const SHADES: f64 = 24.0;

/// A disc.
pub(super) fn circle(centre: Pixel, radius: f64, style: &Style) -> Group {
    let circle = disc(centre, radius, style.colour)
        .set("fill-opacity", number(style.fill * style.opacity))
        .set("stroke", style.colour.to_string())
        .set("stroke-width", number(style.width.min(radius)))
        .set("stroke-opacity", number(style.opacity));
    Group::new().add(dash(circle, style))
}

/// A closed outline, filled as its style says.
pub(super) fn outlined(corners: &[Pixel], style: &Style) -> Group {
    let outline = line(path_data(corners, true), style.colour, style.width)
        .set("fill", style.colour.to_string())
        .set("fill-opacity", number(style.fill * style.opacity))
        .set("stroke-opacity", number(style.opacity));
    Group::new().add(dash(outline, style))
}

fn dash<T: svg::Node>(mut element: T, style: &Style) -> T {
    if style.dashed {
        let (on, off) = (2.6 * style.width + 1.5, 1.9 * style.width + 2.2);
        element.assign("stroke-dasharray", format!("{} {}", number(on), number(off)));
    }
    element
}

/// A rectangle in the style of an area, for the legend.
pub(super) fn swatch(bounds: Aabb, style: &Style) -> Group {
    let (min, max) = (bounds.min, bounds.max);
    let corners = [min, Pixel::new(max.x, min.y), max, Pixel::new(min.x, max.y)];
    outlined(&corners, &style.clone().width(style.width.min(2.0)))
}

/// The points of a cloud.
pub(super) fn cloud(points: &[Point], style: &Style, frame: &Frame) -> Group {
    let pixels: Vec<Pixel> = points.iter().filter(|p| is_finite(p)).map(|p| frame.at(*p)).collect();
    dots(&pixels, style)
}

/// Dots, at most one per position.
pub(super) fn dots(pixels: &[Pixel], style: &Style) -> Group {
    // Positions on a grid of half a pixel, row by row: more dots would only darken each other. They are
    // limited to 32 bits, far beyond any picture, so that differences always fit.
    let half_pixels = |value: f64| i64::from((2.0 * value).round() as i32);
    let places: BTreeSet<(i64, i64)> = pixels.iter().map(|p| (half_pixels(p.y), half_pixels(p.x))).collect();
    let places: Vec<_> = places.into_iter().collect();
    let half = |twice: i64| number(twice as f64 / 2.0);
    let apart = (2.0 * style.width).max(1.0) as i64;
    // Dots that touch form a line.
    let runs = places.chunk_by(|a, b| a.0 == b.0 && b.1 - a.1 <= apart);
    let (mut data, mut at) = (String::new(), (0, 0));
    for run in runs {
        let ((y, x), (_, last)) = (run[0], run[run.len() - 1]);
        // Relative to the end of the previous run: short numbers.
        let _ = write!(data, "m{} {}h{}", half(x - at.1), half(y - at.0), half(last - x));
        at = (y, last);
    }
    Group::new().add(line(data, style.colour, style.width).set("stroke-opacity", number(style.opacity)))
}

/// A line through some pixels.
pub(super) fn stroke(pixels: &[Pixel], style: &Style) -> Group {
    let shape = line(path_data(pixels, false), style.colour, style.width)
        .set("stroke-opacity", number(style.opacity));
    Group::new().add(dash(shape, style))
}

/// A line that changes its shape; its last shape in a still picture.
pub(super) fn moving(shapes: &[(f64, Vec<Pixel>)], style: &Style, film: Option<&Film>) -> Group {
    let Some((_, last)) = shapes.last() else { return Group::new() };
    let still =
        line(path_data(last, false), style.colour, style.width).set("stroke-opacity", number(style.opacity));
    let still = dash(still, style);
    Group::new().add(match film {
        Some(film) if shapes.len() > 1 => still.add(film.shapes(shapes)),
        _ => still,
    })
}

/// A path: points, times and speeds; times and speeds may be empty.
#[derive(Debug, Clone, Copy)]
pub(super) struct Path<'a> {
    pub(super) points: &'a [Point],
    pub(super) times: &'a [f64],
    pub(super) speeds: &'a [f64],
    pub(super) style: &'a Style,
}

impl Path<'_> {
    /// The whole path, in one colour or coloured by speed relative to `top_speed`.
    pub(super) fn draw(&self, frame: &Frame, top_speed: f64) -> Group {
        if self.speeds.len() < self.points.len() {
            let data = self.data(0..self.points.len(), frame);
            let shape = line(data, self.style.colour, self.style.width)
                .set("stroke-opacity", number(self.style.opacity));
            return Group::new().add(dash(shape, self.style));
        }
        let shade = |speed: f64| if top_speed > 0.0 { (speed / top_speed * SHADES).round() } else { 0.0 };
        let mut group = Group::new();
        let mut start = 0;
        for end in 1..=self.points.len() {
            let last = end == self.points.len();
            if last || shade(self.speeds[end]) != shade(self.speeds[start]) {
                // Adjacent pieces share a point.
                let data = self.data(start..(end + 1).min(self.points.len()), frame);
                group = group.add(line(data, ramp(shade(self.speeds[start]) / SHADES), self.style.width));
                start = end;
            }
        }
        group
    }

    /// The path as it grows in a film. `name` is the name of its mask, unique in the document.
    pub(super) fn grow(&self, frame: &Frame, top_speed: f64, film: &Film, name: &str) -> Group {
        let plain = self.speeds.is_empty() && !self.style.dashed;
        let (colour, width) = if plain { (self.style.colour, self.style.width) } else { (PAGE, 8.0) };
        let growing = runs(self.points).into_iter().map(|run| {
            let places: Vec<(f64, Pixel)> = run
                .map(|i| (self.times.get(i).copied().unwrap_or(f64::INFINITY), frame.at(self.points[i])))
                .collect();
            let places: Vec<_> = in_time(&places).into_iter().map(|i| places[i]).collect();
            let (mut along, mut before) = (0.0, places[0].1);
            let reached: Vec<(f64, f64)> = places
                .iter()
                .map(|(time, place)| {
                    along += (place - before).norm();
                    before = *place;
                    (*time, along)
                })
                .collect();
            let (pattern, growth) = film.growth(along, &reached);
            let pixels: Vec<Pixel> = places.into_iter().map(|(_, place)| place).collect();
            line(path_data(&pixels, false), colour, width).set("stroke-dasharray", pattern).add(growth)
        });
        if plain {
            return growing.fold(Group::new(), Group::add).set("stroke-opacity", number(self.style.opacity));
        }
        let bounds = frame.pixels().inflated(20.0);
        let size = bounds.size();
        let mask = Mask::new()
            .set("id", name)
            .set("maskUnits", "userSpaceOnUse")
            .set("x", number(bounds.min.x))
            .set("y", number(bounds.min.y))
            .set("width", number(size.x))
            .set("height", number(size.y));
        let mask = growing.fold(mask, Mask::add);
        let whole = self.draw(frame, top_speed).set("mask", format!("url(#{name})"));
        Group::new().add(mask).add(whole)
    }

    /// Path data of a piece, simplified.
    fn data(&self, piece: Range<usize>, frame: &Frame) -> String {
        runs(&self.points[piece.clone()])
            .into_iter()
            .map(|run| path_data(&thinned(&self.points[piece.clone()][run], frame), false))
            .collect()
    }
}

/// The unbroken parts of a path.
pub(super) fn runs(points: &[Point]) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut start = 0;
    for end in 0..=points.len() {
        if points.get(end).is_none_or(|point| !is_finite(point)) {
            if end > start {
                runs.push(start..end);
            }
            start = end + 1;
        }
    }
    runs
}

/// A simplified path in pixels.
pub(super) fn thinned(points: &[Point], frame: &Frame) -> Vec<Pixel> {
    let pixels: Vec<Pixel> = points.iter().map(|p| frame.at(*p)).collect();
    let off = |between: usize, a: usize, b: usize| distance(pixels[between], pixels[a], pixels[b]);
    simplified(pixels.len(), TOLERANCE, off).into_iter().map(|i| pixels[i]).collect()
}

/// Distance in pixels from a point to the segment between two others.
fn distance(point: Pixel, a: Pixel, b: Pixel) -> f64 {
    let along = b - a;
    let length = along.norm_squared();
    let share = if length > 0.0 { ((point - a).dot(&along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (point - (a + along * share)).norm()
}
