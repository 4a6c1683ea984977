use roverlab::drive::colour::{ColourTracker, ColourTrackerParameters, PushHome, PushHomeParameters};
use roverlab::drive::end_to_end::{SteeringTeacher, TeacherParameters};
use roverlab::drive::lane_keeping::{BookLaneKeeper, BookLaneParameters, LaneKeeper, LaneKeeperParameters};
use roverlab::drive::marine::{
    Boat, BoatParameters, DepthHoldParameters, Dive, DiveParameters, PoolSearch, PoolSearchParameters,
    PoolWall, PoolWallParameters, Survey, SurveyParameters,
};
use roverlab::drive::motion_watch::{
    MotionApproach, MotionApproachParameters, MotionWatch, MotionWatchParameters,
};
use roverlab::drive::parking::{ParkingDriver, ParkingKind, ParkingParameters};
use roverlab::drive::terrain::{Ascent, AscentParameters, SlopeSensor};
use roverlab::drive::traffic::{
    FreeDrive, FreeDriveRules, RoadSharing, RoadSharingParameters, RoadStation, RoadStationParameters,
    TrafficDriver, TrafficParameters,
};
use roverlab::drive::{
    AToB, AToBParameters, AlongWall, CarDriver, CarToB, CarToBParameters, Chase, ChaseParameters,
    CoverageMap, CoverageMapParameters, Cruise, CruiseParameters, FirstSteps, FirstStepsParameters,
    FirstTask, Follower, FollowerParameters, Formation, Goal, LidarWallFollower, LidarWallFollowerParameters,
    Method, OmniDriver, OmniParameters, OmniTracker, Path, PathFollower, PathFollowerParameters, Pid,
    PidParameters, PidWallFollower, PidWallFollowerParameters, RadioRing, RadioRingParameters, RandomDrive,
    RandomDriveParameters, Steering, Tour, TourParameters, TwoLevelWallFollower, WallFollower,
    WallFollowerParameters, WallSensors,
};
use roverlab::geometry::{Aabb, Point, Pose};
use roverlab::kinematics::marine::CraftSpec;
use roverlab::kinematics::{Ackermann, Omni};
use roverlab::random::Stream;
use roverlab::vision::lane_markings::{RoadCamera, RoadModel};
use roverlab::vision::motion::{FlowDetector, FlowParameters, MotionParameters};
use roverlab::vision::network::MapSize;
use roverlab::vision::{CameraGeometry, ColourFinder, FindMethod};
use roverlab::world::road::{RoadCourseOptions, generate};
use roverlab::world::{RobotSpec, World};

use crate::check::{check, check_variant, ends};

const GOAL: Point = Point::new(2.0, 1.5);

fn finder() -> ColourFinder {
    let camera = RobotSpec::s4().camera.expect("a camera");
    ColourFinder::new(42, 10, FindMethod::Blob, CameraGeometry::from(&camera)).expect("a finder")
}

#[test]
fn colours_and_motion() {
    check!(ColourTrackerParameters = ColourTrackerParameters::default(),
        |p| ends(RobotSpec::s4(), ColourTracker::new(finder(), p)?),
        { Positive: speed, turn_speed, radius, leg, period; NotNegative: margin, gap, memory; });
    let home = PushHomeParameters::default;
    check!(ColourTrackerParameters = home().tracker,
        |p| PushHome::new(finder(), GOAL, PushHomeParameters { tracker: p, ..home() })?,
        { Positive: speed, turn_speed, radius, leg, period; NotNegative: margin, gap, memory; });
    check!(PushHomeParameters = home(), |p| ends(RobotSpec::s4(), PushHome::new(finder(), GOAL, p)?),
        { Positive: round, push_speed, correction, near; NotNegative: clearance, foresight; } but tracker);
    let camera = CameraGeometry { field_of_view: 1.0, height: 0.06, ahead: 0.06 };
    check!(MotionApproachParameters = MotionApproachParameters::new(camera), |p| ends(RobotSpec::s4(), MotionApproach::new(p)?),
        { Positive: speed, turn_speed, period, reach, half_width; Bounded: apart; } but flow, patience);
    check!(FlowParameters = FlowParameters::new(camera), |p| { FlowDetector::new(p)?; },
        { CountUpTo: slack; NotNegative: overhang; } but camera, motion);
    check!(MotionWatchParameters = MotionWatchParameters::new(1.0), |p| ends(RobotSpec::s4(), MotionWatch::new(p)?),
        { Bounded: field_of_view; Positive: turn_speed, period; NotNegative: parallax, patience; }
        but standing, turning);
    check!(MotionParameters = MotionParameters::default(),
        |p| ends(RobotSpec::s4(), MotionWatch::new(MotionWatchParameters { turning: p, ..MotionWatchParameters::new(1.0) })?),
        { Bounded: block; NotNegative: threshold; Positive: least_noise; });
}

