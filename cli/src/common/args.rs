use std::fmt::Display;
use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use roverlab::files::irregular;
use roverlab::geometry::Pose;
use roverlab::io::wrappers::Fault;
use roverlab::picture::{Picture, SaveError};
use roverlab::world::InertialSpec;

use super::library::Library;
use super::values::{
    GoalOption, parse_animation, parse_goal, parse_noise, parse_picture, parse_pose, parse_seconds,
};
use super::{Failure, Origin, Report, is_same_file, onlooker};

/// Default folder of files that no option names.
const UNNAMED: &str = "target/pictures";

/// The options shared by all commands, flattened into a command's own.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Options of all commands (millimetres and degrees)")]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub(crate) struct CommonArgs {
    /// World or scene to run in: .sim, .wld, .maz, a ROS map.yaml, or a MovingAI .map.
    #[arg(long, value_name = "FILE")]
    pub(crate) world: Option<PathBuf>,

    /// Robot description, or the name of a built-in robot [default: S4; on hills: Blizzard].
    #[arg(long, value_name = "FILE.robi")]
    pub(crate) robot: Option<PathBuf>,

    /// Start pose of the robot.
    #[arg(long, value_name = "X,Y,DEG", value_parser = parse_pose, allow_hyphen_values = true)]
    pub(crate) start: Option<Pose>,

    /// Goal of the robot; some commands take a heading on arrival.
    #[arg(long, value_name = "X,Y[,DEG]", value_parser = parse_goal, allow_hyphen_values = true)]
    pub(crate) goal: Option<GoalOption>,

    /// Seed of every random stream.
    #[arg(long, value_name = "N", default_value_t = 1, allow_hyphen_values = true)]
    pub(crate) seed: u64,

    /// Noise: 0 ideal, 1 as on the real robot, up to 5.
    #[arg(long, value_name = "F", default_value = "1", value_parser = parse_noise, allow_hyphen_values = true)]
    pub(crate) noise: f64,

    /// Simulated seconds after which the run ends.
    #[arg(long, value_name = "S", value_parser = parse_seconds, allow_hyphen_values = true)]
    pub(crate) time_limit: Option<f64>,

    /// Draw the run into a .svg or .png file.
    #[arg(long, value_name = "FILE", value_parser = parse_picture)]
    pub(crate) picture: Option<PathBuf>,

    /// Draw the run as an endless animation into an .svg file.
    #[arg(long, value_name = "FILE.svg", value_parser = parse_animation)]
    pub(crate) animation: Option<PathBuf>,

    /// Record the run.
    #[arg(long, value_name = "FILE.mcap")]
    pub(crate) record: Option<PathBuf>,

    /// Record in the place of a file that is no recording too.
    #[arg(long, requires = "record")]
    pub(crate) force: bool,

    /// Wait until each second of a recording is on the disk.
    #[arg(long, requires = "record")]
    pub(crate) fsync: bool,

    /// Run against a recording, with its options; further options override them.
    #[arg(long, value_name = "FILE.mcap")]
    pub(crate) replay: Option<PathBuf>,

    /// Drive a real EyeBot, or another RoBIOS system, through this C library; the world is the robot's map.
    #[arg(long, value_name = "LIB")]
    pub(crate) robios: Option<PathBuf>,

    /// Round the simulated robot's numbers like RoBIOS: to whole millimetres and degrees.
    #[arg(long)]
    pub(crate) quantised: bool,

    /// Print exactly one JSON object on standard output, and nothing else there.
    #[arg(long)]
    pub(crate) json: bool,

    /// Report the duration too, which differs from run to run.
    #[arg(long)]
    pub(crate) timing: bool,

    /// Pace simulated time by the wall clock.
    #[arg(long)]
    pub(crate) realtime: bool,

    /// Inject a fault T seconds into the run: stuck, lost, nan, jump, late, link, hang or clock. May be
    /// repeated.
    #[arg(long, value_name = "KIND@T")]
    pub(crate) fault: Vec<String>,

    /// Put robots under the safety system, armed and started, and report its actions. Robots of campaigns and
    /// of fleets have none.
    #[arg(long)]
    pub(crate) supervised: bool,

    /// The page beside the run.
    #[cfg(feature = "view")]
    #[command(flatten)]
    pub(crate) view: super::view::ViewArgs,

    /// Description of the run, for recordings.
    #[arg(skip)]
    pub(crate) origin: Origin,
}

