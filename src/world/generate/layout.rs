use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use super::CourseOptions;
use super::border::Field;
use super::brush::{Brush, Drawing};
use super::figure::{Figure, Outline, distance_between};
use super::repertoire::ObstacleKind;
use crate::geometry::{Aabb, Point, Pose};
use crate::random::Stream;
use crate::world::{Object, ObjectKind, Shape, Wall, World};

/// Number of attempts to place a figure or object before the field counts as full.
const TRIES: usize = 40;

/// A field being filled with obstacles at a distance from one another.
#[derive(Debug)]
pub(super) struct Layout {
    pub(super) field: Field,
    pub(super) world: World,
    pub(super) kinds: Vec<ObstacleKind>,
    /// Places within the obstacles.
    pub(super) pockets: Vec<Point>,
    /// Places within the enclosure.
    pub(super) chambers: Vec<Point>,
    pieces: Vec<Piece>,
    /// Room between the faces of any two solids (m).
    room: f64,
}

/// A placed figure or object.
#[derive(Debug)]
struct Piece {
    /// Its lines, each with half its thickness.
    lines: Vec<(Point, Point, f64)>,
    outlines: Vec<Outline>,
    bounds: Aabb,
}

impl Piece {
    fn new(lines: Vec<(Point, Point, f64)>, outlines: Vec<Outline>) -> Option<Self> {
        let bounds = Aabb::around(lines.iter().flat_map(|line| [line.0, line.1]))?;
        let thickest = lines.iter().map(|line| line.2).fold(0.0, f64::max);
        Some(Self { lines, outlines, bounds: bounds.inflated(thickest) })
    }

    fn of_walls(walls: &[Wall], outlines: Vec<Outline>) -> Option<Self> {
        Self::new(walls.iter().map(|w| (w.line.a, w.line.b, 0.5 * w.thickness)).collect(), outlines)
    }

    fn is_clear_of(&self, other: &Self, room: f64) -> bool {
        let reach = self.bounds.inflated(room);
        if !overlap(&reach, &other.bounds) {
            return true;
        }
        let near = |line: &&(Point, Point, f64)| {
            Aabb::around([line.0, line.1]).is_some_and(|b| overlap(&b.inflated(line.2), &reach))
        };
        let others: Vec<_> = other.lines.iter().filter(near).collect();
        let apart = |a: &(Point, Point, f64), b: &(Point, Point, f64)| {
            distance_between((a.0, a.1), (b.0, b.1)) >= room + a.2 + b.2
        };
        self.lines.iter().all(|line| others.iter().all(|other| apart(line, other)))
    }

    /// Whether part of the other piece is inside one of this piece's closed lines. Since the lines are apart,
    /// one point of each of the other's lines suffices.
    fn swallows(&self, other: &Self) -> bool {
        let points =
            || other.outlines.iter().map(|o| o.points[0]).chain(other.lines.first().map(|line| line.0));
        self.outlines.iter().any(|outline| points().any(|point| outline.holds(point)))
    }
}

fn overlap(a: &Aabb, b: &Aabb) -> bool {
    a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y
}

impl Layout {
    /// An empty field of a random size, with `room` metres between solids.
    pub(super) fn new(stream: &mut Stream, options: &CourseOptions, room: f64) -> Self {
        let (least, greatest) = options.size;
        let mut side = || round_to_centimetre(stream.between(least, greatest)).clamp(least, greatest);
        let field = Field { width: side(), height: side() };
        let world = World::walled(field.width, field.height);
        let pieces = Piece::of_walls(&world.walls, Vec::new()).into_iter().collect();
        Self { field, world, kinds: Vec::new(), pockets: Vec::new(), chambers: Vec::new(), pieces, room }
    }

    /// Draws an enclosure first, if `enclosed`, then obstacles of some kinds up to `count`, as far as they
    /// fit.
    pub(super) fn fill(&mut self, stream: &mut Stream, kinds: &[ObstacleKind], count: usize, enclosed: bool) {
        // Approximate side of the square available per obstacle.
        let share = self.field.shorter() / (count as f64 + 2.0).sqrt();
        if enclosed {
            self.try_kind(stream, ObstacleKind::Enclosure, share);
        }
        let mut deck = kinds.to_vec();
        stream.shuffle(&mut deck);
        let wanted = count.saturating_sub(self.kinds.len());
        for &kind in deck.iter().cycle().take(wanted) {
            self.try_kind(stream, kind, share);
        }
    }

