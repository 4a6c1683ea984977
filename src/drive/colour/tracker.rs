use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use super::observation::{ColourObservation, Sight};
use super::steering::{Exempt, Steering, nearest, obstacles};
use crate::ParameterError;
use crate::geometry::{Point, Twist, angle_difference, math};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::{self, Camera, Lidar, LidarScan, Odometry, Resolution, StallDetector};
use crate::parameter::{require_not_negative, require_positive};
use crate::vision::{ColourFinder, Sighting};

/// Parameters of [`ColourTracker`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourTrackerParameters {
    /// Driving speed (m/s).
    pub speed: f64,
    /// Turn rate (rad/s).
    pub turn_speed: f64,
    /// Radius of the robot (m).
    pub radius: f64,
    /// Clearance kept beside the robot (m).
    pub margin: f64,
    /// Distance between the robot's rim and the object on arrival (m).
    pub gap: f64,
    /// Time for which the robot keeps driving to an object out of sight (s).
    pub memory: f64,
    /// Distance driven to search from another place (m).
    pub leg: f64,
    /// Control period (s).
    pub period: f64,
}

impl Default for ColourTrackerParameters {
    fn default() -> Self {
        Self {
            speed: 0.25,
            turn_speed: 1.2,
            radius: 0.060,
            margin: 0.025,
            gap: 0.05,
            memory: 4.0,
            leg: 0.8,
            period: 0.1,
        }
    }
}

impl ColourTrackerParameters {
    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("speed", self.speed)?;
        require_positive("turn speed", self.turn_speed)?;
        require_positive("radius", self.radius)?;
        require_not_negative("margin", self.margin)?;
        require_not_negative("gap", self.gap)?;
        require_not_negative("memory", self.memory)?;
        require_positive("leg", self.leg)?;
        require_positive("control period", self.period)
    }
}

/// Phase of a [`ColourTracker`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColourPhase {
    /// Turning on the spot in search of the colour.
    Searching,
    /// Driving elsewhere to search from there.
    Roaming,
    /// Driving to the object.
    Approaching,
}

/// Outcome of driving to a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColourOutcome {
    /// The robot stands in front of the object.
    Reached,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
    /// The drive stalled.
    Blocked,
}

/// Drives to an object of a taught colour, and searches for it while it is out of sight (book, Programs 11.9
/// to 11.11).
///
/// The camera finds the object; the lidar measures its distance and keeps the robot away from everything
/// else. If the object is hidden, the robot drives on to its last position. If it is nowhere in sight, the
/// robot turns once and then searches from the freest place not yet visited.
///
/// ```
/// use roverlab::drive::colour::{ColourOutcome, ColourTracker, ColourTrackerParameters};
/// use roverlab::geometry::Pose;
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::vision::{CameraGeometry, ColourFinder, FindMethod};
/// use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, World};
/// let (mut world, robot) = (World::walled(2.0, 2.0), RobotSpec::s4());
/// let red = ObjectKind { colour: Colour::RED, ..ObjectKind::predefined("can").expect("a can") };
/// world.objects.push(Object::new(red.into(), Pose::new(1.5, 1.2, 0.0)));
/// let camera = CameraGeometry::from(robot.camera.as_ref().expect("a camera"));
/// let finder = ColourFinder::new(42, 10, FindMethod::Blob, camera)?;
/// let mut tracker = ColourTracker::new(finder, ColourTrackerParameters::default())?;
/// let scene = Scene::with_robot(world, robot, Pose::new(0.4, 0.4, 2.0));
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let outcome = run(&mut simulation.robot(0)?, &mut tracker, 60.0, |_, _, _| {})?;
/// assert_eq!((outcome, simulation.truth().robot(0)?.contacts), (ColourOutcome::Reached, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ColourTracker {
    finder: ColourFinder,
    parameters: ColourTrackerParameters,
    phase: ColourPhase,
    /// Object's position in the odometry frame, and the time it was last seen (s).
    target: Option<(Point, f64)>,
    sighting: Option<Sighting>,
    /// Angle turned in this search (rad), and the heading at the previous step.
    turned: f64,
    heading: Option<f64>,
    /// Places searched from, and the next one.
    places: Vec<Point>,
    goal: Option<Point>,
    leg_start: f64,
    points: Vec<Point>,
}

