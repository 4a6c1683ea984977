use std::ops::ControlFlow;

use super::align::{Shift, align};
use super::drive::{Drive, Step, cut, length};
use super::parameters::SummitParameters;
use super::reckoning::Reckoning;
use super::sight_map::{Chart, SightMap};
use super::sweep::Sweep;
use crate::geometry::{Point, Point3, Pose, Twist, Vector, angle_difference, direction, math};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::{Attitude, Error, Inertial, Lidar, LidarScan, LidarSettings, Odometry, Result};
use crate::nav::grid::{GridComponents, GridPlanner, GridSearch};
use crate::world::GridCell;

/// Drives to the highest place that the robot can reach, on unknown hills.
///
/// The robot stops and scans its surroundings with the lidar at many tilts. Ground that beams hit is mapped;
/// ground that beams pass over is no higher than the beams, which bounds its elevation. As long as some
/// reachable place may be higher than the highest place with a known safe path, the robot drives there, or to
/// a better viewpoint. So it leaves local maxima. It drives only over ground that it has seen and that its
/// [`Climber`](crate::nav::elevation::Climber) allows. The first two scans, a quarter of a turn apart,
/// calibrate the inertial unit.
///
/// The search ends on the highest reachable place. [`unknown_area`](SummitSearch::unknown_area) is the area
/// that may still be higher when the time limit comes first.
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
    /// Whether the last look did not lie on the map.
    lost: bool,
    /// How often it has been next to the top.
    approaches: u32,
    state: State,
    looks: u32,
    first_heading: f64,
    /// Where it was at the last look.
    looked_from: Point3,
    /// From where it has looked around.
    views: Vec<Point>,
    /// What it wanted to see when it looked last.
    target: Option<Point>,
    unknown: usize,
    highest: f64,
}

/// Outcome of a [`SummitSearch`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SummitOutcome {
    /// The robot is on the highest reachable place: no other can be higher.
    Highest,
    /// The robot cannot stand where it is, or makes no progress.
    Stuck,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(SummitOutcome {
    Highest: "on the highest place that can be reached",
    Stuck: "the robot makes no progress",
});

/// Phase of a search.
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
    BackingOff { from: Point, sign: f64 },
}

/// Observation of a [`SummitSearch`].
#[derive(Debug, Clone, Default)]
pub struct SummitObservation {
    /// Pose by odometry.
    pub odometry: Pose,
    /// Attitude by the inertial unit.
    pub attitude: Attitude,
    /// Lidar scan, while the robot looks around.
    pub scan: LidarScan,
}

/// Seconds in which the robot comes to rest.
const REST: f64 = 0.6;
/// Radians by which a half turn may be missed.
const ALIGNED: f64 = 0.1;
/// Metres that it backs off.
const BACK: f64 = 0.15;
/// Metres within which a look is compared with the map.
const NEAR: f64 = 4.0;
/// By how much the inertial unit may be wrong, in radians, before and after it has been calibrated.
const UNCALIBRATED: f64 = 0.03;
const CALIBRATED: f64 = 0.002;
/// Metres that a way has to lead on for the robot to drive it.
const LEAST_WAY: f64 = 0.1;
/// Metres to ground from which it can drive on, if it stands beside it.
const NEXT: f64 = 0.7;
/// Metres around a place at which a way ends, of which another look from there shows no more.
const LOST_SIGHT: f64 = 0.15;
/// Metres from a place from which another look around shows nothing new.
const VIEW: f64 = 0.4;
/// Metres by which a place has to be higher for a look from there to be better.
const WORTH_CLIMBING: f64 = 0.04;
/// Metres from what it is after that belong to it.
const SAME: f64 = 0.4;
/// The most ways on the top, each after another look.
const MOST_APPROACHES: u32 = 16;
/// The most looks of a search.
const MOST_LOOKS: u32 = 400;

impl SummitSearch {
    /// Creates a search that starts where the robot stands. Fails for parameters out of range.
    pub fn new(parameters: SummitParameters) -> Result<Self> {
        parameters.validate()?;
        Ok(Self {
            map: SightMap::new(parameters.resolution, parameters.extent),
            lost: false,
            approaches: 0,
            parameters,
            reckoning: Reckoning::default(),
            state: State::Settling { until: None },
            looks: 0,
            first_heading: 0.0,
            looked_from: Point3::origin(),
            views: Vec::new(),
            target: None,
            unknown: 0,
            highest: 0.0,
        })
    }

