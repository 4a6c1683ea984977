use super::shape::{OrientedBox, Shape};
use crate::geometry::{Aabb, Pose};
use crate::world::Footprint;

/// What stands upright: an outline on the floor between two heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solid {
    /// Its outline, in its own frame.
    pub outline: Outline,
    /// Where its frame is in the world.
    pub pose: Pose,
    /// Metres from the floor to its foot.
    pub bottom: f64,
    /// Metres from the floor to its top.
    pub top: f64,
}

impl Solid {
    /// The heights between which it stands.
    pub fn span(&self) -> Span {
        Span { bottom: self.bottom, top: self.top }
    }
}

/// An outline on the floor, in its own frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Outline {
    /// A disc about the origin.
    Disc {
        /// Metres.
        radius: f64,
    },
    /// A rectangle along the frame's axes.
    Rectangle(Aabb),
}

impl Outline {
    /// The outline where `pose` puts it.
    #[inline]
    pub(super) fn at(&self, pose: &Pose) -> Shape {
        match self {
            Outline::Disc { radius } => Shape::Disc { centre: pose.position(), radius: *radius },
            Outline::Rectangle(rectangle) => Shape::Box(OrientedBox::placed(rectangle, pose)),
        }
    }
}

impl From<&Footprint> for Outline {
    fn from(footprint: &Footprint) -> Self {
        match footprint {
            Footprint::Disc { radius } => Outline::Disc { radius: *radius },
            Footprint::Rectangle(rectangle) => Outline::Rectangle(*rectangle),
        }
    }
}

/// Names a solid of one [`Space`](super::Space): numbers in the order of adding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SolidId(pub(super) u32);

impl SolidId {
    /// How many solids were added before this one.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// An interval of heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Metres above the floor.
    pub bottom: f64,
    /// Metres above the floor.
    pub top: f64,
}

impl Span {
    /// Whether the two share more than a border: what stands on top of a thing is not beside it.
    #[inline]
    pub fn overlaps(&self, other: &Span) -> bool {
        self.bottom < other.top && other.bottom < self.top
    }

    /// Whether a height lies between the two, borders included.
    #[inline]
    pub fn contains(&self, z: f64) -> bool {
        self.bottom <= z && z <= self.top
    }
}