/// The options of a command that drives no robot.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct PlainArgs {
    /// Draw the result into a .svg or .png file.
    #[arg(long, value_name = "FILE", value_parser = parse_picture)]
    pub(crate) picture: Option<PathBuf>,

    /// Draw the process as an endless animation into an .svg file.
    #[arg(long, value_name = "FILE.svg", value_parser = parse_animation)]
    pub(crate) animation: Option<PathBuf>,

    /// Seed of random inputs.
    #[arg(long, value_name = "N", default_value_t = 1, allow_hyphen_values = true)]
    pub(crate) seed: u64,

    /// Print exactly one JSON object on standard output, and nothing else there.
    #[arg(long)]
    pub(crate) json: bool,

    /// Report the duration too, which differs from run to run.
    #[arg(long)]
    pub(crate) timing: bool,

    /// Description of the run, for campaigns in parts.
    #[arg(skip)]
    pub(crate) origin: Origin,
}

impl CommonArgs {
    /// Fails if this build cannot do what the options request.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        self.faults()?;
        if let Some(file) = &self.record {
            check_writable("--record", file)?;
        }
        match &self.robios {
            Some(library) if self.replay.is_some() => Err(Failure::input(format!(
                "--robios {} and --replay; expected one of them, a recording needs no robot",
                library.display()
            ))),
            Some(library) => check_library(library),
            None => Ok(()),
        }
    }

    /// Fails if the options request a recording although no robot drove.
    pub(crate) fn check_recorded(&self) -> Result<(), Failure> {
        let option = [("--record", &self.record), ("--replay", &self.replay), ("--robios", &self.robios)];
        match option.into_iter().find_map(|(option, file)| file.as_ref().map(|file| (option, file))) {
            Some((option, file)) if !self.origin.is_staged() => Err(Failure::input(format!(
                "{option} {}: found no robot that drives; expected a run of one robot that drives",
                file.display()
            ))),
            _ => Ok(()),
        }
    }

    /// Fails if robots were to be supervised, and none was.
    pub(crate) fn check_supervised(&self, was: bool) -> Result<(), Failure> {
        if self.supervised && !was {
            return Err(Failure::input(
                "--supervised: found no robot under a safety system; expected a run of one robot that drives",
            ));
        }
        Ok(())
    }

    /// Fails for options that contradict the file of a maze.
    pub(crate) fn check_maze(&self) -> Result<(), Failure> {
        let options = [
            ("--robot", self.robot.is_some()),
            ("--start", self.start.is_some()),
            ("--goal", self.goal.is_some()),
        ];
        refuse(&options, |name| {
            if name == "--robot" { "the robot is that for mazes" } else { "the maze's file says where it is" }
        })
    }

    /// Fails for options about place and manner of one robot's drive, in runs that are about something else.
    pub(crate) fn check_placeless(&self, says: &str) -> Result<(), Failure> {
        let options = [
            ("--world", self.world.is_some()),
            ("--robot", self.robot.is_some()),
            ("--start", self.start.is_some()),
            ("--goal", self.goal.is_some()),
            ("--picture", self.picture.is_some()),
            ("--animation", self.animation.is_some()),
            ("--fault", !self.fault.is_empty()),
        ];
        refuse(&options, |_| says)
    }

    /// Prints an event of the run. Silent with `--json`.
    pub(crate) fn tell(&self, event: impl Display) {
        if !self.json && !onlooker::told(&event) {
            // A closed pipe, as with `head`, does not stop the run.
            let _ = writeln!(std::io::stdout(), "{event}");
        }
    }

    /// Records a warning about the input. It is printed on standard error once the input has been accepted,
    /// also with `--json`, which only reserves standard output. If the input is rejected, only the rejection
    /// is printed.
    pub(crate) fn warn(&self, warning: impl Display) {
        self.origin.warn(warning.to_string());
    }

    /// Fails before a long run if a requested picture cannot be written.
    pub(crate) fn check_picture(&self) -> Result<(), Failure> {
        check_pictures(self.picture.as_deref(), self.animation.as_deref())
    }

    /// Adds a still picture of the run to a report, and an animated one if requested.
    pub(crate) fn draw(&self, report: Report, name: &str, picture: impl FnOnce() -> Picture) -> Report {
        if onlooker::stands_in() {
            onlooker::pictured(&picture());
            return report.field("picture", None::<&str>);
        }
        let files = (self.picture_file(name), self.animation.clone());
        let tell = |file| self.tell(file);
        if onlooker::is_there() {
            let picture = picture();
            onlooker::pictured(&picture);
            return drawn(report, files, tell, || picture);
        }
        drawn(report, files, tell, picture)
    }

    /// File of the picture: the one of `--picture`, or one in the default folder.
    pub(crate) fn picture_file(&self, name: &str) -> Option<PathBuf> {
        self.picture.clone().or_else(|| self.unnamed_file(name))
    }

    /// File for an output that no option names, in the default folder; `None` with `--json`, or if an option
    /// uses that very file for something else.
    pub(crate) fn unnamed_file(&self, name: &str) -> Option<PathBuf> {
        let file = unnamed_file(self.json || onlooker::stands_in(), name)?;
        let named = [&self.picture, &self.animation, &self.record, &self.replay, &self.world, &self.robot];
        let is_named = named.into_iter().flatten().any(|other| is_same_file(other, &file));
        (!is_named).then_some(file)
    }

    /// The faults to inject.
    pub(crate) fn faults(&self) -> Result<Vec<Fault>, Failure> {
        let parse = |text: &String| text.parse().map_err(|error| Failure::input(format!("--fault: {error}")));
        self.fault.iter().map(parse).collect()
    }
}

