use roverlab::drive::WallOutcome;
use roverlab::geometry::units;
use roverlab::picture::{Picture, Style};
use roverlab::world::{Colour, Scene};

use super::drive::Walk;
use super::{Args, Watch};
use crate::driving::{Conditions, Run, pale};

/// Picture of a run: the room, the robot's path, and the position of its largest error.
pub(crate) fn of(
    args: &Args,
    scene: &Scene,
    run: &Run<Walk>,
    watch: &Watch,
    conditions: &Conditions,
) -> Picture {
    let outline = scene.robots[0].spec.footprint;
    let start = scene.robots[0].pose;
    let mut picture = Picture::new(&scene.world);
    let ending = match &run.ending {
        _ if run.truth.contacts > 0 => "collided",
        Ok(walk) if walk.outcome == WallOutcome::Stopped => "all the way round",
        Ok(walk) if walk.outcome == WallOutcome::Blocked => "blocked",
        Ok(_) => "timed out",
        Err(_) => "failed",
    };
    picture.title(format!("Wall following ({}): {ending}", args.controller.name()));
    let mm =
        |length: Option<f64>| length.map_or("-".into(), |length| format!("{:.1} mm", units::to_mm(length)));
    picture.caption(format!(
        "rms {}, worst {} away from corners; {:.0} s, noise {}, seed {}",
        mm(watch.away_from_corners.rms()),
        mm(watch.away_from_corners.rms().map(|_| watch.away_from_corners.worst)),
        run.sim_time,
        conditions.noise,
        conditions.seed
    ));
    picture.robot_with(start, &outline, pale());
    if let Some(worst) = watch.worst_place {
        let style = Style::new(Colour::from_hex(0xd0_20_20)).width(2.5).labelled("largest error");
        picture.disc(worst.position(), 0.05, style);
    }
    run.draw(&mut picture, &scene.robots[0].spec);
    picture
}
