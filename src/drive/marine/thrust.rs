use crate::io::control::Command;
use crate::io::{Error, ErrorKind, Motors, Result};
use crate::kinematics::marine::MAX_THRUSTERS;

/// Command for a craft's first thrusters, as fractions of full speed from -1 to 1. With its thrusters stopped, a
/// buoyant craft surfaces.
///
/// ```
/// use roverlab::drive::marine::Thrust;
/// assert_eq!(Thrust::new(&[0.5, -0.5])?.commands(), [0.5, -0.5]);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thrust {
    commands: [f64; MAX_THRUSTERS],
    thrusters: usize,
}

impl Thrust {
    /// Commands for the thrusters, starting with the first. Fails for more of them than a craft may have.
    pub fn new(commands: &[f64]) -> Result<Self> {
        if commands.len() > MAX_THRUSTERS {
            return Err(Error::invalid_input("number of thrusters", commands.len(), "at most 8"));
        }
        let mut all = [0.0; MAX_THRUSTERS];
        all[..commands.len()].copy_from_slice(commands);
        Ok(Self { commands: all, thrusters: commands.len() })
    }

    /// The commands.
    pub fn commands(&self) -> &[f64] {
        &self.commands[..self.thrusters]
    }
}

impl<R: Motors + ?Sized> Command<R> for Thrust {
    fn apply(&self, robot: &mut R) -> Result<()> {
        (1..).zip(self.commands()).try_for_each(|(motor, &command)| robot.set_motor(motor, command))
    }

    fn stop(robot: &mut R) -> Result<()> {
        // The first motor that the craft does not have ends the row; RoBIOS gives no reason for its refusal.
        for motor in 1..=MAX_THRUSTERS as u8 {
            match robot.set_motor(motor, 0.0) {
                Err(error)
                    if motor > 1 && matches!(error.kind(), ErrorKind::Unsupported | ErrorKind::Other) =>
                {
                    break;
                }
                stopped => stopped?,
            }
        }
        Ok(())
    }
}
