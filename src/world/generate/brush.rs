use super::figure::{Figure, Outline, stroke};
use crate::geometry::Point;
use crate::random::Stream;

/// A figure to be placed.
#[derive(Debug)]
pub(super) enum Drawing {
    /// About the origin, freely movable.
    Loose(Figure),
    /// At its place on the border.
    OnBorder(Figure),
}

/// Parameters for drawing figures.
#[derive(Debug)]
pub(super) struct Brush<'a> {
    pub(super) stream: &'a mut Stream,
    /// Distance between the centre lines of two walls with the narrowest passage between them (m).
    pub(super) gap: f64,
    /// About half of the desired size (m). Figures with corridors may need more.
    pub(super) radius: f64,
}

impl Brush<'_> {
    /// Length of the wall facets of a curve: fine to coarse.
    pub(super) fn facet(&mut self) -> f64 {
        self.stream.between(0.03, 0.09)
    }

    /// With a probability of about a third, walls along a line, otherwise walls around a stroke of a width
    /// along it.
    pub(super) fn wall_or_stroke(&mut self, line: Vec<Point>, width: f64) -> Outline {
        if self.stream.chance(0.35) { Outline::open(line) } else { stroke(&line, width) }
    }
}
