use std::collections::BTreeMap;

use ambassador::Delegate;
use image::RgbImage;

use crate::geometry::{Pose, Twist, Vector3, normalize_angle};
use crate::io::delegate::{
    ambassador_impl_Clock, ambassador_impl_DepthSensor, ambassador_impl_Display, ambassador_impl_Drive,
    ambassador_impl_Encoders, ambassador_impl_Inertial, ambassador_impl_Keys, ambassador_impl_Manoeuvres,
    ambassador_impl_Motors, ambassador_impl_Radio, ambassador_impl_Servos, ambassador_impl_StallDetector,
};
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive,
    Encoders, Error, Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Manoeuvres, Motors,
    Odometry, Pixel, Psd, Radio, RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::random::Stream;
use crate::world::Colour;

/// Standard deviations of Gaussian noise; 0 leaves a reading unchanged, bit for bit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Distance sensors (m).
    pub distance: f64,
    /// Lidar ranges (m).
    pub lidar: f64,
    /// Channels of an image's pixels (levels of 255).
    pub image: f64,
    /// Odometry's x and y (m).
    pub position: f64,
    /// Odometry's heading (rad).
    pub heading: f64,
    /// Odometry's forward speed (m/s).
    pub linear: f64,
    /// Odometry's turn rate (rad/s).
    pub angular: f64,
}

impl Noise {
    /// No noise.
    pub const NONE: Noise = Noise {
        distance: 0.0,
        lidar: 0.0,
        image: 0.0,
        position: 0.0,
        heading: 0.0,
        linear: 0.0,
        angular: 0.0,
    };

    /// Fails with the name of a standard deviation that is negative or not finite.
    pub fn validate(&self) -> Result<()> {
        for (name, sigma) in [
            ("noise of distances", self.distance),
            ("noise of lidar ranges", self.lidar),
            ("noise of images", self.image),
            ("noise of the position", self.position),
            ("noise of the heading", self.heading),
            ("noise of the forward speed", self.linear),
            ("noise of the turning speed", self.angular),
        ] {
            if !(sigma.is_finite() && sigma >= 0.0) {
                return Err(Error::invalid_input(name, sigma, "a finite standard deviation of 0 or more"));
            }
        }
        Ok(())
    }
}

impl Default for Noise {
    /// Ten millimetres on every distance, like EyeSim's sensor noise, and a little on images and odometry.
    fn default() -> Self {
        Self {
            distance: 0.01,
            lidar: 0.01,
            image: 2.0,
            position: 0.002,
            heading: 0.005,
            linear: 0.002,
            angular: 0.01,
        }
    }
}

/// A robot with extra noise on distances, lidar scans, images and odometry.
///
/// Each sensor has its own random stream, so the readings of one do not affect another. Noise never makes a
/// distance negative, never turns "nothing in range" into a distance, and never moves a range beyond the
/// lidar's maximum.
#[derive(Debug, Clone, Delegate)]
#[expect(clippy::duplicated_attributes, reason = "every capability has the same target")]
#[delegate(Clock, target = "inner")]
#[delegate(Drive, target = "inner")]
#[delegate(Manoeuvres, target = "inner")]
#[delegate(StallDetector, target = "inner")]
#[delegate(Display, target = "inner")]
#[delegate(Keys, target = "inner")]
#[delegate(Radio, target = "inner")]
#[delegate(Motors, target = "inner")]
#[delegate(Servos, target = "inner")]
#[delegate(Encoders, target = "inner")]
#[delegate(DepthSensor, target = "inner")]
#[delegate(Inertial, target = "inner")]
pub struct Noisy<R> {
    inner: R,
    noise: Noise,
    parent: Stream,
    distances: BTreeMap<Psd, Stream>,
    lidar: Stream,
    image: Stream,
    pose: Stream,
    speed: Stream,
}

impl<R> Noisy<R> {
    /// Adds noise to a robot's readings, from child streams of `stream`. Fails if a standard deviation is
    /// negative or not finite.
    pub fn new(inner: R, noise: Noise, stream: &Stream) -> Result<Self> {
        noise.validate()?;
        Ok(Self {
            inner,
            noise,
            parent: stream.clone(),
            distances: BTreeMap::new(),
            lidar: stream.child("noisy lidar", 0),
            image: stream.child("noisy image", 0),
            pose: stream.child("noisy pose", 0),
            speed: stream.child("noisy speed", 0),
        })
    }

    /// The wrapped robot.
    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The wrapped robot, without the noise.
    pub fn into_inner(self) -> R {
        self.inner
    }
}

/// A value with noise. A deviation of 0 draws nothing and keeps the bits.
fn add(value: f64, sigma: f64, stream: &mut Stream) -> f64 {
    if sigma == 0.0 { value } else { value + sigma * stream.normal() }
}

impl<R: DistanceSensors> DistanceSensors for Noisy<R> {
    fn distance(&mut self, sensor: Psd) -> Result<f64> {
        let distance = self.inner.distance(sensor)?;
        if self.noise.distance == 0.0 {
            return Ok(distance);
        }
        let parent = &self.parent;
        let stream =
            self.distances.entry(sensor).or_insert_with(|| parent.child("noisy distance", sensor.0.into()));
        Ok(add(distance, self.noise.distance, stream).max(0.0))
    }
}

impl<R: Lidar> Lidar for Noisy<R> {
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()> {
        self.inner.scan_into(scan)?;
        if self.noise.lidar == 0.0 {
            return Ok(());
        }
        for range in &mut scan.ranges {
            // Drawn for every beam, so that one beam's noise does not depend on the hits of others.
            let noisy = add(*range, self.noise.lidar, &mut self.lidar);
            if range.is_finite() {
                *range = noisy.min(scan.range_max.max(*range)).max(0.0);
            }
        }
        Ok(())
    }

    fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()> {
        self.inner.configure_lidar(settings)
    }
}

impl<R: Camera> Camera for Noisy<R> {
    fn set_resolution(&mut self, resolution: Resolution) -> Result<()> {
        self.inner.set_resolution(resolution)
    }

    fn resolution(&mut self) -> Result<Resolution> {
        self.inner.resolution()
    }

    fn image_into(&mut self, image: &mut RgbImage) -> Result<()> {
        self.inner.image_into(image)?;
        if self.noise.image == 0.0 {
            return Ok(());
        }
        for level in image.iter_mut() {
            // Half a level is added because the conversion to integers truncates.
            *level = (add(f64::from(*level), self.noise.image, &mut self.image) + 0.5) as u8;
        }
        Ok(())
    }
}

impl<R: Odometry> Odometry for Noisy<R> {
    fn speed(&mut self) -> Result<Twist> {
        let Twist { linear, angular } = self.inner.speed()?;
        Ok(Twist::new(
            add(linear, self.noise.linear, &mut self.speed),
            add(angular, self.noise.angular, &mut self.speed),
        ))
    }

    fn pose(&mut self) -> Result<Pose> {
        let Pose { x, y, heading } = self.inner.pose()?;
        Ok(Pose::new(
            add(x, self.noise.position, &mut self.pose),
            add(y, self.noise.position, &mut self.pose),
            normalize_angle(add(heading, self.noise.heading, &mut self.pose)),
        ))
    }

    fn set_pose(&mut self, pose: Pose) -> Result<()> {
        self.inner.set_pose(pose)
    }
}
