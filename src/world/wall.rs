use super::Colour;
use crate::geometry::{Point, Segment};

/// An upright wall on a straight line.
///
/// ```
/// use roverlab::geometry::Point;
/// use roverlab::world::{Colour, Wall};
/// let wall = Wall { colour: Colour::RED, ..Wall::new(Point::new(0.0, 0.0), Point::new(3.0, 4.0)) };
/// assert_eq!(wall.line.length(), 5.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wall {
    /// Centre line of the wall's foot.
    pub line: Segment,
    /// Thickness, half on either side of the line (m). The ends are square and coincide with the line's ends.
    pub thickness: f64,
    /// Height above the floor, more than 0 (m).
    pub height: f64,
    /// The colour of its faces.
    pub colour: Colour,
}

impl Wall {
    /// EyeSim's default thickness of a wall.
    pub const DEFAULT_THICKNESS: f64 = 0.010;
    /// EyeSim's default visible height of a wall.
    pub const DEFAULT_HEIGHT: f64 = 0.200;
    /// Default colour of a wall.
    pub const DEFAULT_COLOUR: Colour = Colour::WHITE;

    /// A wall of default thickness, height and colour between two points.
    pub const fn new(a: Point, b: Point) -> Self {
        Self {
            line: Segment::new(a, b),
            thickness: Self::DEFAULT_THICKNESS,
            height: Self::DEFAULT_HEIGHT,
            colour: Self::DEFAULT_COLOUR,
        }
    }
}
