use roverlab::drive::marine::{PoolWall, PoolWallOutcome, PoolWallParameters};
use roverlab::io::control;
use roverlab::world::Scene;

use crate::common::{Failure, portable};
use crate::driving::{Conditions, Run};
use crate::water::Shore;

/// What came of a drive along the sides of a pool.
#[derive(Debug, Clone)]
pub(crate) struct Round {
    pub(crate) run: Run<(PoolWallOutcome, u32)>,
    pub(crate) errors: Errors,
}

/// How far from where it should be the craft was, away from corners.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Errors {
    pub(crate) squares: f64,
    pub(crate) count: u64,
    pub(crate) largest: f64,
    /// Of the depth.
    pub(crate) depth_squares: f64,
}

portable!(struct Errors { squares, count, largest, depth_squares });

/// Metres around the nearest side in which a corner counts, and seconds after one that do.
const CORNER: f64 = 1.2;
const AFTER: f64 = 5.0;
/// Metres from the wanted distance at which the first lap begins.
const BEGINS: f64 = 0.05;

impl Errors {
    pub(crate) fn rms(&self) -> Option<f64> {
        (self.count > 0).then(|| (self.squares / self.count as f64).sqrt())
    }

    pub(crate) fn depth_rms(&self) -> Option<f64> {
        (self.count > 0).then(|| (self.depth_squares / self.count as f64).sqrt())
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.squares += other.squares;
        self.count += other.count;
        self.largest = self.largest.max(other.largest);
        self.depth_squares += other.depth_squares;
    }
}

/// Follows the sides of a scene's pool.
pub(crate) fn round(
    scene: &Scene,
    parameters: PoolWallParameters,
    conditions: &Conditions,
    watch: impl FnMut(f64),
) -> Result<Round, Failure> {
    let spec = &scene.robots[0].spec;
    let mut drive = PoolWall::new(spec, parameters).map_err(Failure::input)?;
    let run = conditions.run(scene, watch, |robot, step| {
        let outcome = control::run(robot, &mut drive, conditions.time_limit, |_, _, _| step())?;
        Ok((outcome, drive.laps()))
    })?;
    let errors = errors(scene, &parameters, &run);
    Ok(Round { run, errors })
}

fn errors<T>(scene: &Scene, parameters: &PoolWallParameters, run: &Run<T>) -> Errors {
    let spec = &scene.robots[0].spec;
    let level = scene.world.water_level.unwrap_or_default();
    let shore = Shore::of(&scene.world, level - parameters.depth);
    let half_width = spec.psds.iter().map(|psd| psd.mount.y).fold(0.0, f64::max);
    let up = spec.depth_sensor.map_or(0.0, |sensor| sensor.z);
    let (mut errors, mut begun, mut corner) = (Errors::default(), false, f64::NEG_INFINITY);
    for ((time, pose), space) in run.trail.iter().skip(1).zip(&run.in_space) {
        let Some(distance) = shore.distance(pose.position()) else { break };
        let error = distance - half_width - parameters.distance;
        // Coming to the side is a corner too.
        let comes = !begun && error.abs() < BEGINS;
        begun |= comes;
        if comes || shore.is_corner(pose.position(), CORNER) {
            corner = *time;
        }
        if begun && time - corner > AFTER {
            let depth = level - space.pose.position.z - up;
            errors.squares += error * error;
            errors.count += 1;
            errors.largest = errors.largest.max(error.abs());
            errors.depth_squares += (depth - parameters.depth) * (depth - parameters.depth);
        }
    }
    errors
}
