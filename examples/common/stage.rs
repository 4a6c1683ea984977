use std::fs::File;
use std::io::BufWriter;
use std::ops::{Deref, DerefMut};
use std::path::Path;
#[cfg(feature = "robios")]
use std::path::PathBuf;
#[cfg(feature = "robios")]
use std::sync::{Mutex, PoisonError};

#[cfg(feature = "robios")]
use roverlab::geometry::Pose;
use roverlab::io::log::{Attachment, Header, LogError, LogWriter, Player, Troop, Witness};
#[cfg(feature = "robios")]
use roverlab::io::robios::{RobiosRobot, RobiosTruth};
use roverlab::io::sim::{Fleet, SimOptions, Simulation};
use roverlab::io::wrappers::{Fault, Faulty, Quantised};
use roverlab::io::{self, Key, RobotIo};
use roverlab::world::{Scene, formats};

use super::{CommonArgs, Failure, Origin};

/// A robot for an example: simulated or replayed, and recorded if the options ask for it.
pub(crate) type Driven = Box<dyn RobotIo + Send>;

/// What is true about an example's robots.
pub(crate) type StageTruth = Box<dyn Witness + Send>;

/// Where an example gets its robots from: a simulator, or a recording; and where it records them.
///
/// When it goes, the recording is complete, and the run's [`Origin`] knows what went wrong with it.
#[derive(Debug)]
pub(crate) struct Stage {
    play: Play,
    faults: Vec<Fault>,
    /// Whether simulated robots round as RoBIOS does.
    quantised: bool,
    recording: Recording,
}

#[derive(Debug)]
enum Play {
    Simulation(Simulation),
    /// Each robot alone in a world of its own.
    Apart(Vec<Simulation>),
    Recording(Player),
    /// The one robot behind a library, until it is taken, and what is known about it.
    #[cfg(feature = "robios")]
    Library(PathBuf, Mutex<(Option<RobiosRobot>, Option<RobiosTruth>)>),
}

/// Where a run is recorded, and what it replays.
#[derive(Debug, Default)]
struct Recording {
    writer: Option<LogWriter<BufWriter<File>>>,
    player: Option<Player>,
    origin: Origin,
}

/// Robots that are stepped in one thread: simulated or replayed, and recorded if the options ask for it. For all else as
/// a [`Stage`].
pub(crate) struct StagedTroop<'a> {
    // Let go before the recording is finished.
    troop: Box<dyn Troop<'a> + 'a>,
    _recording: Recording,
}

impl<'a> Deref for StagedTroop<'a> {
    type Target = dyn Troop<'a> + 'a;

    fn deref(&self) -> &Self::Target {
        self.troop.as_ref()
    }
}

impl DerefMut for StagedTroop<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        self.troop.as_mut()
    }
}

impl CommonArgs {
    /// The stage that the options describe: a simulation of a scene, or the recording that `--replay` names.
    pub(crate) fn stage(&self, scene: &Scene, options: SimOptions) -> Result<Stage, Failure> {
        let stage = match (self.player(), &self.robios) {
            (Some(player), _) => Stage {
                play: Play::Recording(player),
                faults: Vec::new(),
                quantised: false,
                recording: Recording::default(),
            },
            #[cfg(feature = "robios")]
            (None, Some(library)) => {
                let start = scene.robots.first().map_or(Pose::default(), |robot| robot.pose);
                let robot = RobiosRobot::open(library).map_err(Failure::input)?;
                let truth = robot.truth(start);
                let play = Play::Library(library.clone(), Mutex::new((Some(robot), Some(truth))));
                Stage { play, faults: self.faults()?, quantised: false, recording: Recording::default() }
            }
            _ => Stage { quantised: self.quantised, ..Stage::simulated(scene, options, self.faults()?)? },
        };
        self.recorded(scene, stage)
    }

    /// Fails where many robots drive at once, and a library has only one.
    fn check_no_library(&self) -> Result<(), Failure> {
        self.robios.as_ref().map_or(Ok(()), |library| Err(alone(library)))
    }

