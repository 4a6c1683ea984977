mod passing;
#[cfg(test)]
mod tests;
mod turn;
mod turning;

use std::ops::ControlFlow;

use super::obstacles::{Obstacle, SAME, ZEBRA, is_at, is_in_crossing, is_in_zebra, obstacles};
use super::parameters::TrafficParameters;
use super::shift::Shift;
use crate::ParameterError;
use crate::drive::lane_keeping::{Guide, LaneKeeper, LaneObservation, LaneOutcome};
use crate::geometry::Twist;
use crate::io::control::{Behaviour, Decision, Senses};
use crate::io::{self, Camera, Odometry};
use crate::vision::lane_markings::{RoadCamera, RoadModel};
use crate::vision::road_elements::{RoadElement, RoadElementFinder, RoadElementKind};

/// State of a [`TrafficDriver`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TrafficState {
    /// Keeps its lane.
    Follow,
    /// Stays behind an obstacle that it may not pass.
    Behind,
    /// Is beside its lane to pass an obstacle.
    Pass,
    /// Returns to its lane.
    Return,
    /// Brakes before a line or a crosswalk.
    Stop,
    /// Stands before it.
    Wait,
    /// Turns off at a crossing.
    Turn,
}

/// Drives a car in traffic by camera and odometry: in its lane, to a halt at lines and before pedestrians,
/// and past obstacles.
///
/// | state | enters when | does | leaves when |
/// |---|---|---|---|
/// | `Follow` | at first | keeps the lane's centre | a line, an occupied crosswalk or an obstacle is near |
/// | `Behind` | an obstacle is in the own lane, and the centre line is solid or the other lane is not free | stays `following` behind it, and farther if a box comes in the other lane | it may pass: `Pass`; the obstacle is gone: `Follow` |
/// | `Pass` | an obstacle is in the own lane | shifts into the other lane | the obstacle is behind the rear axle: `Return`; a box comes before the car is near: `Behind` |
/// | `Return` | it is passed | shifts back | the shift is over: `Follow` |
/// | `Stop` | a stop line, a give-way line or a crosswalk with a pedestrian is ahead | brakes to stand `gap` before it | the car stands: `Wait`; the crosswalk is free: as before |
/// | `Wait` | the car stands at the line | stands | the time of `halts` is over, and nobody is on the crosswalk or crossing: as before |
/// | `Turn` | an arrow is before a crossing at which the car need not stop any more | an arc onto the other road by odometry, then onto its lane by camera | the lane is where odometry expects it: `Follow` |
///
/// `Stop` and `Wait` add to the other states, whose path the car keeps. In each state, the speed is at most
/// what bends and sight allow ([`LaneKeeper`]), what stops the car before a box in its way, what the numbers
/// of speed zones allow, and `crosswalk` at crosswalks.
///
/// # Limits
///
/// The start box and signs are not handled. Lanes are changed along curves for a car at the rules' size.
/// Oncoming traffic is seen from 4 m on, and on straights; what appears when the car is already within 0.5
/// m of what it passes is not given way. Give-way lines of which less than a third is left are not seen.
/// `roverlab traffic --campaign` counts what goes wrong.
///
/// ```
/// use roverlab::drive::traffic::{TrafficDriver, TrafficParameters, TrafficState};
/// use roverlab::vision::lane_markings::RoadModel;
/// use roverlab::world::RobotSpec;
/// let camera = RobotSpec::road_car().camera.as_ref().expect("the car has one").into();
/// let driver = TrafficDriver::new(camera, RoadModel::default(), TrafficParameters::default())?;
/// assert_eq!(driver.state(), TrafficState::Follow);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct TrafficDriver {
    parameters: TrafficParameters,
    keeper: LaneKeeper,
    finder: RoadElementFinder,
    /// Direction of the other lane: 1 to the left, -1 to the right.
    side: f64,
    /// Metres per metre of the rules.
    road_size: f64,
    lateral: Lateral,
    halt: Option<Halt>,
    /// Towards the other lane.
    shift: Shift,
    /// Distance driven along the road (m), and the last time (s).
    driven: f64,
    time: Option<f64>,
    /// Positions of lines where the car has stopped (m).
    released: Vec<f64>,
    /// Last time at which somebody was on the road ahead (s).
    occupied: f64,
    /// The obstacle that it passes, and time (s) and distance driven (m) when that was last seen.
    passed: Option<(Obstacle, f64, f64)>,
    /// The turn that has begun.
    turn: Option<turn::Turn>,
    /// Maximum speed that others allow, and that of the speed zone (m/s).
    limit: f64,
    zone: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Lateral {
    Own,
    Behind,
    Pass,
    Return,
}

