use std::f64::consts::PI;

use super::spec::{StarmanSpec, require_time_step};
use crate::geometry::{Point, Pose, direction};
use crate::io::{Error, Result};
use crate::parameter::{require, require_not_negative, require_positive, require_up_to};

/// A body with limbs, which may have limbs themselves: a tree with a servo in every joint. Lengths in metres,
/// masses in kilograms, angles in radians.
///
/// Frames have their x axis along a part. That of the body has its origin in the middle, and at rest x points
/// along the floor and y up; that of a limb has its origin in its hinge.
///
/// ```
/// use roverlab::io::sim::starman::{BodyPlan, LimbPlan, Starman};
/// use roverlab::io::{Clock, Odometry, Servos};
///
/// # fn main() -> roverlab::io::Result<()> {
/// // A worm of three parts, the outer ones bent a little downwards.
/// let part = LimbPlan { length: 0.08, radius: 0.012, mass: 0.1, range: 0.8, ..LimbPlan::default() };
/// let plan = BodyPlan {
///     length: 0.08,
///     limbs: vec![
///         LimbPlan { hinge: [0.04, 0.0], rest: -0.2, ..part },
///         LimbPlan { hinge: [-0.04, 0.0], rest: 3.3416, ..part },
///     ],
///     ..BodyPlan::default()
/// };
/// let mut worm = Starman::of(&plan)?;
/// worm.wait(1.0)?;
/// worm.set_servo(1, -1.0)?;
/// worm.wait(1.0)?;
/// assert!(worm.pose()?.x.abs() < 0.1 && worm.truth().posture.limbs[0] < -0.5);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct BodyPlan {
    /// Length of the body between the middles of its round ends; 0 for a disc.
    pub length: f64,
    /// Radius of its ends.
    pub radius: f64,
    /// Mass of the body.
    pub mass: f64,
    /// The limbs; servo 1 moves the first one.
    pub limbs: Vec<LimbPlan>,
    /// Coefficient of friction between parts and floor.
    pub friction: f64,
    /// Servo speed per second.
    pub servo_speed: f64,
    /// Largest torque of a servo (N m).
    pub servo_torque: f64,
    /// Time step of the physics (s).
    pub time_step: f64,
}

/// A limb of a [`BodyPlan`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimbPlan {
    /// Index of the limb that carries it, an earlier one; `None` for the body.
    pub parent: Option<usize>,
    /// Hinge in the parent's frame.
    pub hinge: [f64; 2],
    /// Direction at rest, in the parent's frame.
    pub rest: f64,
    /// Distance from the hinge to the middle of its round tip.
    pub length: f64,
    /// Half its width.
    pub radius: f64,
    /// Mass of the limb.
    pub mass: f64,
    /// Swing to either side of its rest.
    pub range: f64,
}

impl Default for LimbPlan {
    /// A limb of the book's Starman, on the body's middle.
    fn default() -> Self {
        let StarmanSpec { limb_length, limb_radius, limb_mass, servo_range, .. } = StarmanSpec::book();
        Self {
            parent: None,
            hinge: [0.0, 0.0],
            rest: 0.0,
            length: limb_length,
            radius: limb_radius,
            mass: limb_mass,
            range: servo_range,
        }
    }
}

impl Default for BodyPlan {
    /// A capsule without limbs, with servos of 90 degrees per second.
    fn default() -> Self {
        let StarmanSpec { friction, servo_torque, time_step, .. } = StarmanSpec::book();
        Self {
            length: 0.1,
            radius: 0.015,
            mass: 0.2,
            limbs: Vec::new(),
            friction,
            servo_speed: 0.5 * PI,
            servo_torque,
            time_step,
        }
    }
}

/// Largest number of limbs: servos have numbers of a byte, and more would slow the physics down.
const MOST_LIMBS: usize = 24;
/// Maximum length (m).
const LONGEST: f64 = 1e3;
/// Maximum of a body's other values, in SI units; far beyond, the physics overflows.
const MOST: f64 = 1e6;
/// Widest swing (rad): the limits of joints are checked by sines.
const WIDEST: f64 = 1.2;

impl BodyPlan {
    /// Checks every value; the error names the one out of range, and the limb that it belongs to.
    pub fn validate(&self) -> Result<()> {
        require_not_negative("body length", self.length)?;
        require("body length", self.length, self.length <= LONGEST, "at most 1000 m")?;
        require_up_to("body radius", self.radius, LONGEST)?;
        require_up_to("body mass", self.mass, MOST)?;
        require_up_to("friction", self.friction, MOST)?;
        require_up_to("servo speed", self.servo_speed, MOST)?;
        require_up_to("servo torque", self.servo_torque, MOST)?;
        require_time_step(self.time_step)?;
        let limbs = self.limbs.len();
        require("number of limbs", limbs as f64, (1..=MOST_LIMBS).contains(&limbs), "1 to 24")?;
        self.limbs.iter().enumerate().try_for_each(|(index, limb)| limb.validate(index))
    }

    /// Poses of the body's middle and of the limbs' hinges at rest, with the body's middle at the origin.
    pub(super) fn at_rest(&self) -> Vec<Pose> {
        let mut hinges: Vec<Pose> = Vec::with_capacity(self.limbs.len());
        for limb in &self.limbs {
            let parent = limb.parent.map_or_else(Pose::default, |parent| hinges[parent]);
            hinges.push(parent.compose(&Pose::new(limb.hinge[0], limb.hinge[1], limb.rest)));
        }
        hinges
    }

    /// Height of the body's middle when the lowest part touches the floor.
    pub(super) fn standing_height(&self) -> f64 {
        let tips = self.at_rest().into_iter().zip(&self.limbs).map(|(hinge, limb)| {
            let tip = hinge.position() + direction(hinge.heading) * limb.length;
            hinge.position().y.min(tip.y) - limb.radius
        });
        -tips.fold(-self.radius, f64::min)
    }

    /// The end of a limb's frame (m).
    pub(super) fn middle_of(limb: &LimbPlan, hinge: &Pose) -> Point {
        hinge.position() + direction(hinge.heading) * (0.5 * limb.length)
    }
}

impl LimbPlan {
    fn validate(&self, index: usize) -> Result<()> {
        let whole = |error: crate::ParameterError| Error::from(error.of(&format!("limb {}", index + 1)));
        if let Some(parent) = self.parent.filter(|parent| *parent >= index) {
            let expected = "an earlier limb";
            return Err(Error::invalid_input(
                &format!("parent of limb {}", index + 1),
                parent.saturating_add(1),
                expected,
            ));
        }
        let good = self.hinge.iter().all(|place| place.abs() <= LONGEST);
        require("hinge", self.hinge[0].max(self.hinge[1]), good, "at most 1000 m away").map_err(whole)?;
        require("rest", self.rest, self.rest.abs() <= 2.0 * PI, "at most a turn either way")
            .map_err(whole)?;
        require_up_to("length", self.length, LONGEST).map_err(whole)?;
        require_up_to("radius", self.radius, LONGEST).map_err(whole)?;
        require_up_to("mass", self.mass, MOST).map_err(whole)?;
        require_positive("range", self.range).map_err(whole)?;
        require("range", self.range, self.range <= WIDEST, "at most 1.2 rad").map_err(whole)
    }
}
