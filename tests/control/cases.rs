//! Every behaviour of the library, on a robot that it drives.

use roverlab::drive::colour::{ColourTracker, ColourTrackerParameters, PushHome, PushHomeParameters};
use roverlab::drive::end_to_end::{NetworkDriver, SteeringTeacher, TeacherParameters};
use roverlab::drive::lane_keeping::{BookLaneKeeper, BookLaneParameters, LaneKeeper, LaneKeeperParameters};
use roverlab::drive::marine::{
    Boat, BoatParameters, Dive, DiveParameters, PoolSearch, PoolSearchParameters, PoolWall,
    PoolWallParameters, Survey, SurveyParameters,
};
use roverlab::drive::motion_watch::{
    MotionApproach, MotionApproachParameters, MotionWatch, MotionWatchParameters,
};
use roverlab::drive::parking::{ParkingDriver, ParkingKind, ParkingParameters};
use roverlab::drive::terrain::{Ascent, AscentParameters, SlopeSensor};
use roverlab::drive::traffic::{
    RadioCar, RoadSharingParameters, RoadStation, RoadStationParameters, TrafficDriver, TrafficParameters,
};
use roverlab::drive::{
    AToB, AToBParameters, AlongWall, CarDriver, CarToB, CarToBParameters, Chase, ChaseParameters, FirstSteps,
    FirstStepsParameters, FirstTask, Goal, LidarWallFollower, LidarWallFollowerParameters, Method,
    OmniDriver, OmniParameters, OmniTracker, PidWallFollower, PidWallFollowerParameters, RadioRing,
    RadioRingParameters, RandomDrive, RandomDriveParameters, Tour, TourParameters, TwoLevelWallFollower,
    WallFollower, WallFollowerParameters,
};
use roverlab::evolve::Gait;
use roverlab::geometry::{Aabb, Point, Pose};
use roverlab::io::control::{Command, Senses, run, until};
use roverlab::io::sim::SimRobot;
use roverlab::io::wrappers::Faulty;
use roverlab::io::{Error, ErrorKind, Odometry, Result};
use roverlab::kinematics::marine::CraftSpec;
use roverlab::kinematics::{Ackermann, OdometryErrors, Omni};
use roverlab::maze::{
    CellDriveParameters, Direction, LeftHand, LeftHandParameters, LidarLeft, LidarLeftParameters, Rig, Scale,
};
use roverlab::nav::{
    BugKind, BugParameters, DistBug, Navigator, NavigatorParameters, RampCrossing, SummitParameters,
    SummitSearch,
};
use roverlab::race::{EventParameters, EventRacer, GapDriver, Racer, RacerParameters};
use roverlab::random::Stream;
use roverlab::vision::lane_markings::RoadModel;
use roverlab::vision::network::Network;
use roverlab::vision::{CameraGeometry, ColourFinder, FindMethod};
use roverlab::world::{RobotSpec, World};

pub(super) type Robot = Faulty<SimRobot>;