/// A place by the distance driven (m) where the car stops.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Halt {
    Approach {
        place: f64,
    },
    /// Stands since a time (s).
    Stand {
        place: f64,
        since: f64,
    },
}

/// Length of a crosswalk with the part behind it that pedestrians hide (m).
const CROSSWALK: f64 = 0.75;
/// Length of a crossing between its line and the far edge (m).
const CROSSING: f64 = 1.2;
/// Distance beyond the right edge line at which traffic from the right has priority, by the rules (m).
const PRIORITY: f64 = 0.25;
/// Width of a line across the lane (m).
const LINE: f64 = 0.04;
/// Speed below which the car stands (m/s).
const STANDS: f64 = 0.02;
/// Speed at which the car rolls to a line (m/s).
const ROLLS: f64 = 0.05;
/// Time for which the road has to be free (s).
const FREE: f64 = 0.7;
/// Number of a speed limit of 1 m/s, by the rules.
const NUMBER: f64 = 36.0;
/// Fraction of a limit that is driven, because the speed varies.
const WITHIN: f64 = 0.93;
/// Distance before a speed zone at which the car has slowed down (m).
const SLOWED: f64 = 0.10;
/// Distance behind a speed zone at which the car speeds up (m).
const ENDED: f64 = 0.15;

impl TrafficDriver {
    /// Creates a driver for a camera and a road. Fails for parameters out of range.
    pub fn new(
        camera: RoadCamera,
        road: RoadModel,
        parameters: TrafficParameters,
    ) -> Result<Self, ParameterError> {
        parameters.validate()?;
        Ok(Self {
            parameters,
            keeper: LaneKeeper::new(camera, road, parameters.lane)?,
            finder: RoadElementFinder::new(camera, road)?,
            side: if road.left_hand { -1.0 } else { 1.0 },
            road_size: road.size,
            lateral: Lateral::Own,
            halt: None,
            shift: Shift::default(),
            driven: 0.0,
            time: None,
            released: Vec::new(),
            occupied: 0.0,
            passed: None,
            turn: None,
            limit: f64::INFINITY,
            zone: f64::INFINITY,
        })
    }

    /// Limits the speed (m/s) until the next call, for whoever knows more of the road: other cars by radio.
    pub fn set_limit(&mut self, speed: f64) {
        self.limit = speed.max(0.0);
    }

    /// The state.
    pub fn state(&self) -> TrafficState {
        if self.turn.is_some() {
            return TrafficState::Turn;
        }
        match (self.halt, self.lateral) {
            (Some(Halt::Stand { .. }), _) => TrafficState::Wait,
            (Some(Halt::Approach { .. }), _) => TrafficState::Stop,
            (None, Lateral::Own) => TrafficState::Follow,
            (None, Lateral::Behind) => TrafficState::Behind,
            (None, Lateral::Pass) => TrafficState::Pass,
            (None, Lateral::Return) => TrafficState::Return,
        }
    }

    /// What it has found on the road.
    pub fn elements(&self) -> impl Iterator<Item = RoadElement> {
        self.finder.elements()
    }

    /// The lane keeper with its estimate.
    pub fn keeper(&self) -> &LaneKeeper {
        &self.keeper
    }

    /// Distance from the car's front to a place ahead of its origin (m).
    fn gap(&self, ahead: f64) -> f64 {
        ahead - self.parameters.body[0]
    }

    /// Maximum speed that lets the car stop within a distance (m).
    fn stoppable(&self, distance: f64, speed: f64) -> f64 {
        let free = distance - self.parameters.lane.delay * speed.max(0.0);
        (2.0 * self.parameters.brake * free.max(0.0)).sqrt()
    }

