//! The robot traits of [`Supervised`]: commands are filtered, readings are checked.

use image::RgbImage;

use super::health::digest;
use super::supervised::{LONGEST, Supervised, fault};
use super::{Causes, Station};
use crate::geometry::{Pose, Twist, Vector3};
use crate::io::wrappers::signatures;
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive,
    Encoders, Error, ErrorKind, Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Manoeuvres,
    Motors, Odometry, Pixel, Psd, Radio, RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::world::Colour;

/// Traits that neither drive nor sense the surroundings; their calls still take time.
macro_rules! passed_on {
    ($capability:ident { $( fn $name:ident($($arg:ident: $type:ty),*) -> $result:ty; )* }) => {
        impl<R: Clock + Drive + Odometry + $capability, S: Station> $capability for Supervised<R, S> {
            $( fn $name(&mut self $(, $arg: $type)*) -> Result<$result> {
                self.alive();
                self.inner.$name($($arg),*)
            } )*
        }
    };
}

signatures! { StallDetector => passed_on!() }
signatures! { Display => passed_on!() }
signatures! { Radio => passed_on!() }
signatures! { Encoders => passed_on!() }
signatures! { Inertial => passed_on!() }
signatures! { DepthSensor => passed_on!() }

impl<R: Clock + Drive + Odometry + Keys, S: Station> Keys for Supervised<R, S> {
    fn read_key(&mut self) -> Result<Option<Key>> {
        self.alive();
        self.inner.read_key()
    }

    /// Polls once per control period, and runs the checks.
    fn wait_key(&mut self) -> Result<Key> {
        loop {
            if let Some(key) = self.read_key()? {
                return Ok(key);
            }
            self.wait(self.parameters.period)?;
        }
    }

    fn read_touch(&mut self) -> Result<Option<Pixel>> {
        self.alive();
        self.inner.read_touch()
    }
}

impl<R: Clock + Drive + Odometry, S: Station> Clock for Supervised<R, S> {
    fn now(&mut self) -> Result<f64> {
        self.alive();
        self.inner.now()
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        self.alive();
        crate::parameter::require_finite("seconds", seconds)?;
        if seconds > LONGEST {
            return Err(Error::invalid_input("seconds", seconds, "at most a day, 86400"));
        }
        let mut left = seconds;
        let mut answer = Ok(());
        while left > 1e-9 {
            let part = left.min(self.due - self.waited).max(1e-6);
            let waited = self.inner.wait(part);
            self.pass(part);
            left -= part;
            if let Err(error) = waited {
                self.seen =
                    self.seen.with(fault(&error)).with_if(error.kind() == ErrorKind::TimedOut, Causes::LINK);
                answer = Err(error);
            }
            self.look_if_due();
            self.shows_life();
            if answer.is_err() {
                break;
            }
        }
        answer
    }

    fn peek_time(&mut self) -> Result<f64> {
        self.inner.peek_time()
    }
}

impl<R: Clock + Drive + Odometry, S: Station> Drive for Supervised<R, S> {
    fn set_speed(&mut self, twist: Twist) -> Result<()> {
        if !self.may_drive(twist != Twist::STOP) {
            self.steer_on(twist);
            return Ok(());
        }
        let answer = self.inner.set_speed(twist);
        if answer.is_ok() {
            let bends = twist.linear.abs() > 1e-3;
            self.told(twist.linear, if bends { twist.angular / twist.linear } else { 0.0 });
        }
        self.note(answer)
    }
}

impl<R: Clock + Drive + Odometry, S: Station> Odometry for Supervised<R, S> {
    fn speed(&mut self) -> Result<Twist> {
        self.reading(R::speed)
    }

    fn pose(&mut self) -> Result<Pose> {
        self.reading(R::pose)
    }

    fn set_pose(&mut self, pose: Pose) -> Result<()> {
        self.alive();
        let answer = self.inner.set_pose(pose);
        if answer.is_ok() {
            self.odometry.move_to(pose);
        }
        self.note(answer)
    }
}

impl<R: Clock + Drive + Odometry + Manoeuvres + StallDetector, S: Station> Manoeuvres for Supervised<R, S> {
    fn straight(&mut self, distance: f64, speed: f64) -> Result<()> {
        if !self.may_drive(false) {
            return Ok(());
        }
        let answer = self.inner.straight(distance, speed);
        if answer.is_ok() {
            self.told(speed, 0.0);
        }
        self.note(answer)
    }

