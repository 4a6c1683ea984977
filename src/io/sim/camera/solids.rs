use super::canvas::Canvas;
use super::face::Cutter;
use super::light::{lit, packed};
use super::view::{Place, View};
use crate::geometry::{Point, Vector, math};
use crate::world::Colour;

/// Height range and colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Standing {
    pub(super) bottom: f64,
    pub(super) top: f64,
    pub(super) colour: Colour,
}

/// Height of flat things on hills above the middle of their place, so that slopes do not bury them (m).
const ABOVE: f64 = 0.004;
/// Most facets on the side of a cylinder that the camera sees.
const MAX_FACETS: usize = 32;

/// Draws upright solids with flat tops.
#[derive(Debug, Default)]
pub(super) struct Carpenter {
    cutter: Cutter,
    outline: Vec<Point>,
    lid: Vec<Place>,
}

impl Carpenter {
    /// An upright prism; its corners run counter-clockwise as seen from above.
    pub(super) fn prism(&mut self, canvas: &mut Canvas, view: &View, corners: &[Point], body: Standing) {
        if is_out_of_sight(view, corners, body) {
            return;
        }
        self.outline.clear();
        self.outline.extend_from_slice(corners);
        let outline = std::mem::take(&mut self.outline);
        for (i, &a) in outline.iter().enumerate() {
            self.side(canvas, view, a, outline[(i + 1) % outline.len()], body);
        }
        self.outline = outline;
        self.lid(canvas, view, body);
    }

    /// An upright cylinder. Its lateral outline is exact: the facets begin and end at the tangents from the
    /// eye.
    pub(super) fn cylinder(
        &mut self,
        canvas: &mut Canvas,
        view: &View,
        centre: Point,
        radius: f64,
        body: Standing,
    ) {
        let eye = Point::new(view.eye[0], view.eye[1]) - centre;
        let distance = eye.norm();
        let middle = [centre.x, centre.y, 0.5 * (body.bottom + body.top)];
        let reach = math::hypot(radius, 0.5 * (body.top - body.bottom));
        if view.misses(view.see(middle), reach) {
            return;
        }
        // From straight above or below, only the lid is visible.
        let beside = distance > radius;
        let half = if beside { math::acos(radius / distance) } else { std::f64::consts::FRAC_PI_2 };
        let pixels = view.focal * radius / (distance - radius).max(radius);
        let facets = ((2.5 * pixels.sqrt()) as usize + 3).min(MAX_FACETS);
        let towards = if distance > 0.0 { eye / distance } else { Vector::x() };
        self.outline.clear();
        let (front, back) = (2.0 * half, std::f64::consts::TAU - 2.0 * half);
        arc(&mut self.outline, centre, turned(towards, -half) * radius, front / facets as f64, facets);
        arc(&mut self.outline, centre, turned(towards, half) * radius, back / facets as f64, facets);
        if beside {
            let outline = std::mem::take(&mut self.outline);
            for pair in outline[..=facets].windows(2) {
                self.side(canvas, view, pair[0], pair[1], body);
            }
            self.outline = outline;
        }
        self.lid(canvas, view, body);
    }

    /// An upright cone between the circles of its foot and its top.
    pub(super) fn cone(
        &mut self,
        canvas: &mut Canvas,
        view: &View,
        centre: Point,
        [foot, top]: [f64; 2],
        body: Standing,
    ) {
        let height = body.top - body.bottom;
        let middle = [centre.x, centre.y, 0.5 * (body.bottom + body.top)];
        let reach = math::hypot(foot.max(top), 0.5 * height);
        let seen = view.see(middle);
        if view.misses(seen, reach) {
            return;
        }
        let pixels = view.focal * foot.max(top) / seen.norm().max(reach);
        let facets = ((5.0 * pixels.sqrt()) as usize + 6).min(MAX_FACETS);
        let step = std::f64::consts::TAU / facets as f64;
        let mut lower = Vec::with_capacity(facets);
        arc(&mut lower, centre, Vector::new(foot, 0.0), step, facets);
        self.outline.clear();
        arc(&mut self.outline, centre, Vector::new(top, 0.0), step, facets);
        let slant = math::hypot(height, foot - top).max(f64::MIN_POSITIVE);
        for (i, &a) in lower.iter().enumerate() {
            let next = (i + 1) % facets;
            let (b, c, d) = (lower[next], self.outline[next], self.outline[i]);
            let out = turned(Vector::x(), (i as f64 + 0.5) * step) * (height / slant);
            let normal = [out.x, out.y, (foot - top) / slant];
            let corners = [
                [a.x, a.y, body.bottom],
                [b.x, b.y, body.bottom],
                [c.x, c.y, body.top],
                [d.x, d.y, body.top],
            ];
            self.cutter.draw(canvas, view, &corners, lit(body.colour, normal));
        }
        self.lid(canvas, view, body);
    }