    /// Updates the state. Returns the maximum speed.
    fn decide(&mut self, time: f64, speed: f64) -> f64 {
        let elements: Vec<RoadElement> = self.finder.elements().collect();
        let most = self.halt_speed(time, speed, &elements).min(self.zone_speed(&elements));
        let most = most.min(self.crosswalk_speed(&elements));
        // A wait that has just ended forgets what was crossing.
        let elements: Vec<RoadElement> = self.finder.elements().collect();
        let mut obstacles = obstacles(&elements, self.side, self.road_size);
        // Those behind a line are no reason to change lanes before it: traffic may be crossing there.
        if let Some(Halt::Approach { place } | Halt::Stand { place, .. }) = self.halt {
            obstacles.retain(|it| it.ahead < place - self.driven);
        }
        // Nor is what is in a crossing: it drives on.
        let (crossing, mut obstacles): (Vec<_>, Vec<_>) =
            obstacles.into_iter().partition(|it| is_in_crossing(&elements, it.ahead, self.road_size));
        self.remember(time, &mut obstacles);
        self.change_lanes(speed, &obstacles);
        obstacles.extend(crossing);
        most.min(self.free_speed(&obstacles))
    }

    /// Maximum speed in a speed zone and before one. A zone begins when the car's front reaches its number,
    /// and ends when the rear has passed the one that is struck out.
    fn zone_speed(&mut self, elements: &[RoadElement]) -> f64 {
        let mut most = f64::INFINITY;
        for RoadElement { kind, ahead, .. } in elements {
            match *kind {
                _ if is_in_zebra(elements, *ahead, self.road_size) => {}
                RoadElementKind::SpeedLimit(number) => {
                    let limit = WITHIN * self.road_size * f64::from(number) / NUMBER;
                    let left = (self.gap(*ahead) - self.road_size * SLOWED).max(0.0);
                    most = most.min((limit * limit + 2.0 * self.parameters.brake * left).sqrt());
                    if left == 0.0 {
                        self.zone = limit;
                    }
                }
                RoadElementKind::SpeedLimitEnd if *ahead < -ENDED * self.road_size => {
                    self.zone = f64::INFINITY;
                }
                _ => {}
            }
        }
        most.min(self.zone)
    }

    /// Maximum speed before crosswalks, and until the car's front is beyond.
    fn crosswalk_speed(&self, elements: &[RoadElement]) -> f64 {
        let TrafficParameters { crosswalk, brake, .. } = self.parameters;
        let is_zebra = |element: &&RoadElement| element.kind == RoadElementKind::Zebra;
        let ahead = elements.iter().filter(is_zebra).map(|element| self.gap(element.ahead));
        let most = |gap: f64| (crosswalk * crosswalk + 2.0 * brake * gap.max(0.0)).sqrt();
        ahead.filter(|gap| *gap > -CROSSWALK * self.road_size).map(most).fold(f64::INFINITY, f64::min)
    }

    /// Stops at lines and crosswalks. Returns the maximum speed.
    fn halt_speed(&mut self, time: f64, speed: f64, elements: &[RoadElement]) -> f64 {
        if let Some(Halt::Stand { place, since }) = self.halt {
            self.wait(time, (place, since), elements);
            return 0.0;
        }
        let Some(place) = self.next_halt(elements) else {
            self.halt = None;
            return f64::INFINITY;
        };
        let left = self.gap(place - self.driven) - self.parameters.gap;
        self.halt = Some(Halt::Approach { place });
        if left < 0.03 && speed.abs() < STANDS {
            self.halt = Some(Halt::Stand { place, since: time });
            self.occupied = time;
        }
        if left < 0.01 { 0.0 } else { self.stoppable(left, speed).max(ROLLS) }
    }

