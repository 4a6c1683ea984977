//! Driving to goals, along paths and over a whole floor; kinematics, controllers and landmarks.

use roverlab::drive::end_to_end::NetworkDriver;
use roverlab::drive::lane_keeping::{BookLaneKeeper, BookLaneParameters, LaneKeeper, LaneKeeperParameters};
use roverlab::drive::parking::{ParkingDriver, ParkingKind, ParkingLot, ParkingParameters};
use roverlab::drive::traffic::{
    BoxMotion, CarFront, FreeDrive, FreeDriveRules, ObstacleEvasion, RoadBox, TrafficActors, TrafficDriver,
    TrafficParameters, TrafficScene,
};
use roverlab::drive::{
    AToB, AToBParameters, CarDriver, CarToB, CarToBParameters, Chase, ChaseParameters, CoverageMap,
    CoverageMapParameters, CoveragePlan, FirstSteps, FirstStepsParameters, FirstTask, Goal, Method,
    OmniDriver, OmniParameters, OmniTracker, Path, PathFollower, PathFollowerParameters, Pid, PidParameters,
    RandomDrive, RandomDriveParameters, RelayTuner, Steering, Tour, TourParameters, Waypoint,
};
use roverlab::geometry::{Point, Pose, Twist};
use roverlab::io::control::run;
use roverlab::io::sim::Simulation;
use roverlab::io::{Clock, Drive, Lidar, LidarScan, Odometry, Result};
use roverlab::kinematics::{
    Ackermann, CarState, Differential, Displacement, OdometryErrors, OdometryUncertainty, Omni, PlanarTwist,
    WheelSpeeds, advance, advance_planar,
};
use roverlab::random::Stream;
use roverlab::scan::{Landmark, LandmarkFilter};
use roverlab::vision::lane_markings::RoadModel;
use roverlab::vision::network::{Architecture, FixedNetwork, Network};
use roverlab::world::road::{Appearance, RoadCourse, RoadCourseOptions, generate};
use roverlab::world::{DriveSpec, ObjectKind, RobotSpec, Scene, Shape, World};

use super::{Robot, Scenario, in_room, noise, note, note_truth, other, ride, room};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("kinematics", kinematics),
    Scenario::new("paths", paths),
    Scenario::new("controllers", controllers),
    Scenario::new("a-to-b", a_to_b),
    Scenario::new("chase", chase),
    Scenario::new("ackermann", ackermann),
    Scenario::new("mecanum", mecanum),
    Scenario::new("random-drive", random_drive),
    Scenario::new("coverage", coverage),
    Scenario::new("landmarks", landmarks),
    Scenario::new("lane-keeping", lane_keeping),
    Scenario::new("lane-keeping-book", lane_keeping_book),
    Scenario::new("end-to-end", end_to_end),
    Scenario::new("traffic", traffic),
    Scenario::new("parking", parking),
    Scenario::new("first-steps", first_steps),
];

const METHODS: [Method; 4] = [Method::Turn, Method::Arc, Method::Dog, Method::Spline];

