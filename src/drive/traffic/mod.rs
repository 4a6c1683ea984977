//! Driving in traffic (book, chapter 13): the driver, the scene, and the referees.
//!
//! [`FreeDrive`] judges how a car keeps its lane on a free road. For Obstacle Evasion, [`TrafficScene`] puts
//! boxes and pedestrians on a course, [`TrafficActors`] moves them, [`TrafficDriver`] drives by camera and
//! odometry, and [`ObstacleEvasion`] judges it by the rules. Referee and actors see the truth; the driver
//! does not.
//!
//! Several cars share a road by radio: each is a [`RadioCar`], and a [`RoadStation`] draws them and stops
//! them.

mod actors;
mod driver;
mod encounter;
mod evasion;
mod obstacles;
mod parameters;
mod radio;
mod referee;
mod scene;
mod score;
mod shift;
#[cfg(test)]
mod tests;
mod turn;

pub use actors::{CarFront, TrafficActors};
pub use driver::{TrafficDriver, TrafficState};
pub use evasion::ObstacleEvasion;
pub use parameters::TrafficParameters;
pub use radio::{
    CarIntent, CarReport, RadioCar, RadioCarCommand, RadioCarObservation, RoadMessage, RoadSharing,
    RoadSharingParameters, RoadStation, RoadStationCommand, RoadStationObservation, RoadStationParameters,
};
pub use referee::{FreeDrive, FreeDriveRules, FreeDriveScore};
pub use scene::{BoxMotion, RoadBox, TrafficScene};
pub use score::{EvasionElement, EvasionRow, EvasionScore};
pub use turn::RoadTurn;
