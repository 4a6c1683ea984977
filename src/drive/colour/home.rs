use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::ControlFlow;

use super::observation::{ColourObservation, Sight};
use super::scan_memory::ScanMemory;
use super::steering::{Exempt, Steering, directions, nearest, obstacles};
use super::tracker::OBJECT;
use super::{ColourTracker, ColourTrackerParameters};
use crate::ParameterError;
use crate::geometry::{Point, Pose, Twist, Vector, angle_difference, direction, math, normalize_angle};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::{self, Camera, Lidar, Odometry, Resolution, StallDetector};
use crate::parameter::{require_finite, require_not_negative, require_positive};
use crate::scan::ScanMatcher;
use crate::vision::ColourFinder;

/// Parameters of [`PushHome`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PushHomeParameters {
    /// Search for the object and approach.
    pub tracker: ColourTrackerParameters,
    /// Distance from the object's centre at which the robot goes round it (m).
    pub round: f64,
    /// Pushing speed (m/s).
    pub push_speed: f64,
    /// Decay rate of an error in the pushing direction (1/s).
    pub correction: f64,
    /// Distance of the object's centre from home at which it has arrived (m).
    pub near: f64,
    /// Clearance kept beside robot and object while pushing (m).
    pub clearance: f64,
    /// Distance ahead of the object checked for obstacles (m).
    pub foresight: f64,
}

impl Default for PushHomeParameters {
    fn default() -> Self {
        // A larger gap than for reaching the object alone leaves room to go round it.
        let tracker = ColourTrackerParameters { gap: 0.14, ..ColourTrackerParameters::default() };
        Self {
            tracker,
            round: 0.24,
            push_speed: 0.10,
            correction: 1.0,
            near: 0.08,
            clearance: 0.05,
            foresight: 0.5,
        }
    }
}

impl PushHomeParameters {
    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        self.tracker.validate().map_err(|error| error.of("tracker"))?;
        require_positive("round", self.round)?;
        require_positive("push speed", self.push_speed)?;
        require_positive("correction", self.correction)?;
        require_positive("near", self.near)?;
        require_not_negative("clearance", self.clearance)?;
        require_not_negative("foresight", self.foresight)
    }
}

/// Phase of a [`PushHome`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HomePhase {
    /// Searching for the object and approaching it.
    Finding,
    /// Driving round to the far side.
    Rounding,
    /// Turning to the object.
    Turning,
    /// Pushing.
    Pushing,
}

/// Outcome of pushing an object home.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PushOutcome {
    /// The object is home.
    Home,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
    /// The drive stalled.
    Blocked,
}

/// Finds an object of a taught colour, drives round it and pushes it home (book, section 11.6).
///
/// A round robot turns a round object away as soon as it pushes off-centre. The lidar keeps the object
/// centred: with `r` the distance between both centres (m) and `e` the heading to the left of the line
/// between them, that line turns by `-v sin(e) / r` (rad/s). A direction error `d` therefore decays as `-k d`
/// if `sin(e) = r k d / v`.
///
/// Obstacles are avoided even while the object hides them: lidar points are remembered. Scan matching
/// localises the robot, since odometry drifts too far with so much turning and pushing.
///
/// ```
/// use roverlab::drive::colour::{PushHome, PushHomeParameters, PushOutcome};
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::vision::{CameraGeometry, ColourFinder, FindMethod};
/// use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, World};
/// let (mut world, robot) = (World::walled(3.0, 3.0), RobotSpec::s4());
/// let red = ObjectKind { colour: Colour::RED, mass: 0.4, ..ObjectKind::predefined("can").expect("a can") };
/// world.objects.push(Object::new(red.into(), Pose::new(1.6, 1.5, 0.0)));
/// let camera = CameraGeometry::from(robot.camera.as_ref().expect("a camera"));
/// let finder = ColourFinder::new(42, 10, FindMethod::Blob, camera)?;
/// let mut push = PushHome::new(finder, Point::origin(), PushHomeParameters::default())?;
/// let scene = Scene::with_robot(world, robot, Pose::new(0.5, 0.5, 0.8));
/// let simulation = Simulation::new(&scene, SimOptions { pushing: true, ..SimOptions::with_noise(1.0, 1) })?;
/// let outcome = run(&mut simulation.robot(0)?, &mut push, 240.0, |_, _, _| {})?;
/// assert_eq!(outcome, PushOutcome::Home, "the can is where the robot started");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct PushHome {
    parameters: PushHomeParameters,
    tracker: ColourTracker,
    home: Point,
    phase: HomePhase,
    /// Object's position in the initial odometry frame.
    object: Point,
    /// Distance from the object's centre to the surface the lidar meets (m).
    size: f64,
    lost: f64,
    memory: ScanMemory,
    /// Corrects odometry by matching scans.
    matcher: ScanMatcher,
    points: Vec<Point>,
}

