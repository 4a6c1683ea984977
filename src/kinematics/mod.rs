//! Pure geometry of drives: from wheel motions to robot motions and back, and exact integration over a step.
//!
//! [`Differential`] has two driven wheels, [`Ackermann`] is a car, [`Omni`] moves in every direction on three or four
//! wheels with rollers, [`Tracked`] skids on two belts. The wheeled ones have `forward`, `inverse`, and `inverse_limited`, which keeps the direction of motion where a
//! wheel would have to turn too fast. [`advance`] and [`advance_planar`] integrate in closed form.
//! [`OdometryUncertainty`] says how far odometry may be wrong.

mod ackermann;
mod differential;
mod integrate;
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
pub use uncertainty::{OdometryErrors, OdometryUncertainty};
pub(crate) use uncertainty::{
    DISTANCE_ERROR, LEAST_RANGE_ERROR, OUTLIER, OdometryStep, SCALE_ERROR, TURN_ERROR, arc_between,
};
