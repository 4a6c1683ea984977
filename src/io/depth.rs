use super::Result;

/// A pressure sensor that tells how deep under water the robot is.
///
/// # For implementers
///
/// Return the depth of the sensor, not that of the robot's centre, and 0 above the surface.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait DepthSensor {
    /// Metres from the surface down to the sensor; 0 out of the water. Fails on a robot without one.
    fn depth(&mut self) -> Result<f64>;
}
