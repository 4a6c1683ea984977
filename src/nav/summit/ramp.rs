use std::ops::ControlFlow;

use super::axis::{Ramp, is_sloped};
use super::chart::Chart;
use super::explorer::{Explorer, SummitObservation, SummitPhase};
use super::parameters::SummitParameters;
use super::straight::Straight;
use crate::geometry::{Point, Pose, Twist, Vector, way_length};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::{Inertial, Lidar, Odometry, Result};
use crate::nav::elevation::Climber;
use crate::nav::grid::{DistanceField, GridComponents, StepCosts, UniformCost};
use crate::world::{Footprint, GridCell, RobotSpec};

/// Crosses a level above the floor: up a ramp, across, and down another ramp (book, section 7.4).
///
/// The robot stands in front of a ramp, and knows neither its slope nor where the other one is. It looks
/// around with its lidar as [`SummitSearch`](super::SummitSearch) does. Each look makes a new map, as wheels
/// slip on ramps and levels show nothing by which a look could be placed; only directions, the ramp that it
/// came by, and places of looks are remembered. Of a ramp, the map shows its direction (the median rise) and
/// its middle line. The robot drives to that line on level ground, turns, and follows the line by its
/// inertial unit until it is level again: it does not turn on ramps, where belts slip. On the level it looks
/// for another ramp; its paths keep to the middle: a cell costs the more, the nearer it is to ground on which
/// the robot cannot stand.
///
/// # Assumptions
///
/// Ramps have at most 22 degrees, and at most 95 % of the slope on which the robot slips or tips. Both they
/// and the level are wider than the robot by at least 0.2 m.
///
/// ```
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::nav::{RampCrossing, RampOutcome};
/// use roverlab::random::Stream;
/// use roverlab::world::generate::{ReliefKind, ReliefOptions, relief};
/// use roverlab::world::{RobotSpec, Scene};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let levels = relief(&mut Stream::new(1), &ReliefOptions::of(ReliefKind::Ramp))?;
/// let spec = RobotSpec::blizzard();
/// let mut crossing = RampCrossing::new(RampCrossing::parameters(&spec).ok_or("no lidar")?)?;
/// let simulation = Simulation::new(&Scene::with_robot(levels.world, spec, levels.start), SimOptions::default())?;
/// let outcome = run(&mut simulation.robot(0)?, &mut crossing, 300.0, |_, _, _| {})?;
/// assert_eq!((outcome, simulation.truth().mishap(0)?), (RampOutcome::Crossed, None));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct RampCrossing {
    explorer: Explorer,
    leg: RampLeg,
    /// Whether it drives along a ramp.
    rides: bool,
    /// The ramp that it came up by, or is to come up by, as it was seen last.
    came_by: Option<Ramp>,
    /// The other ramp, as it was seen last: where the robot can turn to it, it may be out of sight.
    other: Option<Ramp>,
}

/// Part of a crossing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RampLeg {
    /// Up the first ramp.
    Up,
    /// Across the upper level, in search of another ramp.
    Across,
    /// Down the other ramp.
    Down,
}

/// How a crossing ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RampOutcome {
    /// The robot stands on the floor again, beyond the other ramp.
    Crossed,
    /// It found no ramp up.
    NoWayUp,
    /// It found no other ramp down.
    NoWayDown,
    /// The map shows no safe ground under the robot, or the robot makes no progress.
    Stuck,
    /// The time limit came first.
    TimedOut,
    /// The run was stopped by its observer.
    Stopped,
}

halts!(RampOutcome {
    Crossed: "beyond the other ramp",
    NoWayUp: "found no ramp up",
    NoWayDown: "found no other ramp down",
    Stuck: "the robot does not get on",
});

/// Part of the slope at which a robot slips or tips that ramps may have; they are even, unlike hills.
const TRUSTED: f64 = 0.95;
/// Steepest ramp (rad): 22 degrees. What is steeper may be a drop that is seen obliquely.
const STEEPEST: f64 = 0.384;
/// Cell size of the map (m): a third of what a robot of 0.25 m leaves of a ramp of 0.5 m on each side.
const RESOLUTION: f64 = 0.04;
/// Distance from the start that the map reaches (m); each look makes a new one.
const EXTENT: f64 = 5.0;
/// Distance before the foot of a ramp at which the robot turns to it (m): its radius and 0.1 m.
const BEFORE: f64 = 0.35;
/// Distance from a ramp's middle line on which the robot may start (m).
const ASIDE: f64 = 0.06;
/// Deviation from its direction (rad).
const TURNED: f64 = 0.12;
/// Difference in elevation that counts as none (m): three errors of the map.
const EVEN: f64 = 0.03;
/// Number of looks, all around, after which there is no ramp up.
const FIRST_LOOKS: u32 = 6;
/// Distance from a place from which another look shows nothing new (m).
const VIEW: f64 = 0.2;
/// Distance from ground on which the robot cannot stand that is the edge of a level (m): the drop itself is
/// 0.35 m away, and ramps of 22 degrees are in the lidar's sight from 0.5 m.
const EDGE: f64 = 0.15;
/// Length of a path that is worth driving (m).
const LEAST_WAY: f64 = 0.06;
/// Extra cost of a cell next to unsafe ground, in lengths; it falls with the distance, so that the middle is
/// worth a detour.
const NARROW: f64 = 8.0;

