//! Driving by a network that sees the camera image and steers (book, section 13.6).
//!
//! [`NetworkDriver`] drives by a trained [`Network`](crate::vision::network::Network). What it learns from
//! are [`SteeringExamples`]: images, each with the curvature that a
//! [`LaneKeeper`](super::lane_keeping::LaneKeeper) would steer there. A [`SteeringTeacher`] collects them
//! while the lane keeper drives and is disturbed, so that there are images from beside the lane's middle too,
//! or while a network drives whose mistakes the lane keeper corrects on paper (dataset aggregation; Ross et
//! al. 2011). The feature `learn` trains with them.
//!
//! ```
//! use roverlab::drive::end_to_end::{
//!     NetworkDriver, SteeringExamples, SteeringTeacher, TeacherParameters, see_road_into,
//! };
//! use roverlab::drive::lane_keeping::{LaneKeeper, LaneKeeperParameters};
//! use roverlab::io::Camera;
//! use roverlab::io::control::run;
//! use roverlab::io::sim::{SimOptions, Simulation};
//! use roverlab::vision::lane_markings::RoadModel;
//! use roverlab::vision::network::{Architecture, Network};
//! use roverlab::world::road::{Appearance, RoadCourseOptions, generate};
//! use roverlab::world::{RobotSpec, Scene};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let course = generate(2, &RoadCourseOptions::default())?;
//! let world = course.world(&Appearance { pixel: 0.004, ..Appearance::default() })?;
//! let spec = RobotSpec::road_car();
//! let scene = Scene::with_robot(world, spec.clone(), course.start());
//! let mut car = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?.robot(0)?;
//!
//! // A second of lessons for a network that sees 16 by 40 pixels.
//! let architecture: Architecture = "16x40x1 conv4/5/2 dense1".parse()?;
//! let camera = spec.camera.as_ref().expect("the car has one").into();
//! let keeper = LaneKeeper::new(camera, RoadModel::default(), LaneKeeperParameters::default())?;
//! let mut teacher = SteeringTeacher::new(keeper, architecture.input(), TeacherParameters::default())?;
//! run(&mut car, &mut teacher, 1.0, |_, _, _| ())?;
//! let examples: SteeringExamples = teacher.into_examples();
//! assert!(examples.len() >= 29);
//!
//! // A network of zeros drives straight on.
//! let zeros = |(filters, taps): (usize, usize)| (vec![0.0; filters * taps], vec![0.0; filters]);
//! let weights = architecture.filters().flatten().map(zeros);
//! let network = Network::new(architecture.clone(), weights.collect())?;
//! let mut driver = NetworkDriver::new(network, 1.0)?;
//! run(&mut car, &mut driver, 0.5, |_, _, _| ())?;
//! assert_eq!(driver.curvature(), 0.0);
//!
//! // What it sees of an image.
//! let mut input = vec![0.0; architecture.input().len()];
//! see_road_into(&car.image()?, architecture.input(), &mut input)?;
//! # Ok(())
//! # }
//! ```

mod driver;
mod examples;
mod sight;
mod teacher;
#[cfg(test)]
mod tests;

pub use driver::NetworkDriver;
pub use examples::SteeringExamples;
pub use sight::see_road_into;
pub use teacher::{SteeringTeacher, TeacherParameters};