#[test]
fn first_steps() {
    for task in [FirstTask::Wall, FirstTask::Circle] {
        check!(FirstStepsParameters = FirstStepsParameters::default(), |p| ends(RobotSpec::s4(), FirstSteps::new(task, p)?),
            { NotNegative: gap; Positive: diameter, radius, speed, turn_rate, period; });
    }
    check!(RadioRingParameters = RadioRingParameters::default(), |p| ends(RobotSpec::s4(), RadioRing::new(true, p)?),
        { Count: tries; Positive: repetition, period; });
}

#[test]
fn hills() {
    let sensor = || SlopeSensor::lidar(&RobotSpec::blizzard()).expect("a lidar");
    check!(AscentParameters = AscentParameters::of(&RobotSpec::blizzard()), |p| Ascent::new(sensor(), p)?,
        { Bounded: slope, smoothing; Positive: speed, turn_rate, patience, gain, period; });
}

#[test]
fn from_a_to_b() {
    check!(PathFollowerParameters = PathFollowerParameters::default(), |p| {
            let path = Path::straight(Point::origin(), GOAL)?;
            let mut follower = PathFollower::new(path, p)?;
            let _ = follower.step(Pose::default());
        },
        { Positive: speed, turn_rate, deceleration, approach_rate, lag; } but steering);
    let follows = |steering| {
        PathFollower::new(
            Path::straight(Point::origin(), GOAL)?,
            PathFollowerParameters { steering, ..Default::default() },
        )
    };
    check_variant!(Steering::PurePursuit = Steering::PurePursuit { lookahead: 0.1 }, |p| follows(p)?, { Positive: lookahead; });
    check_variant!(Steering::CrossTrack = Steering::CrossTrack { reach: 0.1 }, |p| follows(p)?, { Positive: reach; });
    for full_speed in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
        let kinematics = Ackermann::new(0.12, 0.1, 0.5).unwrap();
        assert_eq!(CarDriver::new(kinematics, full_speed).unwrap_err().name(), "full speed", "{full_speed}");
        let kinematics = Omni::mecanum(0.2, 0.2).unwrap();
        assert_eq!(OmniDriver::new(kinematics, full_speed).unwrap_err().name(), "full speed", "{full_speed}");
    }
    check!(AToBParameters = AToBParameters::default(),
        |p| ends(RobotSpec::s4(), AToB::new(Method::Spline, Goal::point(GOAL), p)?),
        { Positive: turn_speed, creep_speed, tolerance, heading_tolerance, period; Bounded: spline_scale;
          AnyCount: corrections; } but follower);
    check!(ChaseParameters = ChaseParameters::default(), |p| Chase::new(Method::Dog, p)?.step(Pose::new(1.0, 0.5, 0.0))?,
        { Positive: distance, turn_threshold, period; Bounded: spline_scale; } but follower);
    let driver = CarDriver::new(Ackermann::new(0.12, 0.1, 0.5).unwrap(), 0.5).unwrap();
    check!(CarToBParameters = CarToBParameters::default(),
        |p| ends(RobotSpec::car(), CarToB::new(Method::Arc, Goal::point(GOAL), driver, p)?),
        { Positive: tolerance, heading_tolerance, steering_time, period, margin; Bounded: spline_scale;
          AnyCount: corrections; } but follower);
    check!(OmniParameters = OmniParameters::default(), |p| OmniTracker::new(Pose::default(), &[GOAL], p)?,
        { Positive: speed, acceleration, position_gain, heading_gain, lag, tolerance, heading_tolerance, period;
          Finite: spin; });
    check!(PidParameters = PidParameters::default(), |p| Pid::new(p)?.step(1.0, 0.0, 0.1)?,
        { Finite: proportional, integral, derivative; NotNegative: derivative_filter; } but limits);
    let limited = |limits| Pid::new(PidParameters { limits, ..PidParameters::default() });
    for limits in [[f64::NAN, 1.0], [-1.0, f64::NAN], [1.0, -1.0], [1.0, 1.0], [f64::INFINITY, f64::INFINITY]]
    {
        let error = limited(limits).unwrap_err().to_string();
        assert!(error.contains("output limits") && error.contains("expected"), "{limits:?}: {error}");
    }
    assert!(limited([f64::NEG_INFINITY, 1e300]).is_ok());
}

