use roverlab::drive::marine::PoolSearchOutcome;
use roverlab::geometry::{Aabb, Point, Pose, units};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::{Colour, Scene, World};

use super::Args;
use super::campaign::campaign;
use super::hunt::{DEPTH, Hunt, hunt};
use super::scene::scene;
use crate::common::{Failure, Outcome, Report, millimetres, point_in_mm, rounded};
use crate::driving::{Conditions, paced};
use crate::water::{Site, afloat, ground, limit, surveyor};

/// The work of the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.trials.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let scene = afloat((common, &args.waters), &surveyor(), || scene(common.seed))?;
    let limit = limit(&Site::of(&scene.world, DEPTH), 1.0);
    let light = args.light.unwrap_or(1.0);
    let conditions = Conditions { light, ..Conditions::new(common, limit)? };
    let done = hunt(&scene, &conditions, paced(common))?;
    let report = done
        .run
        .report(|outcome| match outcome {
            PoolSearchOutcome::Found if done.is_false() => Outcome::failure("false_find"),
            PoolSearchOutcome::Found => Outcome::verdict("found"),
            PoolSearchOutcome::NotFound => Outcome::verdict("not_found"),
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
    if let Some(place) = done.place {
        above.mark(Mark::Goal, place);
    }
    let mut both = Picture::panels(&[above, side(scene, done)], 2);
    both.title("Search of a pool's floor");
    let error = done
        .error
        .map_or("nothing was found".into(), |error| format!("found {:.0} mm off", units::to_mm(error)));
    both.caption(format!(
        "{error}, after {:.0} s; turbidity {} per metre",
        done.run.sim_time, scene.world.water.turbidity
    ));
    both
}

/// The way along y and up, above the floor under the middle of the pool.
fn side(scene: &Scene, done: &Hunt) -> Picture {
    let area: Aabb = scene.world.bounds();
    let (length, level) = (area.size().y, scene.world.water_level.unwrap_or_default());
    // Heights are shown three times as large.
    let at = |y: f64, z: f64| Point::new(y - area.min.y, 0.2 + 3.0 * z);
    let mut side = Picture::new(&World::empty(length, 0.6 + 3.0 * level));
    side.title("From the side, heights times three");
    side.without_scale();
    let line = |z: f64| [at(area.min.y, z), at(area.max.y, z)];
    side.line(line(level), Style::new(Colour::from_hex(0x70_c0_d8)).labelled("surface"));
    let middle = area.min.x + 0.5 * area.size().x;
    let floor = |share: f64| {
        let place = Point::new(middle, area.min.y + share * length);
        at(place.y, ground(&scene.world).and_then(|ground| ground.height(place)).unwrap_or(0.0))
    };
    side.line(
        (0..=200).map(|step| floor(f64::from(step) / 200.0)),
        Style::new(Colour::from_hex(0x60_50_40)).labelled("floor"),
    );
    side.true_path(done.run.in_space.iter().map(|space| at(space.pose.position.y, space.pose.position.z)));
    if let Some(place) = done.place {
        side.mark(Mark::Goal, floor((place.y - area.min.y) / length));
    }
    if let Some(last) = done.run.in_space.last() {
        let end = at(last.pose.position.y, last.pose.position.z);
        side.robot(Pose::new(end.x, end.y, 0.0), &scene.robots[0].spec.footprint);
    }
    side
}