    /// As [`stage`](Self::stage), with copies of the scene's first robot that drive each alone in a copy of its world.
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
            let simulations = (0..robots).map(|_| Simulation::new(scene, options.clone()));
            Play::Apart(simulations.collect::<io::Result<_>>().map_err(Failure::input)?)
        };
        self.recorded(
            scene,
            Stage { play, faults: Vec::new(), quantised: false, recording: Recording::default() },
        )
    }

    fn recorded(&self, scene: &Scene, stage: Stage) -> Result<Stage, Failure> {
        let player = match &stage.play {
            Play::Recording(player) => Some(player.clone()),
            _ => None,
        };
        Ok(Stage { recording: self.recording(scene, player)?, ..stage })
    }

    /// As [`stage`](Self::stage), with all robots stepped in one thread.
    pub(crate) fn troop<'a>(&self, scene: &Scene, options: SimOptions) -> Result<StagedTroop<'a>, Failure> {
        self.check_no_library()?;
        let player = self.player();
        let troop: Box<dyn Troop<'a> + 'a> = match &player {
            Some(player) => Box::new(player.troop()),
            None => Box::new(Fleet::new(scene, options).map_err(Failure::input)?),
        };
        let recording = self.recording(scene, player)?;
        let troop = match &recording.writer {
            Some(writer) => Box::new(writer.troop(troop)),
            None => troop,
        };
        Ok(StagedTroop { troop, _recording: recording })
    }

    /// What plays the recording that `--replay` names.
    fn player(&self) -> Option<Player> {
        self.origin.facts().log.as_ref().map(Player::new)
    }

    /// Begins the recording that `--record` asks for.
    fn recording(&self, scene: &Scene, player: Option<Player>) -> Result<Recording, Failure> {
        let mut recording = Recording { writer: None, player, origin: self.origin.clone() };
        self.origin.set_staged();
        let Some(file) = &self.record else { return Ok(recording) };
        let facts = self.origin.facts();
        let header = facts.log.as_ref().map_or_else(
            || Header {
                seed: Some(self.seed),
                attachments: texts(scene).into_iter().chain(self.origin.files()).collect(),
                ..Header::new(&facts.program, &facts.options)
            },
            |log| log.header().clone(),
        );
        let writer = create(file, &header).map_err(|error| {
            let file = file.display();
            Failure::input(format!("--record {file}: {error}; expected a file that can be written"))
        })?;
        writer.show(scene);
        recording.writer = Some(writer);
        Ok(recording)
    }
}

/// World and robots as text.
fn texts(scene: &Scene) -> Vec<Attachment> {
    let text = |name: String, text: String| Attachment {
        name,
        media_type: "text/plain".into(),
        data: text.into_bytes(),
    };
    let mut files = vec![text("scene.wld".into(), formats::wld::print(&scene.world))];
    let script = formats::sim::SimFile::for_scene(scene, "scene.wld");
    files.push(text("scene.sim".into(), formats::sim::print(&script)));
    for (index, robot) in scene.robots.iter().enumerate() {
        if !scene.robots[..index].iter().any(|other| other.spec == robot.spec) {
            files.push(text(format!("scene.robot{}.robi", index + 1), formats::robi::print(&robot.spec)));
        }
    }
    files
}

fn create(file: &Path, header: &Header) -> std::io::Result<LogWriter<BufWriter<File>>> {
    LogWriter::new(BufWriter::with_capacity(1 << 16, File::create(file)?), header)
}

impl Stage {
    /// A simulation that nobody records, with faults of the first robot.
    pub(crate) fn simulated(scene: &Scene, options: SimOptions, faults: Vec<Fault>) -> Result<Self, Failure> {
        let simulation = Simulation::new(scene, options).map_err(Failure::input)?;
        Ok(Self {
            play: Play::Simulation(simulation),
            faults,
            quantised: false,
            recording: Recording::default(),
        })
    }

