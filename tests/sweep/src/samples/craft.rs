//! Robots, and what drives them through water and over hills.

use std::f64::consts::PI;

use crate::Sample;
use crate::sample::{samples, varied};
use roverlab::drive::marine::{
    DepthHold, DepthHoldParameters, PoolSearch, PoolSearchParameters, PoolWall, PoolWallParameters, Survey,
    SurveyParameters,
};
use roverlab::drive::terrain::SlopeSensor;
use roverlab::geometry::{Aabb, Point, Pose};
use roverlab::io::Clock;
use roverlab::io::sim::starman::{BodyPlan, LimbPlan, Starman, StarmanSpec};
use roverlab::kinematics::marine::{Craft, CraftSpec};
use roverlab::nav::{RampCrossing, SummitParameters, SummitSearch};
use roverlab::world::{HeightField, PsdSpec, RobotSpec};

varied! {
    CraftSpec => varied [CraftSpec::mako(), CraftSpec::solar_raft()];
    RobotSpec => varied [
        RobotSpec::s4(), RobotSpec::mako(), RobotSpec::race_car(), RobotSpec::omni(),
        SlopeSensor::equip(RobotSpec::blizzard())
    ];
    BodyPlan => varied [BodyPlan { limbs: vec![LimbPlan::default(); 2], ..BodyPlan::default() }];
}

/// A hill in the middle of a square.
fn hill(samples: usize, side: f64, height: f64) -> Option<HeightField> {
    let area = Aabb::new(Point::origin(), Point::new(side, side));
    let middle = Point::new(0.5 * side, 0.5 * side);
    let shape = |at: Point| height * (1.0 - (at - middle).norm() / side);
    HeightField::from_fn(samples, samples, area, shape).ok()
}

/// A rectangle from the origin to a corner.
fn pool(x: f64, y: f64) -> Aabb {
    Aabb::new(Point::origin(), Point::new(x, y))
}

fn survey(start: Pose, area: Aabb, parameters: SurveyParameters) -> Option<Survey> {
    Survey::new(&RobotSpec::mako(), start, area, true, parameters).ok()
}

fn search(robot: &RobotSpec, area: Aabb, survey: SurveyParameters) -> Option<PoolSearch> {
    let parameters = PoolSearchParameters { survey, ..PoolSearchParameters::nth(0)? };
    PoolSearch::new(robot, Pose::new(1.0, 1.0, 0.0), area, false, parameters).ok()
}

fn wall(robot: &RobotSpec, parameters: PoolWallParameters) -> Option<PoolWall> {
    PoolWall::new(robot, parameters).ok()
}

/// A craft whose distance sensors are somewhere else.
fn mako_with_sensors(change: impl Fn(&mut PsdSpec)) -> RobotSpec {
    let mut robot = RobotSpec::mako();
    robot.psds.iter_mut().for_each(change);
    robot
}

/// A figure that has stood, or fallen, for a while.
fn after(seconds: f64, figure: roverlab::io::Result<Starman>) -> Option<Starman> {
    let mut figure = figure.ok()?;
    let _ = figure.wait(seconds);
    Some(figure)
}

fn star(spec: StarmanSpec) -> Option<Starman> {
    after(0.05, Starman::new(&spec))
}

fn body(limbs: Vec<LimbPlan>, mass: f64) -> Option<Starman> {
    after(0.05, Starman::of(&BodyPlan { limbs, mass, ..BodyPlan::default() }))
}

/// Limbs, each at the tip of the one before.
fn chain(count: usize, limb: LimbPlan) -> Vec<LimbPlan> {
    let next = |index: usize| LimbPlan {
        parent: index.checked_sub(1),
        hinge: if index == 0 { limb.hinge } else { [limb.length, 0.0] },
        ..limb
    };
    (0..count).map(next).collect()
}