    /// A disc on the floor, or on hills at some height.
    pub(super) fn spot(
        &mut self,
        canvas: &mut Canvas,
        view: &View,
        (centre, on_hills): (Point, Option<f64>),
        radius: f64,
        (colour, alpha): (Colour, u8),
    ) {
        /// Number of corners of a disc's polygon.
        const CORNERS: usize = 24;
        self.outline.clear();
        let step = std::f64::consts::TAU / CORNERS as f64;
        arc(&mut self.outline, centre, Vector::new(radius, 0.0), step, CORNERS);
        self.lid.clear();
        let height = on_hills.map_or(0.0, |height| height + ABOVE);
        self.lid.extend(self.outline.iter().map(|p| [p.x, p.y, height]));
        if on_hills.is_some() {
            self.cutter.tint_seen(canvas, view, &self.lid, packed(colour), alpha);
        } else {
            self.cutter.tint(canvas, view, &self.lid, packed(colour), alpha);
        }
    }

    fn side(&mut self, canvas: &mut Canvas, view: &View, a: Point, b: Point, body: Standing) {
        let along = b - a;
        let length = along.norm();
        if length == 0.0 {
            return;
        }
        let normal = [along.y / length, -along.x / length, 0.0];
        let corners =
            [[a.x, a.y, body.bottom], [b.x, b.y, body.bottom], [b.x, b.y, body.top], [a.x, a.y, body.top]];
        self.cutter.draw(canvas, view, &corners, lit(body.colour, normal));
    }

    /// The top or bottom of the present outline, whichever is visible.
    fn lid(&mut self, canvas: &mut Canvas, view: &View, body: Standing) {
        self.lid.clear();
        let normal = if view.eye[2] > body.top {
            self.lid.extend(self.outline.iter().map(|p| [p.x, p.y, body.top]));
            [0.0, 0.0, 1.0]
        } else if view.eye[2] < body.bottom {
            self.lid.extend(self.outline.iter().rev().map(|p| [p.x, p.y, body.bottom]));
            [0.0, 0.0, -1.0]
        } else {
            return;
        };
        self.cutter.draw(canvas, view, &self.lid, lit(body.colour, normal));
    }
}

fn is_out_of_sight(view: &View, corners: &[Point], body: Standing) -> bool {
    let [Some(first), Some(opposite)] = [corners.first(), corners.get(corners.len() / 2)] else {
        return true;
    };
    let middle = nalgebra::center(first, opposite);
    let level = corners.iter().map(|corner| (corner - middle).norm()).fold(0.0, f64::max);
    let radius = math::hypot(level, 0.5 * (body.top - body.bottom));
    view.misses(view.see([middle.x, middle.y, 0.5 * (body.bottom + body.top)]), radius)
}

/// `steps` points on a circle, counter-clockwise.
fn arc(points: &mut Vec<Point>, centre: Point, mut offset: Vector, step: f64, steps: usize) {
    let (sin, cos) = math::sin_cos(step);
    for _ in 0..steps {
        points.push(centre + offset);
        offset = Vector::new(cos * offset.x - sin * offset.y, sin * offset.x + cos * offset.y);
    }
}

fn turned(vector: Vector, angle: f64) -> Vector {
    let (sin, cos) = math::sin_cos(angle);
    Vector::new(cos * vector.x - sin * vector.y, sin * vector.x + cos * vector.y)
}
