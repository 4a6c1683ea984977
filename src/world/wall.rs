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
    /// The middle line of the wall's foot.
    pub line: Segment,
    /// Metres across; half of it on either side of the line. The ends are square and stand on the line's ends.
    pub thickness: f64,
    /// Metres above the floor.
    pub height: f64,
    /// The colour of its faces.
    pub colour: Colour,
}

impl Wall {
    /// EyeSim's thickness of a wall that states none.
    pub const DEFAULT_THICKNESS: f64 = 0.010;
    /// EyeSim's visible height of a wall that states none.
    pub const DEFAULT_HEIGHT: f64 = 0.200;
    /// The colour of a wall that states none.
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