/// A behaviour: its name, its robot, and a run within a limit that is stopped at a time. None of them is done
/// in 5 s.
pub(super) type Case = (&'static str, fn() -> RobotSpec, fn(&mut Robot, f64, f64) -> Result<String>);

const GOAL: Point = Point::new(3.0, 2.0);
pub(super) const START: Pose = Pose::new(3.0, 3.0, 0.3);
const CORRIDOR: f64 = 0.36;

fn driven<B>(robot: &mut Robot, behaviour: &mut B, limit: f64, stop: f64) -> Result<String>
where
    B: Senses<Robot> + ?Sized,
    B::Command: Command<Robot>,
    B::Outcome: std::fmt::Debug,
{
    let outcome = run(robot, behaviour, limit, |_, _, step| until(step.time >= stop))?;
    Ok(format!("{outcome:?}"))
}

/// A network that sees the image and steers straight on.
fn straight_on() -> Result<Network> {
    Ok(Network::new("16x40x1 dense1".parse()?, vec![(vec![0.0; 640], vec![0.0])])?)
}

pub(super) const CASES: &[Case] = &[
    ("lane", RobotSpec::s4, |robot, limit, stop| {
        let camera = RobotSpec::s4().camera.as_ref().unwrap().into();
        let mut behaviour = LaneKeeper::new(camera, RoadModel::default(), LaneKeeperParameters::default())?;
        driven(robot, &mut behaviour, limit, stop)
    }),
    ("the book's lane", RobotSpec::s4, |robot, limit, stop| {
        let mut behaviour = BookLaneKeeper::new(BookLaneParameters::default())
            .map_err(|error| Error::new(ErrorKind::Other, error.to_string()))?;
        driven(robot, &mut behaviour, limit, stop)
    }),
    ("a network", RobotSpec::s4, |robot, limit, stop| {
        driven(robot, &mut NetworkDriver::new(straight_on()?, 0.2)?, limit, stop)
    }),
    ("a teacher of steering", RobotSpec::s4, |robot, limit, stop| {
        let camera = RobotSpec::s4().camera.as_ref().unwrap().into();
        let keeper = LaneKeeper::new(camera, RoadModel::default(), LaneKeeperParameters::default())?;
        let parameters = TeacherParameters { speed: 0.2, ..TeacherParameters::default() };
        let size = straight_on()?.architecture().input();
        driven(robot, &mut SteeringTeacher::new(keeper, size, parameters)?, limit, stop)
    }),
    ("traffic", RobotSpec::s4, |robot, limit, stop| {
        let camera = RobotSpec::s4().camera.as_ref().unwrap().into();
        let mut behaviour = TrafficDriver::new(camera, RoadModel::default(), TrafficParameters::default())?;
        driven(robot, &mut behaviour, limit, stop)
    }),
    ("radio car", RobotSpec::s4, |robot, limit, stop| {
        let camera = RobotSpec::s4().camera.as_ref().unwrap().into();
        let parameters = (TrafficParameters::default(), RoadSharingParameters::default());
        let mut behaviour = RadioCar::new(camera, RoadModel::default(), parameters, Pose::default())?;
        driven(robot, &mut behaviour, limit, stop)
    }),
    ("base station", RobotSpec::s4, |robot, limit, stop| {
        driven(robot, &mut RoadStation::new(RoadStationParameters::default())?, limit, stop)
    }),
    ("parking", RobotSpec::s4, |robot, limit, stop| {
        let camera = RobotSpec::s4().camera.as_ref().unwrap().into();
        let (kind, parameters) = (ParkingKind::Parallel, ParkingParameters::default());
        driven(robot, &mut ParkingDriver::new(camera, RoadModel::default(), kind, parameters)?, limit, stop)
    }),
    ("turn", RobotSpec::s4, |robot, limit, stop| a_to_b(Method::Turn, robot, limit, stop)),
    ("spline", RobotSpec::s4, |robot, limit, stop| a_to_b(Method::Spline, robot, limit, stop)),
    ("by another estimate", RobotSpec::s4, |robot, limit, stop| {
        let mut behaviour = AToB::new(Method::Dog, Goal::point(GOAL), AToBParameters::default())?;
        driven(robot, &mut behaviour.by(Robot::pose), limit, stop)
    }),
    ("chase", RobotSpec::s4, |robot, limit, stop| {
        let mut behaviour = Chase::new(Method::Dog, ChaseParameters::default())?;
        let goal = |_: &mut Robot, time| Ok(Pose::new(1.0 + time, 0.0, 0.0));
        driven(robot, &mut behaviour.after(goal), limit, stop)
    }),
    ("car", RobotSpec::car, |robot, limit, stop| {
        let driver = CarDriver::new(Ackermann::new(0.12, 0.1, 0.5).unwrap(), 0.5).unwrap();
        let goal = Goal::point(Point::new(2.0, -2.0));
        let mut behaviour = CarToB::new(Method::Arc, goal, driver, CarToBParameters::default())?;
        driven(robot, &mut behaviour, limit, stop)
    }),
    ("Mecanum", RobotSpec::omni, |robot, limit, stop| {
        let driver = OmniDriver::new(Omni::mecanum(0.2, 0.2).unwrap(), 0.5).unwrap();
        let tracker = OmniTracker::new(Pose::default(), &[GOAL], OmniParameters::default())?;
        driven(robot, &mut tracker.by(driver), limit, stop)
    }),
    ("dive", RobotSpec::mako, |robot, limit, stop| {
        driven(robot, &mut Dive::new(&CraftSpec::mako(), DiveParameters::default())?, limit, stop)
    }),
    ("pool wall", RobotSpec::mako, |robot, limit, stop| {
        driven(robot, &mut PoolWall::new(&RobotSpec::mako(), PoolWallParameters::default())?, limit, stop)
    }),
    ("survey", RobotSpec::mako, |robot, limit, stop| {
        let area = Aabb::new(Point::origin(), Point::new(8.0, 8.0));
        let parameters = SurveyParameters::default();
        driven(robot, &mut Survey::new(&RobotSpec::mako(), START, area, true, parameters)?, limit, stop)
    }),
    ("pool search", RobotSpec::mako, |robot, limit, stop| {
        let area = Aabb::new(Point::origin(), Point::new(8.0, 8.0));
        let parameters = PoolSearchParameters::default();
        driven(robot, &mut PoolSearch::new(&RobotSpec::mako(), START, area, true, parameters)?, limit, stop)
    }),
    ("boat", RobotSpec::solar_raft, |robot, limit, stop| {
        let course = [Point::new(9.0, 3.0)];
        let mut boat = Boat::new(&CraftSpec::solar_raft(), START, &course, BoatParameters::default())?;
        driven(robot, &mut boat, limit, stop)
    }),
    ("tour", RobotSpec::s4, |robot, limit, stop| {
        let corners = [START.position(), Point::new(5.0, 5.0), Point::new(1.0, 5.0)];
        driven(robot, &mut Tour::new(&corners, TourParameters::default())?, limit, stop)
    }),
    ("wall", RobotSpec::s4, |robot, limit, stop| {
        let follower = WallFollower::new(WallFollowerParameters::default())?;
        driven(robot, &mut AlongWall::new(follower), limit, stop)
    }),
    ("wall by PID", RobotSpec::s4, |robot, limit, stop| {
        let follower = PidWallFollower::new(PidWallFollowerParameters::default())?;
        driven(robot, &mut AlongWall::new(follower), limit, stop)
    }),
    ("wall by lidar", RobotSpec::s4, |robot, limit, stop| {
        let follower = LidarWallFollower::new(LidarWallFollowerParameters::default())?;
        driven(robot, &mut AlongWall::new(follower), limit, stop)
    }),
    ("wall as printed", RobotSpec::s4, |robot, limit, stop| {
        driven(robot, &mut AlongWall::new(TwoLevelWallFollower::default()), limit, stop)
    }),
    ("random", RobotSpec::s4, |robot, limit, stop| {
        let mut behaviour = RandomDrive::new(RandomDriveParameters::default(), Stream::new(1))?;
        driven(robot, &mut behaviour, limit, stop)
    }),
    ("first steps", RobotSpec::s4, |robot, limit, stop| {
        let mut behaviour = FirstSteps::new(FirstTask::Wall, FirstStepsParameters::default())?;
        driven(robot, &mut behaviour, limit, stop)
    }),
    ("radio ring", RobotSpec::s4, |robot, limit, stop| {
        let mut behaviour = RadioRing::new(true, RadioRingParameters::default())?;
        driven(robot, &mut behaviour, limit, stop)
    }),
    ("left hand", RobotSpec::s4, |robot, limit, stop| {
        let mut rule = LeftHand::new(LeftHandParameters::as_printed(), Direction::North)?;
        driven(robot, &mut rule, limit, stop)
    }),
    ("left hand, controlled", RobotSpec::s4, |robot, limit, stop| {
        let drive = CellDriveParameters::pid(&rig(&RobotSpec::s4())?, Scale::DOUBLED, 0.18);
        let mut rule = LeftHand::new(LeftHandParameters::controlled(drive), Direction::North)?;
        driven(robot, &mut rule, limit, stop)
    }),
    ("left by lidar", RobotSpec::s4, |robot, limit, stop| {
        let mut follower = LidarLeft::new(LidarLeftParameters::for_corridor(CORRIDOR))?;
        driven(robot, &mut follower, limit, stop)
    }),
    ("bug", RobotSpec::s4, |robot, limit, stop| {
        let mut bug = BugKind::Bug2.with(GOAL, BugParameters::default())?;
        driven(robot, bug.as_mut(), limit, stop)
    }),
    ("DistBug", RobotSpec::s4, |robot, limit, stop| {
        driven(robot, &mut DistBug::new(GOAL, BugParameters::default())?, limit, stop)
    }),
    ("navigate", RobotSpec::s4, |robot, limit, stop| {
        let goal = Point::new(5.5, 5.5);
        let mut navigator = Navigator::new(&room(), START, goal, NavigatorParameters::default())?;
        driven(robot, &mut navigator, limit, stop)
    }),
    ("summit", RobotSpec::blizzard, |robot, limit, stop| {
        let parameters = SummitParameters::of(&RobotSpec::blizzard()).unwrap();
        driven(robot, &mut SummitSearch::new(parameters)?, limit, stop)
    }),
    ("ramp", RobotSpec::blizzard, |robot, limit, stop| {
        let parameters = RampCrossing::parameters(&RobotSpec::blizzard()).unwrap();
        driven(robot, &mut RampCrossing::new(parameters)?, limit, stop)
    }),
    ("ascent", RobotSpec::blizzard, |robot, limit, stop| {
        let spec = RobotSpec::blizzard();
        let mut ascent = Ascent::new(SlopeSensor::lidar(&spec).unwrap(), AscentParameters::of(&spec))?;
        driven(robot, &mut ascent, limit, stop)
    }),
    ("colour", RobotSpec::s4, |robot, limit, stop| {
        let mut tracker = ColourTracker::new(finder(), ColourTrackerParameters::default())?;
        driven(robot, &mut tracker, limit, stop)
    }),
    ("home", RobotSpec::s4, |robot, limit, stop| {
        let mut push = PushHome::new(finder(), Point::origin(), PushHomeParameters::default())?;
        driven(robot, &mut push, limit, stop)
    }),
    ("motion", RobotSpec::s4, |robot, limit, stop| {
        driven(robot, &mut MotionWatch::new(MotionWatchParameters::new(1.0)).unwrap(), limit, stop)
    }),
    ("motion approach", RobotSpec::s4, |robot, limit, stop| {
        let camera = CameraGeometry::from(RobotSpec::s4().camera.as_ref().unwrap());
        let mut approach = MotionApproach::new(MotionApproachParameters::new(camera)).unwrap();
        driven(robot, &mut approach, limit, stop)
    }),
    ("gait", RobotSpec::s4, |robot, limit, stop| {
        let gait = Gait::from_bytes(&[30, 128, 200, 40, 128, 90], 2, 1)?;
        driven(robot, &mut gait.walking(), limit, stop)
    }),
    ("gap", RobotSpec::car, |robot, limit, stop| driven(robot, &mut GapDriver::default(), limit, stop)),
    ("racer", RobotSpec::s4, |robot, limit, stop| {
        driven(robot, &mut Racer::new(RacerParameters::default())?, limit, stop)
    }),
    ("event", RobotSpec::s4, |robot, limit, stop| {
        let parameters = EventParameters { patience: [99.0; 2], ..EventParameters::default() };
        driven(robot, &mut EventRacer::acceleration(parameters)?, limit, stop)
    }),
];

fn a_to_b(method: Method, robot: &mut Robot, limit: f64, stop: f64) -> Result<String> {
    let mut behaviour = AToB::new(method, Goal::point(GOAL), AToBParameters::default())?;
    driven(robot, &mut behaviour, limit, stop)
}

fn finder() -> ColourFinder {
    let camera = RobotSpec::s4().camera.unwrap();
    ColourFinder::new(42, 10, FindMethod::Blob, CameraGeometry::from(&camera)).unwrap()
}

pub(super) fn rig(spec: &RobotSpec) -> Result<Rig> {
    let errors = OdometryErrors { wheel_scale: 0.0, wheel_mismatch: 0.0, track: 0.0, slip: 0.0 };
    Rig::new(spec, errors, 0.01)
}

pub(super) fn room() -> World {
    World::walled(6.0, 6.0)
}
