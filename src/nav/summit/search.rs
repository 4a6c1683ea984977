use std::ops::ControlFlow;

use super::chart::Chart;
use super::drive::ARRIVED;
use super::explorer::{Explorer, SummitObservation, SummitPhase, climbing_costs};
use super::parameters::SummitParameters;
use crate::geometry::{Point, Pose, Twist, way_length};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::{Inertial, Lidar, Odometry, Result};
use crate::nav::grid::GridComponents;
use crate::world::GridCell;

/// Drives to the highest place that it can reach, on hills that it does not know.
///
/// Where it stands, the robot looks around with its lidar at many tilts. What beams meet is mapped; what they
/// pass over is no higher than they are. While anything may be higher than the highest place that it has a
/// safe way to, and may be reached, it drives there, or to where it sees more; so it leaves local maxima
/// behind. It drives only over ground that it has seen and that its
/// [`Climber`](crate::nav::elevation::Climber) allows. The first two looks, with a quarter of a turn between,
/// show by how much the inertial unit is wrong.
///
/// In hollows a robot stands on the ends of its belts and may not turn. Wheels and inertial unit then differ:
/// the search counts its way by the belt that holds, and drives straight on to where the robot can turn.
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
    explorer: Explorer,
    /// How often it has been next to the top.
    approaches: u32,
    /// How often it has tried again where it had not got on.
    retries: u32,
    /// What it wanted to see when it looked last.
    target: Option<Point>,
    unknown: usize,
    highest: f64,
    /// Elevation from which it has driven straight up last.
    climbed_from: f64,
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

/// Metres that a way has to lead on for the robot to drive it.
const LEAST_WAY: f64 = 0.1;
/// Metres around a place at which a way ends, of which another look from there shows no more.
const LOST_SIGHT: f64 = 0.15;
/// Metres from a place from which another look around shows nothing new.
const VIEW: f64 = 0.4;
/// Metres by which a place has to be higher for a look from there to be better.
const WORTH_CLIMBING: f64 = 0.04;
/// Metres from what it is after that belong to it.
const SAME: f64 = 0.4;
/// How often it tries again where it had not got on, before it takes a place for the highest.
const MOST_RETRIES: u32 = 3;
/// The most ways on the top, each after another look.
const MOST_APPROACHES: u32 = 16;

