mod recording;

use std::collections::BTreeMap;
use std::fmt;
use std::ops::{Deref, DerefMut};
use std::sync::{Arc, Mutex, PoisonError};

use roverlab::geometry::Pose;
use roverlab::io::log::{FleetIo, GroundTruth, Player};
use roverlab::io::sim::{Fleet, RobotTruth, SimOptions, Simulation, Watcher};
use roverlab::io::wrappers::{Deadman, Fault, Faulty, Quantised};
use roverlab::io::{self, Key, RobotIo, TruthInSpace};
use roverlab::safety::{SpeedError, StoppingModel};
use roverlab::world::{RobotPlacement, Scene};

use super::library::{Library, alone};
use super::supervision::{DEADMAN, Stops, guarded};
use super::{CommonArgs, Failure, onlooker};
use recording::{Recording, replayed_robot, replayed_truth};

/// Whether robots can be recorded and replayed. A web page has no files, and omits the code.
pub(super) const RECORDS: bool = cfg!(feature = "native");

/// Maximum number of bytes by which a separate robot's recording may be ahead of the others.
const MOST_AHEAD: usize = 1 << 20;

/// A command's robot: simulated or replayed, and recorded if requested.
pub(crate) type Driven = Box<dyn RobotIo + Send>;

/// Ground truth of a command's robots.
pub(crate) type StageTruth = Box<dyn GroundTruth + Send>;

/// Source of a command's robots, a simulator or a recording, and their recording.
///
/// Dropping it completes the recording, and reports its problems to the run's [`Origin`].
#[derive(Debug)]
pub(crate) struct Stage {
    play: Play,
    faults: Vec<Fault>,
    /// Whether simulated robots round like RoBIOS.
    quantised: bool,
    /// Ground truth of each robot. Dropped before the recording is finished.
    truths: Mutex<BTreeMap<usize, SharedTruth>>,
    recording: Recording,
    guard: Option<Guard>,
    /// Whether robots stop by themselves without calls.
    deadman: bool,
}

/// Parameters of the robots' safety systems, one each.
#[derive(Debug, Clone)]
struct Guard {
    models: Vec<StoppingModel>,
    /// Whether each robot has its own world.
    apart: bool,
    /// Time of the first robot's first fault (s).
    fault: Option<f64>,
    stops: Stops,
}

#[derive(Debug)]
enum Play {
    Simulation(Simulation),
    /// Each robot in its own world.
    Apart(Vec<Simulation>),
    Recording(Player),
    Library(Library),
}

/// Robots stepped in one thread: simulated or replayed, and recorded if requested. Otherwise like a
/// [`Stage`].
pub(crate) struct StagedFleet<'a> {
    // Dropped before the recording is finished.
    fleet: Box<dyn FleetIo<'a> + 'a>,
    _recording: Recording,
}

impl<'a> Deref for StagedFleet<'a> {
    type Target = dyn FleetIo<'a> + 'a;

    fn deref(&self) -> &Self::Target {
        self.fleet.as_ref()
    }
}

impl DerefMut for StagedFleet<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        self.fleet.as_mut()
    }
}

/// A robot with its own kind of world: made by the command or replayed, and recorded if requested. Otherwise
/// like a [`Stage`].
#[cfg_attr(not(feature = "native"), allow(dead_code, reason = "only the walking robot needs it"))]
pub(crate) struct StagedRobot {
    // Dropped before the recording is finished.
    robot: Driven,
    _recording: Recording,
}

impl Deref for StagedRobot {
    type Target = Driven;

    fn deref(&self) -> &Self::Target {
        &self.robot
    }
}

impl DerefMut for StagedRobot {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.robot
    }
}

/// Ground truth shared by several programs.
#[derive(Clone)]
struct SharedTruth(Arc<Mutex<StageTruth>>);

impl SharedTruth {
    fn ask<T>(&self, question: impl FnOnce(&mut StageTruth) -> io::Result<T>) -> io::Result<T> {
        question(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl fmt::Debug for SharedTruth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SharedTruth").finish_non_exhaustive()
    }
}

impl GroundTruth for SharedTruth {
    fn time(&mut self) -> io::Result<f64> {
        self.ask(GroundTruth::time)
    }

