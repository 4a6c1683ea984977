use super::ClosedSpline;
use super::centre_line::{CentreLine, CentreLineParameters};
use super::cone::Cone;
use super::error::PlanError;
use super::map::{ConeMap, ConeMapParameters};
use super::profile::{CarLimits, SpeedProfile};
use super::racing_line::{LineSolver, RacingLineParameters};
use super::sight::{Sighting, sightings};
use super::tracker::{LineTracker, TrackerParameters};
use crate::geometry::{Point, Pose, Twist};
use crate::io::{self, Clock, Drive, Lidar, LidarScan};

/// How a track is raced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RacerParameters {
    /// Laps; the first one is for the map.
    pub laps: usize,
    /// What is asked of the tyres and motors at most.
    pub limits: CarLimits,
    /// The same while the track is not known; its top speed is that of the first lap.
    pub first_lap: CarLimits,
    /// Metres that the racing line keeps from the middle of cones.
    pub margin: f64,
    /// How the way between cones is found.
    pub centre_line: CentreLineParameters,
    /// How the map is made.
    pub map: ConeMapParameters,
    /// How lines are followed.
    pub tracker: TrackerParameters,
    /// Seconds from decision to decision.
    pub period: f64,
}

impl Default for RacerParameters {
    fn default() -> Self {
        Self {
            laps: 10,
            limits: CarLimits { grip: 7.5, drive: 4.5, brake: 6.0, top_speed: 20.0 },
            first_lap: CarLimits { grip: 5.0, drive: 3.0, brake: 5.0, top_speed: 6.0 },
            margin: 1.12,
            centre_line: CentreLineParameters::default(),
            map: ConeMapParameters::default(),
            tracker: TrackerParameters::default(),
            period: 0.05,
        }
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
}

/// Races on a track that it does not know: between the cones that it sees in the first lap, on the racing line in all others.
#[derive(Debug, Clone)]
pub struct Racer {
    parameters: RacerParameters,
    map: ConeMap,
    phase: RacePhase,
    laps: usize,
    /// Metres by odometry since the start line was crossed.
    since_line: f64,
    before: f64,
    last: Option<Pose>,
    tracker: Option<LineTracker>,
    solver: LineSolver,
    /// Decisions since the way was planned.
    stale: u32,
    /// Where it drove in the first lap, every two metres.
    driven: Vec<Point>,
    /// Whether a lap was ended since the racing line was planned.
    plan_again: bool,
    /// Decisions until the whole track is tried to be planned again.
    patience: u32,
}

/// Metres around the car within which cones are planned with in the first lap.
const NEAR: f64 = 24.0;
/// Metres in front of where it stands at first, where the line lies at which the racer counts laps.
const LINE: f64 = 6.0;
/// Metres that a lap takes at least.
const SHORTEST: f64 = 40.0;
/// Metres per second at which it feels its way where nothing is known.
const CRAWL: f64 = 1.5;

impl Racer {
    /// A racer at the start.
    pub fn new(parameters: RacerParameters) -> Self {
        Self {
            map: ConeMap::new(parameters.map),
            parameters,
            phase: RacePhase::Mapping,
            laps: 0,
            since_line: 0.0,
            before: -LINE,
            last: None,
            tracker: None,
            solver: LineSolver::default(),
            stale: 0,
            driven: Vec::new(),
            plan_again: false,
            patience: 0,
        }
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

    /// The same for what was found already.
    pub fn decide(&mut self, odometry: Pose, speed: Twist, seen: &[Sighting]) -> Twist {
        self.map.update(odometry, seen);
        self.count(odometry);
        match self.phase {
            RacePhase::Finished => {
                let command = self.follow(speed);
                // Straight on would lead off the track: it brakes along the line.
                let slower = (speed.linear - 0.3).min(command.linear).max(0.0);
                Twist::new(slower, if speed.linear > 0.1 { slower * curvature_of(command) } else { 0.0 })
            }
            RacePhase::Racing => {
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
                self.follow(speed)
            }
        }
    }

    /// Races until all laps are driven and it stands, or a time is over. `watch` is told of every decision.
    pub fn run<R: Clock + Drive + Lidar>(
        &mut self,
        robot: &mut R,
        seconds: f64,
        mut watch: impl FnMut(&mut R, &Self),
    ) -> io::Result<RacePhase> {
        let mut scan = LidarScan::default();
        let end = robot.now()? + seconds;
        while robot.now()? < end {
            robot.scan_into(&mut scan)?;
            let (pose, speed) = (robot.pose()?, robot.speed()?);
            let command = self.step(pose, speed, &scan);
            robot.set_speed(command)?;
            watch(robot, self);
            if self.phase == RacePhase::Finished && speed.linear.abs() < 0.05 {
                break;
            }
            robot.wait(self.parameters.period)?;
        }
        robot.set_speed(Twist::default())?;
        Ok(self.phase)
    }

    /// Counts laps at the line, and ends the race.
    fn count(&mut self, odometry: Pose) {
        let way =
            self.last.replace(odometry).map_or(0.0, |last| (odometry.position() - last.position()).norm());
        self.since_line += way;
        let pose = self.map.pose();
        // The line lies across the start's heading, which is the x axis of the map.
        let along = pose.x - LINE;
        let crossed = self.before < 0.0 && along >= 0.0 && pose.y.abs() < 4.0 && pose.forward().x > 0.3;
        self.before = along;
        if !crossed {
            return;
        }
        // The first time, the race begins.
        let around = self.since_line >= SHORTEST;
        self.since_line = 0.0;
        if !around {
            return;
        }
        self.laps += 1;
        self.plan_again = true;
        if self.laps >= self.parameters.laps {
            self.phase = RacePhase::Finished;
        }
    }

    fn follow(&mut self, speed: Twist) -> Twist {
        let pose = self.map.pose();
        let command = self.tracker.as_mut().and_then(|tracker| tracker.step(pose, speed.linear));
        match command {
            Some((twist, _)) => twist,
            None => Twist::new(CRAWL, 0.0),
        }
    }

    /// Plans with what is known: the whole track if it closes, else as far as it is seen.
    fn explore(&mut self) {
        let own = self.map.pose().to_world(Point::new(self.parameters.tracker.ahead, 0.0));
        if self.driven.last().is_none_or(|last| (own - last).norm() > 2.0) {
            self.driven.push(own);
        }
        if self.laps > 0 && self.patience == 0 {
            self.patience = 20;
            if let Ok(tracker) = self.whole_track() {
                self.tracker = Some(tracker);
                self.plan_again = false;
                self.phase = RacePhase::Racing;
                return;
            }
        }
        self.patience = self.patience.saturating_sub(1);
        let pose = self.map.pose();
        let near: Vec<Cone> = self
            .map
            .cones()
            .filter(|cone| {
                let local = pose.to_local(cone.position);
                local.x > -8.0 && local.coords.norm() < NEAR
            })
            .collect();
        if let Ok(tracker) = self.local_way(&near, pose) {
            self.tracker = Some(tracker);
            self.stale = 0;
        } else {
            self.stale += 1;
            if self.stale > 20 {
                self.tracker = None;
            }
        }
    }

    fn local_way(&self, near: &[Cone], pose: Pose) -> Result<LineTracker, PlanError> {
        let parameters = CentreLineParameters {
            horizon: 18.0,
            shortest_loop: f64::INFINITY,
            ..self.parameters.centre_line
        };
        let line = CentreLine::from_cones(near, pose, &parameters)?;
        let mut points: Vec<Point> = line.corridor.stations().iter().map(|s| s.position).collect();
        // From the car on, so that the line does not begin beyond it.
        let own = pose.to_world(Point::new(self.parameters.tracker.ahead, 0.0));
        let ahead = |p: &Point| (p - own).dot(&pose.forward());
        if points.first().is_some_and(|first| ahead(first) > 0.5) {
            let first = points[0];
            let parts = ((first - own).norm() / 1.0).ceil().max(1.0);
            let lead: Vec<Point> =
                (0..parts as usize).map(|k| own + (first - own) * (k as f64 / parts)).collect();
            points.splice(0..0, lead);
        }
        let limits = self.parameters.first_lap;
        let end = if line.corridor.is_closed() { limits.top_speed } else { 2.0 };
        let profile = SpeedProfile::open(&points, &limits, limits.top_speed, end)?;
        Ok(LineTracker::new(points, profile, false, self.parameters.tracker))
    }

    fn whole_track(&mut self) -> Result<LineTracker, PlanError> {
        let cones: Vec<Cone> = self.map.cones().collect();
        let line = CentreLine::along(&cones, self.map.pose(), &self.driven, &self.parameters.centre_line)?;
        if !line.corridor.is_closed() || line.corridor.length() < SHORTEST {
            return Err(PlanError::NoWay);
        }
        let p = &self.parameters;
        let mut margin = p.margin;
        let found = loop {
            let parameters = RacingLineParameters { margin, ..RacingLineParameters::default() };
            match self.solver.solve(&line.corridor, &parameters) {
                // Where it is too narrow for the margin, the car goes through with less.
                Err(PlanError::TooNarrow { .. }) if margin > 0.75 => margin -= 0.05,
                other => break other?,
            }
        };
        let spline = ClosedSpline::through(&found.points)?;
        let points: Vec<Point> = spline.resample(0.5).iter().map(|place| place.position).collect();
        let profile = SpeedProfile::closed(&points, &p.limits)?;
        Ok(LineTracker::new(points, profile, true, p.tracker))
    }
}

fn curvature_of(twist: Twist) -> f64 {
    if twist.linear.abs() < 1e-6 { 0.0 } else { twist.angular / twist.linear }
}
