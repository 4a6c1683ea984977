use super::ClosedSpline;
use super::centre_line::CentreLine;
use super::cone::{Cone, RUN_UP};
use super::error::LineError;
use super::lane::lane_where;
use super::lane_model::{Lane, Way};
use super::lap::{around_lap, holds, without_kinks};
use super::map::{ConeMap, FRESH, SHORTEST_LAP, STRIDE};
use super::passing::Passing;
use super::profile::SpeedProfile;
use super::racing_line::{LineSolver, RacingLineParameters};
use super::reckoning::Reckoning;
use super::sight::{ConeSighting, sightings};
use super::tracker::{CRAWL, LineTracker};
use crate::ParameterError;
use crate::geometry::{Point, Pose, Twist};
use crate::io::LidarScan;

mod others;
mod parameters;
#[cfg(test)]
mod tests;

pub use parameters::RacerParameters;

/// Phase of a race.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RacePhase {
    /// Drives between the visible cones, and maps them.
    Mapping,
    /// Drives the racing line.
    Racing,
    /// All laps are driven: it brakes or stands.
    Finished,
    /// It found no lane for ten metres of the first lap, or its detections have contradicted the map for a
    /// while: it brakes or stands.
    Lost,
}

/// Races on an unknown track: between the visible cones in the first lap, on the racing line in all others.
///
/// ```
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::race::{RaceOutcome, RacePhase, Racer, RacerParameters, TrackOptions, generate};
/// let track = generate(1, &TrackOptions { length: [120.0, 180.0], ..TrackOptions::default() })?.track;
/// let scene = track.scene(&[track.start_pose().expect("a start")]);
/// let simulation = Simulation::new(&scene, SimOptions::default())?;
/// let mut racer = Racer::new(RacerParameters::default())?;
/// // Only the first ten seconds: it drives between the cones that its lidar sees, and maps them.
/// let outcome = run(&mut simulation.robot(0)?, &mut racer, 10.0, |_, _, _| {})?;
/// assert_eq!((outcome, racer.phase()), (RaceOutcome::TimedOut, RacePhase::Mapping));
/// assert!(racer.map().cones().count() > 10 && simulation.truth().robot(0)?.contacts == 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Racer {
    pub(super) parameters: RacerParameters,
    map: ConeMap,
    phase: RacePhase,
    laps: usize,
    /// Distance by odometry since the last counted lap, or since the start (m).
    since_line: f64,
    /// Pose of the line: that of the car at its first crossing.
    line: Option<Pose>,
    /// Whether it was in front of the line since the last counted lap.
    in_front: bool,
    reckoning: Reckoning,
    tracker: Option<LineTracker>,
    /// Other cars: seen points, and how one is passed on the known track.
    others: Vec<Vec<Point>>,
    passing: Option<Passing>,
    /// Whether it has met another car on the known track.
    has_met: bool,
    solver: LineSolver,
    /// Number of decisions since the path was planned.
    stale: u32,
    /// Whether a lap has ended since the racing line was planned.
    plan_again: bool,
    /// Number of decisions until the next attempt to plan the whole track, or to close the map.
    patience: u32,
    /// Length of a lap after which the map was not closed (m).
    open_lap: Option<f64>,
    /// The lane ahead in the first lap.
    lane: Lane,
    /// Number of decisions until it starts; before, it looks around and turns its wheels.
    looks: u32,
    /// Commanded speed while stopping, after the last lap or when lost (m/s).
    stopping: Option<f64>,
    /// Distance by odometry (m); `led` is that at which it last had a line to follow.
    driven: f64,
    led: f64,
    /// Accumulated time by which its detections contradicted the map rather than agreed (s).
    doubt: f64,
}

