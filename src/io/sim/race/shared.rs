//! A race whose cars are owned by whoever drives them.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use image::RgbImage;

use super::world::Race;
use crate::geometry::{Pose, Twist};
use crate::io::{
    Camera, Clock, Display, DisplayOption, DistanceSensors, Drive, Encoders, Error, Fill, Font, Key, Keys,
    Lidar, LidarScan, LidarSettings, Motors, Picture, Pixel, Psd, Radio, RadioMessage, Resolution, Result,
    RobotTruth, Servos, Viewport, Witness,
};
use crate::world::Colour;

/// A race that is held by several: its cars, and whoever knows what is true. Copies share it.
#[derive(Debug, Clone)]
pub struct SharedRace {
    race: Arc<Mutex<Race>>,
}

impl SharedRace {
    /// Shares a race.
    pub fn new(race: Race) -> Self {
        Self { race: Arc::new(Mutex::new(race)) }
    }

    /// A car as a robot of its own, by its number from 0. Time passes for all cars when one of them waits.
    pub fn car(&self, index: usize) -> Result<SharedCar> {
        self.lock().car(index)?;
        Ok(SharedCar { race: self.clone(), index })
    }

    /// Seconds since the beginning.
    pub fn time(&self) -> f64 {
        self.lock().time()
    }

    /// All that is true about a car. Its contacts are the cones that it has knocked over, at their places, and, as the last
    /// one, another car that it has touched, at its own place.
    pub fn robot(&self, index: usize) -> Result<RobotTruth> {
        self.lock().robot_truth(index)
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, Race> {
        // A panic elsewhere leaves nothing half done that matters here.
        self.race.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Witness for SharedRace {
    fn time(&mut self) -> Result<f64> {
        Ok(SharedRace::time(self))
    }

    fn pose(&mut self, robot: usize) -> Result<Pose> {
        Ok(SharedRace::robot(self, robot)?.pose)
    }

    fn robot(&mut self, robot: usize) -> Result<RobotTruth> {
        SharedRace::robot(self, robot)
    }

    /// The place of a cone, whether it stands or has fallen.
    fn object(&mut self, object: usize) -> Result<Pose> {
        self.lock().cone_pose(object)
    }
}

/// A car of a [`SharedRace`], with all capabilities of a robot; those that a racing car has not fail, and name what is missing.
#[derive(Debug, Clone)]
pub struct SharedCar {
    race: SharedRace,
    index: usize,
}

macro_rules! shared_impl {
    ($capability:ident { $( fn $name:ident($($arg:ident: $type:ty),*) -> $result:ty; )* }) => {
        impl $capability for SharedCar {
            $( fn $name(&mut self $(, $arg: $type)*) -> Result<$result> {
                self.race.lock().car(self.index)?.$name($($arg),*)
            } )*
        }
    };
}

macro_rules! missing_impl {
    ($device:literal $capability:ident { $( fn $name:ident($($arg:ident: $type:ty),*) -> $result:ty; )* }) => {
        impl $capability for SharedCar {
            $( fn $name(&mut self $(, _: $type)*) -> Result<$result> {
                Err(Error::unsupported($device))
            } )*
        }
    };
}

signatures! { Clock => shared_impl!() }
signatures! { Drive => shared_impl!() }
signatures! { Lidar => shared_impl!() }
signatures! { Camera => shared_impl!() }
signatures! { Motors => shared_impl!() }
signatures! { Servos => shared_impl!() }
signatures! { DistanceSensors => missing_impl!("distance sensors") }
signatures! { Display => missing_impl!("display") }
signatures! { Keys => missing_impl!("keys") }
signatures! { Radio => missing_impl!("radio") }
signatures! { Encoders => missing_impl!("encoders") }

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::io::RobotIo;
    use crate::io::sim::race::{RaceCarSpec, RaceCone, RaceOptions};

    #[test]
    fn a_car_is_a_robot_of_its_own() {
        let cones = [RaceCone::new(Point::new(8.0, 0.1), Colour::BLUE)];
        let cars = [Pose::default(), Pose::new(0.0, 5.0, 0.0)].map(|pose| (RaceCarSpec::default(), pose));
        let shared = SharedRace::new(Race::new(&cones, &cars, RaceOptions::default()).unwrap());
        let mut car: Box<dyn RobotIo + Send> = Box::new(shared.car(0).unwrap());
        car.set_speed(Twist::new(4.0, 0.0)).unwrap();
        car.wait(3.0).unwrap();
        let truth = shared.robot(0).unwrap();
        assert_eq!((truth.contacts, truth.contact_places.as_slice()), (1, &[cones[0].position][..]));
        assert!(truth.path_length > 6.0 && shared.robot(1).unwrap().path_length == 0.0);
        assert_eq!(car.read_key().unwrap_err().to_string(), "the robot has no keys");
        assert!(shared.car(2).is_err() && (shared.time() - 3.0).abs() < 1e-9);
    }
}