/// Each drive's forward and inverse kinematics, and what their odometry comes to.
fn kinematics() -> Result<String> {
    let mut log = String::new();
    let two = Differential { track: 0.09 };
    let car = Ackermann::new(0.2, 0.15, 0.5).map_err(other)?;
    let mecanum = Omni::mecanum(0.2, 0.25).map_err(other)?;
    let three = [Omni::three_wheels(0.1), Omni::three_mecanum_wheels(0.1)];
    let errors = OdometryErrors { wheel_scale: 0.01, wheel_mismatch: 0.004, track: 0.02, slip: 0.003 };
    let mut uncertainty = OdometryUncertainty::new(Pose::default(), two, errors);
    let (mut pose, mut slid) = (Pose::default(), Pose::default());
    for (linear, left, angular) in [(0.3, 0.1, 0.7), (-0.2, 0.0, 1e-9), (0.0, -0.3, -2.5), (0.4, 0.05, 9.0)] {
        let twist = Twist::new(linear, angular);
        let wheels = two.inverse(twist);
        note(&mut log, "wheels", &(wheels, two.inverse_limited(twist, 0.3), two.forward(wheels)));
        let rolled = two.displacement(0.1 * wheels.left, 0.1 * wheels.right);
        uncertainty.advance(rolled);
        note(&mut log, "odometry", &(uncertainty.pose(), uncertainty.covariance()));
        let state = car.inverse_limited(twist, 0.25);
        note(&mut log, "car", &(car.inverse(twist), state, car.forward(state), car.wheels(state)));
        note(&mut log, "steering", &(car.wheel_angles(0.3 * angular), car.displacement(linear, 0.2)));
        let planar = PlanarTwist::new(linear, left, angular);
        note(&mut log, "mecanum", &(mecanum.inverse(planar), mecanum.inverse_limited(planar, 0.2)));
        note(&mut log, "rolled", &mecanum.displacement(mecanum.inverse(planar)));
        for drive in three.iter().flatten() {
            note(&mut log, "three wheels", &drive.inverse(planar));
        }
        pose = advance(pose, Displacement { length: linear, angle: angular });
        slid = advance_planar(slid, planar.during(0.7));
        note(&mut log, "poses", &(pose, slid));
    }
    note(&mut log, "forward", &two.forward(WheelSpeeds { left: 0.1, right: 0.3 }));
    note(&mut log, "turning circle", &(car.turning_radius(), car.steering_for(2.0), car.curvature(0.3)));
    Ok(log)
}

/// Each kind of path, and an ideal robot that follows it from beside its beginning, forwards and in reverse.
fn paths() -> Result<String> {
    let goal = Pose::new(1.0, 0.6, 2.0);
    let points = [(0.0, 0.0), (0.5, 0.3), (0.9, -0.1), (1.4, 0.2)];
    let waypoints = points.map(|(x, y)| Waypoint { position: Point::new(x, y), heading: None });
    let mut log = String::new();
    for path in [
        Path::straight(Point::origin(), goal.position())?,
        Path::arc(Pose::default(), goal.position())?,
        Path::hermite(Pose::default(), goal, 1.5)?,
        Path::through(&waypoints)?,
        Path::of_arcs(Pose::default(), &[(0.4, 1.0), (0.3, -2.0), (0.2, 0.0)])?,
        Path::dubins(Pose::default(), goal, 0.25)?,
        Path::dubins_to_point(Pose::default(), Point::new(-0.1, 0.2), 0.25)?,
    ] {
        let sampled: Vec<_> = (0..=10).map(|k| path.at(0.1 * f64::from(k) * path.length())).collect();
        note(&mut log, "path", &(path.length(), path.max_curvature(), path.sharpest_turn(), sampled));
        let cross_track = Steering::CrossTrack { reach: 0.1 };
        for (steering, is_reverse) in
            [(Steering::PurePursuit { lookahead: 0.12 }, false), (cross_track, false), (cross_track, true)]
        {
            let parameters = PathFollowerParameters { steering, ..PathFollowerParameters::default() };
            let mut follower = PathFollower::new(path.clone(), parameters)?;
            if is_reverse {
                follower = follower.reversed();
            }
            let mut pose = path.start().compose(&Pose::new(0.0, 0.03, 0.2));
            for step in 0..200 {
                let twist = follower.step(pose);
                pose =
                    advance(pose, Displacement { length: 0.05 * twist.linear, angle: 0.05 * twist.angular });
                if step % 5 == 0 {
                    let errors = (follower.cross_track_error(), follower.heading_error(), follower.rest());
                    note(&mut log, "step", &(twist, pose, errors));
                }
            }
        }
    }
    Ok(log)
}