/// Number of poses behind the car that count as its lane.
const BEHIND_POSES: usize = 4;
/// Distance within which the lane decides on which side a cone is; farther off, it changes between
/// observations (m).
const VOTES: f64 = 5.0;
/// Number of initial steps without motion: a cone needs several detections, and the wheels take a third of a
/// second to turn fully.
const LOOKS: u32 = 10;
/// Distance by which a lap that is closed later begins before the current position (m).
const BEFORE_LAP: f64 = 15.0;
/// Speed below which the vehicle counts as standing; the last curvature is kept (m/s).
const NEXT_TO_NONE: f64 = 1e-3;
/// Distance driven without a lane after which the car is lost (m).
pub(super) const ASTRAY: f64 = 10.0;
/// Duration of detections that contradict the map after which the car is lost (s).
const DOUBT: f64 = 0.7;
/// Speed below which the car stands (m/s).
pub(super) const STILL: f64 = 0.05;

impl Racer {
    /// A racer at the start.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(parameters: RacerParameters) -> Result<Self, ParameterError> {
        parameters.validate()?;
        Ok(Self {
            map: ConeMap::new(parameters.map)?,
            parameters,
            phase: RacePhase::Mapping,
            laps: 0,
            since_line: 0.0,
            line: None,
            in_front: false,
            reckoning: Reckoning::default(),
            tracker: None,
            others: Vec::new(),
            passing: None,
            has_met: false,
            solver: LineSolver::default(),
            stale: 0,
            plan_again: false,
            patience: 0,
            open_lap: None,
            lane: Lane::unknown(parameters.lane.usual),
            looks: LOOKS,
            stopping: None,
            driven: 0.0,
            led: 0.0,
            doubt: 0.0,
        })
    }

    /// Present phase.
    pub fn phase(&self) -> RacePhase {
        self.phase
    }

    /// Number of counted laps.
    pub fn laps(&self) -> usize {
        self.laps
    }

    /// Its map, in the frame of the start.
    pub fn map(&self) -> &ConeMap {
        &self.map
    }

    /// The line that it follows.
    pub fn line(&self) -> Option<&LineTracker> {
        self.tracker.as_ref()
    }

    /// Command for a pose and a velocity by odometry and a scan.
    pub fn step(&mut self, odometry: Pose, speed: Twist, scan: &LidarScan) -> Twist {
        self.see_others(scan);
        self.decide(odometry, speed, &sightings(scan))
    }

    /// The same for given detections. If odometry is not finite, the car brakes, and then continues from its
    /// last pose.
    pub fn decide(&mut self, odometry: Pose, speed: Twist, seen: &[ConeSighting]) -> Twist {
        if !(odometry.is_finite() && speed.is_finite()) {
            return Twist::STOP;
        }
        let way = self.reckoning.step(odometry, speed, &self.parameters.tracker.tyres);
        self.since_line += way;
        self.driven += way;
        self.map.update(self.reckoning.pose(), seen);
        self.count();
        let command = self.command(speed);
        if self.looks > 0 {
            self.looks -= 1;
            return Twist::new(NEXT_TO_NONE, NEXT_TO_NONE * curvature_of(command));
        }
        self.behind_others(command, speed, seen)
    }

    fn command(&mut self, speed: Twist) -> Twist {
        match self.phase {
            RacePhase::Finished | RacePhase::Lost => self.brake(speed),
            RacePhase::Racing => {
                if self.is_elsewhere() {
                    self.phase = RacePhase::Lost;
                    return self.brake(speed);
                }
                if self.is_alone()
                    && std::mem::take(&mut self.plan_again)
                    && let Ok(tracker) = self.whole_track()
                {
                    // Every lap improves the map.
                    self.take_line(tracker, speed);
                }
                self.pass_others(speed);
                self.follow(speed)
            }
            RacePhase::Mapping => {
                self.explore();
                let command = self.follow(speed);
                if self.driven - self.led > ASTRAY {
                    self.phase = RacePhase::Lost;
                    return self.brake(speed);
                }
                command
            }
        }
    }

    /// Whether most detections near the car have contradicted the map for some time.
    fn is_elsewhere(&mut self) -> bool {
        let period = self.parameters.period;
        match self.map.fits() {
            Some(true) => self.doubt = (self.doubt - period).max(0.0),
            Some(false) => self.doubt += period,
            None => (),
        }
        self.doubt > DOUBT
    }

    /// Brakes along the line, because going straight on would leave the track. The commanded speed falls by
    /// time, not by the measured speed: the relative measurement error is a few percent.
    fn brake(&mut self, speed: Twist) -> Twist {
        if self.tracker.as_ref().is_some_and(|tracker| !tracker.is_closed()) {
            self.look_ahead();
        }
        let command = self.follow(speed);
        let slowing = self.parameters.first_lap.brake * self.parameters.period;
        let stopping = self.stopping.unwrap_or(speed.linear) - slowing;
        self.stopping = Some(stopping);
        let slower = stopping.min(command.linear).max(0.0);
        Twist::new(slower, if speed.linear > 0.1 { slower * curvature_of(command) } else { 0.0 })
    }

    /// Whether it has finished driving and stands.
    pub fn is_done(&self, speed: Twist) -> bool {
        matches!(self.phase, RacePhase::Finished | RacePhase::Lost) && speed.linear.abs() < STILL
    }

    /// Counts laps at the line, and ends the race.
    fn count(&mut self) {
        if self.phase == RacePhase::Lost {
            return;
        }
        let pose = self.map.pose();
        let Some(line) = self.line else {
            self.line = (self.since_line >= RUN_UP).then_some(pose);
            return;
        };
        // A line that was crossed recently is not crossed again.
        let ahead = pose.forward().dot(&line.forward());
        self.in_front |= line.to_local(pose.position()).x < -STRIDE || ahead < 0.0;
        if !self.in_front || self.since_line < SHORTEST_LAP || !self.is_behind(line) {
            return;
        }
        if !self.map.is_closed() {
            // Closing moves the map, so the previous lane no longer applies.
            self.lane.points.clear();
        }
        // Without a loop, it has driven around once all the same.
        let around = self.map.close() || line.to_local(pose.position()).x > 0.6 * FRESH;
        if !(around && self.is_behind(line)) {
            return;
        }
        if !self.map.is_closed() {
            // The first one began at the start, and ended where the car came by there; all others are counted
            // at the same place.
            let past = line.to_local(self.map.pose().position()).x + RUN_UP;
            self.open_lap = Some(self.since_line - if self.laps == 0 { past } else { 0.0 });
        }
        self.since_line = 0.0;
        self.in_front = false;
        self.laps += 1;
        self.plan_again = true;
        if self.laps >= self.parameters.laps {
            self.phase = RacePhase::Finished;
        }
    }

    /// Whether the car crossed the line within the last metres.
    fn is_behind(&self, line: Pose) -> bool {
        let (pose, wrong) = (self.map.pose(), self.map.tolerance());
        let place = line.to_local(pose.position());
        let ahead = pose.forward().dot(&line.forward());
        // On a wide track, the racing line may be far from where the line was first crossed.
        let aside = wrong.max(self.parameters.lane.half_width[1] + 1.0);
        (0.0..FRESH + wrong).contains(&place.x) && place.y.abs() < aside && ahead > 0.3
    }

    fn follow(&mut self, speed: Twist) -> Twist {
        let pose = self.map.pose();
        let command = self.tracker.as_mut().and_then(|tracker| tracker.step(pose, speed));
        let Some((twist, _)) = command else { return Twist::new(CRAWL, 0.0) };
        self.led = self.driven;
        twist
    }

    /// Plans with the known cones: the whole track if it closes, otherwise the visible part.
    fn explore(&mut self) {
        if self.map.is_closed() && self.laps > 0 && self.patience == 0 {
            self.patience = 20;
            if let Ok(tracker) = self.whole_track() {
                self.tracker = Some(tracker);
                self.plan_again = false;
                self.phase = RacePhase::Racing;
                return;
            }
        }
        if let Some(lap) = self.open_lap
            && self.patience == 0
            && !self.map.is_closed()
        {
            self.patience = 4;
            self.map.begin_later(lap + BEFORE_LAP);
            if self.map.close() {
                self.lane.points.clear();
            }
        }
        self.patience = self.patience.saturating_sub(1);
        self.look_ahead();
    }

    /// Plans the visible part.
    fn look_ahead(&mut self) {
        let pose = self.map.pose();
        let near: Vec<Cone> = self
            .map
            .fresh_cones()
            .filter(|cone| {
                let local = pose.to_local(cone.position);
                local.x > -8.0 && local.coords.norm() < FRESH
            })
            .collect();
        if let Ok(tracker) = self.lane_ahead(&near, pose) {
            self.tracker = Some(tracker);
            self.stale = 0;
        } else {
            self.stale += 1;
            if self.stale > 20 {
                self.tracker = None;
            }
        }
    }

    /// The centre line of the lane ahead.
    fn lane_ahead(&mut self, near: &[Cone], pose: Pose) -> Result<LineTracker, LineError> {
        let middle = Pose::new(self.parameters.tracker.ahead, 0.0, 0.0);
        let trail: Vec<Pose> = self.map.trail().collect();
        let behind = trail.iter().rev().take(BEHIND_POSES).rev().map(|pose| pose.compose(&middle));
        let own = pose.compose(&middle);
        let behind: Vec<Pose> = behind.filter(|pose| own.to_local(pose.position()).x < -0.5).collect();
        let earlier: Vec<Pose> = self.map.earlier(FRESH).map(|pose| pose.compose(&middle)).collect();
        let near_it = |place: &Point| (place - own.position()).norm() < FRESH;
        let others: Vec<Point> = self.map.fresh_others().filter(near_it).collect();
        let way = Way { behind: &behind, car: own, earlier: &earlier, others: &others };
        let found = lane_where(near, &way, &self.lane, &self.parameters.lane).ok_or(LineError::NoWay)?;
        for (edge, side) in found.edges.iter().zip([1, -1]) {
            let places = edge.iter().map(|&cone| near[cone].position);
            self.map.vote_side(places.filter(|place| (place - own.position()).norm() < VOTES), side);
        }
        let limits = self.parameters.first_lap;
        let profile = SpeedProfile::open(&found.points, &limits, limits.top_speed, 2.0)?;
        self.lane = found;
        Ok(LineTracker::new(self.lane.points.clone(), profile, false, self.parameters.tracker)?)
    }

    fn whole_track(&mut self) -> Result<LineTracker, LineError> {
        let cones: Vec<Cone> = self.map.cones().collect();
        let ahead = Point::new(self.parameters.tracker.ahead, 0.0);
        let driven: Vec<Point> = self.map.trail().map(|pose| pose.to_world(ahead)).collect();
        let corridor = CentreLine::along(&cones, self.map.pose(), &driven, &self.parameters.centre_line)
            .map(|line| line.corridor)
            .ok()
            .filter(|corridor| holds(corridor, &driven));
        let corridor = if let Some(corridor) = corridor {
            corridor
        } else {
            // If too many cones are missing or false, use the path of the first lap.
            let places: Vec<Point> = cones.iter().map(|cone| cone.position).collect();
            around_lap(&places, &driven, &self.parameters.lane)?
        };
        let (p, line) = (&self.parameters, RacingLineParameters::default());
        let margins = self.solver.margins_for(&corridor, &p.outline, &line)?;
        let found = self.solver.solve_within(&corridor, &corridor.room(&margins), &line);
        let tracker = tracker_along(&found.points, p)?;
        let mut passing = Passing::new(corridor, p.outline, margins, found.offsets, tracker.profile());
        if let Some(earlier) = &self.passing {
            passing.remember(earlier, self.map.pose().to_world(ahead));
        }
        self.passing = Some(passing);
        Ok(tracker)
    }
}

/// Tracks a closed line as fast as possible.
fn tracker_along(line: &[Point], p: &RacerParameters) -> Result<LineTracker, LineError> {
    let spline = ClosedSpline::through(line)?;
    let mut points: Vec<Point> = spline.resample(0.5).iter().map(|place| place.position).collect();
    without_kinks(&mut points);
    let profile = SpeedProfile::closed(&points, &p.limits)?;
    // A curvature beyond the steering results from cones on the wrong side.
    if profile.curvatures.iter().any(|bend| bend.abs() > p.tracker.curvature) {
        return Err(LineError::NoWay);
    }
    Ok(LineTracker::new(points, profile, true, p.tracker)?)
}

fn curvature_of(twist: Twist) -> f64 {
    if twist.linear.abs() < 1e-6 { 0.0 } else { twist.angular / twist.linear }
}
