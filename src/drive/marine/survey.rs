use std::collections::VecDeque;
use std::f64::consts::PI;
use std::ops::ControlFlow;

use super::fix::Fix;
use super::floor_track::FloorTrack;
use super::helm::Helm;
use super::legs::{Legs, Steered, over_ground, steer_beside_walls};
use super::zero::Zero;
use super::{DepthHoldParameters, DiveObservation, Sounding, Thrust};
use crate::geometry::{Aabb, Point, Pose, Vector, math};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::reading::{check_distances, check_pose};
use crate::io::{DepthSensor, DistanceSensors, Error, Inertial, Odometry, Psd, Result};
use crate::parameter::{require, require_not_negative, require_positive};
use crate::world::{DriveSpec, RobotSpec, Water, Waves};

/// Parameters of [`Survey`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurveyParameters {
    /// Distance between two lanes (m).
    pub spacing: f64,
    /// Distance kept from the craft's centre to the border of the area, enough to turn on the spot (m).
    pub margin: f64,
    /// The same on lanes along the border (m). Less than `margin`, the first lanes lead once around the area.
    pub brim: f64,
    /// Depth of the pressure sensor (m); with an altitude, the least one.
    pub depth: f64,
    /// Altitude above the floor to hold, of the distance sensor that points down (m); `None` to hold the
    /// depth.
    pub altitude: Option<f64>,
    /// Speed on a lane (m/s).
    pub speed: f64,
    /// Density of the water, by which the depth sensor is zeroed afloat (kg/m³).
    pub density: f64,
    /// Waves on the surface, by which soundings are wrong.
    pub waves: Option<Waves>,
    /// Control period (s).
    pub period: f64,
    /// Parameters of the depth controller.
    pub hold: DepthHoldParameters,
}

impl Default for SurveyParameters {
    /// Lanes a metre apart, half a metre deep, at 0.6 m/s.
    fn default() -> Self {
        Self {
            spacing: 1.0,
            margin: 1.0,
            brim: 1.0,
            depth: 0.5,
            altitude: None,
            speed: 0.6,
            density: 1000.0,
            waves: None,
            period: 0.1,
            hold: DepthHoldParameters::default(),
        }
    }
}

/// Observation of a [`Survey`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SurveyObservation {
    /// Depth, attitude and turn rates.
    pub dive: DiveObservation,
    /// Pose by the log.
    pub odometry: Pose,
    /// Readings of the distance sensors ahead, to the left, to the right and behind (m).
    pub ranges: [f64; 4],
    /// Reading of the distance sensor that points down (m).
    pub down: f64,
}

/// Outcome of a [`Survey`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SurveyOutcome {
    /// All lanes are done.
    Covered,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(SurveyOutcome { Covered: "all lanes are done" });

/// Drives lanes over the floor of a pool or of open water, at a depth or at an altitude above the floor, with
/// a sounding at each step (book, section 8.5).
///
/// The position, with its covariance, comes from Doppler log and compass, corrected by the distances to the
/// four sides of a pool. Before diving, the depth sensor is zeroed by the craft's waterline. When the
/// position becomes uncertain, the craft leaves its lane for a place from which the nearer side can be
/// measured, and the next lane is one along which that is so. [`DepthMap`](super::DepthMap) makes a map of
/// the soundings.
///
/// ```
/// use roverlab::drive::marine::{DepthMap, Survey, SurveyOutcome, SurveyParameters};
/// use roverlab::geometry::{Aabb, Point, Pose};
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::world::{RobotSpec, Scene, World};
///
/// let area = Aabb::new(Point::origin(), Point::new(6.0, 5.0));
/// let pool = World { water_level: Some(2.0), ..World::walled(6.0, 5.0) };
/// let mako = RobotSpec { dvl: Some(10.0), ..RobotSpec::mako() };
/// let start = Pose::new(3.0, 2.5, 0.0);
/// let simulation = Simulation::new(&Scene::with_robot(pool, mako.clone(), start), SimOptions::with_noise(1.0, 1))?;
/// let mut survey = Survey::new(&mako, start, area, true, SurveyParameters::default())?;
/// let mut map = DepthMap::new(area, 1.0)?;
/// let outcome = run(&mut simulation.robot(0)?, &mut survey, 400.0, |_, survey, _| {
///     survey.sounding().into_iter().for_each(|sounding| map.add(sounding));
/// })?;
/// assert_eq!((outcome, simulation.truth().robot(0)?.contacts), (SurveyOutcome::Covered, 0));
/// assert!((map.cell(3, 2).expect("a depth").depth - 2.0).abs() < 0.03);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Survey {
    parameters: SurveyParameters,
    helm: Helm,
    fix: Fix,
    zero: Zero,
    /// What the sensor that looks down says of the floor, as a depth of that sensor at the floor.
    floor: FloorTrack,
    /// The lanes to come, and the range of the sensors to the sides (m).
    lanes: VecDeque<Lane>,
    sight: f64,
    legs: Legs,
    /// Whether it has gone to measure a side and is unsure still.
    has_looked: bool,
    /// The sensors around, in the craft's frame.
    around: [Pose; 4],
    /// Metres from the sensor that looks down up to the depth sensor, and ahead of the craft's origin.
    down: Point,
    sounding: Option<Sounding>,
    ready: bool,
}