impl RampCrossing {
    /// A crossing from where the robot stands.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(parameters: SummitParameters) -> Result<Self> {
        Ok(Self {
            explorer: Explorer::on_levels(parameters)?,
            leg: RampLeg::Up,
            rides: false,
            came_by: None,
            other: None,
        })
    }

    /// Parameters for a robot; `None` without a lidar.
    pub fn parameters(spec: &RobotSpec) -> Option<SummitParameters> {
        let usual = SummitParameters::of(spec)?;
        // On a ramp, belts or wheels carry the robot, not the corners of its outline.
        let radius = match &spec.footprint {
            Footprint::Rectangle(outline) => 0.5 * outline.size().min(),
            disc => disc.bounding_radius(),
        };
        let slope = (TRUSTED * Climber::steepest(spec)).min(STEEPEST);
        let climber = Climber { slope, radius, ..usual.climber };
        Some(SummitParameters { climber, resolution: RESOLUTION, extent: EXTENT, ..usual })
    }

    /// What it is doing.
    pub fn phase(&self) -> (RampLeg, SummitPhase) {
        (self.leg, self.explorer.phase())
    }

    /// Where the robot takes itself to be, from its start, and how far above it (m).
    pub fn pose(&self) -> (Pose, f64) {
        (self.explorer.reckoning.pose, self.explorer.reckoning.elevation)
    }

    /// How often it has looked around.
    pub fn looks(&self) -> u32 {
        self.explorer.looks()
    }

    fn decide(&mut self, time: f64) -> ControlFlow<RampOutcome, Twist> {
        if std::mem::take(&mut self.rides) {
            match self.leg {
                RampLeg::Down => return ControlFlow::Break(RampOutcome::Crossed),
                RampLeg::Up | RampLeg::Across => self.leg = RampLeg::Across,
            }
        }
        let mut chart = self.explorer.chart();
        let Some(start) = self.explorer.footing(&mut chart, self.explorer.here()) else {
            return ControlFlow::Break(RampOutcome::Stuck);
        };
        let safe = GridComponents::new(&chart.safe);
        let reached: Vec<GridCell> =
            chart.safe.free_cells().filter(|&cell| safe.connected(start, cell)).collect();
        let room = DistanceField::new(&chart.safe);
        let look = Look { chart, start, reached, room };
        match self.leg {
            RampLeg::Up => self.go_up(time, &look),
            RampLeg::Across | RampLeg::Down => self.go_across(time, &look),
        }
    }

    /// To the foot of the nearest ramp that leads up, and up.
    fn go_up(&mut self, time: f64, look: &Look) -> ControlFlow<RampOutcome, Twist> {
        let (here, height) = (self.explorer.here(), self.explorer.reckoning.elevation);
        let ramps = Ramp::all(&self.explorer, &look.chart, &look.reached).into_iter();
        let away = |ramp: &Ramp| (ramp.foot - here).norm();
        let nearest = ramps.filter(|ramp| ramp.height > height).min_by(|a, b| away(a).total_cmp(&away(b)));
        let Some(ramp) = nearest.or(self.came_by) else {
            // A gentle ramp rises little more than the map's errors: not every look shows it.
            if self.explorer.looks() >= FIRST_LOOKS {
                return ControlFlow::Break(RampOutcome::NoWayUp);
            }
            let ahead = self.explorer.reckoning.pose.forward();
            return ControlFlow::Continue(self.explorer.turn(Vector::new(-ahead.y, ahead.x)));
        };
        let goal = self.explorer.map.cell_at(ramp.foot - ramp.uphill() * BEFORE);
        self.came_by = Some(ramp);
        self.take(time, look, &ramp, ramp.uphill(), goal)
    }

    /// To another ramp that leads down, and down; or else to where it has not looked yet.
    fn go_across(&mut self, time: f64, look: &Look) -> ControlFlow<RampOutcome, Twist> {
        let height = self.explorer.reckoning.elevation;
        let radius = self.explorer.parameters.climber.radius;
        let is_new = |ramp: &Ramp| self.came_by.is_none_or(|known| !ramp.is(&known, radius));
        let is_other = |ramp: &Ramp| ramp.height < height && is_new(ramp);
        let seen = Ramp::all(&self.explorer, &look.chart, &look.reached).into_iter().find(is_other);
        self.other = seen.or(self.other);
        let even = self.even(look);
        if let Some(ramp) = self.other {
            let on_line = |cell: &&GridCell| ramp.aside(self.explorer.map.place(**cell)).abs() < ASIDE;
            let goal = look.roomiest(even.iter().filter(on_line));
            return self.take(time, look, &ramp, -ramp.uphill(), goal);
        }
        let view = self.next_view(look, &even);
        self.go_to(time, look, view, RampOutcome::NoWayDown)
    }

    /// The cells that it can reach and that are level with it.
    fn even(&self, look: &Look) -> Vec<GridCell> {
        let height = self.explorer.reckoning.elevation;
        let is_even = |&cell: &GridCell| {
            (self.explorer.height(cell) - height).abs() < EVEN && !is_sloped(&self.explorer, cell)
        };
        look.reached.iter().copied().filter(is_even).collect()
    }

    /// To a cell; ends if there is none, or no way there that is worth driving.
    fn go_to(
        &mut self,
        time: f64,
        look: &Look,
        cell: Option<GridCell>,
        or: RampOutcome,
    ) -> ControlFlow<RampOutcome, Twist> {
        match cell.and_then(|cell| self.way_to(look, cell)) {
            Some(way) => ControlFlow::Continue(self.explorer.drive(time, &look.chart, &way)),
            None => ControlFlow::Break(or),
        }
    }

    /// The cell on the level from which to look next: near the robot and along the edge, away from where it
    /// has looked. Only from near an edge can it see whether a ramp leads down there. `None` if it has looked
    /// all around.
    fn next_view(&self, look: &Look, even: &[GridCell]) -> Option<GridCell> {
        let (here, width) = (self.explorer.here(), EDGE / self.explorer.parameters.resolution);
        let away = |cell: &GridCell| (self.explorer.map.place(*cell) - here).norm();
        let is_new = |cell: &GridCell| {
            let place = self.explorer.map.place(*cell);
            self.explorer.views.iter().all(|view| (view - place).norm() > VIEW)
        };
        let new: Vec<GridCell> =
            even.iter().copied().filter(|cell| look.room.at(*cell) < width && is_new(cell)).collect();
        let nearest = new.iter().map(away).fold(f64::INFINITY, f64::min);
        look.roomiest(new.iter().filter(|cell| away(cell) < nearest + VIEW))
    }

    /// To the end of a ramp, into its direction, and along it.
    fn take(
        &mut self,
        time: f64,
        look: &Look,
        ramp: &Ramp,
        towards: Vector,
        end: Option<GridCell>,
    ) -> ControlFlow<RampOutcome, Twist> {
        let pose = self.explorer.reckoning.pose;
        let aside = ramp.aside(pose.position()).abs();
        if aside > ASIDE {
            if let Some(way) = end.and_then(|end| self.way_to(look, end)) {
                return ControlFlow::Continue(self.explorer.drive(time, &look.chart, &way));
            }
            if aside > 2.0 * ASIDE {
                let up = self.leg == RampLeg::Up;
                return ControlFlow::Break(if up { RampOutcome::NoWayUp } else { RampOutcome::NoWayDown });
            }
        }
        let bearing = pose.bearing_to(pose.position() + towards);
        if bearing.abs() > TURNED {
            return ControlFlow::Continue(self.explorer.turn(towards));
        }
        self.rides = true;
        if self.leg == RampLeg::Across {
            self.leg = RampLeg::Down;
        }
        let straight = Straight::along(ramp.foot, towards);
        ControlFlow::Continue(self.explorer.drive_straight(straight))
    }

    /// A path to a cell in the middle of safe ground; `None` if it is not worth driving.
    fn way_to(&self, look: &Look, goal: GridCell) -> Option<Vec<Point>> {
        let costs = Centred { room: &look.room };
        let way = self.explorer.way_over(&look.chart.safe, costs, look.start, goal)?;
        (way_length(&way) > LEAST_WAY).then_some(way)
    }
}