    /// A robot, by its index in the scene. Take all robots that drive at once before the first one does.
    pub(crate) fn robot(&self, index: usize) -> Result<Driven, Failure> {
        let simulated = |simulation: &Simulation, index| simulation.robot(index).map_err(Failure::input);
        match &self.play {
            Play::Simulation(simulation) => {
                let faults = if index == 0 { self.faults.clone() } else { Vec::new() };
                let robot = simulated(simulation, index)?;
                if self.quantised {
                    return Ok(self.recorded(Faulty::new(Quantised::new(robot), faults), index));
                }
                Ok(self.recorded(Faulty::new(robot, faults), index))
            }
            Play::Apart(simulations) => Ok(self.recorded(simulated(&simulations[index], 0)?, index)),
            Play::Recording(player) => {
                Ok(self.recorded(player.robot(index).map_err(|error| foreign(&error))?, index))
            }
            #[cfg(feature = "robios")]
            Play::Library(library, taken) => {
                let robot = taken.lock().unwrap_or_else(PoisonError::into_inner).0.take();
                let robot = robot.filter(|_| index == 0).ok_or_else(|| alone(library))?;
                Ok(self.recorded(Faulty::new(robot, self.faults.clone()), index))
            }
        }
    }

    fn recorded(&self, robot: impl RobotIo + Send + 'static, index: usize) -> Driven {
        match &self.recording.writer {
            Some(writer) => Box::new(writer.recorder(robot, index)),
            None => Box::new(robot),
        }
    }

    /// What is true, for the program that drives or watches a robot. Of robots apart, each is the first one of its world.
    pub(crate) fn truth(&self, index: usize) -> Result<StageTruth, Failure> {
        match &self.play {
            Play::Simulation(simulation) => Ok(self.witnessed(simulation.truth(), index)),
            Play::Apart(simulations) => Ok(self.witnessed(simulations[index].truth(), index)),
            Play::Recording(player) => {
                Ok(self.witnessed(player.truth(index).map_err(|error| foreign(&error))?, index))
            }
            #[cfg(feature = "robios")]
            Play::Library(library, taken) => {
                let truth = taken.lock().unwrap_or_else(PoisonError::into_inner).1.take();
                Ok(self.witnessed(truth.ok_or_else(|| alone(library))?, index))
            }
        }
    }

    fn witnessed(&self, witness: impl Witness + Send + 'static, index: usize) -> StageTruth {
        match &self.recording.writer {
            Some(writer) => Box::new(writer.witness(witness, index)),
            None => Box::new(witness),
        }
    }

    /// Schedules a key press, in seconds since the start. A replayed robot's keys are in the recording.
    pub(crate) fn press_key(&self, index: usize, time: f64, key: Key) -> io::Result<()> {
        match &self.play {
            Play::Simulation(simulation) => simulation.press_key(index, time, key),
            Play::Apart(simulations) => simulations[index].press_key(0, time, key),
            Play::Recording(_) => Ok(()),
            // Whoever stands beside the robot presses its keys.
            #[cfg(feature = "robios")]
            Play::Library(..) => Ok(()),
        }
    }
}

/// A library has one robot.
fn alone(library: &Path) -> Failure {
    let library = library.display();
    Failure::input(format!(
        "--robios {library}: found several robots that drive; expected a run of one robot"
    ))
}

/// A recording that lacks a robot belongs to another scene.
fn foreign(error: &LogError) -> Failure {
    Failure::input(format!("--replay: {error}"))
}

impl Drop for Recording {
    fn drop(&mut self) {
        if let Some(Err(error)) = self.writer.take().map(LogWriter::finish) {
            self.origin.note(format!("--record: the recording is incomplete: {error}"));
        }
        if let Some((time, call)) = self.player.as_ref().and_then(Player::rest) {
            self.origin.note(format!(
                "--replay: the run has ended; expected the call {call} at {time} s, as recorded"
            ));
        }
    }
}