    fn turn(&mut self, angle: f64, speed: f64) -> Result<()> {
        if !self.may_drive(false) {
            return Ok(());
        }
        let answer = self.inner.turn(angle, speed);
        if answer.is_ok() {
            self.told(f64::INFINITY, 0.0);
        }
        self.note(answer)
    }

    fn curve(&mut self, length: f64, angle: f64, speed: f64) -> Result<()> {
        if !self.may_drive(false) {
            return Ok(());
        }
        let answer = self.inner.curve(length, angle, speed);
        if answer.is_ok() {
            self.told(speed, if length.abs() > 1e-3 { angle / length } else { 0.0 });
        }
        self.note(answer)
    }

    fn remaining(&mut self) -> Result<f64> {
        self.alive();
        self.inner.remaining()
    }

    fn is_done(&mut self) -> Result<bool> {
        self.alive();
        self.inner.is_done()
    }

    fn wait_done(&mut self) -> Result<()> {
        // After a stop no manoeuvre is active: the brakes use a speed command.
        while !self.inner.is_done()? && !self.inner.is_stalled()? && self.core.state().lets_drive() {
            self.wait(self.parameters.period)?;
        }
        Ok(())
    }
}

impl<R: Clock + Drive + Odometry + Motors, S: Station> Motors for Supervised<R, S> {
    fn set_motor(&mut self, motor: u8, fraction: f64) -> Result<()> {
        if !self.may_turn(motor, fraction != 0.0) {
            return Ok(());
        }
        let answer = self.inner.set_motor(motor, fraction);
        if answer.is_ok() {
            self.turned();
        }
        self.note(answer)
    }
}

impl<R: Clock + Drive + Odometry + Servos, S: Station> Servos for Supervised<R, S> {
    fn set_servo(&mut self, servo: u8, position: f64) -> Result<()> {
        if !self.commanded() {
            return Ok(());
        }
        let answer = self.inner.set_servo(servo, position);
        if answer.is_ok() {
            self.turned();
        }
        self.note(answer)
    }
}

impl<R: Clock + Drive + Odometry + Lidar, S: Station> Lidar for Supervised<R, S> {
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()> {
        let answer = self.reading(|inner| inner.scan_into(scan));
        if answer.is_ok() {
            let number = !scan.ranges.iter().any(|range| range.is_nan());
            let shows = scan.ranges.iter().any(|range| range.is_finite());
            let digest = shows.then(|| digest(scan.ranges.iter().map(|range| range.to_bits())));
            let good = self.scans.read(digest, self.pose, &self.parameters.health);
            self.seen = self.seen.with_if(!(number && good), Causes::SENSOR);
        }
        answer
    }

    fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()> {
        self.alive();
        self.inner.configure_lidar(settings)
    }
}

impl<R: Clock + Drive + Odometry + DistanceSensors, S: Station> DistanceSensors for Supervised<R, S> {
    fn distance(&mut self, sensor: Psd) -> Result<f64> {
        let answer = self.reading(|inner| inner.distance(sensor));
        if let Ok(distance) = answer {
            let digest = distance.is_finite().then(|| distance.to_bits());
            let health = &mut self.distances[usize::from(sensor.0)];
            let good = health.read(digest, self.pose, &self.parameters.health);
            self.seen = self.seen.with_if(distance.is_nan() || !good, Causes::SENSOR);
        }
        answer
    }
}

impl<R: Clock + Drive + Odometry + Camera, S: Station> Camera for Supervised<R, S> {
    fn set_resolution(&mut self, resolution: Resolution) -> Result<()> {
        self.alive();
        self.inner.set_resolution(resolution)
    }

    fn resolution(&mut self) -> Result<Resolution> {
        self.alive();
        self.inner.resolution()
    }

    fn image_into(&mut self, image: &mut RgbImage) -> Result<()> {
        let answer = self.reading(|inner| inner.image_into(image));
        if answer.is_ok() {
            let black = image.as_raw().iter().all(|level| *level == 0);
            let digest = digest(image.as_raw().iter().map(|level| u64::from(*level)));
            let good = self.images.read(Some(digest), self.pose, &self.parameters.health);
            self.seen = self.seen.with_if(black || !good, Causes::SENSOR);
        }
        answer
    }
}