/// What a look shows.
struct Look {
    chart: Chart,
    /// The cell of the robot, and those to which a safe path leads from there.
    start: GridCell,
    reached: Vec<GridCell>,
    /// Distance of each cell from ground on which the robot cannot stand.
    room: DistanceField,
}

impl Look {
    fn roomiest<'a>(&self, cells: impl Iterator<Item = &'a GridCell>) -> Option<GridCell> {
        cells.copied().max_by(|&a, &b| self.room.at(a).total_cmp(&self.room.at(b)))
    }
}

/// Costs of paths that keep away from ground on which the robot cannot stand.
struct Centred<'a> {
    room: &'a DistanceField,
}

impl StepCosts for Centred<'_> {
    fn cost(&self, from: GridCell, to: GridCell) -> f64 {
        let room = self.room.at(to).max(0.5);
        UniformCost.cost(from, to) * (1.0 + NARROW / room)
    }
}

impl Behaviour for RampCrossing {
    type Observation = SummitObservation;
    type Command = Twist;
    type Outcome = RampOutcome;

    fn period(&self) -> f64 {
        self.explorer.parameters.period
    }

    fn step(&mut self, time: f64, seen: &SummitObservation) -> Decision<Self> {
        let event = self.explorer.step(time, seen)?;
        Ok(event.answer(RampOutcome::Stuck, || self.decide(time)))
    }
}

impl<R: Odometry + Lidar + Inertial + ?Sized> Senses<R> for RampCrossing {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut SummitObservation) -> Result<()> {
        self.explorer.sense(robot, seen)
    }
}