/// Sensors that look around.
const AROUND: [Psd; 4] = [Psd::FRONT, Psd::LEFT, Psd::RIGHT, Psd::BACK];
/// Sensor that looks down.
const DOWN: Psd = Psd(6);
/// Deviation from the depth at which lanes begin (m).
const BEGIN: f64 = 0.1;
/// Distance from a waypoint at which it is reached (m).
const REACHED: f64 = 0.2;
/// The most lanes.
const MOST_LANES: f64 = 1e4;
/// Metres ahead at which the craft steers.
const LOOKAHEAD: f64 = 1.5;
/// Distance within the range of a sensor at which a side is certainly seen (m).
const WITHIN: f64 = 0.3;
/// Standard deviation of the place (m) at which a craft is unsure of it.
const UNSURE: f64 = 0.1;
/// The most tilt (rad) with which the sensor looks down.
const LEVEL: f64 = 0.15;

/// A lane: its waypoints, and how far it is from the nearer side along it (m).
#[derive(Debug, Clone)]
struct Lane {
    points: Vec<Point>,
    off: f64,
}

impl Survey {
    /// Creates a survey of an area by a craft with distance sensors to all sides and down, which starts at a
    /// pose. With `sides` the area ends at walls, by which the craft localises.
    ///
    /// Fails without these sensors, without room for a lane, and for parameters out of range.
    pub fn new(
        robot: &RobotSpec,
        start: Pose,
        area: Aabb,
        sides: bool,
        parameters: SurveyParameters,
    ) -> Result<Self> {
        let DriveSpec::Craft(craft) = &robot.drive else {
            return Err(Error::invalid_input("robot", &robot.name, "a craft"));
        };
        let SurveyParameters { spacing, margin, brim, depth, altitude, speed, density, waves, period, hold } =
            parameters;
        require_positive("spacing", spacing)?;
        require_not_negative("margin", margin)?;
        require_not_negative("brim", brim)?;
        Water { waves, ..Water::default() }.validate()?;
        require_not_negative("depth", depth)?;
        if let Some(altitude) = altitude {
            require_positive("altitude", altitude)?;
        }
        require_positive("speed", speed)?;
        require_positive("density", density)?;
        require_positive("period", period)?;
        let mount = |psd: Psd| {
            let spec = robot.psds.iter().find(|spec| spec.id == psd.0);
            spec.map(|spec| spec.mount).ok_or_else(|| Error::unsupported(psd))
        };
        let sensor = |psd: Psd| mount(psd).map(|mount| Pose::new(mount.x, mount.y, mount.yaw));
        let down = mount(DOWN)?;
        let up = robot.depth_sensor.ok_or_else(|| Error::unsupported("depth sensor"))?.z;
        let sights = robot.psds.iter().filter(|psd| [Psd::LEFT.0, Psd::RIGHT.0].contains(&psd.id));
        let sight = sights.map(|psd| psd.max_range).fold(f64::INFINITY, f64::min);
        Ok(Self {
            helm: Helm::new(craft, 0.8, period, hold)?,
            fix: Fix::new(start, sides.then_some(area)),
            zero: Zero::afloat(craft.waterline(density) - up),
            floor: FloorTrack::default(),
            lanes: lanes(&area, start.position(), spacing, [margin, brim])?,
            sight,
            legs: Legs::new(vec![start.position()], speed, LOOKAHEAD, REACHED),
            has_looked: false,
            around: [sensor(AROUND[0])?, sensor(AROUND[1])?, sensor(AROUND[2])?, sensor(AROUND[3])?],
            down: Point::new(down.x, up - down.z),
            sounding: None,
            ready: false,
            parameters,
        })
    }

