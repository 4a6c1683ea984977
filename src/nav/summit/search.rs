use std::ops::ControlFlow;

use super::parameters::SummitParameters;
use super::reckoning::Reckoning;
use super::sight_map::{Chart, SightMap};
use super::sweep::Sweep;
use crate::geometry::{Point, Pose, Twist, angle_difference, direction, math};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::{Attitude, Error, Inertial, Lidar, LidarScan, LidarSettings, Odometry, Result};
use crate::nav::grid::{GridComponents, GridPlanner, GridSearch};
use crate::world::GridCell;

/// Drives to the highest place that it can reach, on hills that it does not know.
///
/// Where it stands, the robot looks around with its lidar at many tilts. What beams meet is mapped; what they pass over is no
/// higher than they are. While anything may be higher than the highest place that it has a safe way to, and may be reached,
/// it drives there, or to where it sees more; so it leaves local maxima behind. It drives only over ground that it has seen
/// and that its [`Climber`](crate::nav::elevation::Climber) allows. The first two looks, with half a turn between, show by how much
/// the inertial unit is wrong.
///
/// It ends on the highest place that can be reached; what is still unknown when the time is over tells
/// [`unknown_area`](SummitSearch::unknown_area).
///
/// ```
/// use roverlab::geometry::{Aabb, Point, Pose};
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::nav::{SummitOutcome, SummitParameters, SummitSearch};
/// use roverlab::world::{HeightField, RobotSpec, Scene, Terrain, World};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let area = Aabb::new(Point::origin(), Point::new(3.0, 3.0));
/// let hill = HeightField::from_fn(61, 61, area, |at| 0.2 * (-2.0 * (at - Point::new(1.9, 1.7)).norm_squared()).exp())?;
/// let world = World { terrain: Some(Terrain::new("hill.png", hill)), ..World::empty(3.0, 3.0) };
/// let spec = RobotSpec::blizzard();
/// let parameters = SummitParameters::of(&spec).expect("it has a lidar");
/// let simulation = Simulation::new(&Scene::with_robot(world, spec, Pose::new(0.6, 0.6, 0.0)), SimOptions::default())?;
/// let mut search = SummitSearch::new(parameters)?;
/// let outcome = run(&mut simulation.robot(0)?, &mut search, 300.0, |_, _, _| {})?;
/// assert_eq!(outcome, SummitOutcome::Highest);
/// assert!(simulation.truth().pose(0)?.distance_to(Point::new(1.9, 1.7)) < 0.2);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct SummitSearch {
    parameters: SummitParameters,
    reckoning: Reckoning,
    map: SightMap,
    state: State,
    looks: u32,
    /// The normal of the ground around by the first look.
    first_plane: Option<Attitude>,
    unknown: usize,
    highest: f64,
}

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SummitOutcome {
    /// On the highest place that can be reached: nothing else may be higher.
    Highest,
    /// It cannot stand where it is, or does not get on.
    Stuck,
    /// The time was over.
    TimedOut,
    /// Who watched has seen enough.
    Stopped,
}

halts!(SummitOutcome {
    Highest: "on the highest place that can be reached",
    Stuck: "the robot does not get on",
});

/// What a search is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SummitPhase {
    /// Coming to rest, and looking around.
    Looking,
    /// Turning to where it looks again.
    Turning,
    /// Driving.
    Driving,
}

#[derive(Debug, Clone)]
enum State {
    Settling { until: Option<f64> },
    Looking(Sweep),
    Turning { to: f64 },
    Driving(Drive),
    BackingOff { from: Point },
}

#[derive(Debug, Clone)]
struct Drive {
    way: Vec<Point>,
    /// The point that was passed last.
    passed: usize,
    /// The least distance to the end so far, and since when.
    nearest: (f64, f64),
}

/// What a [`SummitSearch`] sees at a step.
#[derive(Debug, Clone, Default)]
pub struct SummitObservation {
    /// Where odometry takes the robot to be.
    pub odometry: Pose,
    /// How it is turned.
    pub attitude: Attitude,
    /// A scan, while it looks around.
    pub scan: LidarScan,
}

