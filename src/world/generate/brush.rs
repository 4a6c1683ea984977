use super::figure::{Figure, Outline, stroke};
use crate::geometry::Point;
use crate::random::Stream;

/// A figure that is yet to be placed.
#[derive(Debug)]
pub(super) enum Drawing {
    /// About the origin, to be moved anywhere.
    Loose(Figure),
    /// At its place on the border.
    OnBorder(Figure),
}

/// What figures are drawn with.
#[derive(Debug)]
pub(super) struct Brush<'a> {
    pub(super) stream: &'a mut Stream,
    /// Metres between the middle lines of two walls with the narrowest passage between them.
    pub(super) gap: f64,
    /// About half the size wanted, in metres. Figures with corridors in them may need more.
    pub(super) radius: f64,
}

impl Brush<'_> {
    /// The length of the walls that make up a curve: from fine to coarse.
    pub(super) fn facet(&mut self) -> f64 {
        self.stream.between(0.03, 0.09)
    }

    /// One time in three walls along a line, else around a stroke of a width along it.
    pub(super) fn wall_or_stroke(&mut self, line: Vec<Point>, width: f64) -> Outline {
        if self.stream.chance(0.35) { Outline::open(line) } else { stroke(&line, width) }
    }
}
