//! Parking beside a road (book, chapter 13), parallel and perpendicular.
//!
//! [`ParkingLot`] draws areas by the rules of the CAuDri-Challenge, and judges where a car stands.
//! [`ParkingDriver`] keeps the lane by camera, measures gaps between boxes by a distance sensor, and plans
//! the shortest path into the gap, forward and in reverse.

mod driver;
mod follow;
mod gaps;
mod lot;
mod search;
mod spots;

pub use driver::{ParkingDriver, ParkingObservation, ParkingOutcome, ParkingParameters};
pub use lot::{ParkingKind, ParkingLot, parking_car};
