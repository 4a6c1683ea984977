use std::ops::ControlFlow;

use super::follow::Follower;
use super::gaps::Gaps;
use super::lot::{DEPTHS, ParkingKind, SENSOR, SPOT as WIDTH};
use super::search::{Car, Room, search};
use super::spots::spot_middle;
use crate::ParameterError;
use crate::drive::lane_keeping::{Guide, LaneKeeper, LaneKeeperParameters, LaneObservation};
use crate::drive::outline::Outline;
use crate::geometry::{Aabb, Point, Pose, Twist, math};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::reading::check_distances;
use crate::io::{self, Camera, DistanceSensors, Odometry, Psd};
use crate::parameter::require_positive;
use crate::vision::lane_markings::{RoadCamera, RoadModel};

/// Parameters of a [`ParkingDriver`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParkingParameters {
    /// Speed while a spot is looked for, and while the car manoeuvres (m/s).
    pub speed: [f64; 2],
    /// Deceleration behind the spot (m/s²).
    pub brake: f64,
    /// Distance that is kept from boxes (m).
    pub clearance: f64,
    /// Ends of the body along x, about the middle of the rear axle, and half of its width (m).
    pub body: [f64; 3],
    /// Distance between the axles, and half of that between the wheels of each (m).
    pub wheels: [f64; 2],
    /// Greatest curvature of a planned path (1/m); a little more is left for corrections.
    pub curvature: f64,
}

impl Default for ParkingParameters {
    /// For [`parking_car`](super::parking_car), which turns with 2.04 per metre.
    fn default() -> Self {
        Self {
            speed: [0.5, 0.25],
            brake: 1.0,
            clearance: 0.025,
            body: [-0.080, 0.350, 0.095],
            wheels: [0.260, 0.0825],
            curvature: 1.85,
        }
    }
}

impl ParkingParameters {
    fn validate(&self) -> Result<(), ParameterError> {
        require_positive("speed of looking", self.speed[0])?;
        require_positive("speed of manoeuvres", self.speed[1])?;
        require_positive("brake", self.brake)?;
        require_positive("clearance", self.clearance)?;
        require_positive("half width", self.body[2])?;
        require_positive("curvature", self.curvature)
    }
}

/// Observation of a parking car.
#[derive(Debug, Clone, Default)]
pub struct ParkingObservation {
    /// Camera and odometry.
    pub lane: LaneObservation,
    /// Distance to the side of the parking area (m).
    pub side: f64,
}

/// Outcome of parking.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ParkingOutcome {
    /// The car stands in a spot.
    Parked,
    /// There is no path into the spot.
    NoPath,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(ParkingOutcome { Parked: "the car stands in a spot", NoPath: "there is no path into the spot" });

/// Parks a car beside the road: in its lane by camera, past the boxes of a parking area, which it measures by
/// a distance sensor, until it has passed a gap; then by odometry along the shortest path into the gap.
///
/// | state | enters when | does | leaves when |
/// |---|---|---|---|
/// | look | at first | keeps the lane, maps boxes beside it | a gap is passed |
/// | plan | the car stands | searches the shortest path of straights and full locks into the gap | there is one |
/// | drive | a path is found | follows it, forward and in reverse | its end: the car is parked, or plans again |
///
/// ```
/// use roverlab::drive::parking::{ParkingDriver, ParkingKind, ParkingParameters, parking_car};
/// use roverlab::io::control::Behaviour;
/// use roverlab::vision::lane_markings::RoadModel;
/// let camera = parking_car().camera.as_ref().expect("the car has one").into();
/// let parameters = ParkingParameters::default();
/// let driver = ParkingDriver::new(camera, RoadModel::default(), ParkingKind::Parallel, parameters)?;
/// assert!(driver.period() <= 0.05);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ParkingDriver {
    parameters: ParkingParameters,
    kind: ParkingKind,
    keeper: LaneKeeper,
    gaps: Gaps,
    phase: Phase,
    /// Pose in the lane: x along it, y to the left of its centre (m).
    pose: Pose,
    odometry: Option<Pose>,
    /// Distance from the road's centre line to its edge lines (m).
    edge: f64,
    plans: u32,
}

#[derive(Debug, Clone)]
enum Phase {
    Look,
    Brake,
    Drive(Follower),
}

