use roverlab::drive::Steering;
use roverlab::geometry::{Point, Twist};

use super::chase::parse_moving;
use crate::common::{CommonArgs, OF_ONE_RUN, OF_PARTS, PartArgs, parse_point};
use crate::driving::Way;

/// Command line of `a-to-b`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Drives a robot to a goal: turn and straight, arc, dog curve or spline, with feedback all the way",
    after_help = "\
Without --world, the robot drives on an empty floor. Every method reaches the heading in --goal: a spline arrives with
it, the others turn at the end. An arc to a goal behind the robot is driven backwards.

With --landmark, lidar measurements of poles at known places correct odometry: the world's cylinders, or one beside the
goal on the empty floor.

With --via, a chain of splines through all these places. With --moving, the goal moves ahead along its heading; the
robot knows its position and replans at each step.

With --campaign, random goals instead of one, with every method: errors without noise, with and without encoder ticks;
the number of runs with noise that end within the 95 % ellipse predicted by odometry; errors with a landmark.

JSON fields:
  method                      turn, arc, dog or spline
  goal, goal_heading_deg      [x, y] mm; the heading or null
  position_error_mm           true distance to the goal at the end
  heading_error_deg           true error of the heading, or null
  ellipse_mm                  semi-axes of odometry's 95 % error ellipse, longer one first
  inside_ellipse              whether the robot is truly inside it; null with --landmark or without noise
  landmark_scans              scans that showed a landmark
  time_limit_s, picture
  rows                        with --campaign only: the table
Outcomes: reached, caught (a moving goal), missed (all by its own odometry; the error is the truth), blocked, timed_out,
collided, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Method of driving to the goal.
    #[arg(long, value_enum, default_value = "spline")]
    pub(crate) method: Way,

    /// Steering law along the path.
    #[arg(long, value_enum, default_value = "cross-track")]
    pub(crate) follower: Follower,

    /// Tangent length of a spline as a multiple of the distance to the goal: the book's k.
    #[arg(long, value_name = "K", default_value_t = 1.0, value_parser = parse_scale, allow_hyphen_values = true)]
    pub(crate) scale: f64,

    /// A point that a spline passes; may be repeated, in this order.
    #[arg(long, value_name = "X,Y", value_parser = parse_point, allow_hyphen_values = true)]
    pub(crate) via: Vec<Point>,

    /// Let the goal move, in millimetres and degrees per second.
    #[arg(long, value_name = "MM[,DEG]", value_parser = parse_moving, allow_hyphen_values = true)]
    pub(crate) moving: Option<Twist>,

    /// Encoders measure exactly instead of counting ticks.
    #[arg(long)]
    pub(crate) ideal_encoders: bool,

    /// Correct odometry by known poles that the lidar sees.
    #[arg(long)]
    pub(crate) landmark: bool,

    /// Drive to many random goals and print a table.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Runs of each method with noise in a campaign; a tenth of it in its other rows.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) runs: u64,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("campaign", OF_ONE_RUN),
    ("campaign", &["noise", "time_limit", "method", "moving", "ideal_encoders", "landmark"]),
    ("!campaign", &["runs"]),
    ("!campaign", OF_PARTS),
    ("method=turn,arc,dog", &["scale"]),
    ("method=dog", &["follower"]),
    ("via", &["scale"]),
    ("moving", &["follower"]),
]);

/// Path follower by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Follower {
    /// By heading error and cross-track error.
    CrossTrack,
    /// Along the arc to a point ahead on the path.
    PurePursuit,
}

impl Follower {
    pub(crate) fn steering(self) -> Steering {
        match self {
            Self::CrossTrack => Steering::CrossTrack { reach: 0.1 },
            Self::PurePursuit => Steering::PurePursuit { lookahead: 0.12 },
        }
    }
}

/// A scale above 0, at most 10.
fn parse_scale(text: &str) -> Result<f64, String> {
    let scale = text.parse().ok().filter(|scale: &f64| *scale > 0.0 && *scale <= 10.0);
    scale.ok_or_else(|| "expected a number above 0, at most 10".into())
}
