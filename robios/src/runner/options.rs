use std::path::{Path, PathBuf};

use clap::builder::ArgPredicate;

use crate::costs::Costs;
use crate::keys::KeyPlan;
use crate::plan::{FRAME_RATE, Plan, parse_pose};
use roverlab::geometry::Pose;
use roverlab::io::sim::TICK;
use roverlab::picture::FileType;

/// Runs programs written for RoBIOS and EyeSim in simulated worlds, without a display and in virtual time.
///
/// A script starts the program of each robot; all robots share one world. A single program drives the first
/// robot of the world, or an S4.
#[derive(Debug, clap::Parser)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
#[command(
    name = "robios",
    version,
    after_help = "Per robot, `--json` prints: program, exit (null if a signal or a limit has ended it), outcome (finished, \
                  collided, failed, crashed, timed_out), sim_time_s, pose, odometry, path_length_mm, collisions, \
                  lcd_text, sounds, and where there are some: error, beyond_robots (functions called that no robot has), \
                  trail (with --trail)."
)]
pub(crate) struct Options {
    /// World or scene: .sim, .wld, .maz, or a ROS map.yaml [default: the script; the only .sim, or else the
    /// only .maz or .wld beside the program; or a square of 4 m].
    #[arg(long, value_name = "FILE")]
    pub(crate) world: Option<PathBuf>,

    /// Robot: S4, LabBot, Omni, Car, or a description, .robi [default: the world's, or an S4].
    #[arg(long, value_name = "ROBOT")]
    pub(crate) robot: Option<String>,

    /// Start pose of the robot, in millimetres and degrees.
    #[arg(long, value_name = "X,Y,DEG", value_parser = parse_pose, allow_hyphen_values = true)]
    pub(crate) start: Option<Pose>,

    /// Seed of all random streams.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,

    /// Noise: 0 ideal, EyeSim's default; 1 as on the real robot; up to 5.
    #[arg(long, value_name = "F", default_value = "0", value_parser = parse_noise)]
    pub(crate) noise: f64,

    /// Time limit of a program, in simulated seconds.
    #[arg(long, value_name = "S", default_value = "120", value_parser = parse_seconds)]
    pub(crate) time_limit: f64,

    /// Duration of calls: as in EyeSim, where a frame serves one request per robot (eyesim); 0.1 ms each
    /// (free); or from a file, with a line for each call that differs from EyeSim: `PSDGet query 2`.
    #[arg(long, value_name = "eyesim|free|FILE", default_value = "eyesim")]
    pub(crate) call_costs: String,

    /// Frame rate of EyeSim's rendering.
    #[arg(long, value_name = "HZ", default_value_t = FRAME_RATE, value_parser = parse_rate)]
    pub(crate) frame_rate: f64,

    /// Simulated seconds per second of a program's CPU time. Above 0, runs are not reproducible.
    #[arg(long, value_name = "FACTOR", default_value_t = 0.0, value_parser = parse_factor)]
    pub(crate) cpu_time: f64,

    /// Time limit of a program and its run, in real seconds [a day with --view].
    #[arg(
        long, value_name = "S", default_value = "60", value_parser = parse_seconds,
        default_value_if("view", ArgPredicate::IsPresent, "86400")
    )]
    pub(crate) real_limit: f64,

    /// Real seconds without a call after which the others stop waiting for a program; its time then passes
    /// without it.
    #[arg(long, value_name = "S", default_value = "5", value_parser = parse_seconds)]
    pub(crate) hang_limit: f64,

    /// Keys: AUTO; NONE; presses such as `KEY1@2s,KEY4@60s,TOUCH:120:80@3s,IRTV_OK@4s`; or TERMINAL: the
    /// digits 1 to 4 and Enter press the first robot's soft keys, in real time. With --view, TERMINAL is the
    /// default, and the page presses the keys of all robots.
    #[arg(
        long, value_name = "PLAN", default_value = "AUTO", value_parser = parse_keys,
        default_value_if("view", ArgPredicate::IsPresent, "TERMINAL")
    )]
    pub(crate) keys: String,

    /// Draw the robots' paths to a .svg or .png file.
    #[arg(long, value_name = "FILE", value_parser = parse_picture)]
    pub(crate) picture: Option<PathBuf>,

    /// Start programs outside the folder of the script that names them.
    #[arg(long)]
    pub(crate) allow_outside: bool,

    /// Report the robots' true paths as `trail`, with a point every S simulated seconds: seconds, millimetres
    /// and degrees.
    #[arg(long, value_name = "S", value_parser = parse_interval)]
    pub(crate) trail: Option<f64>,

    /// Record the robots' calls and answers.
    #[arg(long, value_name = "FILE.mcap")]
    pub(crate) record: Option<PathBuf>,

    /// Record in the place of a file that is no recording too.
    #[arg(long, requires = "record")]
    pub(crate) force: bool,

    /// Wait until each second of a recording is on the disk.
    #[arg(long, requires = "record")]
    pub(crate) fsync: bool,

    /// Show the run in a page, whose local address is printed: at this port, or at a free one.
    #[arg(long, value_name = "PORT", num_args = 0..=1, require_equals = true, default_missing_value = "0")]
    pub(crate) view: Option<u16>,

    /// Start before anybody has opened the page of --view.
    #[arg(long, requires = "view")]
    pub(crate) no_wait: bool,

    /// Save the display of the last robot that has one as a .png file.
    #[arg(long, value_name = "FILE.png")]
    pub(crate) lcd: Option<PathBuf>,

    /// Print exactly one JSON object on standard output, and nothing else there.
    #[arg(long)]
    pub(crate) json: bool,

    /// Also report the run time, which varies between runs.
    #[arg(long)]
    pub(crate) timing: bool,

    /// A script (.sim), or a program: an executable, Python (.py), C (.c) or C++ (.cpp, .cc). Or install
    /// FOLDER, to copy the library, headers and scripts to a folder; or compile SOURCE PROGRAM.
    #[arg(value_name = "PROGRAM", required = true)]
    pub(crate) program: PathBuf,

    /// The program's arguments.
    #[arg(value_name = "ARGUMENTS", trailing_var_arg = true, allow_hyphen_values = true)]
    pub(crate) arguments: Vec<String>,
}