/// Least length of a parallel gap (lengths of the car).
const LEAST: f64 = 1.3;
/// Least width of a perpendicular gap (m): more than one spot of 350 mm.
const SPOT: f64 = 0.355;
/// Longest distance behind a box in which the next one is waited for (m).
const OPEN: f64 = 1.2;
/// Distance that the car goes on behind a gap before it stops (m).
const BEYOND: f64 = 0.30;
/// Distance of the wheels from the lines of a parallel spot, and of a perpendicular one (m): odometry is off
/// by some centimetres at the end of a manoeuvre, and wheels leave 240 mm free in a perpendicular spot's
/// length.
const INSIDE: [f64; 2] = [0.02, 0.06];
/// Direction in which the car has to stand, within (rad).
const ASKEW: f64 = 0.09;
/// Half of the length of a perpendicular spot's middle in which the wheels stand (m).
const HALF_SPOT: f64 = 0.135;
/// Length of road before and behind the gap on which the car manoeuvres, and how far into the other lane (m).
const AROUND: f64 = 1.2;
/// Number of plans before it gives up.
const PLANS: u32 = 4;
/// Speed below which the car stands (m/s).
const STANDS: f64 = 0.02;

impl ParkingDriver {
    /// Creates a driver for a camera and a road. Fails for parameters out of range.
    pub fn new(
        camera: RoadCamera,
        road: RoadModel,
        kind: ParkingKind,
        parameters: ParkingParameters,
    ) -> Result<Self, ParameterError> {
        parameters.validate()?;
        let lane = LaneKeeperParameters { speed: parameters.speed[0], ..LaneKeeperParameters::default() };
        Ok(Self {
            parameters,
            kind,
            keeper: LaneKeeper::new(camera, road, lane)?,
            gaps: Gaps::default(),
            phase: Phase::Look,
            pose: Pose::default(),
            odometry: None,
            edge: 0.0,
            plans: 0,
        })
    }

    /// Direction of the parking area: 1 to the left, -1 to the right.
    fn side(&self) -> f64 {
        match self.kind {
            ParkingKind::Parallel => -1.0,
            ParkingKind::Perpendicular => 1.0,
        }
    }

    /// Distances from the lane's centre to the spots' inner and outer lines (m).
    fn depths(&self) -> (f64, f64) {
        let (line, depth) = match self.kind {
            ParkingKind::Parallel => (0.5 * self.edge, DEPTHS[0]),
            ParkingKind::Perpendicular => (1.5 * self.edge, DEPTHS[1]),
        };
        (line + 0.01, line + depth)
    }

    /// Distance of the wheels from the spot's inner and outer lines (m).
    fn inside(&self) -> f64 {
        INSIDE[usize::from(self.kind == ParkingKind::Perpendicular)]
    }

    /// Maps the box beside the car, if there is one.
    fn map(&mut self, distance: f64) {
        let (_, outer) = self.depths();
        let at = Point::new(SENSOR.0, self.side() * (SENSOR.1 + distance.min(9.0)));
        let hit = self.pose.to_world(at);
        let out = (hit.y * self.side()).abs();
        self.gaps.see(hit.x, (distance.is_finite() && out < outer).then_some(out));
    }

    /// The gap that the car has passed (m).
    fn gap(&self) -> Option<(f64, f64)> {
        let [back, front, _] = self.parameters.body;
        let least = match self.kind {
            ParkingKind::Parallel => LEAST * (front - back),
            ParkingKind::Perpendicular => SPOT,
        };
        self.gaps.find(least, OPEN)
    }

    fn room(&self, (from, to): (f64, f64)) -> Room {
        let p = &self.parameters;
        let (inner, outer) = self.depths();
        let (side, inside) = (self.side(), self.inside());
        let between = |a: (f64, f64), b: (f64, f64)| {
            Aabb::new(Point::new(a.0, side * a.1), Point::new(b.0, side * b.1))
        };
        let boxes = self.gaps.boxes().map(|(near, far, out)| {
            let middle = Pose::new(0.5 * (near + far), side * 0.5 * (out + outer), 0.0);
            let half = 0.5 * (far - near) + p.clearance;
            Outline::new(&middle, (-half, half), 0.5 * (outer - out).abs() + p.clearance)
        });
        let (goal, direction) = match self.kind {
            ParkingKind::Parallel => (between((from, inner + inside), (to, outer - inside)), 0.0),
            ParkingKind::Perpendicular => {
                let boxes: Vec<(f64, f64)> = self.gaps.boxes().map(|(near, far, _)| (near, far)).collect();
                let middle = spot_middle(&boxes, (from, to), WIDTH);
                let goal =
                    between((middle - HALF_SPOT, inner + inside), (middle + HALF_SPOT, outer - inside));
                (goal, -std::f64::consts::FRAC_PI_2)
            }
        };
        Room {
            obstacles: boxes.collect(),
            free: between((from - AROUND, -0.7 * self.edge), (to + AROUND, outer)),
            goal,
            direction,
            tolerance: ASKEW,
        }
    }

