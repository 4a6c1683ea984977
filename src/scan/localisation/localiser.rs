use nalgebra::Matrix3;

use super::hypothesis::{Bench, KNOWN};
use super::search::search;
use super::{Hypothesis, LocalisationMap, LocaliserParameters};
use crate::geometry::{Pose, angle_difference, math, normalize_angle};
use crate::io::{Error, LidarScan, Result};

/// Result of a [`Localiser`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Localisation {
    /// Unknown: no scan yet, no pose explains the scans, too many poses do, or none is known to within 30 mm.
    Lost,
    /// Several poses explain the scans: their number, and the most probable one.
    Several(usize, Hypothesis),
    /// A single pose.
    One(Hypothesis),
}

impl Localisation {
    /// The most probable pose.
    pub fn best(&self) -> Option<Hypothesis> {
        match self {
            Localisation::Lost => None,
            Localisation::Several(_, best) | Localisation::One(best) => Some(*best),
        }
    }

    /// Number of possible poses.
    pub fn count(&self) -> usize {
        match self {
            Localisation::Lost => 0,
            Localisation::Several(count, _) => *count,
            Localisation::One(_) => 1,
        }
    }
}

/// Global localisation in a known world, without a known start (the task of section 4.3).
///
/// A branch-and-bound search finds all poses in the world that explain the first scan. Each becomes a
/// hypothesis: a pose with a covariance, which moves with odometry, is matched to each scan and weighted by
/// how well it explains it (P. Jensfelt and S. Kristensen, "Active global localization for a mobile robot
/// using multiple hypothesis tracking", 2001). Poses that the world does not distinguish remain equally
/// probable and are reported as several. If too many poses explain a scan, as along a bare wall, the robot is
/// lost until it sees more. If none explains the scans, for example because the robot was carried away, the
/// search starts again.
///
/// ```
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::io::{Odometry, Manoeuvres, Lidar, Clock};
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::scan::{Localiser, LocaliserParameters, LocalisationMap};
/// use roverlab::world::{RobotSpec, Scene, Wall, World};
/// # fn main() -> roverlab::io::Result<()> {
/// let mut world = World::walled(2.0, 3.0);
/// world.walls.push(Wall::new(Point::new(0.0, 2.0), Point::new(0.9, 2.0)));
/// let start = Pose::new(1.3, 0.7, 2.0);
/// let scene = Scene::with_robot(world.clone(), RobotSpec::s4(), start);
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let mut robot = simulation.robot(0)?;
/// let mut localiser = Localiser::new(LocalisationMap::new(&world)?, LocaliserParameters::default())?;
/// for _ in 0..10 {
///     robot.turn(0.3, 1.0)?;
///     robot.wait_done()?;
///     let (odometry, scan) = (robot.pose()?, robot.scan()?);
///     localiser.update(odometry, &scan)?;
/// }
/// let found = localiser.localisation();
/// assert_eq!(found.count(), 1);
/// assert!(found.best().unwrap().pose.distance_to(start.position()) < 0.02);
/// assert_eq!(simulation.truth().robot(0)?.contacts, 0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Localiser {
    map: LocalisationMap,
    parameters: LocaliserParameters,
    hypotheses: Vec<Hypothesis>,
    bench: Option<Bench>,
    odometry: Option<Pose>,
    /// Distance driven (m).
    driven: f64,
    /// Odometry at the last update of the weights.
    viewed: Option<Pose>,
    /// Odometry at the last search without a usable result.
    searched: Option<Pose>,
    /// Number of consecutive unexplained scans.
    unexplained: u32,
    /// Number of searches.
    searches: u32,
}

