//! Kinematics of drives: forward and inverse, and exact integration over a step.
//!
//! [`Differential`] has two driven wheels, [`Ackermann`] is a car, [`Omni`] moves in every direction on three
//! or four wheels with rollers, [`Tracked`] skids on two belts. The wheeled drives have `forward`, `inverse`
//! and `inverse_limited`; the last one preserves the direction of motion where a wheel would have to turn too
//! fast. [`advance`] and [`advance_planar`] integrate in closed form. [`OdometryUncertainty`] propagates the
//! uncertainty of odometry. [`marine`] moves craft in water.

mod ackermann;
mod differential;
mod integrate;
pub mod marine;
mod omni;
mod planar;
mod tracked;
mod uncertainty;

pub use ackermann::{Ackermann, CarState, CarWheels};
pub use differential::{Differential, WheelSpeeds};
pub use integrate::{Displacement, advance};
pub use omni::{Omni, RollerWheel};
pub use planar::{PlanarMotion, PlanarTwist, advance_planar};
pub use tracked::Tracked;
pub(crate) use uncertainty::{
    DISTANCE_ERROR, LEAST_RANGE_ERROR, OUTLIER, OdometryStep, SCALE_ERROR, TURN_ERROR, arc_between,
};
pub use uncertainty::{OdometryErrors, OdometryUncertainty};
