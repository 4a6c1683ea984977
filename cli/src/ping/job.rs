use roverlab::io::sim::SimOptions;
use roverlab::picture::{Picture, SERIES, Style};

use super::Args;
use super::campaign::campaign;
use super::game::{Game, Played};
use crate::common::{Failure, Outcome, Report, rounded};
use crate::driving::{paced, pale};

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.trials.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let options = SimOptions { radio_loss: args.loss, ..SimOptions::with_noise(common.noise, common.seed) };
    let game = Game::new(args.robots.into(), args.messages, options, common.time_limit);
    let mut fleet = common.fleet(&game.scene, game.options.clone())?;
    let played = game.play(&mut *fleet, paced(common))?;
    drop(fleet);
    let (duplicated, missing) = played.duplicated_and_missing();
    let outcome = match () {
        () if played.is_good(args.messages) => Outcome::verdict("passed_on"),
        () if (duplicated, missing) != (0, 0) => Outcome::failure("wrong"),
        () => Outcome::failure("timed_out"),
    };
    let report = Report { sim_time: Some(played.sim_time), ..Report::new(outcome) }
        .field("robots", args.robots)
        .field("messages", played.arrivals.len())
        .field("duplicated", duplicated)
        .field("missing", missing)
        .field("joined", played.joined)
        .field("left", played.left)
        .field("repeats", played.repeats)
        .field("message_ms", rounded(1e3 * played.interval()));
    Ok(common.draw(report, "ping.svg", || picture(args, &game, &played)))
}

/// The ring, each way as wide as it was used.
fn picture(args: &Args, game: &Game, played: &Played) -> Picture {
    let mut picture = Picture::new(&game.scene.world);
    picture.title(format!("A count of {} by radio", played.arrivals.len()));
    picture.caption(format!(
        "{:.0} ms for a message, {:.0} % of what was sent lost, {} repeated",
        1e3 * played.interval(),
        100.0 * args.loss,
        played.repeats
    ));
    let robots = game.scene.robots.len();
    let place = |robot: usize| game.scene.robots[robot].pose.position();
    for pair in (0..robots * robots).map(|index| [index / robots, index % robots]) {
        let used = played.arrivals.windows(2).filter(|way| [way[0].1, way[1].1] == pair).count();
        if used > 0 {
            let width = 6.0 * used as f64 * robots as f64 / played.arrivals.len() as f64;
            let style = Style::new(SERIES[pair[0] % SERIES.len()]).width(width.clamp(0.5, 6.0)).opacity(0.6);
            picture.line(pair.map(place), style);
        }
    }
    for (robot, stay) in game.stays.iter().enumerate() {
        picture.robot_with(game.scene.robots[robot].pose, &game.scene.robots[robot].spec.footprint, pale());
        let heard = played.arrivals.iter().filter(|arrival| arrival.1 == robot).count();
        let until = stay.to.map_or(String::new(), |to| format!(" to {to:.0} s"));
        let from = if stay.from > 0.0 { format!(", from {:.0} s{until}", stay.from) } else { String::new() };
        picture.text(game.beside(robot), format!("{}: {heard}{from}", robot + 1));
    }
    picture
}