samples! {
    HeightField => [hill(41, 2.0, 0.2)?, hill(2, 1e6, 1e6)?, hill(3, 1e-9, -1e6)?, hill(2, 1.0, 0.0)?];
    Craft => [Craft::new(&CraftSpec::mako(), 0.01).ok()?];
    DepthHold => [DepthHold::new(&Craft::nth(0)?, 0.5, DepthHoldParameters::default()).ok()?];
    SummitSearch => [SummitSearch::new(SummitParameters::of(&RobotSpec::blizzard())?).ok()?];
    RampCrossing => [RampCrossing::new(SummitParameters::of(&RobotSpec::blizzard())?).ok()?];
    SlopeSensor => [
        SlopeSensor::psds(&SlopeSensor::equip(RobotSpec::blizzard()))?, SlopeSensor::lidar(&RobotSpec::s4())?,
        SlopeSensor::psds(&SlopeSensor::equip(RobotSpec { height: f64::NAN, ..RobotSpec::s4() }))?,
        SlopeSensor::psds(&SlopeSensor::equip(RobotSpec { height: 1e300, ..RobotSpec::s4() }))?
    ];
    Survey => [
        survey(Pose::new(1.0, 1.0, 0.0), pool(10.0, 5.0), SurveyParameters::default())?,
        survey(Pose::new(1e9, f64::NAN, -1e9), pool(10.0, 5.0), SurveyParameters::default())?,
        survey(Pose::new(1e300, -1e300, 1e300), pool(10.0, 5.0), SurveyParameters::default())?,
        survey(Pose::default(), pool(1e300, 1e300), SurveyParameters::default())?,
        survey(Pose::default(), pool(f64::INFINITY, f64::NAN), SurveyParameters::default())?,
        survey(
            Pose::default(), pool(1e6, 1e-3),
            SurveyParameters { margin: 0.0, brim: 0.0, ..Default::default() }
        )?,
        survey(Pose::default(), pool(50.0, 50.0), SurveyParameters { spacing: 1e-9, ..Default::default() })?,
        survey(Pose::default(), pool(50.0, 50.0), SurveyParameters { spacing: 1e300, ..Default::default() })?,
        survey(Pose::default(), pool(50.0, 50.0), SurveyParameters { margin: 1e300, ..Default::default() })?,
        survey(
            Pose::default(), pool(50.0, 50.0),
            SurveyParameters { altitude: Some(1e300), speed: 1e300, ..Default::default() }
        )?,
        survey(
            Pose::default(), pool(50.0, 50.0),
            SurveyParameters { period: 1e-300, density: 1e300, ..Default::default() }
        )?
    ];
    PoolSearch => [
        search(&RobotSpec::mako(), pool(10.0, 5.0), SurveyParameters::default())?,
        search(&RobotSpec::mako(), pool(1e300, 5.0), SurveyParameters::default())?,
        search(&RobotSpec::mako(), pool(1e3, 1e3), SurveyParameters { spacing: 1e-3, ..Default::default() })?,
        search(&mako_with_sensors(|psd| psd.mount.x = 1e300), pool(10.0, 5.0), SurveyParameters::default())?,
        search(
            &mako_with_sensors(|psd| psd.max_range = f64::NAN), pool(10.0, 5.0), SurveyParameters::default()
        )?
    ];
    PoolWall => [
        wall(&RobotSpec::mako(), PoolWallParameters::default())?,
        wall(&RobotSpec::mako(), PoolWallParameters { laps: u32::MAX, speed: 1e300, ..Default::default() })?,
        wall(
            &RobotSpec::mako(),
            PoolWallParameters { period: 1e300, distance: 1e300, depth: 1e300, ..Default::default() }
        )?,
        wall(
            &RobotSpec::mako(),
            PoolWallParameters { lookahead: 1e-300, distance: 1e-300, ..Default::default() }
        )?,
        wall(&mako_with_sensors(|psd| psd.mount.y = f64::NAN), PoolWallParameters::default())?
    ];
    Starman => [
        star(StarmanSpec::book())?,
        body(chain(2, LimbPlan::default()), 0.2)?,
        body(chain(24, LimbPlan::default()), 0.2)?,
        body(chain(1, LimbPlan { hinge: [1e3, -1e3], ..LimbPlan::default() }), 0.2)?,
        body(chain(3, LimbPlan { mass: 1e300, ..LimbPlan::default() }), 1e-300)?,
        body(chain(3, LimbPlan { length: 1e300, ..LimbPlan::default() }), 0.2)?,
        body(chain(3, LimbPlan { rest: PI, radius: 1e300, ..LimbPlan::default() }), 0.2)?,
        star(StarmanSpec { servo_speed: 1e300, servo_torque: 1e300, ..StarmanSpec::book() })?,
        star(StarmanSpec { time_step: 1e-300, ..StarmanSpec::book() })?,
        star(StarmanSpec { time_step: 1e-5, ..StarmanSpec::book() })?,
        star(StarmanSpec {
            body_radius: 1e-300, limb_radius: 1e-300, limb_length: 1e-300, ..StarmanSpec::book()
        })?,
        star(StarmanSpec { body_mass: 1e300, limb_mass: 1e-300, friction: 1e300, ..StarmanSpec::book() })?
    ];
}