/// Seconds in which the robot comes to rest.
const REST: f64 = 0.6;
/// Metres ahead on its way that the robot steers to.
const AHEAD: f64 = 0.18;
/// Metres to the end of a way at which it has arrived.
const ARRIVED: f64 = 0.04;
/// Radians beyond which it turns on the spot.
const ASIDE: f64 = 0.5;
/// Radians by which a half turn may be missed.
const ALIGNED: f64 = 0.1;
/// Seconds without getting nearer after which it does not get on.
const PATIENCE: f64 = 8.0;
/// Radians above the slope limit at which it backs off.
const TOO_STEEP: f64 = 0.1;
/// Metres that it backs off.
const BACK: f64 = 0.15;
/// Metres within which what was measured before is compared with a look.
const NEAR: f64 = 1.5;
/// The fewest comparisons that count.
const ENOUGH: usize = 60;
/// Metres that a way has to lead on for the robot to drive it.
const LEAST_WAY: f64 = 0.1;
/// Metres around a place at which a way ends, of which another look from there shows no more.
const LOST_SIGHT: f64 = 0.15;
/// The most looks of a search.
const MOST_LOOKS: u32 = 400;

impl SummitSearch {
    /// A search that begins where the robot stands.
    pub fn new(parameters: SummitParameters) -> Result<Self> {
        parameters.validate()?;
        Ok(Self {
            map: SightMap::new(parameters.resolution, parameters.extent),
            parameters,
            reckoning: Reckoning::default(),
            state: State::Settling { until: None },
            looks: 0,
            first_plane: None,
            unknown: 0,
            highest: 0.0,
        })
    }

    /// What it is doing.
    pub fn phase(&self) -> SummitPhase {
        match self.state {
            State::Settling { .. } | State::Looking(_) => SummitPhase::Looking,
            State::Turning { .. } => SummitPhase::Turning,
            State::Driving(_) | State::BackingOff { .. } => SummitPhase::Driving,
        }
    }

    /// Where the robot takes itself to be, from its start, and how far above it.
    pub fn pose(&self) -> (Pose, f64) {
        (self.reckoning.pose, self.reckoning.elevation)
    }

    /// How often it has looked around.
    pub fn looks(&self) -> u32 {
        self.looks
    }

    /// Metres above the start of the highest place to which it knows a way.
    pub fn highest(&self) -> f64 {
        self.highest
    }

    /// The square metres that may be higher and may be reached, for all that it knows.
    pub fn unknown_area(&self) -> f64 {
        self.unknown as f64 * self.parameters.resolution * self.parameters.resolution
    }

    /// The way that it drives, from its start.
    pub fn way(&self) -> &[Point] {
        match &self.state {
            State::Driving(drive) => &drive.way,
            _ => &[],
        }
    }

    fn settle(&mut self) -> Twist {
        self.state = State::Settling { until: None };
        Twist::STOP
    }

    /// Takes in a complete look, and decides where to go.
    fn understand(&mut self, time: f64, sweep: &Sweep) -> ControlFlow<SummitOutcome, Twist> {
        self.looks += 1;
        if self.looks == 1 {
            self.first_plane = self.by_plane(sweep);
            let to = self.reckoning.pose.heading + std::f64::consts::PI;
            self.state = State::Turning { to };
            return ControlFlow::Continue(Twist::STOP);
        }
        if self.looks == 2 {
            self.calibrate(sweep);
        }
        self.take_in(sweep);
        if self.looks > MOST_LOOKS {
            return ControlFlow::Break(SummitOutcome::Stuck);
        }
        self.decide(time)
    }

    /// Roll and pitch that the plane of the ground around has by the inertial unit.
    fn by_plane(&self, sweep: &Sweep) -> Option<Attitude> {
        let normal = sweep.plane(&self.parameters.lidar, NEAR)?;
        let level = Attitude { yaw: 0.0, ..sweep.attitude() }.frame().rotate(normal);
        // The slope of the ground along the robot's heading and to its left.
        Some(Attitude { pitch: level.x / level.z, roll: level.y / level.z, yaw: self.reckoning.pose.heading })
    }

