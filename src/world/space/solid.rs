use super::shape::{Block, OrientedBox, Shape as Placed};
use crate::geometry::{Aabb, Point, Pose};
use crate::world::{Footprint, Mast, Object, RobotPlacement, Shape};

/// What stands upright: an outline on the floor between two heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solid {
    /// Its outline, in its own frame.
    pub outline: Footprint,
    /// Where its frame is in the world.
    pub pose: Pose,
    /// Metres from the floor to its foot.
    pub bottom: f64,
    /// Metres from the floor to its top.
    pub top: f64,
    /// Metres by which a disc's radius is less, as rays meet it, for each metre above its foot.
    pub taper: f64,
    /// What stands up from it, which rays alone meet.
    pub mast: Option<Mast>,
}

impl Solid {
    /// A solid of the same outline at all heights, without a mast.
    pub fn new(outline: Footprint, pose: Pose, bottom: f64, top: f64) -> Self {
        Self { outline, pose, bottom, top, taper: 0.0, mast: None }
    }

    /// The heights between which it stands.
    pub fn span(&self) -> Span {
        Span { bottom: self.bottom, top: self.top }
    }

    /// The mast where it is.
    pub(super) fn placed_mast(&self) -> Option<Block> {
        let Mast { outline, top } = self.mast?;
        let span = Span { bottom: self.top, top: self.bottom + top };
        Some(Block { shape: OrientedBox::placed(&outline, &self.pose), span })
    }
}

impl Footprint {
    /// The outline where `pose` puts it.
    #[inline]
    pub(super) fn at(&self, pose: &Pose) -> Placed {
        match self {
            Footprint::Disc { radius } => Placed::Disc { centre: pose.position(), radius: *radius },
            Footprint::Rectangle(rectangle) => Placed::Box(OrientedBox::placed(rectangle, pose)),
        }
    }
}

impl From<&Object> for Solid {
    /// An object as robots meet it.
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
    /// A robot as others meet it.
    fn from(robot: &RobotPlacement) -> Self {
        let bottom = robot.elevation;
        let spec = &robot.spec;
        Self { mast: spec.mast, ..Self::new(spec.footprint, robot.pose, bottom, bottom + spec.height) }
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
