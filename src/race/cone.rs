use std::sync::Arc;

use crate::geometry::{Aabb, Point, Pose};
use crate::world::{Colour, Object, ObjectKind, RobotPlacement, RobotSpec, Scene, Shape, World};

/// Colour of a cone: blue marks the left edge of the track, yellow the right one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum ConeColour {
    /// Left edge.
    Blue,
    /// Right edge.
    Yellow,
    /// Entries, exits and braking zones.
    Orange,
    /// Large cones beside the start line.
    BigOrange,
    /// Unknown, as from a lidar.
    #[default]
    Unknown,
}

impl ConeColour {
    /// All colours.
    pub const ALL: [Self; 5] = [Self::Blue, Self::Yellow, Self::Orange, Self::BigOrange, Self::Unknown];

    /// Effective radius of the foot (m): that of a circle with the area of the square foot, which is 228 mm
    /// wide, or 285 mm for large cones.
    pub const fn radius(self) -> f64 {
        if matches!(self, Self::BigOrange) { 0.161 } else { 0.129 }
    }

    /// Height (m).
    pub const fn height(self) -> f64 {
        if matches!(self, Self::BigOrange) { 0.505 } else { 0.325 }
    }

    /// Radius halfway up, where a low scanner sees it (m).
    pub(super) fn radius_half_way_up(self) -> f64 {
        0.5 * (1.0 + TIP) * self.radius()
    }

    /// Its colour.
    pub const fn paint(self) -> Colour {
        match self {
            Self::Blue => Colour::from_hex(0x1f_4f_d8),
            Self::Yellow => Colour::from_hex(0xf2_c8_11),
            Self::Orange | Self::BigOrange => Colour::from_hex(0xf0_70_10),
            Self::Unknown => Colour::from_hex(0x90_90_90),
        }
    }

    /// The cone as a world object. It falls when a car touches it.
    pub fn kind(self) -> ObjectKind {
        let (radius, height) = (self.radius(), self.height());
        let shape = Shape::Cone { radius, top: TIP * radius, height };
        let name = format!("cone-{self:?}").to_lowercase();
        ObjectKind { mass: MASS, falls: true, ..ObjectKind::new(name, shape, self.paint()) }
    }

    /// Side of the track: 1 for left, -1 for right, 0 for either.
    pub const fn side(self) -> i8 {
        match self {
            Self::Blue => 1,
            Self::Yellow => -1,
            _ => 0,
        }
    }
}

/// Minimum distance between two cones (m).
pub(super) const APART: f64 = 0.3;
/// Distance from the rear axle of a car at the start to the start line (m).
pub(super) const RUN_UP: f64 = 6.0;
/// Radius of a cone's tip relative to that of its base.
const TIP: f64 = 0.2;
/// Mass of a cone (kg).
const MASS: f64 = 0.45;
/// Width of the ground around the cones of a track (m).
const MARGIN: f64 = 5.0;

/// A cone on the ground.
///
/// ```
/// use roverlab::geometry::Point;
/// use roverlab::race::{Cone, ConeColour};
/// let cone = Cone::new(Point::new(3.0, 1.5), ConeColour::Blue);
/// assert_eq!(cone.colour.side(), -ConeColour::Yellow.side(), "blue and yellow stand on opposite edges");
/// assert_eq!(Cone::unknown(cone.position).colour, ConeColour::Unknown);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// Position of its axis (m).
    pub position: Point,
    /// Its colour.
    pub colour: ConeColour,
}

impl Cone {
    /// A cone of a colour at a position.
    pub const fn new(position: Point, colour: ConeColour) -> Self {
        Self { position, colour }
    }

    /// A cone of unknown colour.
    pub const fn unknown(position: Point) -> Self {
        Self::new(position, ConeColour::Unknown)
    }
}

/// Event that is driven on a track of cones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Event {
    /// Laps of a closed course.
    #[default]
    Laps,
    /// Acceleration over 75 m, straight.
    Acceleration,
    /// Skidpad: two circles to the right, then two to the left.
    Skidpad,
}

/// Cones, and the start pose of the car.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ConeTrack {
    /// Cones, in any order.
    pub cones: Vec<Cone>,
    /// Start pose of the car, if given.
    pub start: Option<Pose>,
    /// Ends of the timing lines, if given.
    pub gates: Vec<[Point; 2]>,
}

impl ConeTrack {
    /// Positions of the cones of a colour.
    pub fn of(&self, colour: ConeColour) -> impl Iterator<Item = Point> + Clone + '_ {
        self.cones.iter().filter(move |cone| cone.colour == colour).map(|cone| cone.position)
    }

    /// Scene with the cones, and racing cars with their rear axles at the given poses.
    pub fn scene(&self, cars: &[Pose]) -> Scene {
        let mut world = World::empty(1.0, 1.0);
        let around = Aabb::around(self.cones.iter().map(|cone| cone.position));
        world.floor = around.unwrap_or(world.floor).inflated(MARGIN);
        let kinds = ConeColour::ALL.map(|colour| Arc::new(colour.kind()));
        let object = |cone: &Cone| {
            let kind = Arc::clone(&kinds[cone.colour as usize]);
            Object::new(kind, Pose::new(cone.position.x, cone.position.y, 0.0))
        };
        world.objects.extend(self.cones.iter().map(object));
        let car = Arc::new(RobotSpec::race_car());
        let placed = |pose: &Pose| RobotPlacement {
            objects_before: self.cones.len(),
            ..RobotPlacement::new(Arc::clone(&car), *pose)
        };
        Scene { robots: cars.iter().map(placed).collect(), ..Scene::new(world) }
    }

    /// The event that the cones represent, by the rules: an acceleration strip ends in a box of orange cones;
    /// the blue and yellow cones of a skidpad are on concentric circles.
    pub fn event(&self) -> Event {
        let orange = self.of(ConeColour::Orange).count();
        if orange == 0 {
            return Event::Laps;
        }
        // The strip is straight: its blue cones lie on a line, within the width of the track.
        let fitted = crate::geometry::FittedLine::through(self.of(ConeColour::Blue));
        if fitted.is_some_and(|line| line.rms < 1.0) { Event::Acceleration } else { Event::Skidpad }
    }

    /// Start pose: the given one, or midway between a blue cone and the nearest yellow one, with blue on the
    /// left. `None` without these.
    pub fn start_pose(&self) -> Option<Pose> {
        if self.start.is_some() {
            return self.start;
        }
        let left = self.of(ConeColour::Blue).next()?;
        let right = self.of(ConeColour::Yellow).min_by(|a, b| {
            let (a, b) = ((a - left).norm_squared(), (b - left).norm_squared());
            a.total_cmp(&b)
        })?;
        let across = left - right;
        let heading = crate::geometry::math::atan2(-across.x, across.y);
        let middle = left + (right - left) * 0.5;
        Some(Pose::new(middle.x, middle.y, heading))
    }
}