/// Radius around an object's position within which lidar points belong to it (m).
pub(super) const OBJECT: f64 = 0.09;

impl ColourTracker {
    /// Creates a tracker that begins with a search. Fails with the name of the parameter that is out of
    /// range.
    pub fn new(finder: ColourFinder, parameters: ColourTrackerParameters) -> Result<Self, ParameterError> {
        parameters.validate()?;
        Ok(Self::searching(finder, parameters))
    }

    fn searching(finder: ColourFinder, parameters: ColourTrackerParameters) -> Self {
        Self {
            finder,
            parameters,
            phase: ColourPhase::Searching,
            target: None,
            sighting: None,
            turned: 0.0,
            heading: None,
            places: Vec::new(),
            goal: None,
            leg_start: 0.0,
            points: Vec::new(),
        }
    }

    /// The same tracker before its first search.
    #[must_use]
    pub(super) fn anew(&self) -> Self {
        Self::searching(self.finder.clone(), self.parameters)
    }

    /// Current phase.
    pub fn phase(&self) -> ColourPhase {
        self.phase
    }

    /// Object's position in the last image.
    pub fn sighting(&self) -> Option<Sighting> {
        self.sighting
    }

    /// Estimated position of the object in the odometry frame.
    pub fn target(&self) -> Option<Point> {
        self.target.map(|(place, _)| place)
    }

    /// The velocity for an observation; `None` when the object is reached.
    pub(super) fn steer(&mut self, seen: &Sight<'_>) -> Result<Option<Twist>, crate::vision::ImageError> {
        self.sighting = self.finder.find(seen.image)?;
        if let Some(sighting) = self.sighting {
            let place = self.place_of(&sighting, seen.scan);
            self.target = Some((seen.pose.to_world(place), seen.time));
            self.phase = ColourPhase::Approaching;
        }
        Ok(match (self.phase, self.target) {
            (ColourPhase::Approaching, Some((target, last))) => self.approach(seen, target, last),
            (ColourPhase::Roaming, _) => Some(self.roam(seen)),
            _ => Some(self.search(seen)),
        })
    }

    /// Position of a detection in the robot's frame, from its foot on the floor or from the lidar.
    fn place_of(&self, sighting: &Sighting, scan: &LidarScan) -> Point {
        let camera = self.finder.camera;
        if let Some(place) = sighting.place
            && place.coords.norm() < 2.5
        {
            // The lidar's distance is more accurate if it meets the same object.
            let bearing = math::atan2(place.y, place.x);
            let met = nearest(scan, bearing, 0.06);
            return met.filter(|met| (met - place).norm() < 0.3 * place.coords.norm()).unwrap_or(place);
        }
        let met = nearest(scan, sighting.bearing, 0.05).map_or(3.0, |met| met.coords.norm());
        let depth = (met - camera.ahead).max(0.01);
        let (sin, cos) = math::sin_cos(sighting.bearing);
        Point::new(camera.ahead + depth * cos, depth * sin)
    }

    fn approach(&mut self, seen: &Sight<'_>, target: Point, last: f64) -> Option<Twist> {
        let p = self.parameters;
        let place = seen.pose.to_local(target);
        let (distance, bearing) = (place.coords.norm(), math::atan2(place.y, place.x));
        let unseen = seen.time - last;
        // An object that should be in view but is not seen is gone.
        let in_view = bearing.abs() < 0.4 * self.finder.camera.field_of_view;
        if unseen > p.memory || (in_view && unseen > 0.8) {
            self.begin_search();
            return Some(self.search(seen));
        }
        let gap = nearest(seen.scan, bearing, 0.15).map_or(f64::INFINITY, |met| met.coords.norm()) - p.radius;
        let is_near = self.sighting.is_some_and(|s| s.at_the_bottom || s.place.is_some_and(|p| p.x < 0.3));
        if is_near && gap <= p.gap && bearing.abs() < 0.25 {
            return None;
        }
        let steering = self.steering();
        let exempt = Exempt { place, reach: OBJECT };
        obstacles(seen.scan, Some(exempt), &mut self.points);
        let reach = (distance - p.radius - p.gap).clamp(0.02, 0.5);
        let Some(way) = steering.way(&self.points, bearing, reach) else {
            return Some(Twist::new(0.0, p.turn_speed));
        };
        let straight = (way - bearing).abs() < 1e-9;
        let fastest = if straight { 0.03 + 1.2 * (gap - 0.8 * p.gap).max(0.0) } else { p.speed };
        Some(steering.towards(way, fastest))
    }