    /// The current phase.
    pub fn phase(&self) -> SummitPhase {
        match self.state {
            State::Settling { .. } | State::Looking(_) => SummitPhase::Looking,
            State::Turning { .. } => SummitPhase::Turning,
            State::Driving(_) | State::BackingOff { .. } => SummitPhase::Driving,
        }
    }

    /// Estimated position relative to the start, with the height above it (m).
    pub fn pose(&self) -> (Pose, f64) {
        (self.reckoning.pose, self.reckoning.elevation)
    }

    /// Estimated bias of the inertial unit's roll and pitch (rad).
    pub fn bias(&self) -> [f64; 2] {
        self.reckoning.bias
    }

    /// Number of complete looks around.
    pub fn looks(&self) -> u32 {
        self.looks
    }

    /// Height above the start of the highest place with a known path (m).
    pub fn highest(&self) -> f64 {
        self.highest
    }

    /// Area that may be higher and may be reachable, by what is known so far (m²).
    pub fn unknown_area(&self) -> f64 {
        self.unknown as f64 * self.parameters.resolution * self.parameters.resolution
    }

    /// The current path, relative to the start.
    pub fn way(&self) -> &[Point] {
        match &self.state {
            State::Driving(drive) => drive.way(),
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
        match self.looks {
            1 => {
                self.take_in(sweep);
                let to = self.reckoning.pose.heading + std::f64::consts::FRAC_PI_2;
                self.state = State::Turning { to };
                self.first_heading = self.reckoning.pose.heading;
                return ControlFlow::Continue(Twist::STOP);
            }
            2 => {
                if let Some(shift) = self.align(sweep, UNCALIBRATED) {
                    self.calibrate(shift.tilt);
                }
                self.map.clear();
            }
            MOST_LOOKS => return ControlFlow::Break(SummitOutcome::Stuck),
            _ => {
                // What does not lie on the map is not put there; once more, and the map is wrong.
                let fits = self.align(sweep, CALIBRATED).is_some();
                if !fits && !self.lost {
                    self.lost = true;
                    return ControlFlow::Continue(self.settle());
                }
                if !fits {
                    self.map.clear();
                }
            }
        }
        self.lost = false;
        self.take_in(sweep);
        self.views.push(self.reckoning.pose.position());
        self.decide(time)
    }

    /// Corrects where the robot takes itself to be by what it knows of the ground. `None` if what it sees
    /// does not lie on that.
    fn align(&mut self, sweep: &Sweep, tilt: f64) -> Option<Shift> {
        let lidar = self.parameters.lidar;
        let robot = self.reckoning.in_space(sweep.attitude());
        let near = sweep.fans(&robot, &lidar).flatten().filter(|beam| beam.range < NEAR);
        let points: Vec<Point3> = near.filter_map(|beam| beam.end()).collect();
        let shift = align(&self.map, robot.position, self.looked_from, &points, tilt)?;
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
        for fan in sweep.fans(&robot, &self.parameters.lidar) {
            self.map.add_fan(fan);
        }
        self.map.stand(robot.position.xy(), robot.position.z);
        self.looked_from = robot.position;
    }

    fn decide(&mut self, time: f64) -> ControlFlow<SummitOutcome, Twist> {
        let mut chart = self.map.chart(&self.parameters);
        let here = self.reckoning.pose.position();
        let Some(start) = self.footing(&mut chart, here) else {
            return ControlFlow::Break(SummitOutcome::Stuck);
        };
        loop {
            let top = self.top(&chart, start);
            let level = self.height(top);
            self.highest = level;
            let higher = self.map.higher(&chart, start, level + self.parameters.tolerance);
            self.unknown = higher.iter().map(Vec::len).sum();
            // The view is better from above.
            let (above, place) = (level - self.reckoning.elevation, self.map.place(top));
            let new = self.views.iter().all(|view| (view - place).norm() > VIEW);
            let climbs = new && above > WORTH_CLIMBING;
            if higher.is_empty() {
                return self.approach(time, &chart, start, top);
            }
            if climbs && let Some(way) = self.way_over(&chart.safe, &chart, start, top) {
                return ControlFlow::Continue(self.drive(time, &way));
            }
            let Some(target) = self.next_target(&higher, here) else {
                return ControlFlow::Break(SummitOutcome::Highest);
            };
            self.target = Some(self.map.place(target));
            let way = self.way_over(&chart.perhaps, &chart, start, target);
            let way = way.unwrap_or_else(|| vec![self.map.place(target)]);
            let known = self.known_part(&chart, &way);
            if length(known) > LEAST_WAY {
                return ControlFlow::Continue(self.drive(time, known));
            }
            // It has looked from here, and does not see that it could go on: nor will it.
            let beyond = way[known.len().min(way.len() - 1)];
            self.map.shun(beyond, LOST_SIGHT);
            chart = self.map.chart(&self.parameters);
            if self.footing(&mut chart, here).is_none() {
                return ControlFlow::Break(SummitOutcome::Stuck);
            }
        }
    }

    /// What to see next: what it has been after, while there is something left of it, or else the patch that
    /// is large for its distance.
    fn next_target(&self, patches: &[Vec<GridCell>], here: Point) -> Option<GridCell> {
        let nearest = |cells: &[GridCell], to: Point| {
            let away = |cell: GridCell| (self.map.place(cell) - to).norm();
            let cells = cells.iter().map(|&cell| (away(cell), cell));
            cells.min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let same = self.target.and_then(|target| {
            let cells = patches.iter().filter_map(|patch| nearest(patch, target));
            cells.filter(|(away, _)| *away < SAME).min_by(|a, b| a.0.total_cmp(&b.0))
        });
        let worth = |patch: &Vec<GridCell>| {
            let (away, cell) = nearest(patch, here)?;
            Some((patch.len() as f64 / (away + SAME), cell))
        };
        let best = || patches.iter().filter_map(worth).max_by(|a, b| a.0.total_cmp(&b.0));
        same.or_else(best).map(|(_, cell)| cell)
    }

    /// The cell on which the robot stands, or the nearest one from which it can drive; where it stands counts
    /// as safe.
    fn footing(&self, chart: &mut Chart, here: Point) -> Option<GridCell> {
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

    fn height(&self, cell: GridCell) -> f64 {
        self.map.smoothed(cell).unwrap_or(f64::NEG_INFINITY)
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

    /// The last part of a search: to the highest place, until it is no more than the map's errors away.
    fn approach(
        &mut self,
        time: f64,
        chart: &Chart,
        start: GridCell,
        top: GridCell,
    ) -> ControlFlow<SummitOutcome, Twist> {
        let way = self.way_over(&chart.safe, chart, start, top).unwrap_or_default();
        let gain = self.height(top) - self.reckoning.elevation;
        let there =
            length(&way) <= 1.5 * self.parameters.resolution || gain < 0.25 * self.parameters.tolerance;
        if there || self.approaches >= MOST_APPROACHES {
            return ControlFlow::Break(SummitOutcome::Highest);
        }
        // Ways that end on the top, not those that lead to it.
        self.approaches += u32::from(length(&way) < self.parameters.stride);
        ControlFlow::Continue(self.drive(time, &way))
    }

    fn drive(&mut self, time: f64, way: &[Point]) -> Twist {
        let way = cut(way, 2.0 * self.parameters.stride);
        self.state = State::Driving(Drive::along(way, self.reckoning.pose, time));
        Twist::STOP
    }
}

/// What ways are to cost little of: climbing costs as much as ten times the way.
const OBJECTIVE: crate::nav::elevation::Objective =
    crate::nav::elevation::Objective::Energy { resistance: 0.5 };

impl Behaviour for SummitSearch {
    type Observation = SummitObservation;
    type Command = Twist;
    type Outcome = SummitOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, time: f64, seen: &SummitObservation) -> Decision<Self> {
        let finite =
            [seen.attitude.roll, seen.attitude.pitch, seen.attitude.yaw].iter().all(|a| a.is_finite());
        if !seen.odometry.is_finite() || !finite {
            let found = format!("{:?} {:?}", seen.odometry, seen.attitude);
            return Err(Error::invalid_input("observed pose", found, "finite numbers"));
        }
        self.reckoning.update(seen.odometry, seen.attitude, self.parameters.slide);
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
            State::Driving(drive) => {
                let tilt = self.reckoning.corrected(seen.attitude).frame().tilt();
                match drive.step(time, self.reckoning.pose, tilt, &self.parameters) {
                    Step::Go(twist) => go_on(twist),
                    Step::Arrived => go_on(self.settle()),
                    Step::NoWay { ahead, sign } => {
                        self.map.shun(ahead, 0.1);
                        self.state = State::BackingOff { from: self.reckoning.pose.position(), sign };
                        go_on(Twist::STOP)
                    }
                }
            }
            State::BackingOff { from, sign } => {
                if self.reckoning.pose.distance_to(*from) > BACK {
                    return go_on(self.settle());
                }
                go_on(Twist::new(-0.5 * *sign * self.parameters.speed, 0.0))
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
const BEAMS: usize = 360;