    /// Waits at a line until its time is over and nobody is on the road.
    fn wait(&mut self, time: f64, (place, since): (f64, f64), elements: &[RoadElement]) {
        let ahead = place - self.driven;
        let is_here = |element: &&RoadElement| (element.ahead - ahead).abs() < self.road_size * SAME;
        let shows =
            |kind: RoadElementKind| elements.iter().filter(is_here).any(|element| element.kind == kind);
        let is_crosswalk = shows(RoadElementKind::Zebra);
        let is_short = shows(RoadElementKind::GiveWayLine) && !shows(RoadElementKind::StopLine);
        let [line, crossing] = [LINE, CROSSING].map(|length| self.road_size * length);
        let is_occupied = if is_crosswalk {
            self.sees_pedestrian(ahead)
        } else {
            self.finder.sees_box((ahead + line, ahead + line + crossing), self.road_size * PRIORITY, 0.0)
        };
        if is_occupied {
            self.occupied = time;
        }
        let halt = self.parameters.halts[usize::from(is_short && !is_crosswalk)];
        if time - since >= halt && time - self.occupied > FREE {
            // What has crossed is gone: the road was seen to be free.
            self.finder.forget_boxes((ahead, ahead + crossing));
            self.released.push(place);
            self.released.retain(|place| self.driven - place < 1.0);
            self.halt = None;
        }
    }

    /// Whether the car stops at a place ahead (m).
    fn is_stopping_at(&self, ahead: f64) -> bool {
        let is_there = |place: f64| (place - self.driven - ahead).abs() < self.road_size * SAME;
        matches!(self.halt, Some(Halt::Approach { place }) if is_there(place))
    }

    /// Whether somebody is on a crosswalk a distance ahead (m): between its stripes, no foot tells a box.
    fn sees_pedestrian(&self, ahead: f64) -> bool {
        let [crosswalk, zebra] = [CROSSWALK, ZEBRA].map(|length| self.road_size * length);
        self.finder.sees_box((ahead, ahead + crosswalk), 0.0, zebra)
    }

    /// The next place where the car has to stop, by the distance driven (m).
    fn next_halt(&self, elements: &[RoadElement]) -> Option<f64> {
        let has_to_stop = |element: &&RoadElement| match element.kind {
            // By the rules, elements are a metre apart: a line at a crosswalk is one of its stripes' ends.
            RoadElementKind::StopLine | RoadElementKind::GiveWayLine => {
                !is_in_zebra(elements, element.ahead, self.road_size)
            }
            RoadElementKind::Zebra => {
                elements.iter().any(|other| is_at(other, element.ahead, self.road_size))
                    || self.is_stopping_at(element.ahead) && self.sees_pedestrian(element.ahead)
            }
            _ => false,
        };
        let is_open = |place: &f64| {
            self.gap(place - self.driven) > -0.05
                && self.released.iter().all(|done| (done - place).abs() > self.road_size * SAME)
        };
        elements.iter().filter(has_to_stop).map(|element| self.driven + element.ahead).find(is_open)
    }
}

impl Behaviour for TrafficDriver {
    type Observation = LaneObservation;
    type Command = Twist;
    type Outcome = LaneOutcome;

    fn period(&self) -> f64 {
        self.parameters.lane.period
    }

    fn step(&mut self, time: f64, seen: &LaneObservation) -> Decision<Self> {
        seen.check()?;
        let seconds = self.time.map_or(0.0, |before| time - before);
        self.time = Some(time);
        self.expect_lane();
        let lane = self.keeper.see(&seen.image, seen.odometry).map_err(io::Error::caused_by)?.clone();
        let metres = self.keeper.driven();
        self.driven += lane.progress(metres);
        if let Some(command) = self.follow_turn(seen, &lane) {
            return Ok(ControlFlow::Continue(command));
        }
        let gray = self.keeper.gray(seen.image.width()).map_err(io::Error::caused_by)?;
        self.finder.see(gray, &lane, metres, seconds);
        if lane.lost {
            return Ok(ControlFlow::Continue(Twist::STOP));
        }
        let speed = self.decide(time, seen.speed).min(self.limit);
        self.begin_turn(&seen.odometry);
        let delayed = self.driven + self.parameters.lane.delay * seen.speed.max(0.0);
        let path = self.shift.at(delayed).map(|value| self.side * value);
        Ok(ControlFlow::Continue(self.keeper.steer_by(&lane, seen.speed, &Guide { path, speed })))
    }
}

impl<R: Camera + Odometry + ?Sized> Senses<R> for TrafficDriver {
    fn prepare(&mut self, robot: &mut R) -> io::Result<()> {
        self.keeper.prepare(robot)
    }

    fn sense(&mut self, robot: &mut R, time: f64, seen: &mut LaneObservation) -> io::Result<()> {
        self.keeper.sense(robot, time, seen)
    }
}