#[test]
fn floors_and_swarms() {
    check!(CoverageMapParameters = CoverageMapParameters::default(),
        |p| CoverageMap::new(&World::walled(1.0, 1.0), Point::new(0.5, 0.5), p)?,
        { Bounded: radius, margin, resolution; BoundedFromZero: overlap; });
    check!(TourParameters = TourParameters::default(), |p| ends(RobotSpec::s4(), Tour::new(&[Point::origin(), GOAL], p)?),
        { Positive: speed, turn_rate, arrival, reach, lag, period; });
    check!(CruiseParameters = CruiseParameters::default(),
        |p| Cruise::new(vec![GOAL], p)?.step(Pose::default(), &[Point::new(0.3, 0.0)])?,
        { Positive: speed, turn_rate, radius, margin, ahead, arrival; });
    check!(FollowerParameters = FollowerParameters::default(), |p| Follower::new(p)?,
        { Positive: speed, turn_rate, patience, period, gap; Bounded: radius, margin, leader_radius; });
    check!(Formation = Formation::at(Point::new(-0.3, 0.2)), |p| p.validate()?,
        { Positive: speed, turn_rate, margin; Bounded: radius; } but offset);
    check!(RandomDriveParameters = RandomDriveParameters::default(),
        |p| ends(RobotSpec::s4(), RandomDrive::new(p, Stream::new(1))?),
        { Positive: speed, turn_rate, safe, radius, margin, lag, period; });
}

#[test]
fn walls() {
    check!(WallFollowerParameters = WallFollowerParameters::default(),
        |p| ends(RobotSpec::s4(), AlongWall::new(WallFollower::new(p)?)),
        { Positive: speed, turn_rate, reach, lag, period; Bounded: distance, radius; BoundedFromZero: range_error; }
        but side, sensors);
    check!(PidWallFollowerParameters = PidWallFollowerParameters::default(),
        |p| ends(RobotSpec::s4(), AlongWall::new(PidWallFollower::new(p)?)),
        { Positive: distance, speed, turn_rate, period; } but side, gains, sensors);
    check!(LidarWallFollowerParameters = LidarWallFollowerParameters::default(),
        |p| ends(RobotSpec::s4(), AlongWall::new(LidarWallFollower::new(p)?)),
        { Positive: distance, speed, turn_rate, reach, lag, period; } but side);
    // A sensor that is nowhere, or that points elsewhere.
    let sensors = WallSensors::default;
    let nowhere = Pose::new(f64::NAN, 0.0, 0.0);
    for (sensors, name) in [
        (WallSensors { front: nowhere, ..sensors() }, "front PSD: x"),
        (WallSensors { left: Pose::new(0.0, 0.0, f64::NAN), ..sensors() }, "left PSD: direction"),
        (WallSensors { right: sensors().left, ..sensors() }, "right PSD: direction"),
    ] {
        assert_eq!(sensors.validate().unwrap_err().name(), name);
        let refused = [
            WallFollower::new(WallFollowerParameters { sensors, ..Default::default() }).map(|_| ()),
            PidWallFollower::new(PidWallFollowerParameters { sensors, ..Default::default() }).map(|_| ()),
        ];
        for answer in refused {
            assert!(answer.unwrap_err().to_string().contains(name));
        }
    }
    for (safe, speed) in [(f64::NAN, 0.2), (0.0, 0.2), (0.3, -1.0), (0.3, f64::INFINITY)] {
        assert!(TwoLevelWallFollower::new(safe, speed).is_err(), "{safe} {speed}");
    }
}

