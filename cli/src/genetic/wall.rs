use roverlab::drive::{AlongWall, PidParameters, PidWallFollower, PidWallFollowerParameters};
use roverlab::evolve::Trial;
use roverlab::geometry::{Pose, math};
use roverlab::io::control::run;
use roverlab::io::log::GroundTruth;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Clock, DistanceSensors, Drive, Odometry, Result, StallDetector};
use roverlab::picture::{Mark, Picture};
use roverlab::world::{RobotSpec, Scene, World};
use serde_json::{Map, Value, json};

use crate::common::{CommonArgs, Failure, rounded};
use crate::driving::Trail;

/// A wall to follow by a PID controller with unknown gains.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wall {
    noise: f64,
}

/// Size of the floor (m): a wall of a corridor's length, and room for errors.
const FLOOR: (f64, f64) = (6.0, 2.0);
/// Duration of a trial (s).
const SECONDS: f64 = 20.0;
/// Time in which the robot should reach its distance (s).
const SETTLING: f64 = 4.0;
/// Cost of a contact (m).
const CONTACT: f64 = 1.0;

impl Wall {
    pub(crate) const GENES: usize = 3;

    pub(crate) fn new(common: &CommonArgs) -> Self {
        Self { noise: common.noise }
    }

    fn parameters(genes: &[f64]) -> PidWallFollowerParameters {
        let base = PidWallFollowerParameters::default();
        let [proportional, integral, derivative] = gains(genes);
        PidWallFollowerParameters {
            gains: PidParameters { proportional, integral, derivative, ..base.gains },
            ..base
        }
    }

    /// Root mean square distance from the line (m).
    pub(crate) fn cost(self, genes: &[f64], trial: Trial) -> Result<f64> {
        let simulation = Simulation::new(&scene(), self.options(trial.random().bits()))?;
        let (mut robot, mut truth) = (simulation.robot(0)?, simulation.truth());
        Ok(drive(genes, &mut robot, &mut truth)?.0)
    }

    fn options(self, seed: u64) -> SimOptions {
        SimOptions::with_noise(self.noise, seed)
    }

    pub(crate) fn found(genes: &[f64]) -> Map<String, Value> {
        let [proportional, integral, derivative] = gains(genes).map(rounded);
        let fields = json!({ "proportional": proportional, "integral": integral, "derivative": derivative });
        fields.as_object().cloned().unwrap_or_default()
    }

    /// Drives with the best gains, recorded if requested, and draws the path.
    pub(crate) fn picture(self, common: &CommonArgs, best: &[f64]) -> std::result::Result<Picture, Failure> {
        let mut picture = Picture::new(&World::walled(FLOOR.0, FLOOR.1));
        let stage = common.stage(&scene(), self.options(common.seed))?;
        let (_, way) = drive(best, &mut stage.robot(0)?, &mut stage.truth(0)?)?;
        picture.title("a drive with the best gains");
        if let Some((_, start)) = way.first() {
            picture.mark(Mark::Start, start.position());
        }
        picture.drive(&way, &RobotSpec::s4().footprint);
        Ok(picture)
    }
}

fn scene() -> Scene {
    let start = Pose::new(0.5, FLOOR.1 - 0.35, 0.2);
    Scene::with_robot(World::walled(FLOOR.0, FLOOR.1), RobotSpec::s4(), start)
}

/// Drives along the wall; returns the cost and the path.
fn drive<R: Clock + DistanceSensors + Drive + Odometry + StallDetector>(
    genes: &[f64],
    robot: &mut R,
    truth: &mut impl GroundTruth,
) -> Result<(f64, Trail)> {
    let parameters = Wall::parameters(genes);
    let mut along = AlongWall::new(PidWallFollower::new(parameters)?);
    let (mut squares, mut count, mut way) = (0.0, 0.0, Vec::new());
    run(robot, &mut along, SECONDS, |_, _, step| {
        let pose = truth.pose(0)?;
        let error = FLOOR.1 - pose.y - parameters.distance;
        if step.time > SETTLING {
            squares += error * error;
            count += 1.0;
        }
        way.push((step.time, pose));
        Result::Ok(())
    })?;
    let contacts = truth.robot(0)?.contacts;
    Ok((math::hypot((squares / f64::max(count, 1.0)).sqrt(), CONTACT * f64::from(contacts)), way))
}

/// Gains encoded by the genes: 0 to 20, 0 to 4, 0 to 30.
fn gains(genes: &[f64]) -> [f64; 3] {
    [20.0 * genes[0], 4.0 * genes[1], 30.0 * genes[2]]
}
