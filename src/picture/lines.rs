//! Areas, clouds of points and lines.

use std::collections::BTreeSet;

use svg::node::element::Group;

use super::Style;
use super::canvas::{disc, line, number, path_data};
use super::colours::ramp;
use super::frame::{Frame, Pixel};
use super::items::{Area, Cloud, Line, Outline, Picture, is_finite};
use crate::geometry::{Aabb, Point};

/// Steps of the colour scale along a path.
const SHADES: f64 = 24.0;
/// Points of a path nearer than this to the one before, in pixels, make no difference.
const FINEST: f64 = 0.45;

/// A disc or a polygon.
pub(super) fn area(item: &Area, frame: &Frame) -> Group {
    match &item.outline {
        Outline::Disc { centre, radius } if is_finite(centre) && radius.is_finite() => {
            let circle = disc(frame.at(*centre), frame.length(radius.abs()), item.style.colour)
                .set("fill-opacity", number(item.style.fill * item.style.opacity))
                .set("stroke", item.style.colour.to_string())
                .set("stroke-width", number(item.style.width))
                .set("stroke-opacity", number(item.style.opacity));
            Group::new().add(dash(circle, &item.style))
        }
        Outline::Polygon(corners) if !corners.is_empty() => {
            let pixels: Vec<Pixel> = corners.iter().map(|p| frame.at(*p)).collect();
            outlined(&path_data(&pixels, true), &item.style)
        }
        _ => Group::new(),
    }
}

/// A closed outline, filled as its style says.
fn outlined(data: &str, style: &Style) -> Group {
    let outline = line(data.to_owned(), style.colour, style.width)
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

/// A rectangle that shows the style of an area in the legend.
pub(super) fn swatch(bounds: Aabb, style: &Style) -> Group {
    let (min, max) = (bounds.min, bounds.max);
    let corners = [min, Pixel::new(max.x, min.y), max, Pixel::new(min.x, max.y)];
    outlined(&path_data(&corners, true), &style.clone().width(style.width.min(2.0)))
}

/// The points of a cloud.
pub(super) fn cloud(cloud: &Cloud, frame: &Frame) -> Group {
    let pixels: Vec<Pixel> = cloud.points.iter().filter(|p| is_finite(p)).map(|p| frame.at(*p)).collect();
    dots(&pixels, &cloud.style)
}

/// Dots, one for every place where there are any.
pub(super) fn dots(pixels: &[Pixel], style: &Style) -> Group {
    // Places on a grid of half a pixel: more dots would only darken each other.
    let places: BTreeSet<(i64, i64)> =
        pixels.iter().map(|p| ((2.0 * p.x).round() as i64, (2.0 * p.y).round() as i64)).collect();
    let half = |twice: i64| number(twice as f64 / 2.0);
    let data =
        places.iter().fold(String::new(), |data, (x, y)| data + "M" + &half(*x) + " " + &half(*y) + "h0");
    Group::new().add(line(data, style.colour, style.width).set("stroke-opacity", number(style.opacity)))
}

/// A line through some pixels.
pub(super) fn stroke(pixels: &[Pixel], style: &Style) -> Group {
    let shape = line(path_data(pixels, false), style.colour, style.width)
        .set("stroke-opacity", number(style.opacity));
    Group::new().add(dash(shape, style))
}

/// The highest speed along the paths that are coloured by it, in metres per second.
pub(super) fn top_speed(picture: &Picture) -> f64 {
    let speeds = picture.lines.iter().filter_map(|line| line.speeds.as_ref()).flatten();
    speeds.copied().filter(|speed| speed.is_finite()).fold(0.0, f64::max)
}

/// A path, in one colour or coloured by speed.
pub(super) fn path(item: &Line, frame: &Frame, top_speed: f64) -> Group {
    let Some(speeds) = &item.speeds else {
        let data: String = runs(&item.points, frame).iter().map(|run| path_data(run, false)).collect();
        let shape =
            line(data, item.style.colour, item.style.width).set("stroke-opacity", number(item.style.opacity));
        return Group::new().add(dash(shape, &item.style));
    };
    let shade = |speed: f64| if top_speed > 0.0 { (speed / top_speed * SHADES).round() } else { 0.0 };
    let mut group = Group::new();
    let mut start = 0;
    for end in 1..=item.points.len() {
        let last = end == item.points.len();
        if last || shade(speeds[end]) != shade(speeds[start]) {
            // Pieces share the point where they meet.
            let piece = &item.points[start..(end + 1).min(item.points.len())];
            let data: String = runs(piece, frame).iter().map(|run| path_data(run, false)).collect();
            group = group.add(line(data, ramp(shade(speeds[start]) / SHADES), item.style.width));
            start = end;
        }
    }
    group
}

/// The unbroken parts of a path in pixels, without points that make no difference.
pub(super) fn runs(points: &[Point], frame: &Frame) -> Vec<Vec<Pixel>> {
    points
        .split(|p| !is_finite(p))
        .filter(|run| !run.is_empty())
        .map(|run| thinned(run.iter().map(|p| frame.at(*p))))
        .collect()
}

fn thinned(pixels: impl Iterator<Item = Pixel>) -> Vec<Pixel> {
    let mut kept: Vec<Pixel> = Vec::new();
    let mut skipped = None;
    for pixel in pixels {
        if kept.last().is_some_and(|last| (pixel - last).norm() < FINEST) {
            skipped = Some(pixel);
        } else {
            kept.push(pixel);
            skipped = None;
        }
    }
    kept.extend(skipped);
    kept
}
