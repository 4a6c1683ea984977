//! Cars that share a road by radio, and their base station (book, chapter 13).
//!
//! ```
//! use roverlab::drive::traffic::{RadioCar, RoadSharing, RoadSharingParameters, RoadStation, TrafficParameters};
//! use roverlab::geometry::Pose;
//! # let camera = roverlab::world::RobotSpec::road_car().camera.as_ref().unwrap().into();
//! // A car, and what it does as long as it has heard of nobody.
//! let parameters = (TrafficParameters::default(), RoadSharingParameters::default());
//! let car = RadioCar::new(camera, Default::default(), parameters, Pose::default())?;
//! assert_eq!(car.pose(&Pose::new(1.0, 0.0, 0.0)), Pose::new(1.0, 0.0, 0.0));
//! let sharing = RoadSharing::new(RoadSharingParameters::default())?;
//! let ahead: Vec<Pose> = RoadSharing::distances().map(|distance| Pose::new(distance, 0.0, 0.0)).collect();
//! assert!(sharing.limit(0.0, &ahead, 1.0).0 > 1.0, "the road is free");
//! let station = RoadStation::new(Default::default())?;
//! assert!(station.cars().is_empty(), "it has heard of nobody");
//! # Ok::<(), roverlab::ParameterError>(())
//! ```

mod car;
mod message;
mod sharing;
mod station;

pub use car::{RadioCar, RadioCarCommand, RadioCarObservation};
pub use message::{CarIntent, CarReport, RoadMessage};
pub use sharing::{RoadSharing, RoadSharingParameters};
pub use station::{RoadStation, RoadStationCommand, RoadStationObservation, RoadStationParameters};
