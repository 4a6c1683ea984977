use super::position::Position;
use super::stamp::nanoseconds;
use super::{Log, LogError};

/// Replays a recording: provides its robots and their ground truth.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::io::Clock;
/// use roverlab::io::log::{Header, Log, LogWriter, Player};
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::world::{RobotSpec, Scene, World};
/// let scene = Scene::with_robot(World::empty(2.0, 2.0), RobotSpec::s4(), Pose::default());
/// let simulation = Simulation::new(&scene, SimOptions::default())?;
/// let writer = LogWriter::new(Vec::new(), &Header::new("waiting", [""]))?;
/// let mut robot = writer.recorder(simulation.robot(0)?, 0);
/// robot.wait(0.5)?;
/// robot.wait(0.5)?;
/// drop(robot);
/// let player = Player::new(&Log::read(writer.finish()?)?);
/// player.robot(0)?.wait(0.5)?;
/// let (time, call) = player.rest().expect("one call is left");
/// assert!(time >= 0.5 && call.contains("wait"), "{time}: {call}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Player {
    positions: Vec<Position>,
    log: Log,
}

impl Player {
    /// Creates a player at the beginning of a recording.
    pub fn new(log: &Log) -> Self {
        let positions = (0..log.robots()).map(|robot| Position::new(log, robot)).collect();
        Self { positions, log: log.clone() }
    }

    /// The recording.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// Current position of each robot.
    pub(super) fn positions(&self) -> impl Iterator<Item = Position> + '_ {
        self.positions.iter().cloned()
    }

    /// Moves to a time of the recording (s): each robot continues with its first call at or after that time.
    pub fn seek(&self, time: f64) {
        self.positions.iter().for_each(|position| position.seek(nanoseconds(time)));
    }

    /// The first recorded call not made yet, of the robot with the lowest index: its time (s) and text.
    /// `None` once the recording has been replayed to its end.
    pub fn rest(&self) -> Option<(f64, String)> {
        self.positions.iter().find_map(Position::rest)
    }

    pub(super) fn position(&self, robot: usize) -> Result<Position, LogError> {
        let no_robot = LogError::NoRobot { index: robot, robots: self.log.robots() };
        self.positions.get(robot).cloned().ok_or(no_robot)
    }
}
