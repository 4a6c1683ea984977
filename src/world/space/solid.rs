use super::shape::{Block, OrientedBox, Shape as Placed};
use crate::geometry::{Aabb, Point, Pose};
use crate::world::{Footprint, Mast, Object, RobotPlacement, Shape};

/// An upright solid: an outline on the floor between two heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solid {
    /// Its outline, in its own frame.
    pub outline: Footprint,
    /// Pose of its frame in the world.
    pub pose: Pose,
    /// Height of its foot above the floor (m).
    pub bottom: f64,
    /// Height of its top above the floor (m).
    pub top: f64,
    /// Decrease of a disc's radius per metre above its foot, for rays.
    pub taper: f64,
    /// Its mast, which only rays hit.
    pub mast: Option<Mast>,
}

impl Solid {
    /// A solid with the same outline at all heights, without a mast.
    pub fn new(outline: Footprint, pose: Pose, bottom: f64, top: f64) -> Self {
        Self { outline, pose, bottom, top, taper: 0.0, mast: None }
    }

    /// Height range of the solid.
    pub fn span(&self) -> Span {
        Span { bottom: self.bottom, top: self.top }
    }

    /// The mast in the world.
    pub(super) fn placed_mast(&self) -> Option<Block> {
        let Mast { outline, top } = self.mast?;
        let span = Span { bottom: self.top, top: self.bottom + top };
        Some(Block { shape: OrientedBox::placed(&outline, &self.pose), span })
    }
}

impl Footprint {
    /// The outline at `pose`.
    #[inline]
    pub(super) fn at(&self, pose: &Pose) -> Placed {
        match self {
            Footprint::Disc { radius } => Placed::Disc { centre: pose.position(), radius: *radius },
            Footprint::Rectangle(rectangle) => Placed::Box(OrientedBox::placed(rectangle, pose)),
        }
    }
}

impl From<&Object> for Solid {
    /// An object as an obstacle for robots.
    fn from(object: &Object) -> Self {
        let outline = match object.kind.shape {
            Shape::Cylinder { radius, .. } | Shape::Cone { radius, .. } | Shape::Sphere { radius } => {
                Footprint::Disc { radius }
            }
            Shape::Box { length, width, .. } => {
                let corner = Point::new(0.5 * length, 0.5 * width);
                Footprint::Rectangle(Aabb::new(-corner, corner))
            }
        };
        let bottom = object.elevation;
        let taper = match object.kind.shape {
            Shape::Cone { radius, top, height } => (radius - top) / height,
            _ => 0.0,
        };
        Self { taper, ..Self::new(outline, object.pose, bottom, bottom + object.kind.shape.height()) }
    }
}

impl From<&RobotPlacement> for Solid {
    /// A robot as an obstacle for others.
    fn from(robot: &RobotPlacement) -> Self {
        let bottom = robot.elevation;
        let spec = &robot.spec;
        Self { mast: spec.mast, ..Self::new(spec.footprint, robot.pose, bottom, bottom + spec.height) }
    }
}

/// Identifier of a solid in one [`Space`](super::Space): an index in the order of addition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SolidId(pub(super) u32);

impl SolidId {
    /// Number of solids added before this one.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// An interval of heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Lower end above the floor (m).
    pub bottom: f64,
    /// Upper end above the floor (m).
    pub top: f64,
}

impl Span {
    /// Whether the intervals share more than a border; a thing on top of another is not beside it.
    #[inline]
    pub fn overlaps(&self, other: &Span) -> bool {
        self.bottom < other.top && other.bottom < self.top
    }

    /// Whether a height is in the interval, including its borders.
    #[inline]
    pub fn contains(&self, z: f64) -> bool {
        self.bottom <= z && z <= self.top
    }
}