    /// Seen the other way round, the ground is as steep; what is not is the unit's error.
    fn calibrate(&mut self, sweep: &Sweep) {
        let (Some(first), Some(second)) = (self.first_plane, self.by_plane(sweep)) else { return };
        // The first one's slope in the second one's axes.
        let (sin, cos) = math::sin_cos(angle_difference(second.yaw, first.yaw));
        let turned = [cos * first.pitch + sin * first.roll, cos * first.roll - sin * first.pitch];
        let off = [second.pitch - turned[0], second.roll - turned[1]];
        // An error of the pitch p shows as p along the heading, whichever way that is: once as itself, once turned away. The two
        // equations (1 - R) e = off.
        let (a, b) = (1.0 - cos, -sin);
        let square = a * a + b * b;
        let along = (a * off[0] - b * off[1]) / square;
        let left = (b * off[0] + a * off[1]) / square;
        self.reckoning.bias = [-left, along];
    }

    fn take_in(&mut self, sweep: &Sweep) {
        let lidar = self.parameters.lidar;
        let attitude = sweep.attitude();
        let robot = self.reckoning.in_space(attitude);
        let mut off = Vec::new();
        for fan in sweep.fans(&robot, &lidar) {
            self.map.differences(fan, NEAR, &mut off);
        }
        if off.len() >= ENOUGH {
            off.sort_by(f64::total_cmp);
            self.reckoning.elevation += off[off.len() / 2];
        }
        let robot = self.reckoning.in_space(attitude);
        for fan in sweep.fans(&robot, &lidar) {
            self.map.add_fan(fan);
        }
        self.map.stand(self.reckoning.pose.position(), self.reckoning.elevation);
    }

    fn decide(&mut self, time: f64) -> ControlFlow<SummitOutcome, Twist> {
        let lowest = self.parameters.lowest.unwrap_or(f64::NEG_INFINITY);
        let mut chart = self.map.chart(&self.parameters.climber, lowest);
        let here = self.reckoning.pose.position();
        let Some(start) = self.footing(&mut chart, here) else {
            return ControlFlow::Break(SummitOutcome::Stuck);
        };
        loop {
            let top = self.top(&chart, start);
            let level = self.height(top);
            self.highest = level;
            let higher = self.map.higher(&chart, start, level + self.parameters.tolerance);
            self.unknown = higher.len();
            // The view is better from above.
            let climbs = level > self.reckoning.elevation + 4.0 * self.parameters.tolerance;
            if climbs || higher.is_empty() {
                let way = self.way_over(&chart.safe, &chart, start, top);
                let near = way.as_ref().is_none_or(|way| length(way) <= 1.5 * self.parameters.resolution);
                if near && higher.is_empty() {
                    return ControlFlow::Break(SummitOutcome::Highest);
                }
                if let Some(way) = way.filter(|_| !near) {
                    return ControlFlow::Continue(self.drive(time, &way, !higher.is_empty()));
                }
            }
            let nearest = |a: &&GridCell, b: &&GridCell| {
                let away = |cell: &GridCell| (self.map.place(*cell) - here).norm_squared();
                away(a).total_cmp(&away(b))
            };
            let Some(&target) = higher.iter().min_by(nearest) else {
                return ControlFlow::Break(SummitOutcome::Highest);
            };
            let Some(way) = self.way_over(&chart.perhaps, &chart, start, target) else {
                return ControlFlow::Break(SummitOutcome::Stuck);
            };
            let known = self.known_part(&chart, &way);
            if length(known) > LEAST_WAY {
                return ControlFlow::Continue(self.drive(time, known, true));
            }
            // It has looked from here, and does not see that it could go on: nor will it.
            let beyond = way[known.len().min(way.len() - 1)];
            self.map.shun(beyond, LOST_SIGHT);
            chart = self.map.chart(&self.parameters.climber, lowest);
            if self.footing(&mut chart, here).is_none() {
                return ControlFlow::Break(SummitOutcome::Stuck);
            }
        }
    }

