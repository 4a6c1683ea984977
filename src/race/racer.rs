use super::ClosedSpline;
use super::centre_line::CentreLine;
use super::cone::{Cone, RUN_UP};
use super::corridor::{Corridor, CrossSection};
use super::error::LineError;
use super::grip::GripLimit;
use super::lane::lane_where;
use super::lane_model::{Lane, LaneParameters, Way};
use super::lap::around_lap;
use super::map::{ConeMap, ConeMapParameters, FRESH, SHORTEST_LAP, STRIDE};
use super::pair::CentreLineParameters;
use super::profile::{CarLimits, SpeedProfile};
use super::racing_line::{CarOutline, LineSolver, RacingLineParameters};
use super::reckoning::Reckoning;
use super::round::BESIDE;
use super::sight::{ConeSighting, sightings};
use super::tracker::{CRAWL, LineTracker, LineTrackerParameters};
use super::tyres::Tyres;
use crate::ParameterError;
use crate::geometry::{Point, Pose, Twist};
use crate::io::LidarScan;
use crate::parameter::require_positive;

#[cfg(test)]
mod tests;

/// How a track is raced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RacerParameters {
    /// Laps; the first one is for the map.
    pub laps: usize,
    /// What is asked of the tyres and motors at most.
    pub limits: CarLimits,
    /// The same while the track is not known; its top speed is that of the first lap.
    pub first_lap: CarLimits,
    /// The car's outline, by which the racing line keeps clear of cones.
    pub outline: CarOutline,
    /// How the way between cones is found.
    pub centre_line: CentreLineParameters,
    /// How the map is made.
    pub map: ConeMapParameters,
    /// How the lane ahead is found in the first lap.
    pub lane: LaneParameters,
    /// How lines are followed.
    pub tracker: LineTrackerParameters,
    /// Seconds from decision to decision.
    pub period: f64,
}

impl Default for RacerParameters {
    fn default() -> Self {
        Self {
            laps: 10,
            limits: CarLimits {
                // A thirtieth of the grip and a fifteenth of the steering are left for what the controller is wrong by.
                grip: GripLimit::Balance(Tyres { grip: 11.6, lock: 0.58, ..Tyres::default() }),
                drive: 8.0,
                brake: 9.5,
                top_speed: 30.0,
                turning: 1.2,
            },
            // What is seen late is driven slowly: tight bends, in which a car answers late as well.
            first_lap: CarLimits {
                grip: GripLimit::Ellipse { across: 5.0, turned: 1.0, along: 5.0 },
                ..CarLimits::circle(5.0, 3.0, 5.0, 6.0)
            },
            outline: CarOutline { half_width: 0.7, nose: 2.15, ahead: 0.9, room: 0.5 },
            centre_line: CentreLineParameters::default(),
            map: ConeMapParameters::default(),
            lane: LaneParameters::default(),
            tracker: LineTrackerParameters::default(),
            period: 0.05,
        }
    }
}

impl RacerParameters {
    /// Fails with the name of the parameter that is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        self.limits.validate().map_err(|error| error.of("limits"))?;
        self.first_lap.validate().map_err(|error| error.of("first lap"))?;
        self.outline.validate().map_err(|error| error.of("outline"))?;
        self.centre_line.validate().map_err(|error| error.of("centre line"))?;
        self.map.validate().map_err(|error| error.of("map"))?;
        self.lane.validate().map_err(|error| error.of("lane"))?;
        self.tracker.validate().map_err(|error| error.of("tracker"))?;
        require_positive("control period", self.period)
    }

    /// For a car whose tyres do not slip.
    pub fn rolling() -> Self {
        Self { tracker: LineTrackerParameters::rolling(), ..Self::default() }
    }
}

/// What a racer does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RacePhase {
    /// Drives between the cones that it sees, and makes the map.
    Mapping,
    /// Drives the racing line.
    Racing,
    /// All laps are driven: it stands, or brakes.
    Finished,
    /// It found no lane for ten metres of the first lap, or what it sees has not been what its map shows for a while: it stands,
    /// or brakes.
    Lost,
}