    /// The sounding of the last step; `None` while the craft is tilted, and without an echo.
    pub fn sounding(&self) -> Option<Sounding> {
        self.sounding
    }

    /// Estimated pose in the pool's frame, and the standard deviations of the position along x and y (m).
    pub fn belief(&self) -> (Pose, Vector) {
        (self.fix.pose(), self.fix.sigma())
    }

    /// Whether it has come to its depth.
    pub(super) fn is_ready(&self) -> bool {
        self.ready
    }

    /// The depth to steer for, its speed and acceleration (m, m/s, m/s²): that of the parameters, or the
    /// floor's less the altitude where this is deeper.
    fn goal(&self) -> [f64; 3] {
        let SurveyParameters { depth, altitude, .. } = self.parameters;
        let above = altitude.and_then(|altitude| self.floor.above(altitude));
        above.filter(|[above, ..]| *above > depth).unwrap_or([depth, 0.0, 0.0])
    }

    /// Goes on to the next lane. A craft that has become unsure of its place takes the next one along which
    /// it can see a side.
    fn go_on(&mut self, place: Point) {
        let unsure = self.fix.sides().is_some() && self.fix.sigma().max() > UNSURE;
        let in_sight = |lane: &Lane| !unsure || lane.off < self.sight;
        let next = self.lanes.iter().position(in_sight).unwrap_or(0);
        if let Some(lane) = self.lanes.remove(next) {
            self.legs.extend(lane.from(place));
        }
    }

    /// Where an unsure craft finds out how far the sides along its lane are, if it does not see them now.
    fn lookout(&mut self, place: Point) -> Option<Point> {
        let (sides, way) = (self.fix.sides()?, self.legs.way().abs());
        let axis = usize::from(way.x > way.y);
        let is_unsure = self.fix.sigma()[axis] > UNSURE;
        let has_looked = std::mem::replace(&mut self.has_looked, is_unsure);
        let (low, high) = (sides.min[axis] + self.sight, sides.max[axis] - self.sight);
        if !is_unsure || has_looked || !(low..high).contains(&place[axis]) {
            return None;
        }
        let mut aside = place;
        aside[axis] = if place[axis] - low < high - place[axis] { low - WITHIN } else { high + WITHIN };
        Some(aside)
    }

    fn notice(&mut self, time: f64, seen: &SurveyObservation) -> Result<()> {
        self.helm.observe(time, &seen.dive)?;
        self.fix.advance(seen.odometry, self.helm.heading(), self.helm.seconds());
        for (sensor, &range) in self.around.iter().zip(&seen.ranges) {
            if range.is_finite() {
                self.fix.see(sensor, range);
            }
        }
        let pose = self.fix.pose();
        let tilt = seen.dive.attitude.pitch.abs().max(seen.dive.attitude.roll.abs());
        self.zero.read(time, seen.dive.depth);
        let has_echo = tilt < LEVEL && seen.down.is_finite();
        let upright = math::cos(seen.dive.attitude.pitch) * math::cos(seen.dive.attitude.roll);
        let echo = has_echo.then_some(seen.dive.depth + seen.down * upright);
        self.floor.see(echo, self.helm.seconds());
        let is_good = has_echo && self.zero.is_over();
        self.sounding = is_good.then(|| Sounding {
            place: pose.to_world(Point::new(self.down.x, 0.0)),
            depth: seen.dive.depth - self.zero.offset() + self.down.y + seen.down,
            sigma: self.fix.sigma(),
            datum: self.zero.sigma(),
            swell: self.parameters.waves.map_or(0.0, |waves| waves.deviation()),
            phase: self.parameters.waves.map_or(0.0, |waves| PI * self.helm.seconds() / waves.period),
        });
        self.ready |= (seen.dive.depth - self.goal()[0]).abs() < BEGIN;
        Ok(())
    }
}

