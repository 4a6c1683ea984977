use super::body::{Body, Command, RaceCarSpec};
use super::robot::RaceCar;
use crate::geometry::{Point, Pose, Twist};
use crate::io::sim::{NoiseModel, RobotTruth, TICK};
use crate::io::{Error, LidarSettings, Resolution, Result};
use crate::random::Stream;
use crate::world::Colour;

/// How a race runs.
#[derive(Debug, Clone, PartialEq)]
pub struct RaceOptions {
    /// The seed of every random stream.
    pub seed: u64,
    /// Drive and sensor errors.
    pub noise: NoiseModel,
    /// The share of cones that a scan does not see.
    pub missed: f64,
    /// Returns of a scan from where nothing is, as a share of the cones that it sees.
    pub phantoms: f64,
}

impl Default for RaceOptions {
    /// Seed 1, noise as on a real robot, every cone seen.
    fn default() -> Self {
        Self { seed: 1, noise: NoiseModel::real(), missed: 0.0, phantoms: 0.0 }
    }
}

/// Where a car truly is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarTruth {
    /// The middle of the rear axle.
    pub pose: Pose,
    /// Speed along the car, and the rate of its heading.
    pub twist: Twist,
    /// The steering angle.
    pub steering: f64,
    /// Metres per second to the left, at the rear axle.
    pub slip: f64,
    /// Cones that it knocked over.
    pub hits: usize,
    /// Whether it has touched another car.
    pub touched: bool,
    /// Metres that its centre of mass has gone.
    pub distance: f64,
}

/// A cone of a race. It falls over when a car touches its foot, and is gone then.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RaceCone {
    /// Where it stands.
    pub position: Point,
    /// Metres from the axis to the edge of its foot.
    pub radius: f64,
    /// Metres from the ground to its tip.
    pub height: f64,
    /// Its colour.
    pub colour: Colour,
}

impl RaceCone {
    /// A small cone of a colour.
    pub const fn new(position: Point, colour: Colour) -> Self {
        Self { position, radius: 0.129, height: 0.325, colour }
    }
}

/// A cone of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Obstacle {
    pub(super) cone: RaceCone,
    pub(super) stands: bool,
}

#[derive(Debug, Clone)]
pub(super) struct Entry {
    pub(super) spec: RaceCarSpec,
    pub(super) body: Body,
    pub(super) command: Command,
    pub(super) odometry: Pose,
    /// What odometry measures now.
    pub(super) measured: Twist,
    pub(super) scanner: LidarSettings,
    pub(super) resolution: Resolution,
    pub(super) lidar: Stream,
    pub(super) camera: Stream,
    drive: Stream,
    scale: f64,
    drift: f64,
    /// Cones that it knocked over, by their indices.
    hits: Vec<usize>,
    /// Where it was when it touched another car.
    touched: Option<Point>,
    distance: f64,
}

/// Cones, and cars between them.
#[derive(Debug, Clone)]
pub struct Race {
    pub(super) cones: Vec<Obstacle>,
    pub(super) cars: Vec<Entry>,
    pub(super) options: RaceOptions,
    ticks: u64,
    /// Seconds that have passed since the last tick.
    owed: f64,
}

/// Steps of the tyres in a tick.
const SUBSTEPS: u32 = 5;
/// The error of a rate gyroscope for noise 1: rad/s that it reads standing, and rad/s from reading to reading.
const GYRO_BIAS: f64 = 0.001;
const GYRO_NOISE: f64 = 0.003;