impl PlainArgs {
    /// Like [`CommonArgs::check_picture`].
    pub(crate) fn check_picture(&self) -> Result<(), Failure> {
        check_pictures(self.picture.as_deref(), self.animation.as_deref())
    }

    /// Like [`CommonArgs::draw`].
    pub(crate) fn draw(&self, report: Report, name: &str, picture: impl FnOnce() -> Picture) -> Report {
        if onlooker::stands_in() {
            onlooker::pictured(&picture());
            return report.field("picture", None::<&str>);
        }
        let still = self.picture.clone().or_else(|| unnamed_file(self.json, name));
        drawn(report, (still, self.animation.clone()), |_| (), picture)
    }
}

/// A file in the default folder; `None` with `--json`.
fn unnamed_file(json: bool, name: &str) -> Option<PathBuf> {
    let folder = Path::new(UNNAMED);
    // If the folder cannot be created, saving the file fails with the reason.
    (!json).then(|| fs::create_dir_all(folder)).map(|_| folder.join(name))
}

fn check_pictures(still: Option<&Path>, moving: Option<&Path>) -> Result<(), Failure> {
    still.map_or(Ok(()), |file| check_writable("--picture", file))?;
    moving.map_or(Ok(()), |file| check_writable("--animation", file))
}

/// Saves a picture, still and animated, and reports the files.
fn drawn(
    report: Report,
    (still, moving): (Option<PathBuf>, Option<PathBuf>),
    tell: impl Fn(String),
    picture: impl FnOnce() -> Picture,
) -> Report {
    let picture = if still.is_some() || moving.is_some() { Some(picture()) } else { None };
    let mut trouble = Vec::new();
    let mut saved = |file: Option<PathBuf>, save: fn(&Picture, &Path) -> Result<(), SaveError>| {
        let (file, picture) = (file?, picture.as_ref()?);
        match save(picture, &file) {
            Ok(()) => {
                tell(format!("picture: {}", file.display()));
                Some(file)
            }
            Err(error) => {
                trouble.push(Failure::from(error).to_string());
                None
            }
        }
    };
    let wants_motion = moving.is_some();
    let (still, moving) = (saved(still, |p, f| p.save(f)), saved(moving, |p, f| p.save_moving(f)));
    let mut report = report.field("picture", still);
    if wants_motion {
        report = report.field("animation", moving);
    }
    report.add_trouble(trouble);
    report
}

/// Fails if a library cannot be loaded.
fn check_library(library: &Path) -> Result<(), Failure> {
    let opened = Library::open(library, Pose::default(), InertialSpec::default());
    opened
        .map(|_| ())
        .map_err(|error| Failure::input(format!("--robios {error}; expected a library of RoBIOS")))
}

/// Fails if a file requested by an option cannot be written.
pub(crate) fn check_writable(option: &str, file: &Path) -> Result<(), Failure> {
    static TRIALS: AtomicUsize = AtomicUsize::new(0);
    let refused = |found: String, expected: &str| {
        Err(Failure::input(format!("{option} {}: found {found}; expected {expected}", file.display())))
    };
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return refused(format!("no folder {}", folder.display()), "one that exists");
    }
    if file.is_dir() {
        return refused("a folder of this name".into(), "the name of a file");
    }
    if let Some(wrong) = irregular(file) {
        let file = file.display();
        return Err(Failure::input(format!("{option} {file}: {wrong}; expected a regular file")));
    }
    // Pictures are written beside an older file and then replace it, so the folder counts.
    let tried = loop {
        let number = TRIALS.fetch_add(1, Ordering::Relaxed);
        let trial = folder.join(format!(".roverlab-{}-{number}.tmp", std::process::id()));
        match File::create_new(&trial) {
            // Whatever has the name belongs to others.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            created => break created.and_then(|_| fs::remove_file(&trial)),
        }
    };
    match tried {
        Ok(()) => Ok(()),
        Err(error) => refused(format!("folder {} ({error})", folder.display()), "one that can be written to"),
    }
}

/// Fails for the first given option of a list, with the reason.
fn refuse<'a>(options: &[(&'a str, bool)], says: impl Fn(&'a str) -> &'a str) -> Result<(), Failure> {
    options.iter().find(|(_, given)| *given).map_or(Ok(()), |(name, _)| {
        Err(Failure::input(format!("{name}: found one; expected none, as {}", says(name))))
    })
}