/// A PID controller on a slow process, with the gains that a relay experiment finds for it.
fn controllers() -> Result<String> {
    const STEP: f64 = 0.01;
    let mut log = String::new();
    let mut lags = [0.0_f64; 3];
    let mut respond = |output: f64| {
        let inputs = [output, lags[0], lags[1]];
        lags.iter_mut().zip(inputs).for_each(|(lag, input)| *lag += STEP / 0.2 * (input - *lag));
        lags[2]
    };
    let mut tuner = RelayTuner::new(1.0, 0.01)?;
    let mut process = 0.0;
    let gain = loop {
        process = respond(tuner.step(0.3 - process, STEP)?);
        if let Some(result) = tuner.result() {
            break result;
        }
    };
    let tuned = [gain.ziegler_nichols(), gain.tyreus_luyben()];
    note(&mut log, "gains", &(gain, tuned));
    for gains in tuned {
        let gains = PidParameters { derivative_filter: 0.05, limits: [-1.0, 2.0], ..gains };
        let mut pid = Pid::new(gains)?;
        for step in 0..400 {
            let output = pid.step(0.8, process, STEP)?;
            process = respond(output);
            if step % 10 == 0 {
                note(&mut log, "response", &(output, process, pid.integral()));
            }
        }
    }
    Ok(log)
}

fn a_to_b() -> Result<String> {
    let scene = Scene::with_robot(World::empty(3.0, 3.0), RobotSpec::s4(), Pose::new(1.0, 1.0, 0.4));
    let goals = [Goal::pose(Pose::new(0.7, 0.4, -0.5)), Goal::point(Point::new(-0.3, 0.5))];
    let mut log = String::new();
    for (method, goal) in METHODS.into_iter().flat_map(|method| goals.map(|goal| (method, goal))) {
        let mut behaviour = AToB::new(method, goal, AToBParameters::default())?;
        if method == Method::Spline {
            behaviour = behaviour.via(vec![Point::new(0.3, -0.1)])?;
        }
        let mut verdict = String::new();
        log += &ride(&scene, noise(1.0, 21), |robot| {
            let plan = behaviour.plan(Pose::default())?;
            note(&mut verdict, "plan", &plan.map(|path| (path.length(), path.end(), path.max_curvature())));
            let outcome = run(robot, &mut behaviour, 30.0, |_, _, _| {})?;
            note(&mut verdict, "outcome", &(method, outcome));
            Ok(())
        })?;
        log += &verdict;
    }
    Ok(log)
}

/// A goal that drives away on an arc.
fn chase() -> Result<String> {
    let scene = Scene::with_robot(World::empty(4.0, 4.0), RobotSpec::s4(), Pose::new(1.0, 1.0, 0.0));
    let quarry = |time: f64| {
        advance(Pose::new(0.5, 0.4, 0.3), Displacement { length: 0.08 * time, angle: 0.1 * time })
    };
    let mut log = String::new();
    for method in METHODS {
        let mut outcome = None;
        log += &ride(&scene, noise(1.0, 22), |robot| {
            let mut behaviour = Chase::new(method, ChaseParameters::default())?;
            outcome = Some(run(
                robot,
                &mut behaviour.after(|_: &mut Robot, time| Ok(quarry(time))),
                12.0,
                |_, _, _| {},
            )?);
            Ok(())
        })?;
        note(&mut log, "outcome", &(method, outcome));
    }
    Ok(log)
}

/// A car by every method, within its turning circle.
fn ackermann() -> Result<String> {
    let scene = Scene::with_robot(World::empty(5.0, 5.0), RobotSpec::car(), Pose::new(1.5, 1.5, 0.0));
    let DriveSpec::Ackermann { wheel_diameter, track, wheelbase, max_steering, max_wheel_speed, .. } =
        scene.robots[0].spec.drive
    else {
        unreachable!("a car has Ackermann steering")
    };
    let kinematics = Ackermann::new(wheelbase, track, max_steering).map_err(other)?;
    let driver = CarDriver::new(kinematics, 0.5 * wheel_diameter * max_wheel_speed)?;
    let goal = Goal::pose(Pose::new(1.2, 0.9, 1.4));
    let mut log = String::new();
    note(&mut log, "command", &driver.command(CarState { speed: 0.2, steering: -0.1 }));
    for method in METHODS {
        let mut behaviour = CarToB::new(method, goal, driver, CarToBParameters::default())?;
        let mut outcome = None;
        log += &ride(&scene, noise(1.0, 23), |robot| {
            outcome = Some(run(robot, &mut behaviour, 25.0, |_, _, _| {})?);
            Ok(())
        })?;
        note(&mut log, "outcome", &(method, outcome));
    }
    Ok(log)
}