/// Races on a track that it does not know: between the cones that it sees in the first lap, on the racing line in all others.
#[derive(Debug, Clone)]
pub struct Racer {
    pub(super) parameters: RacerParameters,
    map: ConeMap,
    phase: RacePhase,
    laps: usize,
    /// Metres by odometry since a lap was counted, or since the start.
    since_line: f64,
    /// Where the line is: the car's pose as it crossed it for the first time.
    line: Option<Pose>,
    /// Whether it was in front of the line since it counted a lap.
    in_front: bool,
    reckoning: Reckoning,
    tracker: Option<LineTracker>,
    solver: LineSolver,
    /// Decisions since the way was planned.
    stale: u32,
    /// Whether a lap was ended since the racing line was planned.
    plan_again: bool,
    /// Decisions until the whole track is tried to be planned again, or a map to be closed.
    patience: u32,
    /// Metres of a lap after which the map was not closed.
    open_lap: Option<f64>,
    /// The lane ahead in the first lap.
    lane: Lane,
    /// Decisions until it drives off: before that, it looks about and turns its wheels.
    looks: u32,
    /// Metres per second that are left of its speed after the last lap, or where it is lost.
    stopping: Option<f64>,
    /// Metres by odometry, and how many they were when it last had a line to follow.
    driven: f64,
    led: f64,
    /// Seconds by which what it sees fitted its map less often than not.
    doubt: f64,
}

/// Places behind the car that are taken for the lane.
const BEHIND_POSES: usize = 4;
/// Metres within which the lane tells on which side of it cones are: what is farther off changes from look to look.
const VOTES: f64 = 5.0;
/// Metres from the line within which another car is in the way, metres ahead at which it begins to matter, and metres, from the
/// middle of a car to the end of another one, that are kept.
const OTHERS: (f64, f64, f64) = (1.5, 24.0, 4.5);
/// Decisions at the start at which it only looks: a cone is one after some sightings, and wheels turn a third of a second to the stop.
const LOOKS: u32 = 10;
/// Metres by which a lap that is closed later begins before the place where the car is now.
const BEFORE_LAP: f64 = 15.0;
/// Metres per second that are next to none: a curvature is kept by them as well.
const NEXT_TO_NONE: f64 = 1e-3;
/// Rounds in which kinks are taken out of a line.
const ROUNDS: usize = 4;
/// Metres that it feels its way before it is lost.
pub(super) const ASTRAY: f64 = 10.0;
/// Seconds of sights that do not fit the map before it is lost.
const DOUBT: f64 = 0.7;
/// Metres per second below which it stands.
pub(super) const STILL: f64 = 0.05;

impl Racer {
    /// A racer at the start. Fails with the name of the parameter that is out of range.
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

    /// What it does now.
    pub fn phase(&self) -> RacePhase {
        self.phase
    }

    /// Laps that it counted.
    pub fn laps(&self) -> usize {
        self.laps
    }

    /// The map that it has made, in the frame of the start.
    pub fn map(&self) -> &ConeMap {
        &self.map
    }

    /// The line that it follows now.
    pub fn line(&self) -> Option<&LineTracker> {
        self.tracker.as_ref()
    }

    /// The command for the speed and the pose that odometry measures and a scan.
    pub fn step(&mut self, odometry: Pose, speed: Twist, scan: &LidarScan) -> Twist {
        self.decide(odometry, speed, &sightings(scan))
    }