    fn pose(&mut self, robot: usize) -> io::Result<Pose> {
        self.ask(|truth| truth.pose(robot))
    }

    fn robot(&mut self, robot: usize) -> io::Result<RobotTruth> {
        self.ask(|truth| truth.robot(robot))
    }

    fn object(&mut self, object: usize) -> io::Result<Pose> {
        self.ask(|truth| truth.object(object))
    }

    fn in_space(&mut self, robot: usize) -> io::Result<TruthInSpace> {
        self.ask(|truth| truth.in_space(robot))
    }
}

impl CommonArgs {
    /// The stage of the options: a simulation of a scene, or the recording of `--replay`.
    pub(crate) fn stage(&self, scene: &Scene, options: SimOptions) -> Result<Stage, Failure> {
        let stage = match (self.player(), &self.robios) {
            (Some(player), _) => Stage::new(Play::Recording(player), Vec::new()),
            (None, Some(library)) => {
                let robot = scene.robots.first();
                let start = robot.map_or(Pose::default(), |robot| robot.pose);
                let inertial = robot.map(|robot| robot.spec.inertial).unwrap_or_default();
                Stage::new(Play::Library(Library::open(library, start, inertial)?), self.faults()?)
            }
            _ => {
                let (scene, watcher) = onlooker::watched(scene);
                let stage = Stage::simulated(&scene, options, self.faults()?)?;
                stage.watch(watcher);
                Stage { quantised: self.quantised, ..stage }
            }
        };
        self.recorded(scene, stage, motors(scene))
    }

    /// Fails if several robots drive, as a library has only one.
    fn check_no_library(&self) -> Result<(), Failure> {
        self.robios.as_ref().map_or(Ok(()), |library| Err(alone(library)))
    }

    /// Like [`stage`](Self::stage), with copies of the scene's first robot, each in its own copy of the world
    /// and its own thread: their recordings are merged by time while they drive.
    pub(crate) fn stage_apart(
        &self,
        scene: &Scene,
        options: &SimOptions,
        robots: usize,
    ) -> Result<Stage, Failure> {
        self.check_no_library()?;
        let play = if let Some(player) = self.player() {
            Play::Recording(player)
        } else {
            let (shown, watcher) = onlooker::watched(scene);
            let simulations = (0..robots).map(|_| Simulation::new(&shown, options.clone()));
            let simulations: Vec<_> = simulations.collect::<io::Result<_>>().map_err(Failure::input)?;
            if let (Some(first), Some(watcher)) = (simulations.first(), watcher) {
                first.watch(watcher);
            }
            Play::Apart(simulations)
        };
        let mut stage = self.recorded(scene, Stage::new(play, Vec::new()), motors(scene))?;
        if let Some(guard) = &mut stage.guard {
            guard.apart = true;
        }
        if let Some(writer) = &stage.recording.writer {
            writer.hold_at_most(MOST_AHEAD);
        }
        Ok(stage)
    }

    fn recorded(&self, scene: &Scene, stage: Stage, models: Vec<StoppingModel>) -> Result<Stage, Failure> {
        let player = match &stage.play {
            Play::Recording(player) => Some(player.clone()),
            _ => None,
        };
        let stops = self.origin.stops().clone();
        // The error of speed measurements depends on the noise level.
        let error = SpeedError::default().scaled(self.noise);
        let models = models.into_iter().map(|model| StoppingModel { error, ..model }).collect();
        let fault = self.faults()?.iter().map(|fault| fault.at).reduce(f64::min);
        let guard = self.supervised.then_some(Guard { models, apart: false, fault, stops });
        Ok(Stage { recording: self.recording(scene, player)?, guard, ..stage })
    }

