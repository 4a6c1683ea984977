use std::fmt;

use super::Result;

/// Number of a position-sensitive device, a distance sensor with one ray.
///
/// The constants are the simulator's numbers, used by robot descriptions; a robot may have others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Psd(pub u8);

impl Psd {
    /// Straight ahead.
    pub const FRONT: Psd = Psd(1);
    /// To the left.
    pub const LEFT: Psd = Psd(2);
    /// To the right.
    pub const RIGHT: Psd = Psd(3);
    /// Straight back.
    pub const BACK: Psd = Psd(4);
}

impl fmt::Display for Psd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Psd::FRONT => f.write_str("front PSD"),
            Psd::LEFT => f.write_str("left PSD"),
            Psd::RIGHT => f.write_str("right PSD"),
            Psd::BACK => f.write_str("back PSD"),
            Psd(id) => write!(f, "PSD {id}"),
        }
    }
}

/// Distance sensors with one ray each.
///
/// # For implementers
///
/// Return metres from the sensor, not from the robot's outline. Nothing in range is infinity, never 0
/// or a maximum; a sensor that does not exist is [`Error::unsupported`](super::Error::unsupported).
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait DistanceSensors {
    /// Distance to the object hit by a sensor's ray (m); +infinity if nothing is in range. Fails if the robot
    /// lacks the sensor.
    fn distance(&mut self, sensor: Psd) -> Result<f64>;
}