impl PushHome {
    /// A behaviour that brings the object found by `finder` to `home`, a point in the odometry frame.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range, or the place not finite.
    pub fn new(
        finder: ColourFinder,
        home: Point,
        parameters: PushHomeParameters,
    ) -> Result<Self, ParameterError> {
        parameters.validate()?;
        home.coords.iter().try_for_each(|&metres| require_finite("home", metres))?;
        Ok(Self {
            parameters,
            tracker: ColourTracker::new(finder, parameters.tracker)?,
            home,
            phase: HomePhase::Finding,
            object: home,
            size: 0.03,
            lost: 0.0,
            memory: ScanMemory::default(),
            matcher: ScanMatcher::new(),
            points: Vec::new(),
        })
    }

    /// Current phase.
    pub fn phase(&self) -> HomePhase {
        self.phase
    }

    /// Estimated position of the object in the initial odometry frame, once it has been found.
    pub fn object(&self) -> Option<Point> {
        (self.phase != HomePhase::Finding).then_some(self.object)
    }

    /// The velocity for an observation; `None` when the object is home.
    pub(super) fn steer(&mut self, seen: &Sight<'_>) -> Result<Option<Twist>, crate::vision::ImageError> {
        let seen = &Sight { pose: self.localise(seen), ..*seen };
        if self.phase == HomePhase::Finding {
            let twist = self.tracker.steer(seen)?;
            let Some(target) = self.tracker.target().filter(|_| twist.is_none()) else { return Ok(twist) };
            (self.object, self.lost) = (target, 0.0);
            self.phase = HomePhase::Rounding;
        }
        if !self.look(seen) {
            self.phase = HomePhase::Finding;
            self.tracker = self.tracker.anew();
            return Ok(Some(Twist::STOP));
        }
        let exempt = Exempt { place: self.object, reach: OBJECT };
        self.memory.see(seen.scan, seen.pose, seen.time, exempt);
        if (self.object - self.home).norm() <= self.parameters.near {
            return Ok(None);
        }
        Ok(Some(match self.phase {
            HomePhase::Rounding => self.round(seen),
            HomePhase::Turning => self.turn(seen),
            _ => self.push(seen),
        }))
    }

    /// The robot's pose by odometry, corrected by the static surroundings.
    fn localise(&mut self, seen: &Sight<'_>) -> Pose {
        let place = self.matcher.corrected(seen.pose).to_local(self.object);
        let moves = (self.phase != HomePhase::Finding).then_some(Exempt { place, reach: OBJECT });
        obstacles(seen.scan, moves, &mut self.points);
        let pose = self.matcher.update(seen.pose, &self.points);
        self.matcher.learn(&self.points);
        pose
    }

    /// Locates the object by lidar. `false` when it has been missing for a second.
    fn look(&mut self, seen: &Sight<'_>) -> bool {
        let place = seen.pose.to_local(self.object);
        let bearing = math::atan2(place.y, place.x);
        let half = math::asin((0.06 / place.coords.norm()).min(1.0));
        // Noise may place a touching point at the robot's centre, which has no direction.
        let unit = |point: Point| point.coords.try_normalize(f64::MIN_POSITIVE);
        let cluster = |near: Point| {
            let points = seen.scan.points().filter(|point| (point - near).norm() < 0.05);
            let sum: Vector = points.filter_map(unit).sum();
            sum.try_normalize(f64::MIN_POSITIVE).map(|towards| (near.coords.norm(), towards))
        };
        let met = nearest(seen.scan, bearing, half.max(0.15)).filter(|met| (met - place).norm() < 0.12);
        match met.and_then(cluster) {
            Some((range, towards)) => {
                let middle = Point::origin() + towards * (range + self.size);
                self.object = seen.pose.to_world(middle);
                self.lost = 0.0;
            }
            None => self.lost += self.parameters.tracker.period,
        }
        self.lost <= 1.0
    }

    fn steering(&self) -> Steering {
        let ColourTrackerParameters { radius, margin, speed, turn_speed, .. } = self.parameters.tracker;
        Steering { radius, margin, speed, turn_speed }
    }

