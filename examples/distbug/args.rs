use crate::common::CommonArgs;

/// The command line of the example `distbug`.
#[derive(Debug, clap::Parser)]
#[command(
    name = "distbug",
    about = "Drives a robot with a lidar to a goal among unknown obstacles, or proves that there is no way (DistBug)",
    after_help = "\
Without --world, the robot drives through a world of the example's own. A .sim gives robot, start and goal (its first
robot and its first marker), a .maz start and goal (the letters S and G), a .wld the start (`position`); --robot,
--start and --goal come before them. Other robots stand still.

Without --time-limit, the time is generous for the size of the world. Without --picture, the run is drawn into
target/pictures/distbug.svg, except with --json.

JSON fields:
  goal                       [x, y] mm
  goal_distance_mm           true distance at the end
  hit_points, leave_points   lists of [x, y] mm in the world, as the robot takes them
  contact_points             list of [x, y] mm, true
  time_limit_s               simulated seconds after which the run would have ended
  picture                    the file's name, or null
  error                      why the robot failed, only if it did
Outcomes: reached, unreachable, timed_out, collided, failed."
)]
pub(crate) struct Args {
    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

impl AsRef<CommonArgs> for Args {
    fn as_ref(&self) -> &CommonArgs {
        &self.common
    }
}