impl Race {
    /// A race between cones, with cars that stand with the middle of their rear axle at a pose.
    ///
    /// Fails where a number is out of range.
    pub fn new(cones: &[RaceCone], cars: &[(RaceCarSpec, Pose)], options: RaceOptions) -> Result<Self> {
        options.noise.validate()?;
        for (name, value) in
            [("share of missed cones", options.missed), ("share of phantoms", options.phantoms)]
        {
            if !(0.0..=1.0).contains(&value) {
                return Err(Error::invalid_input(name, value, "0 to 1"));
            }
        }
        for cone in cones {
            crate::io::error::require_finite("place of a cone", cone.position.x + cone.position.y)?;
            if !(cone.radius > 0.0 && cone.radius < 10.0) {
                return Err(Error::invalid_input(
                    "radius of a cone",
                    cone.radius,
                    "more than 0, less than 10 m",
                ));
            }
            crate::io::error::require_positive("height of a cone", cone.height)?;
        }
        let random = Stream::new(options.seed);
        // Relative errors of the drive are given for robots with small wheels: what is left of them is a tyre's.
        let size = options.noise.wheel_mismatch / NoiseModel::real().wheel_mismatch;
        let mut entries = Vec::new();
        for (index, (spec, pose)) in cars.iter().enumerate() {
            spec.validate()?;
            if !pose.is_finite() {
                return Err(Error::invalid_input("start", format!("{pose:?}"), "finite numbers"));
            }
            let mut drive = random.child("drive", index as u64);
            entries.push(Entry {
                spec: *spec,
                body: Body::standing(spec, *pose),
                command: Command::default(),
                odometry: Pose::default(),
                measured: Twist::default(),
                scanner: LidarSettings { field_of_view: std::f64::consts::PI, tilt: 0.0, points: 901 },
                resolution: Resolution::default(),
                lidar: random.child("lidar", index as u64),
                camera: random.child("camera", index as u64),
                scale: 1.0 + options.noise.wheel_scale * drive.normal(),
                drift: GYRO_BIAS * size * drive.normal(),
                drive,
                hits: Vec::new(),
                touched: None,
                distance: 0.0,
            });
        }
        let cones = cones.iter().map(|&cone| Obstacle { cone, stands: true }).collect();
        Ok(Self { cones, cars: entries, options, ticks: 0, owed: 0.0 })
    }

    /// A car, by its number from 0. Time passes for all of them when it waits.
    pub fn car(&mut self, index: usize) -> Result<RaceCar<'_>> {
        if index >= self.cars.len() {
            return Err(self.no_car(index));
        }
        Ok(RaceCar { race: self, index })
    }

    /// Seconds since the beginning.
    pub fn time(&self) -> f64 {
        self.ticks as f64 * TICK + self.owed
    }

    /// Where a car truly is. `None` if there is no such car.
    pub fn truth(&self, index: usize) -> Option<CarTruth> {
        self.cars.get(index).map(|car| CarTruth {
            pose: car.body.pose(&car.spec),
            twist: car.body.twist(),
            steering: car.body.steering,
            slip: car.body.slip(&car.spec),
            hits: car.hits.len(),
            touched: car.touched.is_some(),
            distance: car.distance,
        })
    }

    /// All that is true about a car, as about any robot.
    pub(super) fn robot_truth(&self, index: usize) -> Result<RobotTruth> {
        let car = self.cars.get(index).ok_or_else(|| self.no_car(index))?;
        let cones = car.hits.iter().map(|&cone| self.cones[cone].cone.position);
        let contact_places: Vec<Point> = cones.chain(car.touched).collect();
        Ok(RobotTruth {
            pose: car.body.pose(&car.spec),
            odometry: car.odometry,
            contacts: contact_places.len() as u32,
            contact_places,
            path_length: car.distance,
            trail: Vec::new(),
        })
    }

    /// Where a cone stands or stood.
    pub(super) fn cone_pose(&self, index: usize) -> Result<Pose> {
        let place = self.cones.get(index).map(|cone| cone.cone.position);
        let pose = place.map(|place| Pose::new(place.x, place.y, 0.0));
        pose.ok_or_else(|| {
            Error::invalid_input("number of the cone", index, &format!("less than {}", self.cones.len()))
        })
    }

    fn no_car(&self, index: usize) -> Error {
        Error::invalid_input("number of the car", index, &format!("less than {}", self.cars.len()))
    }

    /// Cones that all cars have knocked over.
    pub fn hits(&self) -> usize {
        self.cars.iter().map(|car| car.hits.len()).sum()
    }

    /// Which cones stand, in the order in which they were given.
    pub fn standing(&self) -> impl Iterator<Item = bool> + '_ {
        self.cones.iter().map(|cone| cone.stands)
    }

    /// Lets time pass, in ticks of 10 ms.
    pub fn advance(&mut self, seconds: f64) {
        self.owed += seconds.clamp(0.0, 1e6);
        // Half a millionth of a tick: sums of decimals are a little off.
        while self.owed > TICK * (1.0 - 5e-7) {
            self.owed -= TICK;
            self.tick();
        }
        self.owed = self.owed.max(0.0);
    }

    fn tick(&mut self) {
        self.ticks += 1;
        for car in &mut self.cars {
            car.tick(&self.options, &mut self.cones);
        }
        for i in 0..self.cars.len() {
            for j in i + 1..self.cars.len() {
                if self.cars[i].outline_meets(&self.cars[j]) {
                    for index in [i, j] {
                        let car = &mut self.cars[index];
                        car.touched.get_or_insert(car.body.pose(&car.spec).position());
                    }
                }
            }
        }
    }
}

