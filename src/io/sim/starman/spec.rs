use crate::ParameterError;
use crate::parameter::{require, require_positive};
use std::f64::consts::PI;

/// Largest time step (s).
const MOST_STEP: f64 = 0.02;
/// Shortest time step (s): with shorter ones, a run takes forever.
const LEAST_STEP: f64 = 1e-5;

/// Dimensions and servos of a Starman. Lengths in metres, masses in kilograms, angles in radians.
///
/// The form and the servos' range and speed are from the book; sizes and masses are those of a robot that
/// could be built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StarmanSpec {
    /// Radius of the body (m); the limbs' hinges are on its rim, a fifth of a turn apart.
    pub body_radius: f64,
    /// Mass of the body (kg).
    pub body_mass: f64,
    /// Distance from a limb's hinge to its tip (m).
    pub limb_length: f64,
    /// Half the width of a limb, whose ends are round (m).
    pub limb_radius: f64,
    /// Mass of a limb (kg).
    pub limb_mass: f64,
    /// Coefficient of friction between limbs and floor.
    pub friction: f64,
    /// Swing of a limb to either side.
    pub servo_range: f64,
    /// Servo speed per second.
    pub servo_speed: f64,
    /// Largest torque of a servo (N m).
    pub servo_torque: f64,
    /// Time step of the physics (s).
    pub time_step: f64,
}

impl StarmanSpec {
    /// The book's robot: servos of 30 degrees to either side and 30 degrees per second.
    pub fn book() -> Self {
        let degree = PI / 180.0;
        Self {
            body_radius: 0.060,
            body_mass: 0.600,
            limb_length: 0.090,
            limb_radius: 0.010,
            limb_mass: 0.080,
            friction: 0.5,
            servo_range: 30.0 * degree,
            servo_speed: 30.0 * degree,
            servo_torque: 2.0,
            time_step: 0.010,
        }
    }

    /// The original figure, without regard to hardware: limbs as long as the body is wide, which snap to
    /// their angles (A. Fukunaga et al., "Motion-Synthesis Techniques for 2D Articulated Figures", Harvard
    /// TR-05-94, 1994).
    pub fn planar() -> Self {
        let book = Self::book();
        Self { limb_length: 2.0 * book.body_radius, servo_speed: 12.0 * book.servo_speed, ..book }
    }

    /// Fails with the name of a value out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let all = [
            ("body radius", self.body_radius),
            ("body mass", self.body_mass),
            ("limb length", self.limb_length),
            ("limb radius", self.limb_radius),
            ("limb mass", self.limb_mass),
            ("friction", self.friction),
            ("servo range", self.servo_range),
            ("servo speed", self.servo_speed),
            ("servo torque", self.servo_torque),
        ];
        all.into_iter().try_for_each(|(name, value)| require_positive(name, value))?;
        // With a wider range, neighbours would cross; with a larger time step, the solver cannot hold the
        // hinges.
        require("servo range", self.servo_range, self.servo_range <= PI / 5.0, "at most a tenth of a turn")?;
        require_time_step(self.time_step)
    }
}

/// Checks a time step of the physics.
pub(super) fn require_time_step(step: f64) -> Result<(), ParameterError> {
    require("time step", step, (LEAST_STEP..=MOST_STEP).contains(&step), "0.00001 to 0.02 s")
}

impl Default for StarmanSpec {
    fn default() -> Self {
        Self::book()
    }
}
