use crate::geometry::{Point, Pose, Vector, Vector3};
use crate::kinematics::marine::{Craft, CraftMotion, Wrench};

/// A boat's velocity over ground without that of the waves, which carry it to and fro faster than its thrusters
/// can follow: wave filtering by an observer (Fossen 2021, section 13.2).
///
/// The model says what the thrusters and the water's drag do at once; the log corrects it so slowly that waves
/// average out. What wind and current do besides is learnt as an acceleration.
#[derive(Debug, Clone, Default)]
pub(super) struct SlowMotion {
    /// Over ground, in the world (m/s).
    velocity: Vector,
    /// By what the model does not know, in the world (m/s²).
    unknown: Vector,
    begun: bool,
}

/// Bandwidth (rad/s): a sixth of the frequency of waves of 3.5 s, the longest that small lakes have.
const BANDWIDTH: f64 = 0.3;

impl SlowMotion {
    /// Moves on, `seconds` after the step before: at a pose, turning at a rate, pushed ahead by a force (N), and
    /// by the log at a velocity in the craft's frame.
    pub(super) fn advance(
        &mut self,
        craft: &Craft,
        pose: &Pose,
        turn_rate: f64,
        ahead: f64,
        log: Vector,
        seconds: f64,
    ) {
        let seen = turned(pose, log);
        if !self.begun {
            (self.velocity, self.begun) = (seen, true);
        }
        let own = self.along(pose);
        let motion =
            CraftMotion { linear: Vector3::new(own.x, own.y, 0.0), angular: Vector3::z() * turn_rate };
        let force = Wrench { force: Vector3::x() * ahead, moment: Vector3::zeros() };
        let rates = craft.response(&motion, &force).linear;
        // The model's rates are those of a frame that turns.
        let rates = Vector::new(rates.x - turn_rate * own.y, rates.y + turn_rate * own.x);
        let off = seen - self.velocity;
        let by_model = turned(pose, rates) + self.unknown;
        self.velocity += (by_model + off * (2.0 * BANDWIDTH)) * seconds;
        self.unknown += off * (BANDWIDTH * BANDWIDTH * seconds);
    }

    /// The velocity over ground, in the world (m/s).
    pub(super) fn velocity(&self) -> Vector {
        self.velocity
    }

    /// The same forward and to the left of a craft at a pose.
    pub(super) fn along(&self, pose: &Pose) -> Vector {
        in_frame(pose, self.velocity)
    }

    /// The acceleration forward and to the left by what the model does not know (m/s²).
    pub(super) fn unknown(&self, pose: &Pose) -> Vector {
        in_frame(pose, self.unknown)
    }
}

/// A vector of a craft's frame in the world.
fn turned(pose: &Pose, own: Vector) -> Vector {
    pose.to_world(Point::from(own)) - pose.position()
}

/// A vector of the world in a craft's frame.
fn in_frame(pose: &Pose, vector: Vector) -> Vector {
    pose.to_local(pose.position() + vector).coords
}
