use super::Result;

/// A pressure sensor that measures depth under water.
///
/// # For implementers
///
/// Return the depth of the sensor, not that of the robot's centre, and 0 above the surface.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait DepthSensor {
    /// Depth of the sensor below the surface (m); 0 above it. Fails on a robot without one.
    fn depth(&mut self) -> Result<f64>;
}
