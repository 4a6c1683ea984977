use super::course::Course;
use crate::geometry::{Point, Pose};
use crate::kinematics::PlanarMotion;
use crate::world::space::{SolidId, Span};
use crate::world::{Footprint, RobotPlacement};

/// A robot as it moves among things. What else a robot is, is its [`Machine`](super::machine::Machine), which
/// few ticks touch: so the robots of a fleet stay in the cache.
#[derive(Debug)]
pub(super) struct Body {
    pub(super) solid: SolidId,
    /// Its true pose.
    pub(super) course: Course,
    pub(super) span: Span,
    pub(super) outline: Footprint,
    /// Radius of the smallest enclosing circle of its outline about its origin.
    pub(super) radius: f64,
    /// Radius within which a turn on the spot moves its outline.
    pub(super) spin_radius: f64,
    /// Longest motion of its outline that cannot skip an obstacle.
    pub(super) stride: f64,
    pub(super) touch: Touch,
    pub(super) path_length: f64,
    /// Distance that the robot may move before the next check for walls.
    pub(super) wall_budget: f64,
    /// Distance that it and others may approach each other before the next check for solids.
    pub(super) solid_budget: f64,
}

/// Present and past contacts of a robot.
#[derive(Debug, Clone, Default)]
pub(super) struct Touch {
    /// Number of contacts.
    pub(super) contacts: u32,
    /// Whether it is in contact now.
    pub(super) touching: bool,
    /// First point of each contact.
    pub(super) places: Vec<Point>,
    /// Ticks since its wheels last moved it as commanded.
    pub(super) held_ticks: u32,
}

/// Largest number of recorded contact places; counting continues.
const MAX_CONTACT_PLACES: usize = 1000;
/// Ticks of blocked motion that count as a stall: half a second.
const STALL_TICKS: u32 = 50;

impl Touch {
    pub(super) fn begin(&mut self, place: Point) {
        if !self.touching {
            self.count(place);
        }
        self.touching = true;
    }

    /// Counts a contact that ends at once.
    pub(super) fn count(&mut self, place: Point) {
        self.contacts += 1;
        if self.places.len() < MAX_CONTACT_PLACES {
            self.places.push(place);
        }
    }

    /// Clears the contacts of a robot that is moved elsewhere.
    pub(super) fn leave(&mut self) {
        self.touching = false;
        self.held_ticks = 0;
    }

    pub(super) fn is_stalled(&self) -> bool {
        self.held_ticks >= STALL_TICKS
    }
}

impl Body {
    pub(super) fn new(placement: &RobotPlacement, solid: SolidId) -> Self {
        let outline = placement.spec.footprint;
        Self {
            solid,
            course: Course::new(placement.pose),
            span: span(placement),
            outline,
            radius: outline.bounding_radius(),
            spin_radius: spin_radius(&outline),
            stride: stride(&outline),
            touch: Touch::default(),
            path_length: 0.0,
            wall_budget: 0.0,
            solid_budget: 0.0,
        }
    }

    /// Its true pose.
    pub(super) fn pose(&self) -> Pose {
        self.course.pose()
    }

    /// Upper bound of the motion of any point of its outline.
    pub(super) fn reach(&self, motion: PlanarMotion) -> f64 {
        motion.length() + self.spin_radius * motion.angle.abs()
    }

    /// Records the outline's motion in comparison with that of the wheels.
    pub(super) fn note_motion(&mut self, wished: f64, moved: f64, is_driving: bool) {
        let held = self.touch.touching && moved < 0.2 * wished && is_driving;
        self.touch.held_ticks = if held { self.touch.held_ticks.saturating_add(1) } else { 0 };
    }
}

fn spin_radius(outline: &Footprint) -> f64 {
    match outline {
        Footprint::Disc { .. } => 0.0,
        Footprint::Rectangle(_) => outline.bounding_radius(),
    }
}

fn span(placement: &RobotPlacement) -> Span {
    Span { bottom: placement.elevation, top: placement.elevation + placement.spec.height }
}

/// A quarter of the outline's smallest width: within it, a robot leaves a wall on the side on which it
/// entered.
fn stride(footprint: &Footprint) -> f64 {
    let width = match footprint {
        Footprint::Disc { radius } => 2.0 * radius,
        Footprint::Rectangle(rectangle) => rectangle.size().min(),
    };
    (0.25 * width).max(1e-4)
}
