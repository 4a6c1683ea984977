use std::num::NonZero;
use std::path::PathBuf;

use roverlab::geometry::{Point, Pose, units};
use roverlab::nav::elevation::{Climber, Objective};
use roverlab::world::RobotSpec;

use crate::common::{Failure, PlainArgs, parse_point, parse_pose};

/// How a way is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum Planner {
    /// From sample to sample, by Dijkstra's algorithm.
    Dijkstra,
    /// From sample to sample, by A*.
    Astar,
    /// In any direction.
    AnyAngle,
}

/// What a way is to cost little of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Cost {
    /// Millimetres along the ground.
    Length,
    /// Joules, by the robot's mass: what it lifts, and what rolling takes.
    Energy,
    /// Seconds.
    Time,
}

impl Cost {
    pub(crate) const ALL: [Self; 3] = [Self::Length, Self::Energy, Self::Time];

    /// The objective for a robot.
    pub(crate) fn objective(self, spec: &RobotSpec) -> Objective {
        let speed = 0.5 * spec.drive.top_speed();
        match self {
            Self::Length => Objective::Length,
            Self::Energy => Objective::Energy { resistance: RESISTANCE },
            Self::Time => Objective::Time { speed, climb: speed * CLIMB },
        }
    }

    /// What a report's cost is for one of the planner's, and its unit.
    pub(crate) fn unit(self, spec: &RobotSpec) -> (f64, &'static str) {
        match self {
            Self::Length => (1000.0, "mm"),
            Self::Energy => (9.81 * spec.mass, "J"),
            Self::Time => (1.0, "s"),
        }
    }
}

/// The force that rolling on belts takes, as a share of the weight; and the climbing speed as a share of that on level ground: up
/// a slope of 10 degrees a robot is as fast as on level ground.
const RESISTANCE: f64 = 0.1;
const CLIMB: f64 = 0.17;

/// The command line of `terrain-plan`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Plans a way over hills that is short, takes little energy or little time, where a robot does not tip or slip",
    after_help = "\
Without --world, the hills are generated; --seed says which. Without --goal, the way leads to the highest place that can be
reached.

JSON fields:
  cost, unit                  of the way, uphill and downhill
  cost_back                   of the way back, or null
  length_mm, climb_mm         along the ground, and all that it rises
  turns                       places where it turns or steps
  samples, open_percent       of the hills; the share on which the robot can stand
  highest_reachable_mm        within the slope limit
  slope_limit_deg
  expanded                    nodes taken off the queue
  timing                      with --timing: prepare_ms, plan_ms
  runs, changes, equal        with --campaign only: plans of A* and of D* Lite that cost what Dijkstra's and fresh ones do
Outcomes: found, unreachable; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Hills: a .wld or .sim with a line `terrain WIDTH HEIGHT TOP FILE`.
    #[arg(long, value_name = "FILE")]
    pub(crate) world: Option<PathBuf>,

    /// The built-in robot that is to drive.
    #[arg(long, value_name = "NAME", default_value = "Blizzard", value_parser = parse_robot)]
    pub(crate) robot: Box<RobotSpec>,

    /// Where the way begins [default: the start of the world].
    #[arg(long, value_name = "X,Y,DEG", value_parser = parse_pose, allow_hyphen_values = true)]
    pub(crate) start: Option<Pose>,

    /// Where it ends [default: on the highest place that can be reached].
    #[arg(long, value_name = "X,Y", value_parser = parse_point, allow_hyphen_values = true)]
    pub(crate) goal: Option<Point>,

    /// What it is to cost little of.
    #[arg(long, value_enum, default_value_t = Cost::Length)]
    pub(crate) cost: Cost,

    /// How it is found.
    #[arg(long, value_enum, default_value_t = Planner::AnyAngle)]
    pub(crate) planner: Planner,

    /// The steepest ground [default: seven tenths of where the robot would slip or tip].
    #[arg(long, value_name = "DEG", value_parser = parse_slope, allow_hyphen_values = true)]
    pub(crate) slope: Option<f64>,

    /// Plan on many hills, and hold the planners against each other.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Hills of a campaign; each has the next seed.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) runs: u64,

    /// How many threads plan in a campaign [default: one for each core].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) threads: Option<NonZero<usize>>,

    #[command(flatten)]
    pub(crate) plain: PlainArgs,
}

crate::common::shares_options!(Args, plain: PlainArgs, unheeded: [
    ("always", &["animation"]),
    ("world", &["seed"]),
    ("campaign", &["world", "start", "goal", "cost", "planner", "picture"]),
    ("!campaign", &["runs", "threads"]),
]);

impl Args {
    pub(crate) fn climber(&self) -> Climber {
        let usual = Climber::of(&self.robot);
        self.slope.map_or(usual, |slope| usual.with_slope(slope))
    }
}

/// A failed way as an answer.
pub(crate) fn refused(error: impl std::fmt::Display) -> Failure {
    Failure::input(error.to_string())
}

fn parse_robot(text: &str) -> Result<Box<RobotSpec>, String> {
    let known = RobotSpec::predefined(text).map(Box::new);
    known.ok_or_else(|| format!("expected one of {}", RobotSpec::PREDEFINED.join(", ")))
}

fn parse_slope(text: &str) -> Result<f64, String> {
    let slope = text.trim().parse().ok().filter(|degrees| (1.0..=60.0).contains(degrees));
    slope.map(units::from_deg).ok_or_else(|| "expected degrees from 1 to 60".into())
}
