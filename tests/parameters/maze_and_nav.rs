use roverlab::geometry::{Point, Pose};
use roverlab::kinematics::OdometryErrors;
use roverlab::maze::{
    CellDrive, CellDriveParameters, Direction, FastPlanner, LeftHand, LeftHandParameters, LidarLeft,
    LidarLeftParameters, Maze, MazeRunner, MazeRunnerParameters, Rig, RunLimits, Scale,
    TrajectoryTrackerParameters,
};
use roverlab::nav::elevation::{Climber, ElevationMap, ElevationPlanner, Objective};
use roverlab::nav::{BugParameters, DistBug, Navigator, NavigatorParameters, SummitParameters, SummitSearch};
use roverlab::scan::{
    LocalisationMap, Localiser, LocaliserParameters, LogOddsMap, LogOddsMapParameters,
    ScanFeaturesParameters, extract_features,
};
use roverlab::world::{RobotSpec, World};

use crate::check::{check, check_variant, ends, simulation};

const GOAL: Point = Point::new(2.0, 1.5);

fn rig() -> Rig {
    let errors = OdometryErrors { wheel_scale: 0.0, wheel_mismatch: 0.0, track: 0.0, slip: 0.0 };
    Rig::new(&RobotSpec::s4(), errors, 0.01).expect("a rig")
}

#[test]
fn mazes() {
    let left = LeftHandParameters::as_printed;
    check!(LeftHandParameters = left(), |p| ends(RobotSpec::s4(), LeftHand::new(p, Direction::North)?),
        { Positive: threshold, turn_rate, period; } but straight);
    check!(LidarLeftParameters = LidarLeftParameters::for_corridor(0.36),
        |p| ends(RobotSpec::s4(), LidarLeft::new(p)?),
        { Positive: speed, distance, front, turn_rate, period; Finite: angle_gain, distance_gain; });
    check!(CellDriveParameters = CellDriveParameters::pid(&rig(), Scale::DOUBLED, 0.18), |p| CellDrive::new(p)?,
        { Positive: cell, speed, aside, ahead, reading_error; Finite: wall, coast, sensors_ahead; } but steering);
    check!(RunLimits = RunLimits::EYEBOT, |p| FastPlanner::new(Scale::DOUBLED, p)?,
        { Bounded: speed, diagonal_speed, acceleration, lateral_acceleration, pivot_speed, angular_acceleration; });
    let runner = |parameters: MazeRunnerParameters| {
        let maze = Maze::unexplored(4, 4).expect("a maze");
        let mut robot = simulation(RobotSpec::s4()).robot(0)?;
        MazeRunner::new(&mut robot, rig(), maze, Scale::DOUBLED, parameters, 1.0).map(|_| ())
    };
    check!(MazeRunnerParameters = MazeRunnerParameters::EYEBOT, |p| runner(p)?, { Count: readings; }
        but exploring, racing, tracker);
    check!(TrajectoryTrackerParameters = TrajectoryTrackerParameters::EYEBOT,
        |p| runner(MazeRunnerParameters { tracker: p, ..MazeRunnerParameters::EYEBOT })?,
        { Positive: reach, heading, period; NotNegative: along; });
}

#[test]
fn hills() {
    let area = roverlab::geometry::Aabb::new(Point::origin(), Point::new(3.0, 3.0));
    let level = roverlab::world::HeightField::from_fn(31, 31, area, |_| 0.0).expect("a surface");
    check!(Climber = Climber::of(&RobotSpec::blizzard()), |p| ElevationMap::new(&level, &p)?,
        { Bounded: slope; NotNegative: step; Positive: radius; });
    let map = ElevationMap::new(&level, &Climber::of(&RobotSpec::blizzard())).expect("a map");
    let plans = |objective| ElevationPlanner::astar(&map, objective);
    check_variant!(Objective::Energy = Objective::Energy { resistance: 0.1 }, |p| plans(p)?, { Positive: resistance; });
    check_variant!(Objective::Time = Objective::Time { speed: 0.1, climb: 0.1 }, |p| plans(p)?, { Positive: speed, climb; });
    check!(SummitParameters = SummitParameters::of(&RobotSpec::blizzard()).expect("a lidar"),
        |p| SummitSearch::new(p)?,
        { Positive: speed, turn_rate, stride, tolerance, period; NotNegative: slide, half_track;
          Bounded: resolution, extent; Finite: lowest; } but climber, lidar, fence);
}

#[test]
fn navigation() {
    check!(BugParameters = BugParameters::default(), |p| ends(RobotSpec::s4(), DistBug::new(GOAL, p)?),
        { Positive: robot_radius, step, goal_tolerance, cruise_speed, follow_speed, lag, period, clearance;
          Bounded: least_clearance; } but side, match_scans);
    let world = World::walled(3.0, 2.0);
    check!(NavigatorParameters = NavigatorParameters::default(),
        |p| ends(RobotSpec::s4(), Navigator::new(&world, Pose::new(1.0, 1.0, 0.0), GOAL, p)?),
        { Positive: goal_tolerance, cruise_speed, turn_rate, period;
          Bounded: resolution, clearance, least_clearance; }
        but footprint, match_scans);
}

#[test]
fn scans() {
    let scan = roverlab::io::LidarScan { ranges: vec![1.0; 90], angle_increment: 0.05, ..Default::default() };
    check!(ScanFeaturesParameters = ScanFeaturesParameters::default(), |p| extract_features(&scan, &p)?,
        { NotNegative: range_error; Positive: least_wall, largest_object, corner_gap; } but least_points);
    for least_points in 0..3 {
        assert!(
            ScanFeaturesParameters { least_points, ..ScanFeaturesParameters::default() }.validate().is_err()
        );
    }
    check!(LocaliserParameters = LocaliserParameters::default(),
        |p| Localiser::new(LocalisationMap::new(&World::walled(2.0, 1.0))?, p)?,
        { NotNegative: range_error, odometry; Positive: radius, view, track;
          Bounded: least_probability; });
    check!(LogOddsMapParameters = LogOddsMapParameters::default(), |p| LogOddsMap::new(10, 10, 0.1, Pose::default(), p)?,
        { Bounded: hit, miss, most; });
}
