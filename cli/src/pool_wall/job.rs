use roverlab::drive::marine::{PoolWallOutcome, PoolWallParameters};
use roverlab::geometry::units;
use roverlab::picture::Picture;
use roverlab::random::Stream;
use roverlab::world::Scene;
use roverlab::world::generate::{PoolKind, pool};

use super::Args;
use super::campaign::campaign;
use super::round::{Round, round};
use crate::common::{Failure, Outcome, Report, millimetres};
use crate::driving::{Conditions, paced};
use crate::water::{Shore, Side, afloat, surveyor};

/// Seconds for a metre of the sides, and besides for the way to the wall.
const PACE: f64 = 5.0;
const BESIDES: f64 = 100.0;

/// Seconds for laps round a scene's pool.
pub(super) fn limit(scene: &Scene, parameters: &PoolWallParameters) -> f64 {
    let level = scene.world.water_level.unwrap_or_default();
    let around = Shore::of(&scene.world, level - parameters.depth).length();
    f64::from(parameters.laps) * PACE * around + BESIDES
}

/// The pool of a seed.
pub(super) fn generated(seed: u64) -> Result<Scene, Failure> {
    let made = pool(&mut Stream::new(seed), kind(seed)).map_err(Failure::run)?;
    Ok(Scene::with_robot(made.world, surveyor(), made.start))
}

pub(super) fn kind(seed: u64) -> PoolKind {
    PoolKind::ALL[(seed % PoolKind::ALL.len() as u64) as usize]
}

/// The work of the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.trials.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let own = generated(common.seed)?;
    let scene = afloat((common, &args.waters), &surveyor(), || own)?;
    let parameters =
        PoolWallParameters { laps: args.laps, depth: args.depth, ..PoolWallParameters::default() };
    let conditions = Conditions::new(common, limit(&scene, &parameters))?;
    let done = round(&scene, parameters, &conditions, paced(common))?;
    let Round { run, errors } = &done;
    let laps = run.ending.as_ref().ok().map(|ended| ended.1);
    let report = run
        .report(|ended| match ended.0 {
            PoolWallOutcome::Round => Outcome::verdict("round"),
            _ => Outcome::failure("timed_out"),
        })
        .field("rms_error_mm", errors.rms().map(millimetres))
        .field("max_error_mm", errors.rms().map(|_| millimetres(errors.largest)))
        .field("laps", laps)
        .field("depth_rms_error_mm", errors.depth_rms().map(millimetres));
    Ok(common.draw(report, "pool_wall.svg", || picture(&scene, &done)))
}

fn picture(scene: &Scene, done: &Round) -> Picture {
    let Round { run, errors } = done;
    let mut above = Picture::new(&scene.world);
    above.title("From above");
    run.draw(&mut above, &scene.robots[0].spec);
    let mut both = Picture::panels(&[above, Side::of(scene, run).picture(scene)], 2);
    both.title("Along the sides of a pool");
    let rms = errors.rms().map_or("never beside a side".into(), |rms| {
        format!(
            "{:.0} mm off in the root mean square, {:.0} mm at most",
            units::to_mm(rms),
            units::to_mm(errors.largest)
        )
    });
    both.caption(format!("{:.1} m in {:.0} s, {rms}", run.truth.path_length, run.sim_time));
    both
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::water::{BOOK, pool};

    #[test]
    fn the_time_limit_follows_the_sides() {
        let limit = |size, laps| {
            let scene = Scene::new(pool(size, |_| 0.0));
            limit(&scene, &PoolWallParameters { laps, ..PoolWallParameters::default() })
        };
        // At 0.3 m/s, a lap of the book's pool takes 475 s.
        assert!((600.0..1000.0).contains(&limit(BOOK, 1)), "{}", limit(BOOK, 1));
        assert!(limit([6.0, 8.0], 1) < 300.0 && limit(BOOK, 3) > 3.0 * 475.0);
    }
}
