use roverlab::geometry::Point;
use roverlab::geometry::units::from_mm;

use crate::common::{CampaignArgs, CommonArgs, OF_A_CAMPAIGN, OF_ONE_RUN};
use crate::water::WaterArgs;

/// Command line of `boat`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Steers the solar raft along a course in wind, current and waves, and keeps its station at the end",
    after_help = "\
Without --world, the raft is on a lake of 40 x 30 m with islands; --seed draws these, a wind of up to 4 m/s, a current of
up to 0.2 m/s, waves of up to 0.15 m, and the course if --course does not. A world needs water: a line `water_level MM`. The raft
has a Doppler log and a compass, and knows its start.

With --campaign, 200 lakes with a course each.

JSON fields:
  waypoints                   number of waypoints passed
  max_miss_mm                 largest distance by which a waypoint was missed
  cross_track_rms_mm          root mean square distance from the legs
  station_rms_mm              root mean square distance from the last waypoint, from 20 s after arrival, or null
  course_mm                   the waypoints
  picture
  rows                        with --campaign only: the table
Outcomes: arrived, missed, timed_out, failed; with --campaign: passed, wrong. Aground is a contact."
)]
pub(crate) struct Args {
    /// Waypoints.
    #[arg(long, value_name = "X,Y;X,Y...", value_parser = parse_course, allow_hyphen_values = true)]
    pub(crate) course: Option<Course>,

    #[command(flatten)]
    pub(crate) waters: WaterArgs,

    #[command(flatten)]
    pub(crate) trials: CampaignArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

/// Waypoints of the command line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Course(pub(crate) Vec<Point>);

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["goal"]),
    ("campaign", OF_ONE_RUN),
    ("campaign", &["water", "course"]),
    ("!campaign", OF_A_CAMPAIGN),
]);

fn parse_course(text: &str) -> Result<Course, String> {
    let point = |text: &str| {
        let (x, y) = text.split_once(',')?;
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.abs() <= 1e9);
        Some(Point::new(from_mm(number(x)?), from_mm(number(y)?)))
    };
    let points: Option<Vec<Point>> = text.trim().trim_end_matches(';').split(';').map(point).collect();
    points.map(Course).ok_or_else(|| "expected waypoints in mm, such as 5000,4000;9000,8000".into())
}