    fn car(&self) -> Car {
        let ParkingParameters {
            body: [back, front, half_width], wheels: [base, half_track], curvature, ..
        } = self.parameters;
        Car { body: (back, front), half_width, wheels: (base, half_track), curvature }
    }

    /// Looks for a gap. Returns the command.
    fn look(&mut self, seen: &ParkingObservation) -> io::Result<Twist> {
        let lane =
            self.keeper.see(&seen.lane.image, seen.lane.odometry).map_err(io::Error::caused_by)?.clone();
        if lane.lost {
            return Ok(Twist::STOP);
        }
        let along = self.pose.x + lane.progress(self.keeper.driven());
        self.pose = Pose::new(along, lane.offset, lane.heading);
        self.edge = lane.edge;
        self.map(seen.side);
        if self.gap().is_some_and(|(_, to)| self.pose.x > to + BEYOND) {
            self.phase = Phase::Brake;
        }
        let guide = Guide { path: [0.0; 3], speed: self.parameters.speed[0] };
        Ok(self.keeper.steer_by(&lane, seen.lane.speed, &guide))
    }

    /// Follows odometry.
    fn reckon(&mut self, odometry: Pose) {
        if let Some(before) = self.odometry {
            self.pose = self.pose.compose(&before.inverse().compose(&odometry));
        }
    }

    /// Plans a path from where the car stands. `None` if there is none.
    fn plan(&mut self) -> Option<Phase> {
        let gap = self.gap()?;
        self.plans += 1;
        let path = search(&self.car(), &self.room(gap), self.pose)?;
        Some(Phase::Drive(Follower::new(path, self.pose, self.parameters.speed[1])))
    }

    /// Whether the car is in its spot as far as it knows.
    fn is_parked(&self) -> bool {
        self.gap().is_some_and(|gap| {
            let room = self.room(gap);
            let room = Room { goal: room.goal.inflated(0.5 * self.inside()), tolerance: 1.3 * ASKEW, ..room };
            room.is_parked(&self.car(), &self.pose)
        })
    }
}

impl Behaviour for ParkingDriver {
    type Observation = ParkingObservation;
    type Command = Twist;
    type Outcome = ParkingOutcome;

    fn period(&self) -> f64 {
        1.0 / 30.0
    }

    fn step(&mut self, _time: f64, seen: &ParkingObservation) -> Decision<Self> {
        seen.lane.check()?;
        check_distances("distance beside the car", &[seen.side])?;
        let (odometry, stands) = (seen.lane.odometry, seen.lane.speed.abs() < STANDS);
        if !matches!(self.phase, Phase::Look) {
            self.reckon(odometry);
        }
        self.odometry = Some(odometry);
        let mut phase = std::mem::replace(&mut self.phase, Phase::Look);
        let command = match &mut phase {
            Phase::Look => return Ok(ControlFlow::Continue(self.look(seen)?)),
            Phase::Brake if stands => {
                if self.plans > 0 && self.is_parked() {
                    return Ok(ControlFlow::Break(ParkingOutcome::Parked));
                }
                match self.plan() {
                    Some(next) if self.plans <= PLANS => phase = next,
                    _ => return Ok(ControlFlow::Break(ParkingOutcome::NoPath)),
                }
                Twist::STOP
            }
            Phase::Brake => {
                let speed = (seen.lane.speed - self.parameters.brake * self.period()).max(0.0);
                // Straight on along the lane.
                let bend = -8.0 * self.pose.y - 4.0 * math::sin(self.pose.heading);
                let is_lane = self.plans == 0;
                if is_lane { Twist::new(speed, speed * bend.clamp(-2.0, 2.0)) } else { Twist::STOP }
            }
            Phase::Drive(follower) => {
                if let Some(command) = follower.step(&self.pose, stands) {
                    command
                } else {
                    phase = Phase::Brake;
                    Twist::STOP
                }
            }
        };
        self.phase = phase;
        Ok(ControlFlow::Continue(command))
    }
}

impl<R: Camera + Odometry + DistanceSensors + ?Sized> Senses<R> for ParkingDriver {
    fn prepare(&mut self, robot: &mut R) -> io::Result<()> {
        self.keeper.prepare(robot)
    }

    fn sense(&mut self, robot: &mut R, time: f64, seen: &mut ParkingObservation) -> io::Result<()> {
        self.keeper.sense(robot, time, &mut seen.lane)?;
        let sensor = if self.kind == ParkingKind::Parallel { Psd::RIGHT } else { Psd::LEFT };
        seen.side = robot.distance(sensor)?;
        Ok(())
    }
}
