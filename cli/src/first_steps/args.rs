use roverlab::drive::FirstTask;

use crate::common::{CampaignArgs, CommonArgs, OF_A_CAMPAIGN, OF_ONE_RUN};

/// Command line of `first-steps`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Drives to 300 mm before a wall and back, or round a circle of 1 m, and measures how well it returns",
    after_help = "\
Without --world, --seed draws a room and the start in it. The robot compares lidar scans with the one at its start.

With --campaign, both tasks in rooms drawn at random. It passes if 95 % of the runs of each task end within 20 mm and
2 degrees of where they should, without a contact.

JSON fields:
  task                        wall or circle
  position_error_mm           true distance to the start at the end
  heading_error_deg           true error of the heading at the end: that of the start, after a wall half a turn from it
  gap_mm                      wall: true distance between the robot's front and the wall where it turns
  max_deviation_mm            circle: largest true distance to the circle
  time_limit_s, picture
  rows                        with --campaign only: the table, by task
Outcomes: returned (by its own estimate; the errors are the truth), no_room, timed_out, collided, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Task to drive.
    #[arg(long, value_enum, default_value = "wall")]
    pub(crate) task: Task,

    #[command(flatten)]
    pub(crate) trials: CampaignArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["goal"]),
    ("campaign", OF_ONE_RUN),
    ("campaign", &["task"]),
    ("!campaign", OF_A_CAMPAIGN),
]);

/// A task of section 2.13.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Task {
    /// To a wall, about turn, and back.
    Wall,
    /// Once round a circle.
    Circle,
}

impl Task {
    pub(crate) const ALL: [Self; 2] = [Self::Wall, Self::Circle];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Wall => "wall",
            Self::Circle => "circle",
        }
    }

    pub(crate) fn of_library(self) -> FirstTask {
        match self {
            Self::Wall => FirstTask::Wall,
            Self::Circle => FirstTask::Circle,
        }
    }
}
