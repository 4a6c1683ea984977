//! Robots that follow one another, in a chain by lidar and in a formation by the leader's radio messages;
//! cars that share a road by radio.

use std::ops::ControlFlow;
use std::sync::Arc;

use roverlab::drive::traffic::{
    RadioCar, RoadSharingParameters, RoadStation, RoadStationParameters, TrafficParameters,
};
use roverlab::drive::{
    Cruise, CruiseParameters, Follower, FollowerObservation, FollowerParameters, Formation, robots_in,
};
use roverlab::geometry::{Point, Pose};
use roverlab::io::control::{Behaviour as _, Run};
use roverlab::io::sim::Fleet;
use roverlab::io::wrappers::Traced;
use roverlab::io::{Clock, Drive, Lidar, LidarScan, Odometry, Radio, Result};
use roverlab::vision::lane_markings::RoadModel;
use roverlab::world::road::{Appearance, RoadCourseOptions, generate};
use roverlab::world::{Footprint, Object, ObjectKind, RobotPlacement, RobotSpec, Scene, World};

use super::{Scenario, noise, note, note_truth, other};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("chain", || fleet(Follows::TheOneBefore, 41)),
    Scenario::new("formation", || fleet(Follows::ByRadio, 42)),
    Scenario::new("base-station", base_station),
];

#[derive(Clone, Copy, PartialEq)]
enum Follows {
    TheOneBefore,
    ByRadio,
}

/// A leader in a hall with two cans on its way, and three robots behind it.
fn hall() -> Scene {
    let mut scene = Scene::new(World::walled(5.0, 4.0));
    let can = ObjectKind::predefined("can").expect("the kind is predefined");
    let can = Arc::new(ObjectKind { fixed: true, ..can });
    for (x, y) in [(3.3, 1.05), (4.05, 2.2)] {
        scene.world.objects.push(Object::new(Arc::clone(&can), Pose::new(x, y, 0.0)));
    }
    let leader = Pose::new(2.4, 1.0, 0.0);
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::labbot()), leader));
    let follower = Arc::new(RobotSpec::s4());
    for (back, aside, turned) in [(0.45, 0.0, 0.1), (0.8, 0.1, -0.1), (1.15, -0.1, 0.05)] {
        let place = leader.compose(&Pose::new(-back, aside, turned));
        scene.robots.push(RobotPlacement::new(Arc::clone(&follower), place));
    }
    scene
}

fn radius(spec: &RobotSpec) -> f64 {
    match spec.footprint {
        Footprint::Disc { radius } => radius,
        _ => spec.footprint.bounding_radius(),
    }
}

/// A drive round the hall: every robot's readings, messages and commands, and its true path.
fn fleet(follows: Follows, seed: u64) -> Result<String> {
    let scene = hall();
    let mut traces = vec![Vec::new(); scene.robots.len()];
    let mut fleet = Fleet::new(&scene, noise(1.0, seed))?;
    for (index, trace) in traces.iter_mut().enumerate() {
        let start = scene.robots[index].pose;
        let mut scan = LidarScan::default();
        let mut step: Step = match (index, follows) {
            (0, _) => {
                let waypoints = [(4.0, 1.0), (4.0, 3.0), (1.0, 3.0)].map(|(x, y)| Point::new(x, y));
                let local = waypoints.iter().map(|place| start.to_local(*place)).collect();
                let radius = radius(&scene.robots[0].spec);
                let mut cruise =
                    Cruise::new(local, CruiseParameters { radius, ..CruiseParameters::default() })?;
                Box::new(move |robot| lead(robot, &mut cruise, start, &mut scan))
            }
            (_, Follows::TheOneBefore) => {
                let leader_radius = radius(&scene.robots[index - 1].spec);
                let parameters = FollowerParameters {
                    gap: 0.36,
                    leader_radius,
                    radius: radius(&scene.robots[index].spec),
                    ..FollowerParameters::default()
                };
                let mut follower = Follower::new(parameters)?;
                Box::new(move |robot| {
                    robot.scan_into(&mut scan)?;
                    let (time, pose) = (robot.now()?, robot.pose()?);
                    let candidates = robots_in(&scan, leader_radius);
                    let obstacles: Vec<Point> = scan.points().collect();
                    let seen =
                        FollowerObservation { time, pose, candidates: &candidates, obstacles: &obstacles };
                    let twist = follower.step(&seen)?;
                    robot.set_speed(twist)
                })
            }
            (_, Follows::ByRadio) => {
                let place = scene.robots[0].pose.to_local(start.position());
                let formation =
                    Formation { radius: radius(&scene.robots[index].spec), ..Formation::at(place) };
                let mut leader = None;
                Box::new(move |robot| {
                    robot.scan_into(&mut scan)?;
                    while let Some(message) = robot.receive()? {
                        leader = Some(Formation::read(&message.data)?);
                    }
                    let Some((place, speed)) = leader else { return Ok(()) };
                    let obstacles: Vec<Point> = scan.points().collect();
                    let pose = start.compose(&robot.pose()?);
                    robot.set_speed(formation.step(pose, place, speed, &obstacles))
                })
            }
        };
        fleet.control(index, 0.1, move |robot| {
            step(&mut Traced::new(robot, &mut *trace))?;
            Ok(ControlFlow::Continue(()))
        })?;
    }
    fleet.run_for(20.0)?;
    let truths = (0..scene.robots.len()).map(|index| fleet.truth(index)).collect::<Result<Vec<_>>>()?;
    drop(fleet);
    let mut log = String::new();
    note(&mut log, "hall", &scene.robots.iter().map(|robot| robot.pose).collect::<Vec<_>>());
    for (trace, truth) in traces.into_iter().zip(&truths) {
        log += &String::from_utf8(trace).map_err(other)?;
        note_truth(&mut log, truth);
    }
    Ok(log)
}

