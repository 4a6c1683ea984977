//! Hills: their relief in light from the upper left, tinted by elevation, with contour lines.

use std::collections::BTreeMap;

use svg::node::element::Group;

use super::canvas::{area, line, number};
use super::colours::{FLOOR, HILL, INK, WATER, mix};
use super::frame::{Frame, Pixel};
use crate::geometry::{Point, Vector, Vector3};
use crate::world::{Colour, HeightField};

/// Number of patches along the longer side.
const PATCHES: f64 = 120.0;
/// Number of shades between light and shadow.
const SHADES: f64 = 10.0;
/// Number of tints between low and high.
const TINTS: f64 = 5.0;
/// Maximum number of contour lines.
const LINES: f64 = 12.0;
/// Exaggeration of slopes.
const EXAGGERATION: f64 = 2.0;

/// Elevations at the corners of patches.
struct Raster {
    columns: usize,
    rows: usize,
    corner: Point,
    size: Vector,
    heights: Vec<f64>,
}

impl Raster {
    fn of(field: &HeightField) -> Self {
        let extent = field.area().size();
        let longest = extent.x.max(extent.y);
        let count = |side: f64| (PATCHES * side / longest).ceil().max(1.0) as usize;
        let (columns, rows) = (count(extent.x), count(extent.y));
        let size = Vector::new(extent.x / columns as f64, extent.y / rows as f64);
        let corner = field.area().min;
        let mut heights = Vec::with_capacity((columns + 1) * (rows + 1));
        for row in 0..=rows {
            for column in 0..=columns {
                let at = corner + size.component_mul(&Vector::new(column as f64, row as f64));
                heights.push(field.height(at.inf(&field.area().max)).unwrap_or(0.0));
            }
        }
        Self { columns, rows, corner, size, heights }
    }

    fn height(&self, column: usize, row: usize) -> f64 {
        self.heights[row * (self.columns + 1) + column]
    }

    fn corner(&self, column: f64, row: f64) -> Point {
        self.corner + self.size.component_mul(&Vector::new(column, row))
    }

    /// The corners of a patch, counter-clockwise from that of least x and y.
    fn patch(&self, column: usize, row: usize) -> [f64; 4] {
        [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| self.height(column + x, row + y))
    }
}

/// The hills of a world, with its water.
pub(super) fn relief(field: &HeightField, water: Option<f64>, frame: &Frame) -> Group {
    let raster = Raster::of(field);
    let mut group = Group::new().set("shape-rendering", "crispEdges");
    for ((red, green, blue), data) in patches(&raster, field, water, frame) {
        group = group.add(area(data, Colour::new(red, green, blue)));
    }
    let step = contour_step(field);
    let mut contours = Group::new();
    let first = (field.lowest() / step).floor() as i64 + 1;
    for number in first..first + LINES as i64 + 2 {
        let data = contour(&raster, number as f64 * step, frame);
        if !data.is_empty() {
            let width = if number % 5 == 0 { 1.1 } else { 0.6 };
            contours = contours.add(line(data, INK, width).set("stroke-opacity", "0.45"));
        }
    }
    Group::new().add(group).add(contours)
}

/// Height between two contour lines (m): 1, 2 or 5 times a power of ten.
pub(super) fn contour_step(field: &HeightField) -> f64 {
    let least = (field.highest() - field.lowest()).max(1e-6) / LINES;
    let powers = (-8..8).map(|exponent| crate::geometry::math::pow(10.0, f64::from(exponent)));
    let steps = powers.flat_map(|power| [power, 2.0 * power, 5.0 * power]);
    steps.into_iter().find(|step| *step >= least).unwrap_or(least)
}

/// The patches of each colour as one path.
fn patches(
    raster: &Raster,
    field: &HeightField,
    water: Option<f64>,
    frame: &Frame,
) -> BTreeMap<(u8, u8, u8), String> {
    let mut paths = BTreeMap::<_, String>::new();
    for row in 0..raster.rows {
        let colour = |column: usize| patch_colour(raster, field, water, column, row);
        let mut column = 0;
        while column < raster.columns {
            let first = column;
            let key = colour(first);
            while column < raster.columns && colour(column) == key {
                column += 1;
            }
            let low = frame.at(raster.corner(first as f64, row as f64));
            let high = frame.at(raster.corner(column as f64, row as f64 + 1.0));
            let [left, top, right, bottom] = [low.x, high.y, high.x, low.y].map(number);
            let path: &mut String = paths.entry(key).or_default();
            // Absolute coordinates: neighbours have equal ones, so that no gap opens between them.
            path.extend(["M", &left, " ", &top, "H", &right, "V", &bottom, "H", &left, "z"]);
        }
    }
    paths
}

