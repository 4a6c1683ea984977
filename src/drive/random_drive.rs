use std::f64::consts::{FRAC_PI_4, PI};
use std::ops::ControlFlow;

use super::WallSensors;
use super::way::{AHEAD, ALIGNED, BRAKING, TURN_GAIN, Way};
use crate::ParameterError;
use crate::geometry::{Point, Pose, Twist, angle_difference, direction, normalize_angle};
use crate::io::control::{Behaviour, Decision, Halt, SensedBy, Senses};
use crate::io::reading::{check_distances, check_pose, check_scan};
use crate::io::{DistanceSensors, ErrorKind, Lidar, LidarScan, Odometry, Psd, Result};
use crate::parameter::require_positive;
use crate::random::Stream;

/// Parameters of [`RandomDrive`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomDriveParameters {
    /// Driving speed (m/s).
    pub speed: f64,
    /// Turn rate on the spot (rad/s).
    pub turn_rate: f64,
    /// Distance from the robot's outline to an obstacle ahead at which it turns away (m).
    pub safe: f64,
    /// Radius of the circle around the robot's centre that encloses it (m).
    pub radius: f64,
    /// Clearance kept beside the robot (m).
    pub margin: f64,
    /// Delay of the robot's response to commands (s).
    pub lag: f64,
    /// Control period (s).
    pub period: f64,
}

impl Default for RandomDriveParameters {
    /// The book's speed, for an S4 that turns away 150 mm from an obstacle.
    fn default() -> Self {
        Self { speed: 0.2, turn_rate: 1.5, safe: 0.15, radius: 0.06, margin: 0.04, lag: 0.2, period: 0.05 }
    }
}

impl RandomDriveParameters {
    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        require_positive("speed", self.speed)?;
        require_positive("turn rate", self.turn_rate)?;
        require_positive("safe distance", self.safe)?;
        require_positive("radius", self.radius)?;
        require_positive("margin", self.margin)?;
        require_positive("lag", self.lag)?;
        require_positive("control period", self.period)
    }
}

/// Drives straight on until an obstacle is ahead, turns by a random angle, and repeats (book, section 3.1).
///
/// The robot only moves forwards into space seen to be free over its whole width, and slows down before it
/// stops. So several of them can share a world without contact: each stops for the others.
///
/// ```
/// use roverlab::drive::{RandomDrive, RandomDriveParameters};
/// use roverlab::geometry::Pose;
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::random::Stream;
/// use roverlab::world::{RobotSpec, Scene, World};
/// # fn main() -> roverlab::io::Result<()> {
/// let scene = Scene::with_robot(World::walled(1.5, 1.5), RobotSpec::s4(), Pose::new(0.7, 0.7, 0.3));
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let mut drive = RandomDrive::new(RandomDriveParameters::default(), Stream::new(1))?;
/// run(&mut simulation.robot(0)?, &mut drive, 60.0, |_, _, _| {})?;
/// let truth = simulation.truth().robot(0)?;
/// assert!(truth.contacts == 0 && truth.path_length > 3.0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct RandomDrive {
    parameters: RandomDriveParameters,
    stream: Stream,
    /// Target heading of the current turn.
    turning_to: Option<f64>,
    turns: u32,
}

/// Number of directions drawn for a turn. The first with enough room is taken, or else the one with the most.
const DRAWN: usize = 12;
/// Number of parts of an assumed wall between two points.
const WALL_POINTS: u32 = 16;

impl RandomDrive {
    /// Creates a robot about to drive, with its own random stream. Fails for parameters out of range.
    pub fn new(parameters: RandomDriveParameters, stream: Stream) -> Result<Self> {
        parameters.validate()?;
        Ok(Self { parameters, stream, turning_to: None, turns: 0 })
    }

    /// Number of turns so far.
    pub fn turns(&self) -> u32 {
        self.turns
    }

    /// The next velocity, from the odometry pose and the obstacle points in the robot's frame. Fails if the
    /// pose is not finite.
    pub fn step(&mut self, pose: Pose, points: &[Point]) -> Result<Twist> {
        check_pose(&pose)?;
        let RandomDriveParameters { speed, turn_rate, safe, .. } = self.parameters;
        if let Some(heading) = self.turning_to {
            let rest = angle_difference(heading, pose.heading);
            if rest.abs() > ALIGNED {
                return Ok(Twist::new(0.0, (TURN_GAIN * rest).clamp(-turn_rate, turn_rate)));
            }
            self.turning_to = None;
        }
        let free = self.free_way(points, 0.0);
        if free > safe {
            return Ok(Twist::new(speed.min((free - 0.5 * safe) / BRAKING), 0.0));
        }
        let turn = self.draw_turn(points);
        self.turning_to = Some(normalize_angle(pose.heading + turn));
        self.turns += 1;
        Ok(Twist::STOP)
    }