/// A square without turning, and a straight line while spinning, on Mecanum wheels.
fn mecanum() -> Result<String> {
    let scene = Scene::with_robot(World::empty(2.0, 2.0), RobotSpec::omni(), Pose::new(0.5, 0.5, 0.2));
    let DriveSpec::Omni { wheel_diameter, track, wheelbase, max_wheel_speed, .. } =
        scene.robots[0].spec.drive
    else {
        unreachable!("the robot has Mecanum wheels")
    };
    let kinematics = Omni::mecanum(track, wheelbase).map_err(other)?;
    let driver = OmniDriver::new(kinematics, 0.5 * wheel_diameter * max_wheel_speed)?;
    let square = [(0.4, 0.0), (0.4, 0.4), (0.0, 0.4), (0.0, 0.0)].map(|(x, y)| Point::new(x, y));
    let mut log = String::new();
    for (route, spin) in [(&square[..], 0.0), (&square[1..2], 1.5)] {
        let parameters = OmniParameters { spin, ..OmniParameters::default() };
        log += &ride(&scene, noise(1.0, 24), |robot| {
            let tracker = OmniTracker::new(robot.pose()?, route, parameters)?;
            run(robot, &mut tracker.by(driver), 60.0, |_, _, _| {}).map(|_| ())
        })?;
    }
    Ok(log)
}

fn random_drive() -> Result<String> {
    let mut turns = 0;
    let mut log = ride(&in_room(0.5, 0.5, 0.3), noise(1.0, 25), |robot| {
        let mut behaviour = RandomDrive::new(RandomDriveParameters::default(), Stream::new(25))?;
        run(robot, &mut behaviour, 40.0, |_, _, _| {})?;
        turns = behaviour.turns();
        Ok(())
    })?;
    note(&mut log, "turns", &turns);
    Ok(log)
}

/// The plan over a floor, the first part of the tour, and what it covers.
fn coverage() -> Result<String> {
    let (world, start) = (room(), Pose::new(0.3, 0.3, 0.0));
    let mut map = CoverageMap::new(&world, start.position(), CoverageMapParameters::default())?;
    let plan = CoveragePlan::new(&map, start.position())?;
    let mut tour = Tour::new(plan.points(), TourParameters::default())?;
    let mut log = ride(&Scene::with_robot(world, RobotSpec::s4(), start), noise(0.0, 26), |robot| {
        for _ in 0..500 {
            let place = start.compose(&robot.pose()?);
            map.cover(place.position());
            let Some(twist) = tour.step(place) else { break };
            robot.set_speed(twist)?;
            robot.wait(0.05)?;
        }
        Ok(())
    })?;
    note(&mut log, "plan", &(plan.length(), plan.share(), plan.points()));
    note(&mut log, "covered", &(map.share(), map.area(), tour.progress()));
    plan.points().windows(2).for_each(|ends| map.cover_line(ends[0], ends[1], 0.01));
    note(&mut log, "covered by the plan", &(map.share(), map.cells(false).collect::<Vec<_>>()));
    Ok(log)
}

