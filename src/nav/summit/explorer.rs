use std::ops::ControlFlow;

use super::align::{Shift, align};
use super::chart::Chart;
use super::drive::{Drive, Step, cut};
use super::parameters::SummitParameters;
use super::reckoning::Reckoning;
use super::sight_map::{MIN_UPRIGHT, SightMap};
use super::straight::Straight;
use super::sweep::Sweep;
use crate::geometry::{Point, Point3, Pose, Twist, Vector, angle_difference, direction, math};
use crate::io::reading::{check_attitude, check_pose, check_scan};
use crate::io::{Attitude, Inertial, Lidar, LidarScan, LidarSettings, Odometry, Result};
use crate::nav::elevation::{GroundCosts, Objective};
use crate::nav::grid::{GridPlanner, GridSearch, StepCosts};
use crate::world::{BitGrid, GridCell};

/// Looks around, maps the ground, and drives ways: what all behaviours on unknown hills have in common. After
/// each look, the behaviour decides where to drive.
#[derive(Debug, Clone)]
pub(super) struct Explorer {
    pub(super) parameters: SummitParameters,
    pub(super) reckoning: Reckoning,
    pub(super) map: SightMap,
    /// Whether the last look did not lie on the map.
    lost: bool,
    state: State,
    looks: u32,
    first_heading: f64,
    /// Position at the last look.
    looked_from: Point3,
    /// How much the ground under the robot rises there per metre along both axes.
    uphill: Vector,
    /// Positions of all looks.
    pub(super) views: Vec<Point>,
    /// Whether each look makes a new map: where the ground is even, nothing tells where a look belongs.
    forgets: bool,
}

/// Result of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Event {
    /// On, at a speed.
    Go(Twist),
    /// A look is complete: where to?
    Looked,
    /// The robot lies on its side, cannot turn, or has looked around too often.
    Stuck,
}

impl Event {
    /// What a behaviour does about it: it decides after a look, and ends as stuck with its explorer.
    pub(super) fn answer<O>(
        self,
        stuck: O,
        decide: impl FnOnce() -> ControlFlow<O, Twist>,
    ) -> ControlFlow<O, Twist> {
        match self {
            Self::Go(twist) => ControlFlow::Continue(twist),
            Self::Looked => decide(),
            Self::Stuck => ControlFlow::Break(stuck),
        }
    }
}

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
    Turning { to: f64, until: Option<f64> },
    Driving(Drive),
    Straight(Straight),
    BackingOff { from: Point, sign: f64 },
}

/// What a [`SummitSearch`](crate::nav::SummitSearch) sees at a step.
#[derive(Debug, Clone, Default)]
pub struct SummitObservation {
    /// Where odometry takes the robot to be.
    pub odometry: Pose,
    /// How it is turned.
    pub attitude: Attitude,
    /// A scan, while it looks around.
    pub scan: LidarScan,
}

/// Time in which the robot comes to rest (s).
const REST: f64 = 0.6;
/// Time after which a robot that has not turned cannot turn (s): a turn takes less than 10.
const TURNING: f64 = 60.0;
/// Error of a quarter turn (rad).
const ALIGNED: f64 = 0.1;
/// Distance that it backs off (m).
const BACK: f64 = 0.15;
/// Drive by the wheels from which a robot should have got on (m).
const TURNED: f64 = 0.1;
/// The least part of a drive by the wheels that a robot makes if it gets on.
const GOT_ON: f64 = 0.25;
/// Distance to the place that a robot does not get to (m).
const IN_FRONT: f64 = 0.18;
/// Radius around a place where the robot cannot stand or turn (m).
const SHUNNED: f64 = 0.1;
/// Distance within which a look is compared with the map (m).
const NEAR: f64 = 4.0;
/// Error of the inertial unit before its calibration (rad).
const UNCALIBRATED: f64 = 0.03;
/// Error of the inertial unit after its calibration (rad).
const CALIBRATED: f64 = 0.002;
/// Distance to ground from which the robot can drive on, if it stands beside it (m).
const NEXT: f64 = 0.7;
/// Gap between beams above each other that is ground (m).
const WIDE_GAP: f64 = 0.35;
/// The same on levels, where a wider one may be a drop (m): that of beams a degree apart, 1.2 m away.
const NARROW_GAP: f64 = 0.15;
/// Distance that the robot drives straight up (m): its middle stays over ground on which its ends have stood.
const STEP_UP: f64 = 0.12;
/// Maximum number of looks.
const MOST_LOOKS: u32 = 400;
/// Number of beams of a scan.
const BEAMS: usize = 360;
/// Paths are to climb little: climbing costs as much as ten times the way.
const OBJECTIVE: Objective = Objective::Energy { resistance: 0.5 };