#[test]
fn lanes() {
    let camera = || RobotSpec::s4().camera.as_ref().expect("a camera").into();
    check!(LaneKeeperParameters = LaneKeeperParameters::default(),
        |p| LaneKeeper::new(camera(), RoadModel::default(), p)?,
        { Positive: period, speed, across, brake, sight; NotNegative: delay; } but settling);
    check!(BookLaneParameters = BookLaneParameters::default(),
        |p| BookLaneKeeper::new(p)?,
        { Positive: period, speed, gain; BoundedFromZero: horizon; });
    let teacher = |p| {
        let keeper = LaneKeeper::new(camera(), RoadModel::default(), LaneKeeperParameters::default())?;
        SteeringTeacher::new(keeper, MapSize { height: 8, width: 8, channels: 1 }, p)
    };
    check!(TeacherParameters = TeacherParameters::default(), |p| teacher(p)?,
        { Positive: speed, pause; NotNegative: duration, disturbance; } but seed);
    check!(TrafficParameters = TrafficParameters::default(),
        |p| TrafficDriver::new(camera(), RoadModel::default(), p)?,
        { Positive: brake, crosswalk; NotNegative: gap, following, clearance; } but lane, passing, halts, body);
    check!(RoadSharingParameters = RoadSharingParameters::default(), |p| RoadSharing::new(p)?,
        { Positive: interval, memory, brake; NotNegative: gap, clearance; } but body);
    check!(RoadStationParameters = RoadStationParameters::default(), |p| RoadStation::new(p)?,
        { Positive: period, memory; });
    check!(ParkingParameters = ParkingParameters::default(),
        |p| ParkingDriver::new(camera(), RoadModel::default(), ParkingKind::Parallel, p)?,
        { Positive: brake, clearance, curvature; } but speed, body, wheels);
    check!(RoadModel = RoadModel::default(), |p| LaneKeeper::new(camera(), p, LaneKeeperParameters::default())?,
        { Bounded: size, line_width; } but left_hand);
    check!(RoadCamera = camera(), |p| LaneKeeper::new(p, RoadModel::default(), LaneKeeperParameters::default())?,
        { Bounded: field_of_view; AroundZero: tilt; Positive: height; Finite: ahead; } but fisheye);
}

#[test]
fn roads() {
    check!(RoadCourseOptions = RoadCourseOptions::default(), |p| generate(1, &p)?,
        { Bounded: size, lane_width; NotNegative: longest_gap;
          BoundedFromZero: inner_radius, gaps, crossings, zebras, parking, artefacts; } but traffic);
    let course = generate(1, &RoadCourseOptions::default()).unwrap();
    check!(FreeDriveRules = FreeDriveRules::default(),
        |p| FreeDrive::new(course.clone(), &RobotSpec::road_car(), p)?,
        { NotNegative: penalty, intervention; Above: astray, standing; } but subtract_outside);
}

#[test]
fn diving() {
    let dive = |p: DiveParameters| Dive::new(&CraftSpec::mako(), p);
    check!(DiveParameters = DiveParameters::default(), |p| dive(p)?,
        { NotNegative: depth; Finite: heading; Positive: duration, turning, period; } but hold);
    check!(DepthHoldParameters = DepthHoldParameters::default(),
        |p| dive(DiveParameters { hold: p, ..DiveParameters::default() })?,
        { Positive: speed, approach, control, observer; });
    check!(PoolWallParameters = PoolWallParameters::default(), |p| PoolWall::new(&RobotSpec::mako(), p)?,
        { NotNegative: depth; Bounded: lookahead; Positive: distance, speed, period; } but side, laps, hold);
    let area = Aabb::new(Point::origin(), Point::new(25.0, 50.0));
    let start = Pose::new(2.0, 2.0, 0.0);
    check!(SurveyParameters = SurveyParameters::default(),
        |p| Survey::new(&RobotSpec::mako(), start, area, true, p)?,
        { BoundedFromZero: margin; NotNegative: depth; Positive: spacing, speed, density, period; } but altitude, brim, waves, hold);
    let search = |survey| PoolSearchParameters { survey, ..PoolSearchParameters::default() };
    check!(SurveyParameters = SurveyParameters::default(),
        |p| PoolSearch::new(&RobotSpec::mako(), start, area, true, search(p))?,
        { BoundedFromZero: margin; NotNegative: depth; Positive: spacing, speed, density, period; } but altitude, brim, waves, hold);
    check!(BoatParameters = BoatParameters::default(),
        |p| Boat::new(&CraftSpec::solar_raft(), start, &[Point::new(9.0, 9.0)], p)?,
        { NotNegative: station; Positive: speed, lookahead, reached, period; });
}