/// A robot that corrects its odometry by the cans that its lidar sees.
fn landmarks() -> Result<String> {
    let scene = in_room(0.5, 0.5, 0.3);
    let can = ObjectKind::predefined("can").expect("the kind is predefined");
    let Shape::Cylinder { radius, .. } = can.shape else { unreachable!("a can is round") };
    let start = scene.robots[0].pose;
    let seen = scene.world.objects.iter().filter(|object| object.kind.name == "can");
    let landmarks: Vec<_> =
        seen.map(|object| Landmark { position: object.pose.position(), radius }).collect();
    let errors = OdometryErrors { wheel_scale: 0.01, wheel_mismatch: 0.01, track: 0.02, slip: 0.002 };
    let drive = Differential { track: 0.09 };
    let mut filter = LandmarkFilter::new(start, Pose::default(), landmarks, drive, errors, 0.005)?;
    let mut verdict = String::new();
    let log = ride(&scene, noise(2.0, 27), |robot| {
        let mut scan = LidarScan::default();
        robot.set_speed(Twist::new(0.1, 0.4))?;
        for _ in 0..40 {
            robot.wait(0.2)?;
            filter.predict(robot.pose()?);
            robot.scan_into(&mut scan)?;
            let used = filter.correct(&scan);
            note(&mut verdict, "filter", &(used, filter.pose(), filter.covariance()));
        }
        Ok(())
    })?;
    Ok(log + &verdict)
}

/// A short course with everything on it, and a car at its start.
fn on_the_road() -> Result<(RoadCourse, Scene)> {
    let options = RoadCourseOptions { zebras: 0.5, ..RoadCourseOptions::default() };
    let course = generate(5, &options).map_err(other)?;
    let look = Appearance { pixel: 0.004, wear: 0.2, glare: 2, seed: 5 };
    let world = course.world(&look).map_err(other)?;
    let scene = Scene::with_robot(world, RobotSpec::road_car(), course.start());
    Ok((course, scene))
}

/// A car that keeps its lane by its camera, what it takes its lane for, and what the referee says.
fn lane_keeping() -> Result<String> {
    let (course, scene) = on_the_road()?;
    let camera = scene.robots[0].spec.camera.as_ref().expect("the car has a camera").into();
    let parameters = LaneKeeperParameters::default();
    let mut keeper = LaneKeeper::new(camera, RoadModel::default(), parameters)?;
    let mut referee = FreeDrive::new(course.clone(), &scene.robots[0].spec, FreeDriveRules::default())?;
    let mut seen = String::new();
    let mut log = ride(&scene, noise(1.0, 28), |robot| {
        run(robot, &mut keeper, 3.0, |_, keeper, step| {
            note(&mut seen, "lane", &keeper.lane());
            referee.see(step.time, &course.start().compose(&step.seen.odometry));
        })?;
        Ok(())
    })?;
    note(&mut log, "course", &roverlab::world::formats::course::print(&course));
    note(&mut log, "score", referee.score());
    Ok(log + &seen)
}

/// The book's pipeline on the same road.
fn lane_keeping_book() -> Result<String> {
    let (_, scene) = on_the_road()?;
    let mut keeper = BookLaneKeeper::new(BookLaneParameters::default()).map_err(other)?;
    ride(&scene, noise(1.0, 29), |robot| run(robot, &mut keeper, 2.0, |_, _, _| {}).map(drop))
}

/// A car that is steered by a network of random weights, which looks at every pixel, and the bits of its
/// results, in numbers of 32 bits and in integers.
fn end_to_end() -> Result<String> {
    let architecture: Architecture = "32x80x1 conv12/5/2 pool2 conv24/3/2 dense16 dense10".parse()?;
    let mut random = Stream::new(30).child("weights", 0);
    let mut layer = |(filters, taps): (usize, usize)| {
        let spread = (2.0 / taps as f64).sqrt();
        let weights = (0..filters * taps).map(|_| (spread * random.between(-1.0, 1.0)) as f32).collect();
        (weights, vec![0.01; filters])
    };
    let weights = architecture.filters().flatten().map(&mut layer).collect();
    let mut driver = NetworkDriver::new(Network::new(architecture, weights)?, 0.5)?;
    let mut seen = String::new();
    let mut log = ride(&on_the_road()?.1, noise(1.0, 30), |robot| {
        run(robot, &mut driver, 2.0, |_, driver, _| note(&mut seen, "curvature", &driver.curvature()))
            .map(drop)
    })?;
    let mut network = driver.network().clone();
    let last = network.map(0).to_vec();
    let mut fixed = FixedNetwork::new(&mut network, [last.as_slice()])?;
    note(&mut log, "results", &network.run(&last)?.iter().map(|result| result.to_bits()).collect::<Vec<_>>());
    note(&mut log, "whole", &fixed.run(&last)?.iter().map(|result| result.to_bits()).collect::<Vec<_>>());
    Ok(log + &seen)
}