    /// The cell on which the robot stands, or the nearest one from which it can drive; where it stands counts as safe.
    fn footing(&self, chart: &mut Chart, here: Point) -> Option<GridCell> {
        let cell = self.map.cell_at(here)?;
        if chart.safe.is_free(cell) {
            return Some(cell);
        }
        let reach = (0.3 / self.parameters.resolution) as isize;
        let mut free = Vec::new();
        for (dx, dy) in (-reach..=reach).flat_map(|dx| (-reach..=reach).map(move |dy| (dx, dy))) {
            let near = GridCell::new(cell.column.wrapping_add_signed(dx), cell.row.wrapping_add_signed(dy));
            if chart.safe.is_free(near) {
                free.push((dx * dx + dy * dy, near));
            }
        }
        let nearest = free.into_iter().min_by_key(|&(square, near)| (square, near.row, near.column))?.1;
        // A bridge to it.
        let steps = nearest.column.abs_diff(cell.column).max(nearest.row.abs_diff(cell.row)).max(1);
        for step in 0..=4 * steps {
            let share = step as f64 / (4 * steps) as f64;
            let at = |from: usize, to: usize| (from as f64 + (to as f64 - from as f64) * share).round() as usize;
            for row in [at(cell.row, nearest.row), at(cell.row, nearest.row) + 1] {
                let near = GridCell::new(at(cell.column, nearest.column), row);
                if chart.safe.contains(near) {
                    chart.safe.set_free(near, true);
                    chart.perhaps.set_free(near, true);
                }
            }
        }
        Some(cell)
    }

    fn height(&self, cell: GridCell) -> f64 {
        self.map.height(self.map.index_of(cell)).unwrap_or(f64::NEG_INFINITY)
    }

    /// The highest cell to which a safe way leads.
    fn top(&self, chart: &Chart, start: GridCell) -> GridCell {
        let safe = GridComponents::new(&chart.safe);
        let reached = chart.safe.free_cells().filter(|&cell| safe.connected(start, cell));
        reached.max_by(|&a, &b| self.height(a).total_cmp(&self.height(b))).unwrap_or(start)
    }

    fn way_over(
        &self,
        free: &crate::world::BitGrid,
        chart: &Chart,
        start: GridCell,
        goal: GridCell,
    ) -> Option<Vec<Point>> {
        let costs = crate::nav::elevation::GroundCosts::new(chart.elevation.field(), OBJECTIVE);
        let path = GridSearch::astar_by(free, costs).plan(start, goal).ok()?;
        let cells = path.points.iter().filter_map(|&point| GridCell::at(point));
        Some(cells.map(|cell| self.map.place(cell)).collect())
    }

    /// The part of a way that leads over safe ground, no longer than a stride.
    fn known_part<'w>(&self, chart: &Chart, way: &'w [Point]) -> &'w [Point] {
        let is_safe = |point: &Point| self.map.cell_at(*point).is_some_and(|cell| chart.safe.is_free(cell));
        let known = way.iter().take_while(|point| is_safe(point)).count();
        cut(&way[..known], self.parameters.stride)
    }

    fn drive(&mut self, time: f64, way: &[Point], looks: bool) -> Twist {
        // On its way up a robot looks around as well, but not at the end of a search.
        let way = if looks { cut(way, 2.0 * self.parameters.stride) } else { way }.to_vec();
        self.state = State::Driving(Drive { way, passed: 0, nearest: (f64::INFINITY, time) });
        Twist::STOP
    }

    /// The next speed along a way; `None` at its end, or where the robot does not get on.
    fn follow(&mut self, time: f64, attitude: Attitude) -> Option<Twist> {
        let pose = self.reckoning.pose;
        let turned = self.reckoning.corrected(attitude);
        let State::Driving(drive) = &mut self.state else { return None };
        let end = *drive.way.last()?;
        let rest = pose.distance_to(end);
        if rest < ARRIVED {
            return None;
        }
        if rest < drive.nearest.0 - 0.02 {
            drive.nearest = (rest, time);
        }
        let too_steep = turned.frame().tilt() > self.parameters.climber.slope + TOO_STEEP;
        let lost = time - drive.nearest.1 > PATIENCE + 4.0 * length(&drive.way) / self.parameters.speed;
        if too_steep || lost {
            let ahead = pose.position() + direction(pose.heading) * AHEAD;
            self.map.shun(ahead, 0.1);
            self.state = State::BackingOff { from: pose.position() };
            return Some(Twist::STOP);
        }
        while drive.passed + 1 < drive.way.len() && pose.distance_to(drive.way[drive.passed]) < AHEAD {
            drive.passed += 1;
        }
        let bearing = angle_difference(pose.bearing_to(drive.way[drive.passed]), 0.0);
        let SummitParameters { speed, turn_rate, .. } = self.parameters;
        let turn = (2.0 * bearing).clamp(-turn_rate, turn_rate);
        let fast = speed.min(0.03 + 0.8 * rest);
        Some(if bearing.abs() > ASIDE { Twist::new(0.0, turn) } else { Twist::new(fast * math::cos(bearing), turn) })
    }
}

