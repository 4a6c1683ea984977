//! Racing cars between cones: tyres that slip, cones that are knocked over, a low lidar, and nothing else, so that a
//! thousand races take minutes.
//!
//! A [`Race`] holds the cones and the cars. Its cars have the same traits as every robot ([`RaceCar`]).
//!
//! ```
//! use roverlab::geometry::{Point, Pose, Twist};
//! use roverlab::io::sim::race::{Race, RaceCarSpec, RaceCone, RaceOptions};
//! use roverlab::io::{Clock, Drive, Lidar};
//! use roverlab::world::Colour;
//!
//! # fn main() -> roverlab::io::Result<()> {
//! let cones = [RaceCone::new(Point::new(20.0, 0.2), Colour::from_hex(0xff_80_00))];
//! let mut race = Race::new(&cones, &[(RaceCarSpec::default(), Pose::default())], RaceOptions::default())?;
//! let mut car = race.car(0)?;
//! assert!(car.scan()?.points().all(|point| (point - cones[0].position).norm() < 0.2));
//! car.set_speed(Twist::new(6.0, 0.0))?;
//! car.wait(5.0)?;
//! assert_eq!(race.hits(), 1);
//! # Ok(())
//! # }
//! ```

mod body;
mod camera;
mod robot;
mod shared;
mod sight;
mod world;

pub use body::{CarModel, RaceCarSpec};
pub use camera::RaceCamera;
pub use robot::RaceCar;
pub use shared::{SharedCar, SharedRace};
pub use world::{CarTruth, Race, RaceCone, RaceOptions};