/// One step of a robot.
type Step = Box<dyn FnMut(&mut dyn Member) -> Result<()>>;

/// The capabilities of a robot in a fleet.
trait Member: Clock + Drive + Odometry + Lidar + Radio {}

impl<R: Clock + Drive + Odometry + Lidar + Radio> Member for R {}

/// One step of the leader, which tells all others where it is.
fn lead(robot: &mut dyn Member, cruise: &mut Cruise, start: Pose, scan: &mut LidarScan) -> Result<()> {
    robot.scan_into(scan)?;
    let pose = robot.pose()?;
    // What is behind follows, and does not matter.
    let ahead: Vec<Point> = scan.points().filter(|point| point.x > -0.05).collect();
    let twist = cruise.step(pose, &ahead)?;
    robot.set_speed(twist)?;
    let own = robot.radio_id()?;
    for peer in robot.radio_peers()?.into_iter().filter(|&peer| peer != own) {
        robot.send(peer, &Formation::message(start.compose(&pose), twist.linear))?;
    }
    Ok(())
}

/// Two cars on a course, and the station that stops them.
fn base_station() -> Result<String> {
    let course = generate(3, &RoadCourseOptions::default()).map_err(other)?;
    let look = Appearance { pixel: 0.004, ..Appearance::default() };
    let mut scene = Scene::new(course.world(&look).map_err(other)?);
    let spec = Arc::new(RobotSpec::road_car());
    let starts = [course.pose(0.0, 0.0), course.pose(1.5, 0.0)];
    scene.robots = starts.map(|start| RobotPlacement::new(Arc::clone(&spec), start)).into();
    let corner = course.floor().min;
    let beside = Pose::new(corner.x + 0.15, corner.y + 0.15, 0.0);
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::s4()), beside));
    let mut station = RoadStation::new(RoadStationParameters::default())?;
    let (mut run, mut log) = (Run::new(&station, f64::INFINITY)?, String::new());
    let mut fleet = Fleet::new(&scene, noise(1.0, 43))?;
    for (index, start) in starts.iter().enumerate() {
        let camera = spec.camera.as_ref().expect("the car has a camera").into();
        let parameters = (TrafficParameters::default(), RoadSharingParameters::default());
        let place = course.start().inverse().compose(start);
        let mut car = RadioCar::new(camera, RoadModel::default(), parameters, place)?;
        let mut run = Run::new(&car, f64::INFINITY)?;
        fleet.control(index, car.period(), move |robot| Ok(run.step(robot, &mut car)?.map_break(drop)))?;
    }
    fleet.control(2, station.period(), |robot| {
        station.stop(robot.now()? > 3.0);
        let flow = run.step(robot, &mut station)?;
        note(&mut log, "cars", &station.cars());
        Ok(flow.map_break(drop))
    })?;
    fleet.run_for(5.0)?;
    let truths = (0..3).map(|index| fleet.truth(index)).collect::<Result<Vec<_>>>()?;
    drop(fleet);
    for truth in &truths {
        note_truth(&mut log, truth);
    }
    Ok(log)
}