    /// Direction to push the object: home, or past obstacles with room for the robot behind it.
    fn direction_home(&mut self) -> f64 {
        let way = self.home - self.object;
        let straight = math::atan2(way.y, way.x);
        let margin = self.parameters.clearance;
        let steering = Steering { margin, ..self.steering() };
        self.memory.from(self.object, &mut self.points);
        let (ahead, behind) = (way.norm().min(self.parameters.foresight), self.parameters.round);
        let is_free = |angle: f64, reach| steering.free(&self.points, angle, reach) >= reach;
        let mut free =
            directions(straight).filter(|&angle| is_free(angle, ahead) && is_free(angle + PI, behind));
        free.next().unwrap_or(straight)
    }

    /// Goes round the object to the side opposite to the pushing direction.
    fn round(&mut self, seen: &Sight<'_>) -> Twist {
        let wanted = normalize_angle(self.direction_home() + PI);
        let mine = seen.pose.position() - self.object;
        let present = math::atan2(mine.y, mine.x);
        let left = angle_difference(wanted, present);
        if left.abs() < 0.12 && (mine.norm() - self.parameters.round).abs() < 0.06 {
            self.phase = HomePhase::Turning;
            return Twist::STOP;
        }
        let next = present + left.clamp(-0.5, 0.5);
        let place = seen.pose.to_local(self.object + direction(next) * self.parameters.round);
        let (distance, bearing) = (place.coords.norm(), math::atan2(place.y, place.x));
        obstacles(seen.scan, None, &mut self.points);
        match self.steering().way(&self.points, bearing, distance.clamp(0.02, 0.12)) {
            Some(way) => self.steering().towards(way, 0.5 * self.parameters.tracker.speed),
            None => Twist::new(0.0, 0.5),
        }
    }

    /// Turns to the object.
    fn turn(&mut self, seen: &Sight<'_>) -> Twist {
        let place = seen.pose.to_local(self.object);
        let bearing = math::atan2(place.y, place.x);
        if bearing.abs() < 0.05 {
            self.phase = HomePhase::Pushing;
        }
        let fastest = self.parameters.tracker.turn_speed;
        Twist::new(0.0, (3.0 * bearing).clamp(-fastest, fastest))
    }

    /// Drives up to the object and pushes it.
    fn push(&mut self, seen: &Sight<'_>) -> Twist {
        let PushHomeParameters { push_speed, correction, .. } = self.parameters;
        let place = seen.pose.to_local(self.object);
        let (distance, bearing) = (place.coords.norm(), math::atan2(place.y, place.x));
        let line = normalize_angle(seen.pose.heading + bearing);
        let wrong = angle_difference(line, self.direction_home());
        if wrong.abs() > 0.9 || bearing.abs() > FRAC_PI_2 {
            self.phase = HomePhase::Rounding;
            return Twist::new(-push_speed, 0.0);
        }
        let touching = distance < self.parameters.tracker.radius + self.size + 0.015;
        let wanted = if touching {
            -math::asin((distance * correction * wrong / push_speed).clamp(-0.55, 0.55))
        } else {
            0.0
        };
        let angular = (4.0 * (bearing - wanted)).clamp(-1.5, 1.5);
        Twist::new(push_speed * (1.0 - bearing.abs() / PI), angular)
    }
}

halts!(PushOutcome { Home: "the object is home", Blocked: "something holds the robot" });

impl Behaviour for PushHome {
    type Observation = ColourObservation;
    type Command = Twist;
    type Outcome = PushOutcome;

    fn period(&self) -> f64 {
        self.parameters.tracker.period
    }

    fn step(&mut self, time: f64, seen: &ColourObservation) -> Decision<Self> {
        seen.check()?;
        Ok(match self.steer(&seen.at(time)).map_err(io::Error::caused_by)? {
            _ if seen.stalled => ControlFlow::Break(PushOutcome::Blocked),
            Some(twist) => ControlFlow::Continue(twist),
            None => ControlFlow::Break(PushOutcome::Home),
        })
    }
}

impl<R: Camera + Odometry + StallDetector + Lidar + ?Sized> Senses<R> for PushHome {
    fn prepare(&mut self, robot: &mut R) -> io::Result<()> {
        robot.set_resolution(Resolution::Qqvga)
    }

    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut ColourObservation) -> io::Result<()> {
        seen.read(robot, self.phase == HomePhase::Finding)
    }
}