impl SummitSearch {
    /// A search that begins where the robot stands.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(parameters: SummitParameters) -> Result<Self> {
        let explorer = Explorer::new(parameters)?;
        Ok(Self {
            explorer,
            approaches: 0,
            retries: 0,
            target: None,
            unknown: 0,
            highest: 0.0,
            climbed_from: f64::NEG_INFINITY,
        })
    }

    /// What it is doing.
    pub fn phase(&self) -> SummitPhase {
        self.explorer.phase()
    }

    /// Where the robot takes itself to be, from its start, and how far above it.
    pub fn pose(&self) -> (Pose, f64) {
        (self.explorer.reckoning.pose, self.explorer.reckoning.elevation)
    }

    /// The errors of roll and pitch of its inertial unit that it has found, in radians.
    pub fn bias(&self) -> [f64; 2] {
        self.explorer.reckoning.bias
    }

    /// How often it has looked around.
    pub fn looks(&self) -> u32 {
        self.explorer.looks()
    }

    /// Metres above the start of the highest place to which it knows a way.
    pub fn highest(&self) -> f64 {
        self.highest
    }

    /// The square metres that may be higher and may be reached, for all that it knows.
    pub fn unknown_area(&self) -> f64 {
        self.unknown as f64 * self.explorer.parameters.resolution * self.explorer.parameters.resolution
    }

    /// The way that it drives, from its start.
    pub fn way(&self) -> &[Point] {
        self.explorer.way()
    }

    fn decide(&mut self, time: f64) -> ControlFlow<SummitOutcome, Twist> {
        let here = self.explorer.here();
        loop {
            let mut chart = self.explorer.chart();
            let Some(start) = self.explorer.footing(&mut chart, here) else {
                return ControlFlow::Break(SummitOutcome::Stuck);
            };
            let top = self.top(&chart, start);
            let level = self.explorer.height(top);
            self.highest = level;
            let higher = chart.higher(&self.explorer.map, start, level + self.explorer.parameters.tolerance);
            self.unknown = higher.iter().map(Vec::len).sum();
            // The view is better from above.
            let (above, place) = (level - self.explorer.reckoning.elevation, self.explorer.map.place(top));
            let new = self.explorer.views.iter().all(|view| (view - place).norm() > VIEW);
            let climbs = new && above > WORTH_CLIMBING;
            if higher.is_empty() {
                if self.retries < MOST_RETRIES && self.explorer.map.forget_shunned() {
                    self.retries += 1;
                    continue;
                }
                return self.approach(time, &chart, start, top);
            }
            if climbs
                && let Some(way) = self.explorer.way_over(&chart.safe, climbing_costs(&chart), start, top)
            {
                return ControlFlow::Continue(self.explorer.drive(time, &chart, &way));
            }
            let Some(target) = self.next_target(&higher, here) else {
                return ControlFlow::Break(SummitOutcome::Highest);
            };
            self.target = Some(self.explorer.map.place(target));
            let way = self.explorer.way_over(&chart.perhaps, climbing_costs(&chart), start, target);
            let way = way.unwrap_or_else(|| vec![self.explorer.map.place(target)]);
            let known = self.explorer.known_part(&chart, &way);
            if way_length(known) > LEAST_WAY {
                return ControlFlow::Continue(self.explorer.drive(time, &chart, known));
            }
            // It has looked from here, and does not see that it could go on.
            let beyond = way[known.len().min(way.len() - 1)];
            self.explorer.map.give_up(beyond, LOST_SIGHT);
        }
    }

    /// What to see next: what it has been after, while there is something left of it, or else the patch that
    /// is large for its distance.
    fn next_target(&self, patches: &[Vec<GridCell>], here: Point) -> Option<GridCell> {
        let nearest = |cells: &[GridCell], to: Point| {
            let away = |cell: GridCell| (self.explorer.map.place(cell) - to).norm();
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

    /// The highest cell to which a safe way leads.
    fn top(&self, chart: &Chart, start: GridCell) -> GridCell {
        let safe = GridComponents::new(&chart.safe);
        let reached = chart.safe.free_cells().filter(|&cell| safe.connected(start, cell));
        reached.max_by(|&a, &b| self.explorer.height(a).total_cmp(&self.explorer.height(b))).unwrap_or(start)
    }

    /// The last part of a search: to the highest place, until it is no more than the map's errors away.
    fn approach(
        &mut self,
        time: f64,
        chart: &Chart,
        start: GridCell,
        top: GridCell,
    ) -> ControlFlow<SummitOutcome, Twist> {
        let way = self.explorer.way_over(&chart.safe, climbing_costs(chart), start, top).unwrap_or_default();
        let gain = self.explorer.height(top) - self.explorer.reckoning.elevation;
        // On a slope, half a cell is worth several tolerances.
        let is_there = (self.explorer.here() - self.explorer.map.place(top)).norm() < ARRIVED;
        let is_level = gain < self.explorer.parameters.tolerance;
        if is_there || is_level || way.len() < 2 || self.approaches >= MOST_APPROACHES {
            return self.climb_on(time, chart);
        }
        // Ways that end on the top, not those that lead to it.
        self.approaches += u32::from(way_length(&way) < self.explorer.parameters.stride);
        ControlFlow::Continue(self.explorer.drive(time, chart, &way))
    }

    /// A robot on the top stands level: what it feels of a slope leads on, whatever the map says, while that
    /// takes it higher.
    fn climb_on(&mut self, time: f64, chart: &Chart) -> ControlFlow<SummitOutcome, Twist> {
        let (elevation, tolerance) = (self.explorer.reckoning.elevation, self.explorer.parameters.tolerance);
        let has_risen = elevation > self.climbed_from + tolerance;
        match self.explorer.way_up(chart).filter(|(_, gain)| has_risen && *gain > tolerance) {
            Some((way, _)) => {
                self.climbed_from = elevation;
                ControlFlow::Continue(self.explorer.drive(time, chart, &way))
            }
            None => ControlFlow::Break(SummitOutcome::Highest),
        }
    }
}

impl Behaviour for SummitSearch {
    type Observation = SummitObservation;
    type Command = Twist;
    type Outcome = SummitOutcome;

    fn period(&self) -> f64 {
        self.explorer.parameters.period
    }

    fn step(&mut self, time: f64, seen: &SummitObservation) -> Decision<Self> {
        let event = self.explorer.step(time, seen)?;
        Ok(event.answer(SummitOutcome::Stuck, || self.decide(time)))
    }
}

impl<R: Odometry + Lidar + Inertial + ?Sized> Senses<R> for SummitSearch {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut SummitObservation) -> Result<()> {
        self.explorer.sense(robot, seen)
    }
}