    /// The same for what was found already. Where odometry is no number, the car brakes, and goes on from where it was.
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
        self.behind_others(command, seen)
    }

    /// A command that leaves room for what is too large for a cone, another car, on the way ahead.
    fn behind_others(&self, command: Twist, seen: &[ConeSighting]) -> Twist {
        let Some(line) = &self.tracker else { return command };
        let others = seen.iter().filter(|sighting| !sighting.is_cone());
        let places = others.map(|sighting| self.map.pose().to_world(sighting.position));
        let gaps = places.filter_map(|place| line.distance_to(place, OTHERS.0, OTHERS.1));
        let Some(gap) = gaps.min_by(f64::total_cmp) else { return command };
        let fastest = (self.parameters.first_lap.brake * (gap - OTHERS.2).max(0.0)).sqrt();
        if command.linear <= fastest {
            return command;
        }
        let slower = fastest.max(NEXT_TO_NONE);
        Twist::new(slower, slower * curvature_of(command))
    }

    fn command(&mut self, speed: Twist) -> Twist {
        match self.phase {
            RacePhase::Finished | RacePhase::Lost => self.brake(speed),
            RacePhase::Racing => {
                if self.is_elsewhere() {
                    self.phase = RacePhase::Lost;
                    return self.brake(speed);
                }
                if std::mem::take(&mut self.plan_again)
                    && let Ok(tracker) = self.whole_track()
                {
                    // Every lap makes the map better.
                    self.tracker = Some(tracker);
                }
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

    /// Whether it is not where its map says: for some time, most of what it sees near it has not been in the map.
    fn is_elsewhere(&mut self) -> bool {
        let period = self.parameters.period;
        match self.map.fits() {
            Some(true) => self.doubt = (self.doubt - period).max(0.0),
            Some(false) => self.doubt += period,
            None => (),
        }
        self.doubt > DOUBT
    }

    /// Straight on would lead off the track: it brakes along the line. Its own speed tells it nothing of how far it has come with
    /// that: what is measured is some percent of it wrong.
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

    /// Whether it stands and drives no more.
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
        // A line that was crossed lately is not crossed again.
        let ahead = pose.forward().dot(&line.forward());
        self.in_front |= line.to_local(pose.position()).x < -STRIDE || ahead < 0.0;
        if !self.in_front || self.since_line < SHORTEST_LAP || !self.is_behind(line) {
            return;
        }
        if !self.map.is_closed() {
            // What closes the map moves it: the lane lies elsewhere then.
            self.lane.points.clear();
        }
        // Without a loop, it has driven around once all the same.
        let around = self.map.close() || line.to_local(pose.position()).x > 0.6 * FRESH;
        if !(around && self.is_behind(line)) {
            return;
        }
        if !self.map.is_closed() {
            // The first one began at the start, and ended where the car came by there; all others are counted at the same place.
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

    /// Whether the car has crossed the line some metres ago.
    fn is_behind(&self, line: Pose) -> bool {
        let (pose, wrong) = (self.map.pose(), self.map.tolerance());
        let place = line.to_local(pose.position());
        let ahead = pose.forward().dot(&line.forward());
        // A wide track is raced far beside the middle, where the line was crossed first.
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

    /// Plans with what is known: the whole track if it closes, else as far as it is seen.
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

    /// Plans as far as is seen.
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

    /// The middle of the lane ahead.
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
            // Where too many cones are missing or false, by the way of the first lap.
            let places: Vec<Point> = cones.iter().map(|cone| cone.position).collect();
            around_lap(&places, &driven, &self.parameters.lane)?
        };
        let p = &self.parameters;
        let found = self.solver.solve_for(&corridor, &p.outline, &RacingLineParameters::default())?;
        let spline = ClosedSpline::through(&found.points)?;
        let mut points: Vec<Point> = spline.resample(0.5).iter().map(|place| place.position).collect();
        without_kinks(&mut points);
        let profile = SpeedProfile::closed(&points, &p.limits)?;
        // What the steering cannot follow comes of cones on the wrong side.
        if profile.curvatures.iter().any(|bend| bend.abs() > p.tracker.curvature) {
            return Err(LineError::NoWay);
        }
        Ok(LineTracker::new(points, profile, true, p.tracker)?)
    }
}

/// Whether a corridor is a loop around a lap that was driven: the lap is near its middle everywhere, and it is nowhere else.
fn holds(corridor: &Corridor, lap: &[Point]) -> bool {
    let stations = corridor.stations();
    let near = |a: Point, b: Point, most: f64| (a - b).norm_squared() < most * most;
    let inside = |place: &Point| stations.iter().any(|station| near(station.position, *place, BESIDE));
    let driven =
        |station: &CrossSection| lap.iter().any(|place| near(station.position, *place, BESIDE + 1.0));
    corridor.is_closed()
        && corridor.length() > SHORTEST_LAP
        && lap.iter().all(inside)
        && stations.iter().all(driven)
}

/// Takes kinks out of a loop, where narrow places bend it at a point: no car turns its wheels so fast, and centimetres are enough.
fn without_kinks(points: &mut [Point]) {
    let n = points.len();
    // Towards the middle of the neighbours, and then as much outwards again, as bends would shrink.
    for share in [0.5, -0.51].repeat(ROUNDS) {
        let old = points.to_vec();
        for (i, point) in points.iter_mut().enumerate() {
            let middle = nalgebra::center(&old[(i + n - 1) % n], &old[(i + 1) % n]);
            *point += (middle - old[i]) * share;
        }
    }
}

fn curvature_of(twist: Twist) -> f64 {
    if twist.linear.abs() < 1e-6 { 0.0 } else { twist.angular / twist.linear }
}