/// Number of matching steps for candidates of a search.
const SEARCH_STEPS: usize = 10;
/// Number of matching steps while tracking.
const TRACK_STEPS: usize = 3;
/// Standard deviation of a candidate's pose (m, rad).
const CANDIDATE_SPREAD: f64 = 0.15;
/// Fractions of explained beams that a search requires, tried in this order.
const SHARES: [f64; 4] = [0.92, 0.8, 0.7, EXPLAINED];
/// Probability that a beam is not as expected at the robot's own pose, as beside edges (fitted to the
/// campaign's rooms).
const MISSED: f64 = 0.032;
/// Standard deviations of the number of such beams that are allowed.
const ALLOWED: f64 = 3.0;
/// Turns from which each pose found is matched again (rad).
const TURNS: [f64; 6] = [-0.12, -0.08, -0.04, 0.04, 0.08, 0.12];
/// Logarithm of a likelihood by which another pose must be better to take the place of one found.
const BETTER: f64 = 0.01;
/// Motion after which a failed search is repeated (m, rad).
const LOOK_AGAIN: (f64, f64) = (0.5, 0.5);
/// Minimum probability of a hypothesis, relative to the best one.
const COUNTS: f64 = 0.02;
/// Minimum fraction of beams as expected.
const EXPLAINED: f64 = 0.6;
/// Number of consecutive unexplained scans after which the search starts again.
const PATIENCE: u32 = 8;
/// Maximum number of hypotheses; with more, the scan is too ambiguous.
const MOST: usize = 64;