    /// Like [`stage`](Self::stage), with all robots stepped in one thread.
    pub(crate) fn fleet<'a>(&self, scene: &Scene, options: SimOptions) -> Result<StagedFleet<'a>, Failure> {
        self.check_no_library()?;
        let player = self.player();
        if self.quantised && player.is_none() {
            return Err(Failure::input(
                "--quantised: found several robots that are stepped together; expected a run of one robot",
            ));
        }
        let fleet: Box<dyn FleetIo<'a> + 'a> = match &player {
            Some(player) if RECORDS => Box::new(player.fleet()),
            _ => {
                let (scene, watcher) = onlooker::watched(scene);
                let mut fleet = Fleet::new(&scene, options).map_err(Failure::input)?;
                if let Some(watcher) = watcher {
                    fleet.watch(watcher);
                }
                Box::new(fleet)
            }
        };
        let recording = self.recording(scene, player)?;
        let fleet = match &recording.writer {
            Some(writer) if RECORDS => Box::new(writer.fleet(fleet)),
            _ => fleet,
        };
        Ok(StagedFleet { fleet, _recording: recording })
    }

    /// A robot without a scene description: `own`, or that of the recording of `--replay`. Viewers show the
    /// scene around it.
    #[cfg_attr(not(feature = "native"), allow(dead_code, reason = "only the walking robot needs it"))]
    pub(crate) fn staged_robot(
        &self,
        scene: &Scene,
        own: impl RobotIo + Send + 'static,
    ) -> Result<StagedRobot, Failure> {
        let player = self.player();
        let recording = self.recording(scene, player.clone())?;
        let robot = match player {
            Some(player) => recording.recorder(replayed_robot(&player, 0)?, 0),
            None => recording.recorder(Box::new(own), 0),
        };
        Ok(StagedRobot { robot, _recording: recording })
    }

    /// The player of the recording of `--replay`.
    fn player(&self) -> Option<Player> {
        self.origin.facts().log.as_ref().map(Player::new)
    }
}

/// Stopping models of a scene's robots.
fn motors(scene: &Scene) -> Vec<StoppingModel> {
    let model = |robot: &RobotPlacement| StoppingModel {
        reaction: 0.0,
        lag: robot.spec.motor.time_constant,
        deceleration: robot.spec.deceleration(),
        error: SpeedError::NONE,
    };
    scene.robots.iter().map(model).collect()
}

impl Stage {
    /// An unrecorded simulation, with faults of the first robot.
    pub(crate) fn simulated(scene: &Scene, options: SimOptions, faults: Vec<Fault>) -> Result<Self, Failure> {
        let simulation = Simulation::new(scene, options).map_err(Failure::input)?;
        Ok(Self::new(Play::Simulation(simulation), faults))
    }

    /// Adds a watcher to a simulation.
    fn watch(&self, watcher: Option<Box<dyn Watcher>>) {
        if let (Play::Simulation(simulation), Some(watcher)) = (&self.play, watcher) {
            simulation.watch(watcher);
        }
    }

    fn new(play: Play, faults: Vec<Fault>) -> Self {
        Self {
            play,
            faults,
            quantised: false,
            truths: Mutex::default(),
            recording: Recording::default(),
            guard: None,
            deadman: false,
        }
    }

    /// The same, with robots that stop by themselves after [`DEADMAN`] seconds without a call.
    pub(crate) fn with_deadman(self) -> Self {
        Self { deadman: true, ..self }
    }

    /// A robot, by its index in the scene. Where several drive at once, [claim](Self::claim) them all first.
    pub(crate) fn robot(&self, index: usize) -> Result<Driven, Failure> {
        self.claim(index)?.ready()
    }