    /// The behaviour by three distance sensors, as in the book, on robots that need no lidar.
    ///
    /// ```
    /// use roverlab::drive::{RandomDrive, RandomDriveParameters};
    /// use roverlab::geometry::Pose;
    /// use roverlab::io::control::run;
    /// use roverlab::io::sim::{SimOptions, Simulation};
    /// use roverlab::io::{Clock, DistanceSensors, Drive, Odometry, Result};
    /// use roverlab::random::Stream;
    /// use roverlab::world::{RobotSpec, Scene, World};
    ///
    /// fn wander(robot: &mut (impl Clock + Drive + Odometry + DistanceSensors)) -> Result<()> {
    ///     let mut drive = RandomDrive::new(RandomDriveParameters::default(), Stream::new(1))?;
    ///     run(robot, &mut drive.by_distance_sensors(), 60.0, |_, _, _| {})?;
    ///     Ok(())
    /// }
    ///
    /// # fn main() -> Result<()> {
    /// let mut spec = RobotSpec::s4();
    /// spec.lidar = None;
    /// let scene = Scene::with_robot(World::walled(1.5, 1.5), spec, Pose::new(0.7, 0.7, 0.3));
    /// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
    /// wander(&mut simulation.robot(0)?)?;
    /// let truth = simulation.truth().robot(0)?;
    /// assert!(truth.contacts == 0 && truth.path_length > 3.0);
    /// # Ok(())
    /// # }
    /// ```
    pub fn by_distance_sensors<R: DistanceSensors + Odometry + ?Sized>(
        &mut self,
    ) -> impl Senses<R, Observation = RandomDriveObservation, Command = Twist, Outcome = Halt> {
        SensedBy::new(self, |robot: &mut R, _, seen: &mut RandomDriveObservation| {
            seen.feel(robot)?;
            seen.pose = robot.pose()?;
            Ok(())
        })
    }

    /// The heading of a random turn towards free floor, if there is any.
    fn draw_turn(&mut self, points: &[Point]) -> f64 {
        let mut best = (PI, f64::NEG_INFINITY);
        for _ in 0..DRAWN {
            let angle = self.stream.between(FRAC_PI_4, PI);
            let turn = if self.stream.chance(0.5) { angle } else { -angle };
            let room = self.free_way(points, turn);
            if room > AHEAD {
                return turn;
            }
            if room > best.1 {
                best = (turn, room);
            }
        }
        best.0
    }

    /// Distance that the robot can drive in a direction before its outline touches a point (m).
    fn free_way(&self, points: &[Point], direction: f64) -> f64 {
        Way { radius: self.parameters.radius, margin: self.parameters.margin }.free(points, direction)
    }
}

/// Observation of a [`RandomDrive`].
#[derive(Debug, Clone, Default)]
pub struct RandomDriveObservation {
    /// Pose by odometry.
    pub pose: Pose,
    /// Obstacle points in the robot's frame (m).
    pub points: Vec<Point>,
    /// The scan behind the points, if the robot has a lidar.
    pub scan: LidarScan,
}

impl RandomDriveObservation {
    /// Reads the lidar, or the distance sensors of a robot without one.
    fn look<R: DistanceSensors + Lidar + ?Sized>(&mut self, robot: &mut R) -> Result<()> {
        match robot.scan_into(&mut self.scan) {
            Ok(()) => {
                check_scan(&self.scan)?;
                self.points.clear();
                self.points.extend(self.scan.points());
                Ok(())
            }
            Err(error) if error.kind() == ErrorKind::Unsupported => self.feel(robot),
            Err(error) => Err(error),
        }
    }

    /// Reads the distance sensors ahead and to both sides. They see single points, so a straight wall is
    /// assumed between the point ahead and each of the others: a robot that meets a wall at a small angle
    /// would scrape along it otherwise.
    fn feel<R: DistanceSensors + ?Sized>(&mut self, robot: &mut R) -> Result<()> {
        let WallSensors { front, left, right, .. } = WallSensors::default();
        let mut hit = |psd, mount: Pose| -> Result<Option<Point>> {
            let range = robot.distance(psd)?;
            check_distances("observed distance", &[range])?;
            Ok(range.is_finite().then(|| mount.position() + direction(mount.heading) * range))
        };
        let ahead = hit(Psd::FRONT, front)?;
        let sides = [hit(Psd::LEFT, left)?, hit(Psd::RIGHT, right)?];
        self.points.clear();
        self.points.extend(ahead);
        for side in sides.into_iter().flatten() {
            self.points.push(side);
            let wall = ahead.map(|ahead| {
                (1..WALL_POINTS)
                    .map(move |i| ahead + (side - ahead) * (f64::from(i) / f64::from(WALL_POINTS)))
            });
            self.points.extend(wall.into_iter().flatten());
        }
        Ok(())
    }
}