impl Localiser {
    /// A localiser that knows only the map.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(map: LocalisationMap, parameters: LocaliserParameters) -> Result<Self> {
        parameters.validate()?;
        Ok(Self {
            map,
            parameters,
            hypotheses: Vec::new(),
            bench: None,
            odometry: None,
            driven: 0.0,
            viewed: None,
            searched: None,
            unexplained: 0,
            searches: 0,
        })
    }

    /// Starts at a pose known to within a few centimetres and degrees, instead of searching the whole world.
    pub fn start_at(&mut self, pose: Pose) {
        self.hypotheses = vec![Hypothesis::new(pose, KNOWN)];
        (self.odometry, self.viewed, self.searched, self.unexplained) = (None, None, None, 0);
    }

    /// Most probable pose now, by odometry since the last scan.
    pub fn place(&self, odometry: Pose) -> Option<Pose> {
        let best = self.hypotheses.first()?;
        let last = self.odometry.unwrap_or(odometry);
        Some(best.pose.compose(&last.inverse().compose(&odometry)))
    }

    /// All hypotheses, the most probable one first.
    pub fn hypotheses(&self) -> &[Hypothesis] {
        &self.hypotheses
    }

    /// Result of the localisation.
    pub fn localisation(&self) -> Localisation {
        let Some(best) = self.hypotheses.first().filter(|best| best.explained >= EXPLAINED) else {
            return Localisation::Lost;
        };
        let least = COUNTS * best.probability;
        let likely = self.hypotheses.iter().filter(|other| other.probability >= least);
        let (count, widest) =
            likely.fold((0, 0.0_f64), |(count, widest), other| (count + 1, widest.max(other.deviation())));
        match count {
            _ if widest > KNOWN => Localisation::Lost,
            1 => Localisation::One(*best),
            count => Localisation::Several(count, *best),
        }
    }

    /// The map.
    pub fn map(&self) -> &LocalisationMap {
        &self.map
    }

    /// Number of searches of the whole world.
    pub fn searches(&self) -> u32 {
        self.searches
    }

    /// Takes a scan made at a pose by odometry.
    ///
    /// # Errors
    ///
    /// If the pose is not finite or the scan has fewer than eight beams.
    pub fn update(&mut self, odometry: Pose, scan: &LidarScan) -> Result<()> {
        if !odometry.is_finite() {
            return Err(Error::invalid_input("observed pose", format!("{odometry:?}"), "finite numbers"));
        }
        let beams = scan.ranges.len();
        if beams < 8 || scan.angle_increment.abs() < 1e-9 {
            return Err(Error::invalid_input(
                "beams of the scan",
                beams,
                "at least 8 in different directions",
            ));
        }
        let mut bench = match self.bench.take() {
            Some(bench) if bench.is_for(beams) => bench,
            _ => Bench::new(&self.map, scan),
        };
        let motion = self.odometry.map_or(Pose::default(), |last| last.inverse().compose(&odometry));
        self.driven += motion.position().coords.norm();
        if self.hypotheses.is_empty() {
            if self.is_worth_a_search(&odometry) {
                self.search(scan, &mut bench);
                (self.viewed, self.searched) = (Some(odometry), Some(odometry));
            }
        } else {
            let other_view = self.is_other_view(&odometry);
            if other_view {
                self.viewed = Some(odometry);
            }
            self.track(&motion, scan, &mut bench, other_view);
        }
        self.odometry = Some(odometry);
        self.bench = Some(bench);
        self.tidy();
        self.give_up();
        Ok(())
    }

    fn is_other_view(&self, odometry: &Pose) -> bool {
        self.viewed.is_none_or(|last| is_beyond(&last, odometry, self.parameters.view))
    }

    fn is_worth_a_search(&self, odometry: &Pose) -> bool {
        self.searched.is_none_or(|last| is_beyond(&last, odometry, LOOK_AGAIN))
    }

    /// Creates hypotheses for all poses that explain a scan about as well as the best one.
    fn search(&mut self, scan: &LidarScan, bench: &mut Bench) {
        self.searches += 1;
        let bounds = self.map.within_reach(self.driven.min(scan.range_max));
        for share in SHARES {
            let Some(poses) = search(&self.map, &bounds, scan, &self.parameters, share) else { break };
            if !self.try_poses(poses, share, scan, bench) {
                self.hypotheses.clear();
                break;
            }
            self.unite();
            if self.hypotheses.len() <= MOST {
                self.try_turned(share, scan, bench);
            }
            let best = self.hypotheses.iter().map(|other| other.explained).fold(0.0, f64::max);
            let as_well = best - allowed(scan.ranges.len());
            if as_well >= share || share == EXPLAINED {
                self.hypotheses.retain(|other| other.explained >= as_well);
                break;
            }
            self.hypotheses.clear();
        }
        self.unite();
        if self.hypotheses.len() > MOST {
            self.hypotheses.clear();
        }
        // One scan shows what is possible; the following ones how probable it is.
        self.hypotheses.iter_mut().for_each(|hypothesis| hypothesis.log_weight = 0.0);
    }

    /// Creates hypotheses for those poses that explain a fraction of a scan after matching. False once more
    /// than [`MOST`] explain it as well as any could: the others, of which a round room has thousands, do not
    /// matter then.
    fn try_poses(&mut self, poses: Vec<Pose>, share: f64, scan: &LidarScan, bench: &mut Bench) -> bool {
        let as_well_as_any = 1.0 - allowed(scan.ranges.len());
        let mut certain: Vec<Hypothesis> = Vec::new();
        for pose in poses {
            let mut hypothesis = Hypothesis::new(pose, CANDIDATE_SPREAD);
            hypothesis.log_weight =
                hypothesis.match_scan(&self.map, scan, bench, &self.parameters, SEARCH_STEPS);
            if hypothesis.explained < share || !self.is_possible(&hypothesis) {
                continue;
            }
            self.hypotheses.push(hypothesis);
            let is_new = !certain.iter().any(|other| other.is_same(&hypothesis));
            if is_new && hypothesis.explained >= as_well_as_any {
                certain.push(hypothesis);
                if certain.len() > MOST {
                    return false;
                }
            }
        }
        true
    }

    /// Matches the scan again from headings around those found. Where walls consist of short pieces, as in a
    /// round room, a pose turned by half a piece fits its surroundings best, but not as well as the true one.
    fn try_turned(&mut self, share: f64, scan: &LidarScan, bench: &mut Bench) {
        for index in 0..self.hypotheses.len() {
            let Pose { x, y, heading } = self.hypotheses[index].pose;
            for turn in TURNS {
                let mut turned =
                    Hypothesis::new(Pose::new(x, y, normalize_angle(heading + turn)), CANDIDATE_SPREAD);
                turned.log_weight = turned.match_scan(&self.map, scan, bench, &self.parameters, SEARCH_STEPS);
                let is_known = |other: &Hypothesis| {
                    other.is_same(&turned) && other.log_weight + BETTER >= turned.log_weight
                };
                if turned.explained >= share
                    && self.is_possible(&turned)
                    && !self.hypotheses.iter().any(is_known)
                {
                    self.hypotheses.push(turned);
                }
            }
        }
    }

    /// Whether the robot's place is free.
    fn is_possible(&self, hypothesis: &Hypothesis) -> bool {
        self.map.is_free(hypothesis.pose.position(), 0.5 * self.parameters.radius)
    }

    fn track(&mut self, motion: &Pose, scan: &LidarScan, bench: &mut Bench, other_view: bool) {
        for hypothesis in &mut self.hypotheses {
            hypothesis.predict(motion, &self.parameters);
            let likelihood = hypothesis.match_scan(&self.map, scan, bench, &self.parameters, TRACK_STEPS);
            if other_view {
                hypothesis.log_weight += likelihood;
            }
        }
        let map = &self.map;
        let radius = 0.5 * self.parameters.radius;
        self.hypotheses.retain(|hypothesis| map.is_free(hypothesis.pose.position(), radius));
        if self.hypotheses.is_empty() {
            self.searched = None;
        }
    }

    /// Sorts, merges and weights the hypotheses, and drops improbable ones.
    fn tidy(&mut self) {
        self.unite();
        let best = self.hypotheses.first().map_or(0.0, |best| best.log_weight);
        let least = best + math::ln(self.parameters.least_probability);
        self.hypotheses.retain(|hypothesis| hypothesis.log_weight >= least);
        let total: f64 = self.hypotheses.iter().map(|other| math::exp(other.log_weight - best)).sum();
        for hypothesis in &mut self.hypotheses {
            hypothesis.log_weight -= best;
            hypothesis.probability = math::exp(hypothesis.log_weight) / total;
        }
    }

    /// Sorts the hypotheses, best first, and keeps only the best of equal ones.
    fn unite(&mut self) {
        self.hypotheses.retain(|hypothesis| hypothesis.log_weight.is_finite());
        self.hypotheses.sort_by(|a, b| b.log_weight.total_cmp(&a.log_weight));
        let mut kept: Vec<Hypothesis> = Vec::with_capacity(self.hypotheses.len());
        for hypothesis in self.hypotheses.drain(..) {
            if !kept.iter().any(|other| other.is_same(&hypothesis)) {
                kept.push(hypothesis);
            }
        }
        self.hypotheses = kept;
    }

    /// Starts again if no pose explains the scans.
    fn give_up(&mut self) {
        let Some(best) = self.hypotheses.first() else { return };
        self.unexplained = if best.explained >= EXPLAINED { 0 } else { self.unexplained + 1 };
        if self.unexplained >= PATIENCE {
            (self.unexplained, self.searched) = (0, None);
            self.hypotheses.clear();
        }
    }

    /// Covariance of the most probable pose.
    pub fn covariance(&self) -> Option<Matrix3<f64>> {
        self.hypotheses.first().map(|best| best.covariance)
    }
}

/// Fraction of beams by which a pose may explain less than the best one and still count; beyond that, the
/// next scans leave it no probability. Of few beams it is a larger one, as a single beam decides more.
fn allowed(beams: usize) -> f64 {
    MISSED + ALLOWED * (MISSED / beams as f64).sqrt()
}

/// Whether a pose is farther from another one than a distance or an angle.
fn is_beyond(last: &Pose, pose: &Pose, (far, turned): (f64, f64)) -> bool {
    last.distance_to(pose.position()) > far || angle_difference(last.heading, pose.heading).abs() > turned
}