    fn steering(&self) -> Steering {
        let ColourTrackerParameters { radius, margin, speed, turn_speed, .. } = self.parameters;
        Steering { radius, margin, speed, turn_speed }
    }

    fn begin_search(&mut self) {
        self.phase = ColourPhase::Searching;
        (self.turned, self.heading, self.target) = (0.0, None, None);
    }

    /// Turns on the spot, and chooses another place after a full turn.
    fn search(&mut self, seen: &Sight<'_>) -> Twist {
        let heading = seen.pose.heading;
        self.turned += self.heading.map_or(0.0, |before| angle_difference(heading, before).abs());
        self.heading = Some(heading);
        if self.turned < TAU + 0.2 {
            // Slower than elsewhere, so that the images cover every direction often enough.
            return Twist::new(0.0, 0.8 * self.parameters.turn_speed);
        }
        self.places.push(seen.pose.position());
        self.phase = ColourPhase::Roaming;
        self.leg_start = seen.time;
        self.goal = Some(self.freest(seen));
        self.roam(seen)
    }

    /// The end of the longest free way, with a preference for places far from those already searched.
    fn freest(&mut self, seen: &Sight<'_>) -> Point {
        obstacles(seen.scan, None, &mut self.points);
        let steering = self.steering();
        let ends = (0..24).map(|i| {
            let angle = f64::from(i) * (TAU / 24.0);
            let free = steering.free(&self.points, angle, self.parameters.leg);
            let end = seen.pose.to_world(Point::origin() + crate::geometry::direction(angle) * free);
            let away = |place: &Point| (end - place).norm();
            let news = self.places.iter().map(away).fold(f64::INFINITY, f64::min);
            (end, free + 2.0 * news.min(2.0 * self.parameters.leg))
        });
        let best = ends.max_by(|a, b| a.1.total_cmp(&b.1));
        best.map_or(seen.pose.position(), |(end, _)| end)
    }

    fn roam(&mut self, seen: &Sight<'_>) -> Twist {
        let place = self.goal.map_or(Point::origin(), |goal| seen.pose.to_local(goal));
        let (distance, bearing) = (place.coords.norm(), math::atan2(place.y, place.x));
        obstacles(seen.scan, None, &mut self.points);
        let steering = self.steering();
        let way = steering.way(&self.points, bearing, distance.clamp(0.02, 0.3));
        let slow = seen.time - self.leg_start > 4.0 * self.parameters.leg / self.parameters.speed + 4.0;
        match way {
            Some(way) if distance > 0.05 && !slow && (way - bearing).abs() < 0.5 * PI => {
                steering.towards(way, self.parameters.speed)
            }
            _ => {
                self.begin_search();
                Twist::STOP
            }
        }
    }
}

halts!(ColourOutcome { Reached: "the object is reached", Blocked: "something holds the robot" });

impl Behaviour for ColourTracker {
    type Observation = ColourObservation;
    type Command = Twist;
    type Outcome = ColourOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, time: f64, seen: &ColourObservation) -> Decision<Self> {
        seen.check()?;
        Ok(match self.steer(&seen.at(time)).map_err(io::Error::caused_by)? {
            _ if seen.stalled => ControlFlow::Break(ColourOutcome::Blocked),
            Some(twist) => ControlFlow::Continue(twist),
            None => ControlFlow::Break(ColourOutcome::Reached),
        })
    }
}

impl<R: Camera + Odometry + StallDetector + Lidar + ?Sized> Senses<R> for ColourTracker {
    fn prepare(&mut self, robot: &mut R) -> io::Result<()> {
        robot.set_resolution(Resolution::Qqvga)
    }

    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut ColourObservation) -> io::Result<()> {
        seen.read(robot, true)
    }
}
