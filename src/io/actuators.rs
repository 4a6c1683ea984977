use super::Result;

/// Motors driven one by one, below the v-omega interface. They are numbered from 1: left, right; or front
/// left, front right, back left, back right.
///
/// # For implementers
///
/// Return at once; the last command holds until the next one of this motor or of
/// [`Drive`](super::Drive). Fail for a motor that does not exist and for fractions outside -1 to 1.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Motors {
    /// Drives a motor at a fraction of its full speed, -1 to 1, until the next command.
    fn set_motor(&mut self, motor: u8, fraction: f64) -> Result<()>;
}

/// Servos, numbered from 1.
///
/// # For implementers
///
/// Return at once: the servo moves on its own. Fail for a servo that does not exist and for positions
/// outside -1 to 1.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Servos {
    /// Moves a servo to a position, -1 (full left or down) to 1 (full right or up).
    fn set_servo(&mut self, servo: u8, position: f64) -> Result<()>;
}

/// Encoders on the motor shafts, numbered like the motors.
///
/// # For implementers
///
/// Count in both directions; forward is positive. Fail for a motor that does not exist.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Encoders {
    /// Ticks since the start or the last reset.
    fn encoder(&mut self, motor: u8) -> Result<i64>;

    /// Resets an encoder to zero. Odometry is not affected.
    fn reset_encoder(&mut self, motor: u8) -> Result<()>;
}
