//! One drive under the referee.

use roverlab::drive::lane_keeping::LaneOutcome;
use roverlab::drive::traffic::{
    CarFront, EvasionScore, ObstacleEvasion, TrafficActors, TrafficDriver, TrafficParameters,
};
use roverlab::geometry::Pose;
use roverlab::io;
use roverlab::io::control::{run, until};
use roverlab::io::log::GroundTruth;
use roverlab::io::sim::RobotTruth;
use roverlab::vision::lane_markings::{RoadCamera, RoadModel};
use roverlab::world::RobotSpec;
use roverlab::world::road::{RoadCourse, Traffic};

use super::Args;
use super::setting::Setting;
use crate::common::{Failure, Stage, StageTruth};
use crate::driving::{check_lasted, paced};

/// Duration of the event, by the rules (s).
const SECONDS: f64 = 300.0;

/// Result of a drive.
#[derive(Debug, Clone)]
pub(super) struct Drive {
    pub(super) score: EvasionScore,
    /// Points that can be earned.
    pub(super) possible: f64,
    pub(super) truth: RobotTruth,
    pub(super) ending: Result<(), String>,
    /// Path of the car: time, pose and speed.
    pub(super) trail: Vec<(f64, Pose, f64)>,
    /// Paths of the boxes: times and poses where they moved.
    pub(super) boxes: Vec<Vec<(f64, Pose)>>,
}

/// Drives on a course until its laps or its time are over.
pub(super) fn drive(args: &Args, setting: &Setting, stage: &Stage) -> Result<Drive, Failure> {
    let spec = RobotSpec::road_car();
    let camera = spec.camera.as_ref().map(RoadCamera::from);
    let camera = camera.ok_or_else(|| Failure::run("a car without a camera"))?;
    let seconds = args.common.time_limit.map_or(SECONDS, |limit| limit.min(SECONDS));
    let RoadCourse { size, line_width, traffic, .. } = setting.scene.course;
    let road = RoadModel { size, line_width, left_hand: traffic == Traffic::Left };
    let mut driver =
        TrafficDriver::new(camera, road, TrafficParameters::default()).map_err(Failure::input)?;
    let mut car = stage.robot(0)?;
    let actors = TrafficActors::new(setting.scene.clone());
    let mut watch = Watch {
        stage,
        truth: stage.truth(0)?,
        referee: ObstacleEvasion::new(setting.scene.clone(), &spec, args.laps),
        trail: Vec::new(),
        boxes: (0..setting.scene.boxes.len())
            .map(|index| actors.pose(index).map(|pose| (0.0, pose)).into_iter().collect())
            .collect(),
        actors,
        pace: Box::new(paced(&args.common)),
    };
    let driven = run(&mut car, &mut driver, seconds, |_, _, _| {
        let is_over = watch.look()?;
        Ok::<_, io::Error>(until(is_over))
    });
    let lasted = match driven {
        Ok(LaneOutcome::TimedOut) => check_lasted(watch.truth.time()?, seconds),
        Ok(LaneOutcome::Stopped) => Ok(()),
        Err(error) => Err(Failure::from(error).to_string()),
    };
    drop(car);
    Ok(Drive {
        score: watch.referee.score().clone(),
        possible: watch.referee.possible(),
        truth: watch.truth.robot(0)?,
        ending: lasted,
        trail: watch.trail,
        boxes: watch.boxes,
    })
}

/// The observers: the referee, and what moves on the course.
struct Watch<'c> {
    stage: &'c Stage,
    truth: StageTruth,
    referee: ObstacleEvasion,
    actors: TrafficActors,
    trail: Vec<(f64, Pose, f64)>,
    boxes: Vec<Vec<(f64, Pose)>>,
    pace: Box<dyn FnMut(f64) + 'c>,
}

impl Watch<'_> {
    /// Observes the car, and moves the boxes. Returns whether the run is over.
    fn look(&mut self) -> io::Result<bool> {
        let (time, pose) = (self.truth.time()?, self.truth.pose(0)?);
        let speed = self.trail.last().map_or(0.0, |(before, last, _)| {
            let passed = time - before;
            if passed > 0.0 { pose.distance_to(last.position()) / passed } else { 0.0 }
        });
        self.trail.push((time, pose, speed));
        (self.pace)(time);
        let car = CarFront { along: self.referee.front(), speed };
        for (index, place) in self.actors.advance(time, car) {
            self.boxes[index].push((time, place));
            self.stage.move_object(0, index, place)?;
        }
        Ok(self.referee.see(time, &pose, speed, &self.actors))
    }
}
