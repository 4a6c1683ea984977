use roverlab::io::sim::{Fleet, SimOptions};
use serde_json::json;

use super::Args;
use super::game::{Game, Played};
use crate::common::{Failure, Report, campaign_report, rounded, wrong_seeds};

/// Sizes of rings, messages in each game, and the fraction of what is sent that is lost.
const ROBOTS: std::ops::RangeInclusive<u64> = 2..=10;
const MESSAGES: u32 = 1000;
const LOSS: f64 = 0.2;

/// The campaign's work: as many games as are asked for, of each size in turn.
pub(super) fn campaign(args: &Args) -> Result<Report, Failure> {
    let sizes = ROBOTS.count() as u64;
    let first = args.common.seed;
    let robots = |seed: u64| ROBOTS.start() + seed.wrapping_sub(first) % sizes;
    let trials = args.trials.trials(&args.common, "games", sizes, |seed| game(args, seed, robots(seed)))?;
    args.common.tell("robots  games  messages  duplicated  missing  joined  left  repeats  per message");
    let mut rows = Vec::new();
    for size in ROBOTS {
        let of = || trials.iter().filter(move |(seed, _)| robots(*seed) == size).map(|(_, played)| played);
        let games = of().count();
        if games == 0 {
            continue;
        }
        let messages: usize = of().map(|played| played.arrivals.len()).sum();
        let sum = |count: fn(&Played) -> u32| of().map(count).sum::<u32>();
        let (duplicated, missing) = (
            sum(|played| played.duplicated_and_missing().0),
            sum(|played| played.duplicated_and_missing().1),
        );
        let (joined, left) = (sum(|played| played.joined as u32), sum(|played| played.left as u32));
        let (repeats, interval) =
            (sum(|played| played.repeats), of().map(Played::interval).sum::<f64>() / games as f64);
        args.common.tell(format_args!(
            "{size:>6}  {games:>5}  {messages:>8}  {duplicated:>10}  {missing:>7}  {joined:>6}  {left:>4}  \
             {repeats:>7}  {:>8.0} ms",
            1e3 * interval
        ));
        rows.push(json!({
            "robots": size, "games": games, "messages": messages, "duplicated": duplicated,
            "missing": missing, "joined": joined, "left": left, "repeats": repeats,
            "message_ms": rounded(1e3 * interval),
        }));
    }
    let wrong = wrong_seeds(&trials, |played| played.is_good(MESSAGES));
    Ok(campaign_report(wrong.is_empty(), 0, &wrong).table("rows", rows))
}

fn game(args: &Args, seed: u64, robots: u64) -> Result<Played, Failure> {
    let options = SimOptions { radio_loss: LOSS, ..SimOptions::with_noise(args.common.noise, seed) };
    let game = Game::new(robots as usize, MESSAGES, options, args.common.time_limit);
    let mut fleet = Fleet::new(&game.scene, game.options.clone())?;
    Ok(game.play(&mut fleet, |_| {})?)
}
