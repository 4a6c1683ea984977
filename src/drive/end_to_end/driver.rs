use std::ops::ControlFlow;

use image::RgbImage;

use super::sight::{check_sight, redder, see_road_into};
use crate::ParameterError;
use crate::drive::lane_keeping::{LaneObservation, LaneOutcome};
use crate::geometry::Twist;
use crate::io::control::{Behaviour, Decision, Senses};
use crate::io::{self, Camera, Odometry, Resolution};
use crate::parameter::{require_finite, require_positive};
use crate::vision::network::Network;

/// Largest curvature that a network steers (1/m).
const MOST_CURVATURE: f64 = 2.0;
/// Control period, one image each (s).
const PERIOD: f64 = 1.0 / 30.0;

/// Drives at one speed along the curvature that a network reads off the camera image. A network of one result
/// says the curvature as a part of 2/m; one of several has a class for each range of curvatures from -2/m to
/// 2/m, and the most likely one is driven, as in the book with ten.
#[derive(Debug, Clone)]
pub struct NetworkDriver {
    network: Network,
    speed: f64,
    input: Vec<f32>,
    curvature: f64,
}

impl NetworkDriver {
    /// Creates a driver at a speed (m/s).
    ///
    /// # Errors
    ///
    /// If the speed is not positive, or the network sees other channels than one or three.
    pub fn new(network: Network, speed: f64) -> Result<Self, ParameterError> {
        require_positive("speed", speed)?;
        let size = network.architecture().input();
        check_sight(size)?;
        Ok(Self { network, speed, input: vec![0.0; size.len()], curvature: 0.0 })
    }

    /// The curvature that was steered last (1/m).
    pub fn curvature(&self) -> f64 {
        self.curvature
    }

    /// The network, with the values of the last image.
    pub fn network(&self) -> &Network {
        &self.network
    }

    /// Curvature for an image (1/m).
    ///
    /// # Errors
    ///
    /// If the image has fewer pixels than the network sees, or a result is not finite.
    pub fn steer(&mut self, image: &RgbImage) -> Result<f64, ParameterError> {
        see_road_into(image, self.network.architecture().input(), &mut self.input)?;
        let results = self.network.run(&self.input)?;
        for result in results {
            require_finite("result of the network", f64::from(*result))?;
        }
        self.curvature = meant(results);
        Ok(self.curvature)
    }

    /// An image, redder where the network looks: at places that contributed to what its filters see.
    ///
    /// # Errors
    ///
    /// As of [`steer`](Self::steer).
    pub fn looks_at(&mut self, image: &RgbImage) -> Result<RgbImage, ParameterError> {
        self.steer(image)?;
        Ok(redder(image, self.network.architecture().input(), &self.network.attention()))
    }
}

/// The curvature that results of a network mean (1/m).
fn meant(results: &[f32]) -> f64 {
    if let [part] = results {
        return MOST_CURVATURE * f64::from(*part).clamp(-1.0, 1.0);
    }
    let likely =
        results.iter().enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(index, _)| index);
    let width = 2.0 * MOST_CURVATURE / results.len() as f64;
    width * (likely as f64 + 0.5) - MOST_CURVATURE
}

/// The result that a network of a number of results should have for a curvature (1/m).
#[cfg(any(test, feature = "learn"))]
pub(super) fn wanted(curvature: f64, results: usize) -> f32 {
    let part = (curvature / MOST_CURVATURE).clamp(-1.0, 1.0);
    if results == 1 {
        return part as f32;
    }
    let class = (0.5 * (part + 1.0) * results as f64) as usize;
    class.min(results - 1) as f32
}

impl Behaviour for NetworkDriver {
    type Observation = LaneObservation;
    type Command = Twist;
    type Outcome = LaneOutcome;

    fn period(&self) -> f64 {
        PERIOD
    }

    fn step(&mut self, _time: f64, seen: &LaneObservation) -> Decision<Self> {
        seen.check()?;
        let curvature = self.steer(&seen.image).map_err(io::Error::caused_by)?;
        Ok(ControlFlow::Continue(Twist::new(self.speed, self.speed * curvature)))
    }
}

impl<R: Camera + Odometry + ?Sized> Senses<R> for NetworkDriver {
    fn prepare(&mut self, robot: &mut R) -> io::Result<()> {
        robot.set_resolution(Resolution::Qvga)
    }

    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut LaneObservation) -> io::Result<()> {
        seen.read(robot)
    }
}