/// What ways are to cost little of: climbing costs as much as ten times the way.
const OBJECTIVE: crate::nav::elevation::Objective = crate::nav::elevation::Objective::Energy { resistance: 0.5 };

fn length(way: &[Point]) -> f64 {
    way.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
}

/// The beginning of a way.
fn cut(way: &[Point], most: f64) -> &[Point] {
    let mut left = most;
    let steps = way.windows(2).take_while(|pair| {
        left -= (pair[1] - pair[0]).norm();
        left > 0.0
    });
    let points = steps.count() + 1;
    &way[..points.min(way.len())]
}

impl Behaviour for SummitSearch {
    type Observation = SummitObservation;
    type Command = Twist;
    type Outcome = SummitOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, time: f64, seen: &SummitObservation) -> Decision<Self> {
        let finite = [seen.attitude.roll, seen.attitude.pitch, seen.attitude.yaw].iter().all(|a| a.is_finite());
        if !seen.odometry.is_finite() || !finite {
            let found = format!("{:?} {:?}", seen.odometry, seen.attitude);
            return Err(Error::invalid_input("observed pose", found, "finite numbers"));
        }
        self.reckoning.update(seen.odometry, seen.attitude);
        let go_on = |twist| Ok(ControlFlow::Continue(twist));
        match &mut self.state {
            State::Settling { until } => {
                let until = *until.get_or_insert(time + REST);
                if time >= until {
                    self.state = State::Looking(Sweep::default());
                }
                go_on(Twist::STOP)
            }
            State::Looking(sweep) => {
                sweep.add(&self.parameters.lidar, &seen.scan, seen.attitude);
                if sweep.next_tilt().is_some() {
                    return go_on(Twist::STOP);
                }
                let sweep = std::mem::take(sweep);
                Ok(self.understand(time, &sweep))
            }
            State::Turning { to } => {
                let rest = angle_difference(*to, self.reckoning.pose.heading);
                if rest.abs() < ALIGNED {
                    return go_on(self.settle());
                }
                let rate = self.parameters.turn_rate;
                go_on(Twist::new(0.0, (2.0 * rest).clamp(-rate, rate)))
            }
            State::Driving(_) => {
                let next = self.follow(time, seen.attitude);
                let twist = next.unwrap_or_else(|| self.settle());
                go_on(twist)
            }
            State::BackingOff { from } => {
                if self.reckoning.pose.distance_to(*from) > BACK {
                    return go_on(self.settle());
                }
                go_on(Twist::new(-0.5 * self.parameters.speed, 0.0))
            }
        }
    }
}

impl<R: Odometry + Lidar + Inertial + ?Sized> Senses<R> for SummitSearch {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut SummitObservation) -> Result<()> {
        seen.odometry = robot.pose()?;
        seen.attitude = robot.attitude()?;
        if let State::Looking(sweep) = &self.state
            && let Some(tilt) = sweep.next_tilt()
        {
            let settings = LidarSettings { field_of_view: std::f64::consts::TAU, tilt, points: BEAMS };
            robot.configure_lidar(settings)?;
            robot.scan_into(&mut seen.scan)?;
        }
        Ok(())
    }
}

/// Beams of a scan.
const BEAMS: usize = 180;
