use super::RigidBody;
use super::undercarriage::GRAVITY;
use crate::geometry::Pose3;
use crate::io::sim::TICK;
use crate::kinematics::PlanarTwist;
use crate::world::HeightField;

/// What becomes of a robot on hills that drives no more, or in vain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Mishap {
    /// It lies on its side or on its back.
    Tipped,
    /// It fell by more than its own height, or off the world.
    Fell,
    /// Its wheels have turned for two seconds and moved it next to nothing. It is over when it moves again.
    Stuck,
    /// The middle of its mass is below the water's surface.
    Drowned,
    /// The numbers of its motion have come to an end, so that it stays where it was: its description is of no craft that
    /// could be.
    Broken,
}

impl std::fmt::Display for Mishap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Tipped => "tipped over",
            Self::Fell => "fell",
            Self::Stuck => "stuck",
            Self::Drowned => "drowned",
            Self::Broken => "broken",
        })
    }
}

/// Who watches a robot for mishaps.
#[derive(Debug, Clone)]
pub(super) struct Watch {
    height: f64,
    water_level: Option<f64>,
    mishap: Option<Mishap>,
    /// Where the middle of its mass was when the ground carried it last.
    left_ground: f64,
    /// How far the wheels would have moved it, and did, in the present look.
    wished: f64,
    moved: f64,
    ticks: u32,
    gone: bool,
}

/// The cosine of the angle to the vertical beyond which a robot lies: 70 degrees.
const LYING: f64 = 0.342;
/// Ticks of a look for robots that are stuck, and the share of its way that one makes which is not.
const LOOK: u32 = 200;
const PROGRESS: f64 = 0.1;
/// What a robot's wheels must have turned for it to be stuck, in metres or radians times a radius.
const LEAST_WISH: f64 = 0.02;
/// Metres below the lowest place of the ground at which a robot is off the world.
const OFF_THE_WORLD: f64 = 1.0;

impl Watch {
    pub(super) fn new(height: f64, water_level: Option<f64>) -> Self {
        Self {
            height,
            water_level,
            mishap: None,
            left_ground: f64::NEG_INFINITY,
            wished: 0.0,
            moved: 0.0,
            ticks: 0,
            gone: false,
        }
    }

    pub(super) fn mishap(&self) -> Option<Mishap> {
        self.mishap
    }

    /// Whether the robot drives no more.
    pub(super) fn is_over(&self) -> bool {
        matches!(self.mishap, Some(Mishap::Tipped | Mishap::Fell | Mishap::Drowned))
    }

    /// Whether it is off the world.
    pub(super) fn is_gone(&self) -> bool {
        self.gone
    }

    /// Begins anew: a hand has put the robot somewhere else.
    pub(super) fn forget(&mut self) {
        *self = Self::new(self.height, self.water_level);
    }

    /// Looks at a robot after a tick.
    pub(super) fn look(&mut self, body: &RigidBody, pose: &Pose3, ground: &HeightField, drive: &PlanarTwist) {
        let middle = body.middle().z;
        self.gone = middle < ground.lowest() - OFF_THE_WORLD;
        if self.falls(body) {
            // Over an edge a robot tips first.
            self.mishap = Some(Mishap::Fell);
        } else if !self.is_over() {
            self.mishap = self.verdict(body, pose, drive);
        }
        if body.is_carried() || self.left_ground == f64::NEG_INFINITY {
            self.left_ground = middle;
        }
    }

    /// Whether it has fallen off the world, or by more than its height. Falling so far takes a speed, which tells a
    /// fall from a slope that drops away under the wheels.
    fn falls(&self, body: &RigidBody) -> bool {
        let fast = -body.velocity().z > 0.7 * (2.0 * GRAVITY * self.height).sqrt();
        self.gone || (self.left_ground - body.middle().z > self.height && fast)
    }

    fn verdict(&mut self, body: &RigidBody, pose: &Pose3, drive: &PlanarTwist) -> Option<Mishap> {
        if pose.up().z < LYING {
            return Some(Mishap::Tipped);
        }
        if self.water_level.is_some_and(|level| body.middle().z < level) {
            return Some(Mishap::Drowned);
        }
        self.progress(body, drive)
    }

    fn progress(&mut self, body: &RigidBody, drive: &PlanarTwist) -> Option<Mishap> {
        let way = |linear: f64, angular: f64| (linear + angular * self.height) * TICK;
        let wished = way(drive.forward.abs() + drive.left.abs(), drive.angular.abs());
        let moved = way(body.velocity().norm(), body.spin().norm());
        (self.wished, self.moved) = (self.wished + wished, self.moved + moved);
        self.ticks += 1;
        if self.ticks < LOOK {
            return self.mishap;
        }
        let stuck = self.wished > LEAST_WISH && self.moved < PROGRESS * self.wished;
        (self.wished, self.moved, self.ticks) = (0.0, 0.0, 0);
        stuck.then_some(Mishap::Stuck)
    }
}