impl Entry {
    fn tick(&mut self, options: &RaceOptions, cones: &mut [Obstacle]) {
        for _ in 0..SUBSTEPS {
            self.body.step(&self.spec, self.command, TICK / f64::from(SUBSTEPS));
        }
        let twist = self.body.twist();
        if twist == Twist::default() && self.body.speed() == 0.0 {
            self.measured = twist;
            return;
        }
        self.distance += self.body.speed() * TICK;
        let size = options.noise.wheel_mismatch / NoiseModel::real().wheel_mismatch;
        let slip = options.noise.slip * (twist.linear.abs() / TICK).sqrt() * self.drive.normal();
        let rate = twist.angular + self.drift + GYRO_NOISE * size * self.drive.normal();
        self.measured = Twist::new(twist.linear * self.scale + slip, rate);
        let half = self.odometry.heading + 0.5 * TICK * rate;
        let step = crate::geometry::direction(half) * (TICK * self.measured.linear);
        let heading = crate::geometry::normalize_angle(self.odometry.heading + TICK * rate);
        self.odometry = Pose::new(self.odometry.x + step.x, self.odometry.y + step.y, heading);
        let pose = self.body.pose(&self.spec);
        let reach = self.spec.nose + self.spec.width;
        for (index, Obstacle { cone, stands }) in cones.iter_mut().enumerate().filter(|(_, cone)| cone.stands)
        {
            let away = cone.position - pose.position();
            if away.norm_squared() > reach * reach {
                continue;
            }
            let local = pose.to_local(cone.position);
            let outside_x = (local.x - self.spec.nose).max(-self.spec.tail - local.x).max(0.0);
            let outside_y = (local.y.abs() - 0.5 * self.spec.width).max(0.0);
            if outside_x * outside_x + outside_y * outside_y < cone.radius * cone.radius {
                *stands = false;
                self.hits.push(index);
            }
        }
    }

    /// The corners of the car.
    pub(super) fn corners(&self) -> [Point; 4] {
        let (pose, half) = (self.body.pose(&self.spec), 0.5 * self.spec.width);
        [(self.spec.nose, half), (-self.spec.tail, half), (-self.spec.tail, -half), (self.spec.nose, -half)]
            .map(|(x, y)| pose.to_world(Point::new(x, y)))
    }

    /// Whether two cars overlap, by the axes of both.
    fn outline_meets(&self, other: &Self) -> bool {
        let (a, b) = (self.corners(), other.corners());
        [a, b].iter().all(|corners| {
            [corners[1] - corners[0], corners[2] - corners[1]].iter().all(|axis| {
                let span = |points: &[Point; 4]| {
                    points
                        .iter()
                        .map(|p| p.coords.dot(axis))
                        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)))
                };
                let ((al, ah), (bl, bh)) = (span(&a), span(&b));
                al <= bh && bl <= ah
            })
        })
    }
}