impl Explorer {
    /// Starts where the robot stands, on hills.
    pub(super) fn new(parameters: SummitParameters) -> Result<Self> {
        Self::of(parameters, WIDE_GAP, false)
    }

    /// Starts where the robot stands, on levels.
    pub(super) fn on_levels(parameters: SummitParameters) -> Result<Self> {
        Self::of(parameters, NARROW_GAP, true)
    }

    fn of(parameters: SummitParameters, gap: f64, forgets: bool) -> Result<Self> {
        parameters.validate()?;
        Ok(Self {
            map: SightMap::new(&parameters, gap),
            lost: false,
            parameters,
            reckoning: Reckoning::default(),
            state: State::Settling { until: None },
            looks: 0,
            first_heading: 0.0,
            looked_from: Point3::origin(),
            uphill: Vector::zeros(),
            views: Vec::new(),
            forgets,
        })
    }

    pub(super) fn phase(&self) -> SummitPhase {
        match self.state {
            State::Settling { .. } | State::Looking(_) => SummitPhase::Looking,
            State::Turning { .. } => SummitPhase::Turning,
            State::Driving(_) | State::Straight(_) | State::BackingOff { .. } => SummitPhase::Driving,
        }
    }

    pub(super) fn looks(&self) -> u32 {
        self.looks
    }

    /// The path that it drives.
    pub(super) fn way(&self) -> &[Point] {
        match &self.state {
            State::Driving(drive) => drive.way(),
            _ => &[],
        }
    }

    pub(super) fn here(&self) -> Point {
        self.reckoning.pose.position()
    }

    /// Where the robot can drive for all that it knows.
    pub(super) fn chart(&self) -> Chart {
        Chart::of(&self.map, &self.parameters, self.reckoning.doubt)
    }

    fn settle(&mut self) -> Twist {
        self.state = State::Settling { until: None };
        Twist::STOP
    }

    /// Takes in a complete look.
    fn understand(&mut self, sweep: &Sweep) -> Event {
        self.looks += 1;
        match self.looks {
            1 => {
                self.take_in(sweep);
                let to = self.reckoning.pose.heading + std::f64::consts::FRAC_PI_2;
                self.state = State::Turning { to, until: None };
                self.first_heading = self.reckoning.pose.heading;
                return Event::Go(Twist::STOP);
            }
            2 => {
                if let Some(shift) = self.align(sweep, UNCALIBRATED) {
                    self.calibrate(shift.tilt);
                }
                self.begin_map();
            }
            MOST_LOOKS => return Event::Stuck,
            _ if self.forgets => self.begin_map(),
            _ => {
                let believed = self.here();
                // What does not lie on the map is not put there; once more, and the map is wrong.
                let fits = self.align(sweep, CALIBRATED).is_some();
                if !fits && !self.lost {
                    self.lost = true;
                    return Event::Go(self.settle());
                }
                if fits {
                    self.note_slip(believed);
                } else {
                    self.map.clear();
                }
            }
        }
        self.lost = false;
        self.take_in(sweep);
        self.views.push(self.here());
        Event::Looked
    }

    /// A new map begins where the robot takes itself to be.
    fn begin_map(&mut self) {
        self.map.clear();
        self.reckoning.doubt = 0.0;
    }

    /// If belts have turned and the robot has not got on, it does not try the same again.
    fn note_slip(&mut self, believed: Point) {
        let before = self.looked_from.xy();
        let told = believed - before;
        if told.norm() > TURNED && (self.here() - before).norm() < GOT_ON * told.norm() {
            self.map.shun(self.here() + told.normalize() * IN_FRONT, SHUNNED);
        }
    }