    /// Places a figure of a kind if possible; its size decreases every few attempts.
    fn try_kind(&mut self, stream: &mut Stream, kind: ObstacleKind, share: f64) {
        for attempt in 0..TRIES {
            let thickness = draw_thickness(stream);
            let shrink = 1.0 - 0.6 * attempt as f64 / TRIES as f64;
            let radius = share * stream.between(0.28, 0.55) * shrink;
            let mut brush = Brush { stream, gap: self.room + thickness, radius };
            let (figure, on_border) = match kind.draw(&mut brush, self.field) {
                Drawing::Loose(figure) => (self.anywhere(stream, figure), false),
                Drawing::OnBorder(figure) => (figure, true),
            };
            if self.place(figure, thickness, on_border, kind) {
                return;
            }
        }
    }

    fn anywhere(&self, stream: &mut Stream, figure: Figure) -> Figure {
        let heading =
            if stream.chance(0.35) { FRAC_PI_2 * stream.below(4) as f64 } else { stream.between(0.0, TAU) };
        let (x, y) = (stream.between(0.0, self.field.width), stream.between(0.0, self.field.height));
        figure.placed(Pose::new(x, y, heading), stream.chance(0.5))
    }

    /// Adds a figure unless it is too close to existing ones; returns whether it was added.
    fn place(&mut self, figure: Figure, thickness: f64, on_border: bool, kind: ObstacleKind) -> bool {
        let points = || figure.outlines.iter().flat_map(|o| &o.points);
        if !points().all(|&p| self.is_inside(p)) {
            return false;
        }
        let walls: Vec<Wall> = figure.outlines.iter().flat_map(|o| o.walls(thickness)).collect();
        let Some(piece) = Piece::of_walls(&walls, figure.outlines) else { return false };
        if !self.is_clear(&piece, on_border) {
            return false;
        }
        self.pieces.push(piece);
        self.world.walls.extend(walls);
        self.kinds.push(kind);
        self.pockets.extend(figure.pockets);
        if kind == ObstacleKind::Enclosure {
            self.chambers.extend(figure.chambers);
        }
        true
    }

    fn is_inside(&self, p: Point) -> bool {
        // Rounding may place a line's end slightly beyond the border.
        let slack = 1e-9;
        (-slack..=self.field.width + slack).contains(&p.x)
            && (-slack..=self.field.height + slack).contains(&p.y)
    }

    /// Whether a piece is clear of all others; pieces on the border are not checked against it, the first
    /// piece.
    fn is_clear(&self, piece: &Piece, on_border: bool) -> bool {
        self.pieces[usize::from(on_border)..].iter().all(|other| {
            piece.is_clear_of(other, self.room) && !other.swallows(piece) && !piece.swallows(other)
        })
    }

    /// Places up to `most` objects on free floor: cans, balls, and rows of crates.
    pub(super) fn add_objects(&mut self, stream: &mut Stream, most: usize) {
        let count = if stream.chance(0.6) { stream.below(most + 1) } else { 0 };
        for _ in 0..TRIES {
            let left = count - self.world.objects.len();
            if left == 0 {
                return;
            }
            let pose = Pose::new(
                stream.between(0.0, self.field.width),
                stream.between(0.0, self.field.height),
                stream.between(0.0, TAU),
            );
            let name = ["crate", "can", "soccer"][stream.below(3)];
            let row = if name == "crate" { 1 + stream.below(left.min(3)) } else { 1 };
            self.place_objects(name, pose, row);
        }
    }

    /// Places a row of equal objects side by side, if there is room.
    fn place_objects(&mut self, name: &str, pose: Pose, row: usize) {
        let Some(kind) = ObjectKind::predefined(name) else { return };
        let kind = Arc::new(ObjectKind { fixed: true, ..kind });
        let radius = kind.shape.bounding_radius();
        let spacing = match kind.shape {
            Shape::Box { length, .. } => length,
            _ => 2.0 * radius,
        };
        let poses: Vec<Pose> =
            (0..row).map(|k| pose.compose(&Pose::new(spacing * k as f64, 0.0, 0.0))).collect();
        let lines = poses.iter().map(|p| (p.position(), p.position(), radius)).collect();
        let Some(piece) = Piece::new(lines, Vec::new()) else { return };
        let inside = poses.iter().all(|p| self.is_inside(p.position()));
        if inside && self.is_clear(&piece, false) {
            self.pieces.push(piece);
            self.world.objects.extend(poses.into_iter().map(|pose| Object::new(Arc::clone(&kind), pose)));
        }
    }
}

/// Usually the default thickness of walls, sometimes thicker, sometimes zero.
fn draw_thickness(stream: &mut Stream) -> f64 {
    match stream.below(8) {
        0 => 0.0,
        1 => 0.02,
        2 => 0.04,
        _ => Wall::DEFAULT_THICKNESS,
    }
}

fn round_to_centimetre(length: f64) -> f64 {
    (length * 100.0).round() / 100.0
}
