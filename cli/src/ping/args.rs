use crate::common::{CampaignArgs, CommonArgs, OF_A_CAMPAIGN};

/// Command line of `ping`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Passes a count round a ring of robots by radio, although messages are lost and robots join and leave",
    after_help = "\
From the third on, each robot joins at a time drawn by --seed, and every other one leaves again.

With --campaign, 1,000 messages in rings of 2 to 10 robots that lose 20 % of what is sent.

JSON fields:
  robots                      number of robots
  messages                    number of messages that arrived
  duplicated, missing         numbers that arrived more than once, or not although a higher one did
  joined, left                number of robots that joined later, and of those that left
  repeats                     number of messages that were sent again
  message_ms                  mean simulated time from one arrival to the next
  picture
  rows                        with --campaign only: the table, by number of robots
Outcomes: passed_on, wrong, timed_out, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Number of robots.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u8).range(2..=10), allow_hyphen_values = true)]
    pub(crate) robots: u8,

    /// Number of messages.
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=100_000), allow_hyphen_values = true)]
    pub(crate) messages: u32,

    /// Percentage of what is sent that is lost.
    #[arg(long, value_name = "PERCENT", default_value = "20", value_parser = parse_loss, allow_hyphen_values = true)]
    pub(crate) loss: f64,

    #[command(flatten)]
    pub(crate) trials: CampaignArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["world", "robot", "start", "goal", "robios", "quantised", "fault", "supervised"]),
    ("campaign", &["robots", "messages", "loss", "picture", "animation", "realtime"]),
    ("!campaign", OF_A_CAMPAIGN),
]);

fn parse_loss(text: &str) -> Result<f64, String> {
    let percent = text.trim().parse().ok().filter(|percent: &f64| (0.0..=50.0).contains(percent));
    percent.map(|percent| percent / 100.0).ok_or_else(|| "expected 0 to 50 percent".into())
}