    /// Corrects where the robot takes itself to be by what it knows of the ground. `None` if what it sees
    /// does not lie on that.
    fn align(&mut self, sweep: &Sweep, tilt: f64) -> Option<Shift> {
        let lidar = self.parameters.lidar;
        let robot = self.reckoning.in_space(sweep.attitude());
        let beams = sweep.fans(&robot, &lidar, &self.map.climber).flatten();
        // On faces, heights say nothing of the place.
        let near = beams.filter(|beam| beam.range < NEAR && !beam.is_on_face);
        let points: Vec<Point3> = near.filter_map(|beam| beam.end()).collect();
        let shift = align(&self.map, robot.position, self.looked_from, &points, tilt, self.reckoning.doubt)?;
        self.reckoning.correct(&shift);
        Some(shift)
    }

    /// Seen the other way round, the ground is as steep; what is not is the unit's error.
    fn calibrate(&mut self, tilt: Vector) {
        // An error of the attitude is the same in the robot's axes, e, so that by both looks e turned by the
        // first heading and by the second one differ as the second look is tilted.
        let heading = self.reckoning.pose.heading;
        let (sin, cos) = math::sin_cos(angle_difference(heading, self.first_heading));
        let forward = direction(heading);
        // The correction along the robot's axes: that of the second look less that of the first one, in the
        // axes of the second.
        let off = [tilt.dot(&forward), tilt.dot(&Vector::new(-forward.y, forward.x))];
        let (a, b) = (1.0 - cos, -sin);
        let square = a * a + b * b;
        let ahead = (a * off[0] - b * off[1]) / square;
        let left = (b * off[0] + a * off[1]) / square;
        // What is too low ahead was taken for a nose too low.
        self.reckoning.bias = [-left, ahead];
    }

    fn take_in(&mut self, sweep: &Sweep) {
        let robot = self.reckoning.in_space(sweep.attitude());
        let doubt = self.reckoning.doubt;
        self.map.stand(robot.position, doubt);
        let climber = self.map.climber;
        for fan in sweep.fans(&robot, &self.parameters.lidar, &climber) {
            self.map.add_fan(robot.position, &fan, doubt);
        }
        self.looked_from = robot.position;
        self.uphill = -robot.up().xy() / robot.up().z.max(MIN_UPRIGHT);
    }

    /// The way straight up from where the robot stands, and how much higher half of it may be. `None` if it
    /// has not been seen, or is unfit.
    pub(super) fn way_up(&self, chart: &Chart) -> Option<([Point; 2], f64)> {
        let step = self.uphill.try_normalize(f64::MIN_POSITIVE)? * STEP_UP;
        let is_fit = |share: f64| {
            let place = self.here() + step * share;
            let is_open = |cell: GridCell| {
                self.map.height(self.map.index_of(cell)).is_some() && chart.elevation.open().is_free(cell)
            };
            self.parameters.holds(place, self.reckoning.doubt) && self.map.cell_at(place).is_some_and(is_open)
        };
        let gain = 0.5 * STEP_UP * self.uphill.norm();
        (is_fit(0.5) && is_fit(1.0)).then_some(([self.here(), self.here() + step], gain))
    }

