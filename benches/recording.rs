//! What recording costs: a run of `DistBug` with and without it, and camera images on their way into memory.

use std::hint::black_box;
use std::io::{self, Write};
use std::time::Instant;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use image::RgbImage;
use roverlab::geometry::Point;
use roverlab::io::control::run;
use roverlab::io::log::{Header, Log, LogWriter, Player};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Camera, Clock, Drive, Lidar, Odometry, Resolution, Result};
use roverlab::nav::{BugOutcome, BugParameters, DistBug};
use roverlab::random::Stream;
use roverlab::world::generate::{CourseOptions, obstacle_course};
use roverlab::world::{RobotSpec, Scene};

/// A course on which the goal is reached, and the goal as the robot sees it.
fn course() -> (Scene, Point) {
    let options = CourseOptions::default();
    let courses = (1..).map(|seed| obstacle_course(&mut Stream::new(seed), &options).expect("a course"));
    let course = courses.into_iter().find(|course| course.reachable).expect("a course with a way");
    let goal = course.start.to_local(course.goal);
    (Scene::with_robot(course.world, RobotSpec::s4(), course.start), goal)
}

fn simulation(scene: &Scene) -> Simulation {
    let options = SimOptions { time_limit: Some(3600.0), ..SimOptions::with_noise(1.0, 1) };
    Simulation::new(scene, options).expect("a simulation")
}

fn drive(robot: &mut (impl Clock + Drive + Odometry + Lidar), goal: Point) -> BugOutcome {
    let mut bug = DistBug::new(goal, BugParameters::default()).expect("a goal");
    run(robot, &mut bug, 3600.0, |_, _, _| {}).expect("a robot that works")
}

fn record(scene: &Scene, goal: Point, memory: Vec<u8>) -> Vec<u8> {
    let writer = LogWriter::new(memory, &Header::new("bench", [""; 0])).expect("a recording");
    let mut robot = writer.recorder(simulation(scene).robot(0).expect("a robot"), 0);
    drive(&mut robot, goal);
    drop(robot);
    writer.finish().expect("memory")
}

/// Runs of each kind that are compared.
const ROUNDS: usize = 15;

/// How much longer a run takes that is recorded. The fastest of many is what other work on the machine
/// disturbs least.
#[allow(clippy::disallowed_methods, reason = "a benchmark takes the time")]
fn cost(scene: &Scene, goal: Point) -> f64 {
    let (mut plain, mut recorded) = (f64::INFINITY, f64::INFINITY);
    let mut memory = Vec::new();
    for _ in 0..ROUNDS {
        let start = Instant::now();
        black_box(drive(&mut simulation(scene).robot(0).expect("a robot"), goal));
        plain = plain.min(start.elapsed().as_secs_f64());
        memory.clear();
        let start = Instant::now();
        memory = record(scene, goal, memory);
        recorded = recorded.min(start.elapsed().as_secs_f64());
    }
    recorded / plain - 1.0
}

/// The same run plain, recorded into memory, and replayed.
fn distbug(c: &mut Criterion) {
    let (scene, goal) = course();
    let plain = || drive(&mut simulation(&scene).robot(0).expect("a robot"), goal);
    let log = Log::read(record(&scene, goal, Vec::new())).expect("a recording");
    let replay = || drive(&mut Player::new(&log).robot(0).expect("a robot"), goal);
    assert_eq!((plain(), replay()), (BugOutcome::Reached, BugOutcome::Reached));
    let mut memory = log.bytes().to_vec();
    println!(
        "Recording costs {:.1} % of the run: fastest of {ROUNDS} each, in turn",
        100.0 * cost(&scene, goal)
    );
    let mut group = c.benchmark_group("DistBug to its goal");
    group.sample_size(20);
    group.bench_function("plain", |b| b.iter(plain));
    group.bench_function("recorded into memory", |b| {
        b.iter(|| {
            let mut again = std::mem::take(&mut memory);
            again.clear();
            memory = record(&scene, goal, again);
        });
    });
    group.bench_function("replayed", |b| b.iter(replay));
    group.finish();
}

/// A camera that has its image at hand.
struct Eye;

impl Clock for Eye {
    fn now(&mut self) -> Result<f64> {
        Ok(0.0)
    }

    fn wait(&mut self, _seconds: f64) -> Result<()> {
        Ok(())
    }
}

impl Camera for Eye {
    fn set_resolution(&mut self, _resolution: Resolution) -> Result<()> {
        Ok(())
    }

    fn resolution(&mut self) -> Result<Resolution> {
        Ok(Resolution::Vga)
    }

    fn image_into(&mut self, _image: &mut RgbImage) -> Result<()> {
        Ok(())
    }
}

/// Memory that is written over and over.
struct Ring {
    memory: Vec<u8>,
    at: usize,
}

impl Write for Ring {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let room = &mut self.memory[self.at..];
        let length = bytes.len().min(room.len());
        room[..length].copy_from_slice(&bytes[..length]);
        self.at = (self.at + length) % self.memory.len();
        Ok(length)
    }

    fn flush(&mut self) -> io::Result<()> {
        black_box(&self.memory);
        Ok(())
    }
}

/// Camera images of 640 x 480 pixels into memory.
fn camera(c: &mut Criterion) {
    let (width, height) = Resolution::Vga.dimensions();
    let mut image = RgbImage::from_fn(width, height, |x, y| image::Rgb([x as u8, y as u8, (x * y) as u8]));
    let ring = Ring { memory: vec![0; 64 << 20], at: 0 };
    let writer = LogWriter::new(ring, &Header::new("bench", [""; 0])).expect("a recording");
    let mut robot = writer.recorder(Eye, 0);
    let mut group = c.benchmark_group("camera image into memory");
    group.throughput(Throughput::Bytes(image.as_raw().len() as u64));
    group.bench_function("640 x 480", |b| b.iter(|| robot.image_into(&mut image).expect("an image")));
    group.finish();
}

criterion_group!(benches, distbug, camera);
criterion_main!(benches);
