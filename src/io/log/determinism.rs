use std::fmt;

use super::{Difference, Header, Log, LogError, LogWriter, Player};
use crate::io::sim::{SimOptions, Simulation};
use crate::io::{Error, Result, RobotIo};
use crate::parameter::debug_as_sentence;
use crate::world::Scene;

/// Reason why a behaviour is not deterministic.
#[non_exhaustive]
pub enum Indeterminate {
    /// Two runs with the same seed differ.
    Runs {
        /// Seed of the runs.
        seed: u64,
        /// First difference.
        difference: Box<Difference>,
    },
    /// The replay of a run differs from it.
    Replay {
        /// Seed of the run.
        seed: u64,
        /// First difference.
        difference: Box<Difference>,
    },
    /// The scene cannot be simulated.
    Simulation(Error),
    /// A recording cannot be written or read.
    Recording(LogError),
}

debug_as_sentence!(Indeterminate);

impl fmt::Display for Indeterminate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Runs { seed, difference } => write!(f, "two runs with seed {seed} differ: {difference}"),
            Self::Replay { seed, difference } => {
                write!(f, "the replay of a run with seed {seed} differs: {difference}")
            }
            Self::Simulation(error) => write!(f, "the scene cannot be simulated: {error}"),
            Self::Recording(error) => write!(f, "the run cannot be recorded: {error}"),
        }
    }
}

impl std::error::Error for Indeterminate {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Simulation(error) => Some(error),
            Self::Recording(error) => Some(error),
            _ => None,
        }
    }
}

impl From<LogError> for Indeterminate {
    fn from(error: LogError) -> Self {
        Self::Recording(error)
    }
}

impl From<std::io::Error> for Indeterminate {
    fn from(error: std::io::Error) -> Self {
        Self::Recording(error.into())
    }
}

/// Checks that a behaviour is deterministic: for each seed, two recordings of its runs in a world are equal
/// byte for byte, and so is the recording of a replay.
///
/// The behaviour drives the first robot of the scene. Any outcome is accepted, as long as it is always the
/// same.
///
/// ```
/// use roverlab::geometry::{Pose, Twist};
/// use roverlab::io::log::check_determinism;
/// use roverlab::io::sim::SimOptions;
/// use roverlab::world::{RobotSpec, Scene, World};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(1.0, 1.0, 0.0));
/// check_determinism(&scene, &SimOptions::default(), 1..=3, |robot| {
///     robot.set_speed(Twist::new(0.2, 0.5))?;
///     while robot.now()? < 2.0 {
///         robot.pose()?;
///         robot.wait(0.1)?;
///     }
///     Ok(())
/// })?;
/// # Ok(())
/// # }
/// ```
pub fn check_determinism(
    scene: &Scene,
    options: &SimOptions,
    seeds: impl IntoIterator<Item = u64>,
    mut behaviour: impl FnMut(&mut dyn RobotIo) -> Result<()>,
) -> std::result::Result<(), Indeterminate> {
    for seed in seeds {
        let options = SimOptions { seed, ..options.clone() };
        let mut simulated = || {
            let simulation = Simulation::new(scene, options.clone()).map_err(Indeterminate::Simulation)?;
            let robot = simulation.robot(0).map_err(Indeterminate::Simulation)?;
            recorded(seed, robot, &mut behaviour)
        };
        let (first, second) = (simulated()?, simulated()?);
        if let Some(difference) = Difference::between(&first, &second) {
            return Err(Indeterminate::Runs { seed, difference: Box::new(difference) });
        }
        let replay = Player::new(&first).robot(0)?;
        let third = recorded(seed, replay, &mut behaviour)?;
        if let Some(difference) = Difference::between(&first, &third) {
            return Err(Indeterminate::Replay { seed, difference: Box::new(difference) });
        }
    }
    Ok(())
}

/// Records a behaviour's run.
fn recorded<R: RobotIo>(
    seed: u64,
    robot: R,
    behaviour: &mut impl FnMut(&mut dyn RobotIo) -> Result<()>,
) -> std::result::Result<Log, Indeterminate> {
    let header = Header { seed: Some(seed), ..Header::new("check_determinism", [""; 0]) };
    let writer = LogWriter::new(Vec::new(), &header)?;
    let mut robot = writer.recorder(robot, 0);
    // If a robot's error ended the run, the recording contains it.
    let _ = behaviour(&mut robot);
    drop(robot);
    Ok(Log::read(writer.finish()?)?)
}