    /// A robot still to be made ready, which may take time: do so in each robot's own thread.
    pub(crate) fn claim(&self, index: usize) -> Result<Claimed, Failure> {
        let simulated = |simulation: &Simulation, index| simulation.robot(index).map_err(Failure::input);
        let robot = match &self.play {
            Play::Simulation(simulation) if self.quantised => {
                self.faulty(Box::new(Quantised::new(simulated(simulation, index)?)), index)?
            }
            Play::Simulation(simulation) => self.faulty(Box::new(simulated(simulation, index)?), index)?,
            Play::Apart(simulations) => self.faulty(Box::new(simulated(&simulations[index], 0)?), index)?,
            Play::Library(library) => self.faulty(library.robot()?, index)?,
            Play::Recording(player) => self.recording.recorder(replayed_robot(player, index)?, index),
        };
        let Some(guard) = &self.guard else { return Ok(Claimed { robot, guard: None }) };
        let models = &guard.models;
        let model = *models.get(index).or(models.first()).ok_or_else(|| Failure::input("no robot"))?;
        let who = if guard.apart { 0 } else { index };
        let model = (model, guard.fault.filter(|_| index == 0));
        let (truth, stops) = (self.truth(index)?, guard.stops.clone());
        Ok(Claimed { robot, guard: Some(Watch { truth, who, model, stops }) })
    }

    /// A simulated robot with the faults of the first one.
    fn faulty(&self, robot: Driven, index: usize) -> Result<Driven, Failure> {
        let faults = if index == 0 { self.faults.clone() } else { Vec::new() };
        if self.guard.is_none() && !self.deadman {
            return Ok(self.recording.recorder(Box::new(Faulty::new(robot, faults)), index));
        }
        let robot = Deadman::new(robot, DEADMAN).map_err(Failure::run)?;
        Ok(self.recording.recorder(Box::new(Faulty::new(robot, faults)), index))
    }

    /// Ground truth for the program that drives or watches a robot. Each separate robot is the first one of
    /// its world. All users of a robot's truth share one handle, so that a recording keeps one order of
    /// queries.
    pub(crate) fn truth(&self, index: usize) -> Result<StageTruth, Failure> {
        let mut truths = self.truths.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = truths.get(&index) {
            return Ok(Box::new(known.clone()));
        }
        let truth = SharedTruth(Arc::new(Mutex::new(self.unshared_truth(index)?)));
        truths.insert(index, truth.clone());
        Ok(Box::new(truth))
    }

    fn unshared_truth(&self, index: usize) -> Result<StageTruth, Failure> {
        let truth: StageTruth = match &self.play {
            Play::Simulation(simulation) => Box::new(simulation.truth()),
            Play::Apart(simulations) => Box::new(simulations[index].truth()),
            Play::Recording(player) => replayed_truth(player, index)?,
            Play::Library(library) => library.truth()?,
        };
        Ok(match &self.recording.writer {
            Some(writer) if RECORDS => Box::new(writer.truth(truth, index)),
            _ => truth,
        })
    }

    /// Moves an object of the scene at the next tick, on behalf of a robot's program. The images of a
    /// recording show it where it was.
    pub(crate) fn move_object(&self, robot: usize, object: usize, pose: Pose) -> io::Result<()> {
        match &self.play {
            Play::Simulation(simulation) => simulation.truth().move_object(robot, object, pose),
            Play::Apart(simulations) => simulations[robot].truth().move_object(0, object, pose),
            Play::Recording(_) | Play::Library(_) => Ok(()),
        }
    }

    /// Schedules a key press at a time since the start (s). A replayed robot's keys are in the recording.
    pub(crate) fn press_key(&self, index: usize, time: f64, key: Key) -> io::Result<()> {
        match &self.play {
            Play::Simulation(simulation) => simulation.press_key(index, time, key),
            Play::Apart(simulations) => simulations[index].press_key(0, time, key),
            // The user of a real robot presses its keys.
            Play::Recording(_) | Play::Library(_) => Ok(()),
        }
    }
}

/// A robot that the world waits for, and its safety system.
pub(crate) struct Claimed {
    robot: Driven,
    guard: Option<Watch>,
}

/// Parts of a safety system.
struct Watch {
    truth: StageTruth,
    who: usize,
    model: (StoppingModel, Option<f64>),
    stops: Stops,
}

impl Claimed {
    /// The robot, armed and started if it has a safety system.
    pub(crate) fn ready(self) -> Result<Driven, Failure> {
        let Self { robot, guard } = self;
        let Some(Watch { truth, who, model, stops }) = guard else { return Ok(robot) };
        guarded(robot, truth, who, model, stops).map_err(Failure::run)
    }
}