/// The lanes of an area: along its longer side, from the corner nearest to a place on. Those along the border
/// are nearer to it than the corners where the craft turns, if there is a brim, and lead around.
fn lanes(area: &Aabb, start: Point, spacing: f64, [margin, brim]: [f64; 2]) -> Result<VecDeque<Lane>> {
    let [x, y]: [f64; 2] = area.size().into();
    let (long, short) = (x.max(y), x.min(y));
    if short <= 2.0 * margin {
        let found = format!("{x} x {y} m");
        return Err(Error::invalid_input("area", found, "room for a lane between its margins"));
    }
    // Between two corners where it turns, a craft needs room to come nearer to the side and to leave it.
    let brim = if short > 4.0 * margin { brim.min(margin) } else { margin };
    let count = ((short - 2.0 * brim) / spacing).ceil();
    require("number of lanes", count, count <= MOST_LANES, "at most 10000")?;
    let count = count as usize;
    let place = |along: f64, aside: f64| {
        area.min + if x >= y { Vector::new(along, aside) } else { Vector::new(aside, along) }
    };
    let lane = |index: usize| {
        let aside = brim + (short - 2.0 * brim) * index as f64 / count as f64;
        let points = vec![place(margin, aside), place(long - margin, aside)];
        Lane { points, off: aside.min(short - aside) }
    };
    let has_brim = brim < margin;
    let mut lanes: VecDeque<Lane> = (0..=count).map(lane).collect();
    if has_brim {
        lanes.pop_front();
        lanes.pop_back();
    }
    if let (Some(first), Some(last)) = (lanes.front(), lanes.back())
        && last.distance(start) < first.distance(start)
    {
        lanes = lanes.into_iter().rev().collect();
    }
    if has_brim {
        let far = (long - margin, short - margin);
        let corners = [(margin, margin), (far.0, margin), far, (margin, far.1)];
        let corners = corners.map(|(along, aside)| place(along, aside));
        let middle = place(0.5 * long, 0.5 * short);
        let side = |index: usize| {
            let [from, to] = [corners[index % 4], corners[(index + 1) % 4]];
            let along = (to - from).normalize();
            let out = from - middle;
            let out = (out - along * out.dot(&along)).normalize() * (margin - brim);
            let points = vec![from, from + along * margin + out, to - along * margin + out, to];
            Lane { points, off: brim }
        };
        let off = |index: &usize| (corners[*index] - start).norm();
        let nearest = (0..4).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
        (0..4).rev().for_each(|index| lanes.push_front(side(nearest + index)));
    }
    Ok(lanes)
}

impl Lane {
    /// Metres from a place to the nearer end.
    fn distance(&self, place: Point) -> f64 {
        let ends = [self.points.first(), self.points.last()];
        ends.iter().flatten().map(|end| (*end - place).norm()).fold(f64::INFINITY, f64::min)
    }

    /// Its waypoints, from the end nearer to a place on.
    fn from(mut self, place: Point) -> Vec<Point> {
        if let [first, .., last] = self.points[..]
            && (last - place).norm() < (first - place).norm()
        {
            self.points.reverse();
        }
        self.points
    }
}

impl Behaviour for Survey {
    type Observation = SurveyObservation;
    type Command = Thrust;
    type Outcome = SurveyOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, time: f64, seen: &SurveyObservation) -> Decision<Self> {
        seen.dive.check()?;
        check_pose(&seen.odometry)?;
        check_distances("observed distance", &seen.ranges)?;
        check_distances("distance to the floor", &[seen.down])?;
        self.notice(time, seen)?;
        let pose = self.fix.pose();
        self.legs.pass(pose.position());
        if self.legs.is_over() {
            self.go_on(pose.position());
        }
        if self.legs.is_over() {
            return Ok(ControlFlow::Break(SurveyOutcome::Covered));
        }
        if let Some(aside) = self.lookout(pose.position()) {
            self.legs.detour(pose.position(), aside);
        }
        if !self.zero.is_over() {
            return Ok(ControlFlow::Continue(Thrust::new(&[])?));
        }
        let velocity = self.fix.velocity();
        let wanted = self.legs.guide(pose.position(), self.helm.seconds());
        let Steered { turn, speed } = steer_beside_walls(&pose, over_ground(&pose, velocity), wanted);
        let push = self.helm.push(velocity.x, if self.ready { speed } else { 0.0 }, turn);
        Ok(ControlFlow::Continue(self.helm.thrust_along(self.goal(), push)?))
    }
}

impl<R: DepthSensor + Inertial + Odometry + DistanceSensors + ?Sized> Senses<R> for Survey {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut SurveyObservation) -> Result<()> {
        seen.dive.read(robot)?;
        seen.odometry = robot.pose()?;
        for (range, psd) in seen.ranges.iter_mut().zip(AROUND) {
            *range = robot.distance(psd)?;
        }
        seen.down = robot.distance(DOWN)?;
        Ok(())
    }
}