    /// The cell on which the robot stands, or the nearest one from which it can drive; where it stands counts
    /// as safe.
    pub(super) fn footing(&self, chart: &mut Chart, here: Point) -> Option<GridCell> {
        let cell = self.map.cell_at(here)?;
        if chart.safe.is_free(cell) {
            return Some(cell);
        }
        let reach = (NEXT / self.parameters.resolution) as isize;
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
            let at =
                |from: usize, to: usize| (from as f64 + (to as f64 - from as f64) * share).round() as usize;
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

    pub(super) fn height(&self, cell: GridCell) -> f64 {
        self.map.smoothed(cell).unwrap_or(f64::NEG_INFINITY)
    }

    /// The cheapest path over free cells.
    pub(super) fn way_over<C: StepCosts>(
        &self,
        free: &BitGrid,
        costs: C,
        start: GridCell,
        goal: GridCell,
    ) -> Option<Vec<Point>> {
        let path = GridSearch::astar_by(free, costs).plan(start, goal).ok()?;
        let cells = path.points.iter().filter_map(|&point| GridCell::at(point));
        Some(cells.map(|cell| self.map.place(cell)).collect())
    }

    /// The part of a way that leads over safe ground, no longer than a stride.
    pub(super) fn known_part<'w>(&self, chart: &Chart, way: &'w [Point]) -> &'w [Point] {
        let is_safe = |point: &Point| self.map.cell_at(*point).is_some_and(|cell| chart.safe.is_free(cell));
        let known = way.iter().take_while(|point| is_safe(point)).count();
        cut(&way[..known], self.parameters.stride)
    }

    /// Starts to drive a path.
    pub(super) fn drive(&mut self, time: f64, chart: &Chart, way: &[Point]) -> Twist {
        let way = cut(way, 2.0 * self.parameters.stride);
        self.state = State::Driving(Drive::along(way, chart.safe.clone(), &self.reckoning, time));
        Twist::STOP
    }

    /// Starts to turn to a direction.
    pub(super) fn turn(&mut self, towards: Vector) -> Twist {
        self.state = State::Turning { to: math::atan2(towards.y, towards.x), until: None };
        Twist::STOP
    }

    /// Starts to drive along a line.
    pub(super) fn drive_straight(&mut self, straight: Straight) -> Twist {
        self.state = State::Straight(straight);
        Twist::STOP
    }

    /// Processes an observation.
    pub(super) fn step(&mut self, time: f64, seen: &SummitObservation) -> Result<Event> {
        check_pose(&seen.odometry)?;
        check_attitude(&seen.attitude)?;
        check_scan(&seen.scan)?;
        let SummitParameters { slide, half_track, .. } = self.parameters;
        self.reckoning.update(seen.odometry, seen.attitude, slide, half_track);
        self.map.tread(self.here());
        if self.reckoning.in_space(seen.attitude).up().z < MIN_UPRIGHT {
            return Ok(Event::Stuck);
        }
        let go = |twist| Ok(Event::Go(twist));
        match &mut self.state {
            State::Settling { until } => {
                let until = *until.get_or_insert(time + REST);
                if time >= until {
                    let sweep = if self.forgets { Sweep::nearby() } else { Sweep::wide() };
                    self.state = State::Looking(sweep);
                }
                go(Twist::STOP)
            }
            State::Looking(sweep) => {
                sweep.add(&self.parameters.lidar, &seen.scan, seen.attitude);
                if sweep.next_tilt().is_some() {
                    return go(Twist::STOP);
                }
                let sweep = sweep.clone();
                Ok(self.understand(&sweep))
            }
            State::Turning { to, until } => {
                if time > *until.get_or_insert(time + TURNING) {
                    return Ok(Event::Stuck);
                }
                let rest = angle_difference(*to, self.reckoning.pose.heading);
                if rest.abs() < ALIGNED {
                    return go(self.settle());
                }
                if self.reckoning.is_locked() {
                    return go(Twist::new(self.parameters.speed, 0.0));
                }
                let rate = self.parameters.turn_rate;
                go(Twist::new(0.0, (2.0 * rest).clamp(-rate, rate)))
            }
            State::Driving(drive) => {
                let tilt = self.reckoning.corrected(seen.attitude).frame().tilt();
                match drive.step(time, &self.reckoning, tilt, &self.parameters, &self.map) {
                    Step::Go(twist) => go(twist),
                    Step::Arrived => go(self.settle()),
                    Step::Freed { from } => {
                        self.map.shun(from, SHUNNED);
                        go(self.settle())
                    }
                    Step::NoWay { ahead, sign } => {
                        self.map.shun(ahead, SHUNNED);
                        self.state = State::BackingOff { from: self.reckoning.pose.position(), sign };
                        go(Twist::STOP)
                    }
                }
            }
            State::Straight(straight) => {
                let tilt = self.reckoning.corrected(seen.attitude).frame().tilt();
                match straight.step(self.reckoning.pose, tilt, &self.parameters) {
                    Step::Go(twist) => go(twist),
                    Step::Arrived => go(self.settle()),
                    Step::Freed { .. } | Step::NoWay { .. } => Ok(Event::Stuck),
                }
            }
            State::BackingOff { from, sign } => {
                if self.reckoning.pose.distance_to(*from) > BACK {
                    return go(self.settle());
                }
                go(Twist::new(-0.5 * *sign * self.parameters.speed, 0.0))
            }
        }
    }

    /// Reads the sensors for a step.
    pub(super) fn sense<R: Odometry + Lidar + Inertial + ?Sized>(
        &self,
        robot: &mut R,
        seen: &mut SummitObservation,
    ) -> Result<()> {
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

/// Costs of paths that climb little.
pub(super) fn climbing_costs(chart: &Chart) -> GroundCosts {
    GroundCosts::new(chart.elevation.field(), OBJECTIVE)
}