/// Task of the runner.
pub(crate) enum Command {
    Run,
    Install(PathBuf),
    /// Source text and program.
    Compile(PathBuf, PathBuf),
}

impl Options {
    /// The task given by the arguments.
    pub(crate) fn command(&self) -> Command {
        match self.arguments.as_slice() {
            [folder] if self.program == Path::new("install") => Command::Install(folder.into()),
            [source, program] if self.program == Path::new("compile") => {
                Command::Compile(source.into(), program.into())
            }
            _ => Command::Run,
        }
    }

    /// Whether a user types the keys.
    pub(crate) fn is_live(&self) -> bool {
        self.keys.parse() == Ok(KeyPlan::Terminal)
    }

    /// Whether the program is a script that names programs.
    pub(crate) fn is_script(&self) -> bool {
        ends_in(&self.program, "sim")
    }

    /// The world, with absolute file names.
    pub(crate) fn plan(&self) -> Result<Plan, String> {
        if self.is_script() && self.world.is_some() {
            return Err("--world and a script; expected one of them, a script names its world".into());
        }
        let world = if self.is_script() { Some(&self.program) } else { self.world.as_ref() };
        let robot = self.robot.clone().map(|robot| {
            // The name of a built-in robot is not a file.
            if ends_in(Path::new(&robot), "robi") {
                whole(Path::new(&robot)).display().to_string()
            } else {
                robot
            }
        });
        Ok(Plan {
            world: world.map(|file| whole(file)),
            folder: whole(&self.program).parent().map_or_else(|| PathBuf::from("."), Path::to_owned),
            robot,
            start: self.start,
            index: 0,
            seed: self.seed,
            noise: self.noise,
            time_limit: self.time_limit,
            costs: Costs::parse(&self.costs_by_whole_name(), self.frame_rate)
                .map_err(|message| format!("--call-costs {message}"))?,
            cpu_time: self.cpu_time,
        })
    }

    /// The call costs, with a file by its absolute name: programs run elsewhere.
    pub(crate) fn costs_by_whole_name(&self) -> String {
        match self.call_costs.as_str() {
            known @ ("eyesim" | "free") => known.to_owned(),
            file => whole(Path::new(file)).display().to_string(),
        }
    }
}

/// Whether a file has an extension, ignoring case.
pub(crate) fn ends_in(file: &Path, ending: &str) -> bool {
    file.extension().is_some_and(|found| found.to_string_lossy().eq_ignore_ascii_case(ending))
}

/// The absolute name of a file; unchanged on failure.
pub(crate) fn whole(file: &Path) -> PathBuf {
    std::path::absolute(file).unwrap_or_else(|_| file.to_owned())
}

fn parse_noise(text: &str) -> Result<f64, String> {
    let level = text.parse().ok().filter(|level| (0.0..=5.0).contains(level));
    level.ok_or_else(|| "expected a number from 0 to 5".into())
}

fn parse_rate(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate| (1.0..=1000.0).contains(rate));
    rate.ok_or_else(|| "expected 1 to 1000 frames in a second".into())
}

fn parse_factor(text: &str) -> Result<f64, String> {
    let factor = text.parse().ok().filter(|factor| (0.0..=1000.0).contains(factor));
    factor.ok_or_else(|| "expected a factor from 0 to 1000".into())
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|&seconds: &f64| seconds > 0.0 && seconds <= 1e6);
    seconds.ok_or_else(|| "expected a number of seconds above 0, at most a million".into())
}

fn parse_interval(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds| (TICK..=1e6).contains(seconds));
    seconds.ok_or_else(|| format!("expected {TICK} to a million seconds"))
}

/// Validates the plan here; the library parses it again.
fn parse_keys(text: &str) -> Result<String, String> {
    text.parse::<KeyPlan>().map(|_| text.to_owned())
}

fn parse_picture(text: &str) -> Result<PathBuf, String> {
    FileType::of(text).map(|_| PathBuf::from(text)).map_err(|error| error.to_string())
}