/// A car in traffic: its states, the elements that it finds, and what the referee says. The first box stands
/// and the second one drives before the car.
fn traffic() -> Result<String> {
    let mut scene = TrafficScene { course: on_the_road()?.0, boxes: Vec::new() };
    for (along, motion) in [(1.6, BoxMotion::Static), (4.8, BoxMotion::Along(2.0))] {
        scene.boxes.push(RoadBox { along, left: 0.0, size: [0.2, 0.15, 0.18], motion });
    }
    let look = Appearance { pixel: 0.004, wear: 0.2, glare: 2, seed: 5 };
    let world = scene.scene(&look, RobotSpec::road_car()).map_err(other)?;
    let spec = &world.robots[0].spec;
    let camera = spec.camera.as_ref().expect("the car has a camera").into();
    let mut driver = TrafficDriver::new(camera, RoadModel::default(), TrafficParameters::default())?;
    let mut referee = ObstacleEvasion::new(scene.clone(), spec, 1);
    let mut actors = TrafficActors::new(scene.clone());
    let simulation = Simulation::new(&world, noise(1.0, 30))?;
    let (mut car, truth) = (simulation.robot(0)?, simulation.truth());
    let mut log = String::new();
    note(&mut log, "drawn", &TrafficScene::drawn(scene.course, 30).boxes);
    run(&mut car, &mut driver, 6.0, |_, driver, step| {
        let speed = step.seen.speed;
        for (index, pose) in actors.advance(step.time, CarFront { along: referee.front(), speed }) {
            truth.move_object(0, index, pose)?;
        }
        note(&mut log, "state", &(driver.state(), driver.elements().collect::<Vec<_>>()));
        referee.see(step.time, &truth.pose(0)?, speed, &actors);
        Ok::<_, roverlab::io::Error>(())
    })?;
    note(&mut log, "score", referee.score());
    note_truth(&mut log, &truth.robot(0)?);
    Ok(log)
}

/// To a wall and back, by comparing scans.
fn first_steps() -> Result<String> {
    let scene = Scene::with_robot(World::walled(3.0, 2.0), RobotSpec::s4(), Pose::new(0.7, 1.0, 0.0));
    let mut steps = FirstSteps::new(FirstTask::Wall, FirstStepsParameters::default())?;
    let mut outcome = String::new();
    let log = ride(&scene, noise(1.0, 32), |robot| {
        let ended = run(robot, &mut steps, 60.0, |_, _, _| {})?;
        note(&mut outcome, "outcome", &ended);
        Ok(())
    })?;
    Ok(log + &outcome)
}

/// A car that parks across the road.
fn parking() -> Result<String> {
    let lot = ParkingLot::drawn(ParkingKind::Perpendicular, 31).map_err(other)?;
    let look = Appearance { pixel: 0.004, wear: 0.2, glare: 2, seed: 31 };
    let scene = lot.scene(&look).map_err(other)?;
    let camera = scene.robots[0].spec.camera.as_ref().expect("the car has a camera").into();
    let parameters = ParkingParameters::default();
    let mut driver = ParkingDriver::new(camera, RoadModel::default(), lot.kind, parameters)?;
    let mut outcome = String::new();
    let mut log = ride(&scene, noise(1.0, 31), |robot| {
        let ended = run(robot, &mut driver, 60.0, |_, _, _| {})?;
        note(&mut outcome, "outcome", &ended);
        Ok(())
    })?;
    note(&mut log, "lot", &(lot.spot, &lot.boxes));
    Ok(log + &outcome)
}