fn patch_colour(
    raster: &Raster,
    field: &HeightField,
    water: Option<f64>,
    column: usize,
    row: usize,
) -> (u8, u8, u8) {
    let [a, b, c, d] = raster.patch(column, row);
    let rise =
        Vector::new((b + c - a - d) / raster.size.x, (c + d - a - b) / raster.size.y) * (0.5 * EXAGGERATION);
    let normal = Vector3::new(-rise.x, -rise.y, 1.0).normalize();
    // From the upper left, halfway up.
    let light = Vector3::new(-0.5, 0.5, std::f64::consts::FRAC_1_SQRT_2).dot(&normal);
    let middle = 0.25 * (a + b + c + d);
    let range = (field.highest() - field.lowest()).max(1e-9);
    let tint = ((middle - field.lowest()) / range * TINTS).round() / TINTS;
    let shade = (light.clamp(0.0, 1.0) * SHADES).round() / SHADES;
    let ground = mix(FLOOR, HILL, 0.15 + 0.7 * tint);
    // On level ground the light is 0.71, which leaves the tint as it is.
    let lit = if shade > 0.7 {
        mix(ground, Colour::WHITE, 1.2 * (shade - 0.7))
    } else {
        mix(ground, INK, 0.75 * (0.7 - shade))
    };
    let lit = if water.is_some_and(|level| middle < level) { mix(WATER, lit, 0.25) } else { lit };
    (lit.red, lit.green, lit.blue)
}

/// A contour line, patch by patch.
fn contour(raster: &Raster, level: f64, frame: &Frame) -> String {
    let mut data = String::new();
    for row in 0..raster.rows {
        for column in 0..raster.columns {
            let heights = raster.patch(column, row);
            let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
            let mut crossings: Vec<Pixel> = Vec::new();
            for side in 0..4 {
                let (from, to) = (heights[side], heights[(side + 1) % 4]);
                if (from < level) != (to < level) {
                    let share = (level - from) / (to - from);
                    let ((x, y), (next_x, next_y)) = (corners[side], corners[(side + 1) % 4]);
                    let x = column as f64 + x + (next_x - x) * share;
                    let y = row as f64 + y + (next_y - y) * share;
                    crossings.push(frame.at(raster.corner(x, y)));
                }
            }
            for ends in crossings.chunks_exact(2) {
                data.push_str(&super::canvas::path_data(ends, false));
            }
        }
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;

    fn frame() -> Frame {
        Frame::around(Aabb::new(Point::origin(), Point::new(2.0, 2.0)), Pixel::origin())
    }

    #[test]
    fn the_side_towards_the_light_is_lighter_and_lines_have_one_height() {
        let area = Aabb::new(Point::origin(), Point::new(2.0, 2.0));
        let cone = |at: Point| 0.5 - 0.4 * (at - Point::new(1.0, 1.0)).norm();
        let field = HeightField::from_fn(81, 81, area, cone).unwrap();
        let raster = Raster::of(&field);
        let brightness = |column, row| {
            let (red, green, blue) = patch_colour(&raster, &field, None, column, row);
            u32::from(red) + u32::from(green) + u32::from(blue)
        };
        // Row 0 is at the bottom of the picture.
        assert!(brightness(40, 80) > brightness(80, 40));
        let data = contour(&raster, 0.3, &frame());
        let numbers = data.split(['M', 'L', ' ']).filter(|part| !part.is_empty());
        let numbers: Vec<f64> = numbers.map(|part| part.parse().unwrap()).collect();
        assert!(numbers.len() > 100);
        for pair in numbers.chunks_exact(2) {
            let away = (Vector::new(pair[0], pair[1]) - Vector::new(240.0, 240.0)).norm() / 240.0;
            assert!((away - 0.5).abs() < 0.01, "{away}");
        }
        assert_eq!(contour_step(&field), 0.05);
    }

    #[test]
    fn level_ground_has_no_lines() {
        let area = Aabb::new(Point::origin(), Point::new(2.0, 1.0));
        let field = HeightField::from_fn(3, 3, area, |_| 0.2).unwrap();
        assert!(contour(&Raster::of(&field), 0.2, &frame()).is_empty());
        assert_eq!(patches(&Raster::of(&field), &field, Some(0.3), &frame()).len(), 1);
    }
}
