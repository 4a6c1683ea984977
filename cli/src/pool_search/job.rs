use roverlab::drive::marine::PoolSearchOutcome;
use roverlab::geometry::units;
use roverlab::picture::{Mark, Picture};
use roverlab::world::Scene;

use super::Args;
use super::campaign::campaign;
use super::hunt::{DEPTH, Hunt, hunt};
use super::scene::scene;
use crate::common::{Failure, Outcome, Report, millimetres, point_in_mm, rounded};
use crate::driving::{Conditions, paced};
use crate::water::{Side, Site, afloat, limit, surveyor};

/// The work of the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.trials.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let scene = afloat((common, &args.waters), &surveyor(), || scene(common.seed))?;
    let limit = limit(&Site::open(&scene, DEPTH)?, 1.0);
    let light = args.light.unwrap_or(1.0);
    let conditions = Conditions { light, ..Conditions::new(common, limit)? };
    let done = hunt(&scene, &conditions, paced(common))?;
    let report = done
        .run
        .report(|outcome| match outcome {
            PoolSearchOutcome::Found if done.is_false() => Outcome::failure("false_find"),
            PoolSearchOutcome::Found => Outcome::verdict("found"),
            PoolSearchOutcome::NotFound if done.is_there => Outcome::failure("not_found"),
            PoolSearchOutcome::NotFound => Outcome::verdict("not_found"),
            PoolSearchOutcome::Blind => Outcome::failure("blind"),
            _ => Outcome::failure("timed_out"),
        })
        .field("found", done.place.is_some())
        .field("position_error_mm", done.error.map(millimetres))
        .field("place_mm", done.place.map(point_in_mm))
        .field("turbidity", rounded(scene.world.water.turbidity))
        .field("light", rounded(light));
    Ok(common.draw(report, "pool_search.svg", || picture(&scene, &done)))
}

/// The way from above, and from the side.
fn picture(scene: &Scene, done: &Hunt) -> Picture {
    let mut above = Picture::new(&scene.world);
    above.title("From above");
    done.run.draw(&mut above, &scene.robots[0].spec);
    let side = Side::of(scene, &done.run);
    let mut below = side.picture(scene);
    if let Some(place) = done.place {
        above.mark(Mark::Goal, place);
        side.beside(place).into_iter().for_each(|place| {
            below.mark(Mark::Goal, place);
        });
    }
    let mut both = Picture::panels(&[above, below], 2);
    both.title("Search of a pool's floor");
    let find = match (done.place, done.error) {
        (None, _) => "nothing was found".into(),
        (_, None) => "found where nothing is red".into(),
        (_, Some(error)) => format!("found {:.0} mm off", units::to_mm(error)),
    };
    both.caption(format!(
        "{find}, after {:.0} s; turbidity {} per metre",
        done.run.sim_time, scene.world.water.turbidity
    ));
    both
}
