//! One manoeuvre, and where the car stands.

use roverlab::drive::parking::{ParkingDriver, ParkingLot, ParkingOutcome, ParkingParameters, parking_car};
use roverlab::geometry::Pose;
use roverlab::io;
use roverlab::io::control::run;
use roverlab::io::log::GroundTruth;
use roverlab::io::sim::RobotTruth;
use roverlab::vision::lane_markings::{RoadCamera, RoadModel};

use super::Args;
use crate::common::{Failure, Stage};
use crate::driving::{check_lasted, paced};

/// Longest time (s).
const SECONDS: f64 = 90.0;

/// Result of parking.
#[derive(Debug, Clone)]
pub(super) struct Drive {
    pub(super) ending: Result<ParkingOutcome, String>,
    pub(super) is_legal: bool,
    pub(super) is_touched: bool,
    pub(super) truth: RobotTruth,
    /// Path of the car.
    pub(super) trail: Vec<(f64, Pose)>,
}

/// Parks on a lot.
pub(super) fn drive(args: &Args, lot: &ParkingLot, stage: &Stage) -> Result<Drive, Failure> {
    let spec = parking_car();
    let camera = spec.camera.as_ref().map(RoadCamera::from);
    let camera = camera.ok_or_else(|| Failure::run("a car without a camera"))?;
    let seconds = args.common.time_limit.unwrap_or(SECONDS);
    let parameters = ParkingParameters::default();
    let mut driver =
        ParkingDriver::new(camera, RoadModel::default(), lot.kind, parameters).map_err(Failure::input)?;
    let (mut car, mut truth) = (stage.robot(0)?, stage.truth(0)?);
    let (mut trail, mut is_touched) = (Vec::new(), false);
    let mut pace = paced(&args.common);
    let driven = run(&mut car, &mut driver, seconds, |_, _, _| {
        let (time, pose) = (truth.time()?, truth.pose(0)?);
        is_touched |= lot.is_touched(&spec, &pose);
        trail.push((time, pose));
        pace(time);
        Ok::<_, io::Error>(())
    });
    let ending = match driven {
        Ok(ParkingOutcome::TimedOut) => {
            check_lasted(truth.time()?, seconds).map(|()| ParkingOutcome::TimedOut)
        }
        Ok(outcome) => Ok(outcome),
        Err(error) => Err(Failure::from(error).to_string()),
    };
    drop(car);
    let truth = truth.robot(0)?;
    let is_legal = matches!(ending, Ok(ParkingOutcome::Parked)) && lot.is_parked(&spec, &truth.pose);
    Ok(Drive { ending, is_legal, is_touched: is_touched || truth.contacts > 0, truth, trail })
}
