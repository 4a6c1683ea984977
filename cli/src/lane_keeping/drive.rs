//! One drive under the referee.

use std::path::Path;

use image::RgbImage;
use roverlab::drive::end_to_end::NetworkDriver;
use roverlab::drive::lane_keeping::{
    BookLaneKeeper, BookLaneParameters, LaneKeeper, LaneKeeperParameters, LaneObservation, LaneOutcome,
};
use roverlab::drive::traffic::{FreeDrive, FreeDriveScore};
use roverlab::geometry::{Pose, Twist, math};
use roverlab::io::control::{Behaviour, Senses, run, until};
use roverlab::io::log::GroundTruth;
use roverlab::io::sim::RobotTruth;
use roverlab::io::{self, Camera, Clock, Drive as _};
use roverlab::vision::lane_markings::{RoadCamera, RoadModel};
use roverlab::vision::network::Network;
use roverlab::world::RobotSpec;
use roverlab::world::road::{RoadCourse, Traffic};

use super::course::Setting;
use super::rules;
use crate::common::{CommonArgs, Driven, Failure, Stage, StageTruth};
use crate::driving::{check_lasted, paced};

/// Result of a drive.
#[derive(Debug, Clone)]
pub(crate) struct Drive {
    pub(crate) score: FreeDriveScore,
    pub(super) truth: RobotTruth,
    pub(super) ending: Result<(), String>,
    /// Path of the car: time, pose and speed.
    pub(super) trail: Vec<(f64, Pose, f64)>,
    /// The last image, redder where the network looks.
    pub(crate) attention: Option<RgbImage>,
}

/// Who drives.
#[derive(Debug, Clone)]
pub(crate) enum Pilot {
    Ours,
    Book,
    Network(Box<Network>),
}

impl Pilot {
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Ours => "ours",
            Self::Book => "book",
            Self::Network(_) => "net",
        }
    }
}

/// What a car is to do.
#[derive(Debug, Clone)]
pub(crate) struct Plan<'a> {
    pub(crate) pilot: Pilot,
    /// Maximum speed (m/s); `None` for the pilot's own.
    pub(crate) speed: Option<f64>,
    pub(crate) minutes: f64,
    /// Where to draw what a network looks at.
    pub(crate) attention: Option<&'a Path>,
    pub(crate) common: &'a CommonArgs,
}

impl Plan<'_> {
    /// Whether the time limit comes before the end of the drive.
    pub(crate) fn is_cut(&self) -> bool {
        self.common.time_limit.is_some_and(|limit| limit < 60.0 * self.minutes)
    }
}

/// Speed of a network (m/s).
const NETWORK_SPEED: f64 = 1.0;

/// Lane keeper of a car for a course.
pub(crate) fn keeper(course: &RoadCourse, parameters: LaneKeeperParameters) -> Result<LaneKeeper, Failure> {
    let camera = RobotSpec::road_car().camera.as_ref().map(RoadCamera::from);
    let camera = camera.ok_or_else(|| Failure::run("a car without a camera"))?;
    let left_hand = course.traffic == Traffic::Left;
    let road = RoadModel { size: course.size, line_width: course.line_width, left_hand };
    LaneKeeper::new(camera, road, parameters).map_err(Failure::input)
}

/// Drives on a course.
pub(super) fn drive(plan: &Plan<'_>, setting: &Setting, stage: &Stage) -> Result<Drive, Failure> {
    let spec = RobotSpec::road_car();
    let (common, seconds) = (plan.common, 60.0 * plan.minutes);
    let seconds = common.time_limit.map_or(seconds, |limit| limit.min(seconds));
    let mut car = stage.robot(0)?;
    let mut watch = Watch {
        truth: stage.truth(0)?,
        referee: FreeDrive::new(setting.course.clone(), &spec, rules()).map_err(Failure::input)?,
        trail: Vec::new(),
        pace: Box::new(paced(common)),
    };
    let mut attention = None;
    let driven = match &plan.pilot {
        Pilot::Ours => {
            let defaults = LaneKeeperParameters::default();
            let parameters = LaneKeeperParameters { speed: plan.speed.unwrap_or(defaults.speed), ..defaults };
            let mut keeper = keeper(&setting.course, parameters)?;
            watch.keep(&mut car, &mut keeper, seconds, LaneKeeper::forget)
        }
        Pilot::Book => {
            let defaults = BookLaneParameters::default();
            let parameters = BookLaneParameters { speed: plan.speed.unwrap_or(defaults.speed), ..defaults };
            let mut keeper = BookLaneKeeper::new(parameters).map_err(Failure::input)?;
            watch.keep(&mut car, &mut keeper, seconds, |_| ())
        }
        Pilot::Network(network) => {
            let speed = plan.speed.unwrap_or(NETWORK_SPEED);
            let mut driver = NetworkDriver::new((**network).clone(), speed).map_err(Failure::input)?;
            let driven = watch.keep(&mut car, &mut driver, seconds, |_| ());
            if plan.attention.is_some() && driven.is_ok() {
                attention = Some(driver.looks_at(&car.image()?).map_err(Failure::run)?);
            }
            driven
        }
    };
    drop(car);
    Ok(Drive {
        score: *watch.referee.score(),
        truth: watch.truth.robot(0)?,
        ending: driven.map_err(|error| Failure::from(error).to_string()),
        trail: watch.trail,
        attention,
    })
}

