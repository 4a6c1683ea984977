use super::RigidBody;
use super::undercarriage::GRAVITY;
use crate::geometry::Pose3;
use crate::io::Mishap;
use crate::io::sim::TICK;
use crate::kinematics::PlanarTwist;
use crate::world::HeightField;

/// Detects mishaps of a robot.
#[derive(Debug, Clone)]
pub(super) struct Watch {
    height: f64,
    water_level: Option<f64>,
    mishap: Option<Mishap>,
    /// Height of its centre of mass when the ground last carried it.
    left_ground: f64,
    /// Motion of the wheels and of the robot in the present observation.
    wished: f64,
    moved: f64,
    ticks: u32,
    gone: bool,
}

/// Cosine of the angle to the vertical beyond which a robot lies, or hangs over an edge: 60 degrees.
const LYING: f64 = 0.5;
/// Ticks of an observation for stuck robots.
const LOOK: u32 = 200;
/// Smallest fraction of its way that a robot makes if it is not stuck.
const PROGRESS: f64 = 0.1;
/// Smallest motion of the wheels of a stuck robot (m, or rad times a radius).
const LEAST_WISH: f64 = 0.02;
/// Depth below the lowest point of the ground at which a robot is off the world (m).
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

    /// Whether the robot can no longer drive.
    pub(super) fn is_over(&self) -> bool {
        matches!(self.mishap, Some(Mishap::Tipped | Mishap::Fell | Mishap::Drowned))
    }

    /// Whether it is off the world.
    pub(super) fn is_gone(&self) -> bool {
        self.gone
    }

    /// Restarts after the robot was placed elsewhere.
    pub(super) fn forget(&mut self) {
        *self = Self::new(self.height, self.water_level);
    }

    /// Observes a robot after a tick.
    pub(super) fn look(&mut self, body: &RigidBody, pose: &Pose3, ground: &HeightField, drive: &PlanarTwist) {
        let middle = body.middle().z;
        self.gone = middle < ground.lowest() - OFF_THE_WORLD;
        if self.falls(body) {
            // A robot tips over an edge before it falls.
            self.mishap = Some(Mishap::Fell);
        } else if !self.is_over() {
            self.mishap = self.verdict(body, pose, drive);
        }
        if body.is_carried() || self.left_ground == f64::NEG_INFINITY {
            self.left_ground = middle;
        }
    }

    /// Whether it has fallen off the world, or by more than its height. The required speed distinguishes a
    /// fall from driving down a slope.
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
