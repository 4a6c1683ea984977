use std::num::NonZero;
use std::path::PathBuf;

use roverlab::geometry::{Point, Pose, units};
use roverlab::nav::elevation::{Climber, Objective};
use roverlab::world::RobotSpec;

use crate::common::{Failure, OF_A_CAMPAIGN, PartArgs, PlainArgs, parse_point, parse_pose};

/// Planner of the path.
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

/// Quantity to minimise.
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

    /// The planner's objective for a robot.
    pub(crate) fn objective(self, spec: &RobotSpec) -> Objective {
        let speed = 0.5 * spec.drive.top_speed();
        match self {
            Self::Length => Objective::Length,
            Self::Energy => Objective::Energy { resistance: RESISTANCE },
            Self::Time => Objective::Time { speed, climb: speed * CLIMB },
        }
    }

    /// Factor from the planner's cost to the report's, and its unit.
    pub(crate) fn unit(self, spec: &RobotSpec) -> (f64, &'static str) {
        match self {
            Self::Length => (1000.0, "mm"),
            Self::Energy => (9.81 * spec.mass, "J"),
            Self::Time => (1.0, "s"),
        }
    }
}

/// Rolling resistance of belts (fraction of the weight), and speed of climbing relative to level ground: up a
/// slope of 10 degrees a robot is as fast as on level ground.
const RESISTANCE: f64 = 0.1;
const CLIMB: f64 = 0.17;

/// The command line of `terrain-plan`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Plans a path over hills with minimum length, energy or time, on which a robot neither tips nor slips",
    after_help = "\
Without --world, the hills are generated from --seed. Without --goal, the path leads to the highest reachable place.

JSON fields:
  cost, unit                  of the path, uphill and downhill
  cost_back                   of the path back, or null
  length_mm, climb_mm         along the ground, and sum of all ascents
  turns                       number of points of the path
  samples, open_percent       of the hills; the part on which the robot can stand
  highest_reachable_mm        within the slope limit
  slope_limit_deg
  expanded                    nodes taken off the queue
  timing                      with --timing: prepare_ms, plan_ms
  runs, changes, equal        with --campaign only: plans of A* and D* Lite with the costs of Dijkstra's and of new plans
Outcomes: found, unreachable; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Hills: a .wld or .sim with a line `terrain WIDTH HEIGHT TOP FILE`.
    #[arg(long, value_name = "FILE")]
    pub(crate) world: Option<PathBuf>,

    /// Built-in robot.
    #[arg(long, value_name = "NAME", default_value = "Blizzard", value_parser = parse_robot)]
    pub(crate) robot: Box<RobotSpec>,

    /// Start of the path [default: the start of the world].
    #[arg(long, value_name = "X,Y,DEG", value_parser = parse_pose, allow_hyphen_values = true)]
    pub(crate) start: Option<Pose>,

    /// Goal of the path [default: the highest reachable place].
    #[arg(long, value_name = "X,Y", value_parser = parse_point, allow_hyphen_values = true)]
    pub(crate) goal: Option<Point>,

    /// Quantity to minimise.
    #[arg(long, value_enum, default_value_t = Cost::Length)]
    pub(crate) cost: Cost,

    /// Planner of the path.
    #[arg(long, value_enum, default_value_t = Planner::AnyAngle)]
    pub(crate) planner: Planner,

    /// Steepest slope [default: 70 % of the slope at which the robot slips or tips].
    #[arg(long, value_name = "DEG", value_parser = parse_slope, allow_hyphen_values = true)]
    pub(crate) slope: Option<f64>,

    /// Plan on many hills, and compare the planners.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Number of hills in a campaign, with consecutive seeds.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) runs: u64,

    /// Number of threads in a campaign [default: one per core].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) threads: Option<NonZero<usize>>,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,

    #[command(flatten)]
    pub(crate) plain: PlainArgs,
}

crate::common::shares_options!(Args, plain: PlainArgs, unheeded: [
    ("always", &["animation"]),
    ("world", &["seed"]),
    ("campaign", &["world", "start", "goal", "cost", "planner", "picture"]),
    ("!campaign", OF_A_CAMPAIGN),
]);

impl Args {
    pub(crate) fn climber(&self) -> Climber {
        let usual = Climber::of(&self.robot);
        self.slope.map_or(usual, |slope| usual.with_slope(slope))
    }
}

/// Outcome of a failed plan.
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
