use image::RgbImage;

use super::world::Race;
use crate::geometry::{Pose, Twist, math};
use crate::io::{
    Camera, Clock, Drive, Error, Lidar, LidarScan, LidarSettings, Motors, Resolution, Result, Servos,
};

/// A car of a race: drive, lidar, camera, clock, motor 1 and servo 1.
///
/// Its origin is the middle of the rear axle. Odometry takes the speed from the wheels and the heading from a gyroscope; that
/// the car slides is beyond it.
#[derive(Debug)]
pub struct RaceCar<'r> {
    pub(super) race: &'r mut Race,
    pub(super) index: usize,
}

fn manoeuvre() -> Result<()> {
    Err(Error::unsupported("manoeuvres: it is driven by speeds"))
}

impl Clock for RaceCar<'_> {
    fn now(&mut self) -> Result<f64> {
        Ok(self.race.time())
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        crate::io::error::require_finite("seconds", seconds)?;
        self.race.advance(seconds);
        Ok(())
    }
}

impl Drive for RaceCar<'_> {
    /// The curvature is kept by the steering of slow wheels; a car that is to turn on the spot turns its steering and stands.
    fn set_speed(&mut self, twist: Twist) -> Result<()> {
        crate::io::error::require_finite("speed", twist.linear + twist.angular)?;
        let car = &mut self.race.cars[self.index];
        car.command.speed = twist.linear;
        car.command.steering = if twist.angular == 0.0 {
            0.0
        } else if twist.linear == 0.0 {
            car.spec.max_steering.copysign(twist.angular)
        } else {
            math::atan(car.spec.wheelbase() * twist.angular / twist.linear)
        };
        Ok(())
    }

    fn speed(&mut self) -> Result<Twist> {
        Ok(self.race.cars[self.index].measured)
    }

    fn pose(&mut self) -> Result<Pose> {
        Ok(self.race.cars[self.index].odometry)
    }

    fn set_pose(&mut self, pose: Pose) -> Result<()> {
        if !pose.is_finite() {
            return Err(Error::invalid_input("pose", format!("{pose:?}"), "finite numbers"));
        }
        self.race.cars[self.index].odometry = pose;
        Ok(())
    }

    fn straight(&mut self, _: f64, _: f64) -> Result<()> {
        manoeuvre()
    }

    fn turn(&mut self, _: f64, _: f64) -> Result<()> {
        manoeuvre()
    }

    fn curve(&mut self, _: f64, _: f64, _: f64) -> Result<()> {
        manoeuvre()
    }

    fn remaining(&mut self) -> Result<f64> {
        Ok(0.0)
    }

    fn is_done(&mut self) -> Result<bool> {
        Ok(true)
    }

    fn wait_done(&mut self) -> Result<()> {
        Ok(())
    }

    fn is_stalled(&mut self) -> Result<bool> {
        Ok(false)
    }
}

impl Lidar for RaceCar<'_> {
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()> {
        self.race.look(self.index, scan);
        Ok(())
    }

    fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()> {
        settings.validate()?;
        self.race.cars[self.index].scanner = settings;
        Ok(())
    }
}

impl Motors for RaceCar<'_> {
    fn set_motor(&mut self, motor: u8, fraction: f64) -> Result<()> {
        crate::io::error::require_finite("fraction", fraction)?;
        if motor != 1 {
            return Err(Error::unsupported(format!("motor {motor}")));
        }
        let car = &mut self.race.cars[self.index];
        car.command.speed = fraction.clamp(-1.0, 1.0) * car.spec.top_speed;
        Ok(())
    }
}

impl Servos for RaceCar<'_> {
    fn set_servo(&mut self, servo: u8, position: f64) -> Result<()> {
        crate::io::error::require_finite("position", position)?;
        if servo != 1 {
            return Err(Error::unsupported(format!("servo {servo}")));
        }
        let car = &mut self.race.cars[self.index];
        car.command.steering = -position.clamp(-1.0, 1.0) * car.spec.max_steering;
        Ok(())
    }
}

impl Camera for RaceCar<'_> {
    fn set_resolution(&mut self, resolution: Resolution) -> Result<()> {
        self.race.cars[self.index].resolution = resolution;
        Ok(())
    }

    fn resolution(&mut self) -> Result<Resolution> {
        Ok(self.race.cars[self.index].resolution)
    }

    fn image_into(&mut self, image: &mut RgbImage) -> Result<()> {
        let (width, height) = self.race.cars[self.index].resolution.dimensions();
        if image.dimensions() != (width, height) {
            *image = RgbImage::new(width, height);
        }
        self.race.draw(self.index, image);
        Ok(())
    }
}
