use nalgebra::Matrix3;

use super::{HullPart, MAX_THRUSTERS};
use crate::ParameterError;
use crate::geometry::{Point3, Vector3};
use crate::parameter::{require, require_finite, require_not_negative};

/// Description of a craft: mass, hull and thrusters. Positions are in its own frame: x forward, y left, z up.
///
/// Added mass and damping refer to the hull's centre of volume, with one number for each degree of freedom:
/// surge, sway, heave, roll, pitch, yaw.
///
/// ```
/// use roverlab::geometry::{Point3, Vector3};
/// use roverlab::kinematics::marine::{Craft, CraftSpec, CraftState, HullPart, LocalWater};
///
/// // A buoy of 10 kg, half as heavy as the water in its place.
/// let ball = HullPart::Ellipsoid { half_axes: Vector3::repeat(0.168), centre: Point3::origin() };
/// let buoy = Craft::new(&CraftSpec::of_hull(10.0, Point3::new(0.0, 0.0, -0.05), vec![ball]), 0.01)?;
/// let mut state = CraftState::at_rest(&buoy, &Default::default());
/// for _ in 0..3000 {
///     buoy.advance(&mut state, &[], &LocalWater::still(0.0));
/// }
/// let (centre, displaced) = (state.pose(&buoy).position, buoy.displaced(&state, &LocalWater::still(0.0)));
/// assert!((displaced.volume - 0.010).abs() < 1e-5 && centre.z.abs() < 0.01);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CraftSpec {
    /// Mass (kg).
    pub mass: f64,
    /// Centre of mass.
    pub centre_of_mass: Point3,
    /// Moments and products of inertia about the centre of mass (kg m²).
    pub inertia: [[f64; 3]; 3],
    /// Parts that displace water.
    pub hull: Vec<HullPart>,
    /// Added mass (kg), and added moments of inertia for the last three (kg m²).
    pub added_mass: [f64; 6],
    /// Whether added mass turns the craft across the flow, as with a bare, slender hull (Munk moment). Frames
    /// and fins outweigh it; without them a craft does not keep its course.
    pub munk: bool,
    /// Linear damping (N s/m), and N m s for the last three.
    pub linear_damping: [f64; 6],
    /// Quadratic damping (N s²/m²), and N m s² for the last three.
    pub quadratic_damping: [f64; 6],
    /// Thrusters.
    pub thrusters: Vec<Thruster>,
}

/// A propeller and its motor.
#[derive(Debug, Clone, PartialEq)]
pub struct Thruster {
    /// Its name in the craft's description.
    pub name: String,
    /// Centre of the propeller.
    pub place: Point3,
    /// Direction of thrust when it turns forward; its length is ignored.
    pub direction: Vector3,
    /// Thrust at full speed forward (N).
    pub force: f64,
    /// Thrust at full speed backward, at most `force` (N).
    pub back: f64,
    /// Time constant with which its speed follows the command (s).
    pub lag: f64,
}

impl Thruster {
    /// Backward thrust of a propeller designed for forward thrust, as a fraction of the forward thrust:
    /// between measurements on boat motors (0.58 for the Otter) and symmetric blades (1).
    pub const BACK: f64 = 0.7;
    /// Radius of a propeller; at less depth it draws air (m).
    pub const RADIUS: f64 = 0.05;

    /// A thruster with a lag of 0.2 s.
    pub fn new(name: impl Into<String>, place: Point3, direction: Vector3, force: f64) -> Self {
        Self { name: name.into(), place, direction, force, back: Self::BACK * force, lag: 0.2 }
    }

    fn validate(&self) -> Result<(), ParameterError> {
        for coordinate in self.place.iter().chain(self.direction.iter()) {
            require_finite("thruster's place or direction", *coordinate)?;
        }
        let length = self.direction.norm();
        require("length of a thruster's direction", length, length > 1e-9 && length < 1e9, "more than 0")?;
        require_not_negative("thruster's force", self.force)?;
        require("thruster's force", self.force, self.force <= MOST_FORCE, "at most 1e6 N")?;
        let weaker = (0.0..=self.force).contains(&self.back);
        require("thruster's force backward", self.back, weaker, "0 to its force forward")?;
        require_not_negative("thruster's lag", self.lag)
    }
}

/// Force of the strongest thruster (N).
const MOST_FORCE: f64 = 1e6;
/// Mass of the heaviest craft (kg).
const MOST_MASS: f64 = 1e6;
/// The most that a moment of inertia is of the sum of the two others: 1 of a flat body, and what a file rounds.
const FLAT: f64 = 1.001;

impl CraftSpec {
    /// Speed at which damping equals the full forward thrust (m/s); 0 without forward thrust.
    pub fn top_speed(&self) -> f64 {
        let ahead = |thruster: &Thruster| {
            let share = thruster.direction.x / thruster.direction.norm();
            if share > 0.0 { share * thruster.force } else { -share * thruster.back }
        };
        let force: f64 = self.thrusters.iter().map(ahead).sum();
        let (linear, quadratic) = (self.linear_damping[0], self.quadratic_damping[0]);
        let root = (linear * linear + 4.0 * quadratic * force).sqrt();
        if force > 0.0 { 2.0 * force / (linear + root) } else { 0.0 }
    }

    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require(
            "craft's mass",
            self.mass,
            self.mass > 0.0 && self.mass <= MOST_MASS,
            "more than 0 and at most 1e6",
        )?;
        for coordinate in self.centre_of_mass.iter() {
            require_finite("craft's middle of mass", *coordinate)?;
        }
        for value in self.inertia.as_flattened() {
            require("craft's inertia", *value, value.abs() <= 1e9, "at most 1e9")?;
        }
        let moments = Matrix3::from_fn(|row, column| self.inertia[row.min(column)][row.max(column)]);
        let moments = moments.symmetric_eigenvalues();
        require_not_negative("craft's least principal moment of inertia", moments.min())?;
        let (largest, others) = (moments.max(), moments.sum() - moments.max());
        let expected = "at most the sum of the two others";
        require("craft's largest principal moment of inertia", largest, largest <= FLAT * others, expected)?;
        self.hull.iter().try_for_each(HullPart::validate)?;
        for (name, values) in [
            ("added mass", &self.added_mass),
            ("linear damping", &self.linear_damping),
            ("quadratic damping", &self.quadratic_damping),
        ] {
            values.iter().try_for_each(|&value| require_not_negative(name, value))?;
            values.iter().try_for_each(|&value| require(name, value, value <= 1e9, "at most 1e9"))?;
        }
        let count = self.thrusters.len();
        require("number of thrusters", count as f64, count <= MAX_THRUSTERS, "at most 8")?;
        self.thrusters.iter().try_for_each(Thruster::validate)
    }
}
