use std::fmt;

use super::Result;

/// The number of a position-sensitive device, a distance sensor of one ray.
///
/// The constants are the simulator's numbers, which robot descriptions share; a robot may have others.
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

/// Distance sensors of one ray each.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait DistanceSensors {
    /// Metres from the sensor to what its ray hits; +infinity when nothing is within its range. A sensor that the
    /// robot lacks is an error.
    fn distance(&mut self, sensor: Psd) -> Result<f64>;
}