/// The observers: the referee, and the operator of the remote control.
struct Watch<'c> {
    truth: StageTruth,
    referee: FreeDrive,
    trail: Vec<(f64, Pose, f64)>,
    pace: Box<dyn FnMut(f64) + 'c>,
}

/// Standstill before remote control begins, and before control is returned (s).
const STILL: f64 = 1.0;
/// Maximum speed under remote control (m/s).
const REMOTE: f64 = 0.3;
/// Control period of the remote control (s).
const PERIOD: f64 = 0.05;
/// Distance (m) and angle (rad) within which a car is back in its lane.
const BACK: (f64, f64) = (0.04, 0.1);

impl Watch<'_> {
    /// Runs a behaviour until the time is over, and returns the car to its lane if it strays.
    fn keep<B>(
        &mut self,
        car: &mut Driven,
        keeper: &mut B,
        seconds: f64,
        forget: impl Fn(&mut B),
    ) -> io::Result<()>
    where
        B: Behaviour<Observation = LaneObservation, Command = Twist, Outcome = LaneOutcome> + Senses<Driven>,
    {
        loop {
            let left = seconds - self.truth.time()?;
            if left <= 0.0 {
                return Ok(());
            }
            let outcome = run(car, keeper, left, |_, _, _| self.look().map(until))?;
            if outcome == LaneOutcome::TimedOut {
                return check_lasted(self.truth.time()?, seconds)
                    .map_err(|error| io::Error::new(io::ErrorKind::Other, error));
            }
            self.bring_back(car, seconds)?;
            forget(keeper);
        }
    }

    /// Observes the car. Returns whether it has to be taken over.
    fn look(&mut self) -> io::Result<bool> {
        let (time, pose) = (self.truth.time()?, self.truth.pose(0)?);
        let speed = self.trail.last().map_or(0.0, |(before, last, _)| {
            let passed = time - before;
            if passed > 0.0 { pose.distance_to(last.position()) / passed } else { 0.0 }
        });
        self.trail.push((time, pose, speed));
        (self.pace)(time);
        Ok(self.referee.see(time, &pose))
    }

    /// Returns a car to its lane by remote control. By the rules, it stands before and after.
    fn bring_back(&mut self, car: &mut Driven, seconds: f64) -> io::Result<()> {
        car.stop()?;
        self.wait(car, STILL)?;
        while self.truth.time()? < seconds {
            let lane = *self.referee.lane();
            if lane.offset.abs() < BACK.0 && lane.heading.abs() < BACK.1 {
                break;
            }
            let towards = (lane.offset / 0.3).clamp(-1.0, 1.0);
            let bend = lane.curvature - 4.0 * math::sin(lane.heading + 0.9 * towards);
            car.set_speed(Twist::new(REMOTE, REMOTE * bend.clamp(-2.0, 2.0)))?;
            self.wait(car, PERIOD)?;
        }
        car.stop()?;
        self.wait(car, STILL)?;
        self.referee.give_back();
        Ok(())
    }

    /// Waits while the referee observes.
    fn wait(&mut self, car: &mut Driven, seconds: f64) -> io::Result<()> {
        for _ in 0..(seconds / PERIOD).round() as u32 {
            car.wait(PERIOD)?;
            self.look()?;
        }
        Ok(())
    }
}
