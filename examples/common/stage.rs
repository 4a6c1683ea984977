use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use roverlab::geometry::Point;
use roverlab::io::log::{Attachment, Header, LogError, LogWriter, Player, Witness};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::wrappers::{Fault, Faulty};
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
    writer: Option<LogWriter<BufWriter<File>>>,
    origin: Origin,
}

#[derive(Debug)]
enum Play {
    Simulation(Simulation),
    Recording(Player),
}

impl CommonArgs {
    /// The stage that the options describe: a simulation of a scene, or the recording that `--replay` names.
    pub(crate) fn stage(&self, scene: &Scene, options: SimOptions) -> Result<Stage, Failure> {
        let facts = self.origin.facts();
        let mut stage = match &facts.log {
            Some(log) => Stage {
                play: Play::Recording(Player::new(log)),
                faults: Vec::new(),
                writer: None,
                origin: Origin::default(),
            },
            None => Stage::simulated(scene, options, self.faults()?)?,
        };
        stage.origin = self.origin.clone();
        if let Some(file) = &self.record {
            let header = facts.log.as_ref().map_or_else(
                || Header {
                    seed: Some(self.seed),
                    attachments: texts(scene).into_iter().chain(self.origin.files()).collect(),
                    ..Header::new(&facts.program, &facts.options)
                },
                |log| log.header().clone(),
            );
            let writer = create(file, &header).map_err(|error| {
                Failure::input(format!(
                    "--record {}: {error}; expected a file that can be written",
                    file.display()
                ))
            })?;
            writer.show(scene);
            stage.writer = Some(writer);
        }
        Ok(stage)
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
        Ok(Self { play: Play::Simulation(simulation), faults, writer: None, origin: Origin::default() })
    }

    /// A robot, by its index in the scene. Take all robots that drive at once before the first one does.
    pub(crate) fn robot(&self, index: usize) -> Result<Driven, Failure> {
        match &self.play {
            Play::Simulation(simulation) => {
                let faults = if index == 0 { self.faults.clone() } else { Vec::new() };
                let robot = simulation.robot(index).map_err(Failure::input)?;
                Ok(self.recorded(Faulty::new(robot, faults), index))
            }
            Play::Recording(player) => {
                Ok(self.recorded(player.robot(index).map_err(|error| foreign(&error))?, index))
            }
        }
    }

    fn recorded(&self, robot: impl RobotIo + Send + 'static, index: usize) -> Driven {
        match &self.writer {
            Some(writer) => Box::new(writer.recorder(robot, index)),
            None => Box::new(robot),
        }
    }

    /// What is true, for the program that drives or watches a robot.
    pub(crate) fn truth(&self, index: usize) -> Result<StageTruth, Failure> {
        match &self.play {
            Play::Simulation(simulation) => Ok(self.witnessed(simulation.truth(), index)),
            Play::Recording(player) => {
                Ok(self.witnessed(player.truth(index).map_err(|error| foreign(&error))?, index))
            }
        }
    }

    fn witnessed(&self, witness: impl Witness + Send + 'static, index: usize) -> StageTruth {
        match &self.writer {
            Some(writer) => Box::new(writer.witness(witness, index)),
            None => Box::new(witness),
        }
    }

    /// Where the scene's objects are now; a recording does not tell.
    pub(crate) fn objects(&self) -> Option<Vec<Point>> {
        let Play::Simulation(simulation) = &self.play else { return None };
        let truth = simulation.truth();
        let poses = (0..).map_while(|index| truth.object(index).ok());
        Some(poses.map(|pose| pose.position()).collect())
    }

    /// Schedules a key press, in seconds since the start. A replayed robot's keys are in the recording.
    pub(crate) fn press_key(&self, index: usize, time: f64, key: Key) -> io::Result<()> {
        match &self.play {
            Play::Simulation(simulation) => simulation.press_key(index, time, key),
            Play::Recording(_) => Ok(()),
        }
    }
}

/// A recording that lacks a robot belongs to another scene.
fn foreign(error: &LogError) -> Failure {
    Failure::input(format!("--replay: {error}"))
}

impl Drop for Stage {
    fn drop(&mut self) {
        if let Some(Err(error)) = self.writer.take().map(LogWriter::finish) {
            self.origin.note(format!("--record: the recording is incomplete: {error}"));
        }
        if let Play::Recording(player) = &self.play
            && let Some((time, call)) = player.rest()
        {
            self.origin.note(format!(
                "--replay: the run has ended; expected the call {call} at {time} s, as recorded"
            ));
        }
    }
}
