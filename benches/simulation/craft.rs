//! Craft under water: how much faster than real time they hold their depth.

use std::hint::black_box;
use std::ops::ControlFlow;
use std::sync::Arc;

use criterion::{BenchmarkId, Criterion};
use roverlab::drive::marine::{Dive, DiveObservation, DiveParameters};
use roverlab::geometry::Pose;
use roverlab::io::control::{self, Behaviour, Command, Senses};
use roverlab::io::sim::{Fleet, FleetRobot, SimOptions, SimRobot, Simulation, Truth};
use roverlab::io::{Clock, DistanceSensors, Psd, Result};
use roverlab::kinematics::marine::CraftSpec;
use roverlab::world::{RobotPlacement, RobotSpec, Scene, World};
use roverlab_bench::fleet::PERIOD;

use super::robots::{real_time_factor, run};

/// Metres of the water in the pools.
const DEEP: f64 = 1.9;
/// Number of craft along a side of the fleet's pool, and metres between them.
const ROW: usize = 32;
const APART: f64 = 5.0;
const CRAFT: usize = 1000;

fn pool(width: f64, length: f64) -> World {
    World { water_level: Some(DEEP), ..World::walled(width, length) }
}

/// A dive without an end.
fn dive() -> Dive {
    let parameters = DiveParameters { duration: 1e9, ..DiveParameters::default() };
    Dive::new(&CraftSpec::mako(), parameters).expect("good parameters")
}

/// Mako, which holds depth, pitch and heading and reads its six distance sensors, ten times a second.
struct Diver {
    robot: SimRobot,
    truth: Truth,
    dive: Dive,
}

impl Diver {
    fn new(noise: f64) -> Self {
        let scene = Scene::with_robot(pool(25.0, 50.0), RobotSpec::mako(), Pose::new(12.0, 25.0, 0.0));
        let simulation = Simulation::new(&scene, SimOptions::with_noise(noise, 1)).expect("a good scene");
        let robot = simulation.robot(0).expect("the only robot");
        Self { robot, truth: simulation.truth(), dive: dive() }
    }

    fn hold(&mut self, seconds: f64) {
        control::run(&mut self.robot, &mut self.dive, seconds, |robot, _, _| -> Result<()> {
            for psd in 1..=6 {
                black_box(robot.distance(Psd(psd))?);
            }
            Ok(())
        })
        .expect("nothing fails");
    }
}

/// One Mako in the book's pool.
pub(crate) fn one_craft(c: &mut Criterion) {
    let mut group = c.benchmark_group("a second of Mako with six distance sensors");
    for noise in [0.0, 1.0] {
        let mut diver = Diver::new(noise);
        diver.hold(30.0);
        let keel = diver.truth.pose_in_space(0).expect("the only robot").position.z;
        assert!((keel - 0.64).abs() < 0.02, "a metre above its sensor is the surface: {keel}");
        let factor = real_time_factor(200, 5.0, || diver.hold(5.0));
        println!("one Mako, noise {noise}: {factor:.0} times real time");
        group.bench_function(BenchmarkId::new("noise", noise), |b| b.iter(|| diver.hold(1.0)));
    }
    group.finish();
}

/// A step of a fleet's craft.
fn step(dive: &mut Dive, robot: &mut FleetRobot<'_>) -> Result<ControlFlow<()>> {
    let (time, mut seen) = (robot.now()?, DiveObservation::default());
    dive.sense(robot, time, &mut seen)?;
    let ControlFlow::Continue(thrust) = dive.step(time, &seen)? else { return Ok(ControlFlow::Break(())) };
    thrust.apply(robot)?;
    Ok(ControlFlow::Continue(()))
}

/// A thousand of them in one pool.
pub(crate) fn craft_fleet(_: &mut Criterion) {
    let spec = Arc::new(RobotSpec::mako());
    let place = |index: usize| APART * (1.0 + index as f64);
    let placed = (0..CRAFT).map(|number| Pose::new(place(number % ROW), place(number / ROW), 0.0));
    let robots = placed.map(|pose| RobotPlacement::new(Arc::clone(&spec), pose)).collect();
    let side = APART * (ROW + 1) as f64;
    let scene = Scene { robots, ..Scene::new(pool(side, side)) };
    let mut fleet = Fleet::new(&scene, SimOptions::with_noise(1.0, 1)).expect("a good scene");
    for robot in 0..fleet.len() {
        let mut dive = dive();
        fleet.control(robot, PERIOD, move |robot| step(&mut dive, robot)).expect("a robot and a period");
    }
    run(&mut fleet, 5.0);
    let factor = real_time_factor(20, PERIOD, || run(&mut fleet, PERIOD));
    println!("{CRAFT} Makos that hold their depth: {factor:.1} times real time");
}
