use std::f64::consts::TAU;
use std::sync::Arc;

use roverlab::ParameterError;
use roverlab::geometry::{Aabb, Point, Pose, Twist, Vector, Vector3, direction, math};
use roverlab::random::Stream;
use roverlab::world::{HeightField, RobotSpec, Scene, Terrain, World};

/// A smooth terrain, and a drive across it.
pub(crate) struct Course {
    /// The triangles on which both robots drive.
    pub(crate) ground: Arc<HeightField>,
    /// Tangent of the steepest slope within reach of the drive.
    pub(crate) steepest: f64,
    start: Pose,
    /// Curvature of the way that the wheels or belts would drive on level ground (1/m).
    curvature: f64,
}

/// A robot on its course at one moment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    /// The reference point: the origin of the robot's frame, on the ground below the driven axle.
    pub(crate) place: roverlab::geometry::Point3,
    /// Its upward axis.
    pub(crate) up: Vector3,
    /// Its forward axis.
    pub(crate) ahead: Vector3,
}

/// One wave of the ground: its wave vector (rad/m), phase and amplitude (m).
type Wave = (Vector, f64, f64);

/// Time between commands, a tick of the simulator (s).
pub(crate) const PERIOD: f64 = 0.01;
/// Number of commands from the start to the end of a drive.
pub(crate) const PERIODS: u32 = 1100;
/// Number of commands between two samples.
pub(crate) const BETWEEN_SAMPLES: u32 = 10;
/// Time at rest before the drive (s).
const STANDING: f64 = 1.0;
/// Time in which the robot then reaches its speed (s).
const STARTING: f64 = 1.0;
/// Speed (m/s).
const SPEED: f64 = 0.2;
/// Curvature of every other drive (1/m).
const GENTLE: f64 = 0.6;
/// Side of a terrain (m).
const SIDE: f64 = 8.0;
/// Number of samples along a side: triangles of 31 mm.
const SAMPLES: usize = 257;
/// Number of waves of a terrain.
const WAVES: usize = 8;
/// Smallest and largest length of a wave vector (rad/m): waves of 2.1 to 6.3 m, longer than five robots.
const WAVE_NUMBERS: (f64, f64) = (1.0, 3.0);
/// Range of the tangents of the steepest slopes: 9 to 19 degrees.
const STEEPEST: (f64, f64) = (0.15, 0.35);
/// Distance from the start to which slopes are limited (m).
const REACH: f64 = 2.5;

impl Course {
    /// A course of a given number; every other one is curved, to the left and right in turn.
    pub(crate) fn generate(number: u64) -> Result<Self, ParameterError> {
        let mut stream = Stream::new(number);
        let mut waves: Vec<Wave> = (0..WAVES).map(|_| wave(&mut stream)).collect();
        let middle = Point::new(0.5 * SIDE, 0.5 * SIDE);
        let steepest = stream.between(STEEPEST.0, STEEPEST.1);
        let scale = steepest / steepest_slope(&waves, middle);
        for (_, _, size) in &mut waves {
            *size *= scale;
        }
        let area = Aabb::new(Point::origin(), Point::new(SIDE, SIDE));
        let ground = HeightField::from_fn(SAMPLES, SAMPLES, area, |at| height(&waves, at))?;
        let start = Pose::new(middle.x, middle.y, stream.between(-3.1, 3.1));
        let curvature = [0.0, GENTLE, 0.0, -GENTLE][(number % 4) as usize];
        Ok(Self { ground: Arc::new(ground), steepest, start, curvature })
    }

    /// The scene of a robot at the start.
    pub(crate) fn scene(&self, spec: &RobotSpec) -> Scene {
        let terrain = Terrain {
            width: SIDE,
            height: SIDE,
            max_elevation: self.ground.highest(),
            file: "smooth.png".into(),
            surface: Some(Arc::clone(&self.ground)),
        };
        let world = World { terrain: Some(terrain), ..World::empty(SIDE, SIDE) };
        Scene::with_robot(world, spec.clone(), self.start)
    }

    /// Whether the drive is curved.
    pub(crate) fn is_curved(&self) -> bool {
        self.curvature != 0.0
    }

    /// Command number `period` of the drive.
    pub(crate) fn command(&self, period: u32) -> Twist {
        let time = (f64::from(period) + 0.5) * PERIOD;
        let speed = SPEED * ((time - STANDING) / STARTING).clamp(0.0, 1.0);
        Twist::new(speed, speed * self.curvature)
    }
}

/// A wave with a random direction. Short waves are as steep as long ones.
fn wave(stream: &mut Stream) -> Wave {
    let number = stream.between(WAVE_NUMBERS.0, WAVE_NUMBERS.1);
    let along = direction(stream.between(0.0, TAU));
    (along * number, stream.between(0.0, TAU), 1.0 / number)
}

fn height(waves: &[Wave], at: Point) -> f64 {
    waves.iter().map(|(wave, phase, size)| size * math::sin(wave.dot(&at.coords) + phase)).sum()
}

/// Tangent of the steepest slope around a point.
fn steepest_slope(waves: &[Wave], around: Point) -> f64 {
    let slope = |at: Point| -> f64 {
        let rise = |(wave, phase, size): &Wave| wave * (size * math::cos(wave.dot(&at.coords) + phase));
        waves.iter().map(rise).sum::<Vector>().norm()
    };
    let steps = || (-25..=25).map(|step| f64::from(step) / 25.0 * REACH);
    let places = steps().flat_map(|x| steps().map(move |y| Vector::new(x, y)));
    places.filter(|away| away.norm() <= REACH).map(|away| slope(around + away)).fold(0.0, f64::max)
}