impl Behaviour for RandomDrive {
    type Observation = RandomDriveObservation;
    type Command = Twist;
    type Outcome = Halt;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, _time: f64, seen: &RandomDriveObservation) -> Decision<Self> {
        RandomDrive::step(self, seen.pose, &seen.points).map(ControlFlow::Continue)
    }
}

impl<R: DistanceSensors + Odometry + Lidar + ?Sized> Senses<R> for RandomDrive {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut RandomDriveObservation) -> Result<()> {
        seen.look(robot)?;
        seen.pose = robot.pose()?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn drive() -> RandomDrive {
        RandomDrive::new(RandomDriveParameters::default(), Stream::new(3)).unwrap()
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn it_never_drives_at_something_near(x in 0.001..0.18f64, y in -0.05..0.05f64, others in prop::collection::vec((-2.0..2.0f64, -2.0..2.0f64), 0..30)) {
            let mut points: Vec<Point> = others.into_iter().map(|(x, y)| Point::new(x, y)).collect();
            points.push(Point::new(x, y));
            let twist = drive().step(Pose::default(), &points).unwrap();
            prop_assert!(twist.linear == 0.0);
        }

        #[test]
        fn the_way_is_free_as_far_as_it_says(
            points in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 1..20), direction in -3.0..3.0f64,
        ) {
            let points: Vec<Point> = points.into_iter().map(|(x, y)| Point::new(x, y)).collect();
            let drive = drive();
            let free = drive.free_way(&points, direction).min(1.5);
            let radius = drive.parameters.radius;
            for share in [0.0, 0.3, 0.6, 0.9] {
                let place = Point::origin() + crate::geometry::direction(direction) * (share * (free - radius).max(0.0));
                for point in &points {
                    let ahead = (point - place).dot(&crate::geometry::direction(direction)) > 0.0;
                    let behind_start = (point - Point::origin()).dot(&crate::geometry::direction(direction)) <= 0.0;
                    prop_assert!(behind_start || !ahead || (point - place).norm() > radius - 1e-9 || free < radius);
                }
            }
        }
    }

    /// Robots that see along three rays only meet walls at any angle, and touch none.
    #[test]
    fn three_distance_sensors_suffice_among_walls() {
        use crate::io::control::run;
        use crate::io::sim::{SimOptions, Simulation};
        use crate::world::{RobotSpec, Scene, Wall, World};
        let mut world = World::walled(2.0, 1.5);
        world.walls.push(Wall::new(Point::new(0.0, 1.0), Point::new(0.5, 1.5)));
        let spec = RobotSpec { lidar: None, ..RobotSpec::s4() };
        for seed in 1..=20 {
            let scene = Scene::with_robot(world.clone(), spec.clone(), Pose::new(1.0, 0.7, 0.3));
            let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, seed)).unwrap();
            let mut drive = RandomDrive::new(RandomDriveParameters::default(), Stream::new(seed)).unwrap();
            run(&mut simulation.robot(0).unwrap(), &mut drive.by_distance_sensors(), 120.0, |_, _, _| {})
                .unwrap();
            let truth = simulation.truth().robot(0).unwrap();
            println!(
                "{seed}: {} contacts, {:.2} m, {} turns",
                truth.contacts,
                truth.path_length,
                drive.turns()
            );
            assert!(truth.contacts == 0 && truth.path_length > 5.0, "seed {seed}: {truth:?}");
        }
    }

    #[test]
    fn it_turns_to_where_there_is_room() {
        // A wall ahead and on the left: the room is to the right or behind.
        let wall = |i: i32| Point::new(0.15, 0.05 * f64::from(i));
        let left = |i: i32| Point::new(0.05 * f64::from(i), 0.15);
        let points: Vec<Point> = (-8..8).map(wall).chain((-8..4).map(left)).collect();
        let mut drive = drive();
        for _ in 0..50 {
            let turn = drive.draw_turn(&points);
            assert!(drive.free_way(&points, turn) > AHEAD, "{turn}");
        }
        assert!(drive.step(Pose::new(f64::NAN, 0.0, 0.0), &points).is_err());
        let parameters = RandomDriveParameters { safe: 0.0, ..RandomDriveParameters::default() };
        assert!(RandomDrive::new(parameters, Stream::new(1)).is_err());
    }
}
