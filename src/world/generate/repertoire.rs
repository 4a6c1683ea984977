use super::border::{self, Field};
use super::brush::{Brush, Drawing};
use super::{bent, enclosure, round, straight};

/// Shape of an obstacle in a course.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum ObstacleKind {
    /// A convex polygon.
    Polygon,
    /// A disc of short walls.
    Disc,
    /// An ellipse of short walls.
    Ellipse,
    /// A star.
    Star,
    /// Two crossed beams.
    Cross,
    /// A bowed wall.
    Bow,
    /// A crescent with pointed horns.
    Crescent,
    /// A C: a ring with an opening.
    OpenRing,
    /// A G: a C with an inward bar.
    HookedRing,
    /// A C within a C.
    NestedRings,
    /// A round spiral.
    Spiral,
    /// Alternating half rings.
    Snake,
    /// A U.
    Trough,
    /// An L.
    Angle,
    /// A zig-zag wall.
    Zigzag,
    /// A spiral of straight walls.
    SquareSpiral,
    /// Two walls side by side.
    Corridor,
    /// A channel with baffles.
    Baffles,
    /// A spine with teeth.
    Comb,
    /// A room with a door.
    Room,
    /// A room with a door within another.
    NestedRooms,
    /// A wall that projects from the border.
    Spur,
    /// A half disc on the border.
    Bump,
    /// A room with a door on the border.
    Alcove,
    /// Closes off an unreachable goal: a closed line of any shape, alone, on the border, or across the field.
    Enclosure,
}

impl ObstacleKind {
    /// Kinds that are drawn at random.
    pub(super) const DRAWN: [Self; 24] = [
        Self::Polygon,
        Self::Disc,
        Self::Ellipse,
        Self::Star,
        Self::Cross,
        Self::Bow,
        Self::Crescent,
        Self::OpenRing,
        Self::HookedRing,
        Self::NestedRings,
        Self::Spiral,
        Self::Snake,
        Self::Trough,
        Self::Angle,
        Self::Zigzag,
        Self::SquareSpiral,
        Self::Corridor,
        Self::Baffles,
        Self::Comb,
        Self::Room,
        Self::NestedRooms,
        Self::Spur,
        Self::Bump,
        Self::Alcove,
    ];

    /// Whether the obstacle has a cove, room or corridor that can trap a robot.
    pub fn is_concave(self) -> bool {
        !matches!(self, Self::Polygon | Self::Disc | Self::Ellipse | Self::Bump | Self::Enclosure)
    }

    /// An obstacle of this kind: about the origin, or on the border of the field.
    pub(super) fn draw(self, brush: &mut Brush, field: Field) -> Drawing {
        Drawing::Loose(match self {
            Self::Polygon => straight::polygon(brush),
            Self::Disc => round::disc(brush),
            Self::Ellipse => round::ellipse(brush),
            Self::Star => straight::star(brush),
            Self::Cross => straight::cross(brush),
            Self::Bow => round::bow(brush),
            Self::Crescent => round::crescent(brush),
            Self::OpenRing => round::open_ring(brush),
            Self::HookedRing => round::hooked_ring(brush),
            Self::NestedRings => round::nested_rings(brush),
            Self::Spiral => round::spiral(brush),
            Self::Snake => round::snake(brush),
            Self::Trough => bent::trough(brush),
            Self::Angle => bent::angle(brush),
            Self::Zigzag => bent::zigzag(brush),
            Self::SquareSpiral => bent::square_spiral(brush),
            Self::Corridor => bent::corridor(brush),
            Self::Baffles => bent::baffles(brush),
            Self::Comb => straight::comb(brush),
            Self::Room => straight::room(brush),
            Self::NestedRooms => straight::nested_rooms(brush),
            Self::Spur => return Drawing::OnBorder(border::spur(brush, field)),
            Self::Bump => return Drawing::OnBorder(border::bump(brush, field)),
            Self::Alcove => return Drawing::OnBorder(border::alcove(brush, field)),
            Self::Enclosure => return enclosure::draw(brush, field),
        })
    }
}
