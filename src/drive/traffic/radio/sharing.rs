use super::message::{CarIntent, CarReport, RoadMessage};
use crate::ParameterError;
use crate::geometry::{Point, Pose, angle_difference, direction, math};
use crate::parameter::{require_not_negative, require_positive};

/// Parameters of [`RoadSharing`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadSharingParameters {
    /// Interval between reports (s).
    pub interval: f64,
    /// Time after which a car that is not heard any more is forgotten (s).
    pub memory: f64,
    /// Distance behind another car (m).
    pub gap: f64,
    /// Distance to the side of another car (m).
    pub clearance: f64,
    /// Deceleration (m/s²).
    pub brake: f64,
    /// Ends of a car's body along x, and half of its width (m).
    pub body: [f64; 3],
}

impl Default for RoadSharingParameters {
    /// For cars like [`RobotSpec::road_car`](crate::world::RobotSpec::road_car) that report five times a
    /// second. The gap is longer than the distance at which a [`TrafficDriver`](super::super::TrafficDriver)
    /// begins to pass.
    fn default() -> Self {
        Self {
            interval: 0.2,
            memory: 3.0,
            gap: 1.1,
            clearance: 0.08,
            brake: 1.2,
            body: [-0.080, 0.350, 0.095],
        }
    }
}

impl RoadSharingParameters {
    fn validate(&self) -> Result<(), ParameterError> {
        require_positive("interval between reports", self.interval)?;
        require_positive("memory", self.memory)?;
        require_not_negative("gap", self.gap)?;
        require_not_negative("clearance", self.clearance)?;
        require_positive("brake behind cars", self.brake)?;
        require_positive("length of the body", self.body[1] - self.body[0])?;
        require_positive("half width", self.body[2])
    }
}

/// How fast a car may drive by what the other cars say: with a gap behind those ahead in its lane, and giving
/// way where paths cross.
///
/// Of two cars whose paths cross, first goes the one that is in the crossing or can no longer stop before it,
/// then one that nobody keeps waiting, then the one that comes from the right.
#[derive(Debug, Clone)]
pub struct RoadSharing {
    parameters: RoadSharingParameters,
    /// Last reports of the other cars: number, time (s), and report.
    others: Vec<(u32, f64, CarReport)>,
    /// Whether the base station has ordered to stand.
    is_stopped: bool,
}

/// Distance ahead of a car's origin in which its lane is known (m).
const SIGHT: f64 = 2.2;
/// Distance between the places along that lane (m).
const STEP: f64 = 0.05;
/// Angle between paths from which they cross rather than join (rad).
const CROSSES: f64 = 0.6;
/// Distance before a crossing path at which a car stands (m).
const BEFORE: f64 = 0.10;

/// Where two paths meet: distances from this car's origin, and from the other one's (m).
#[derive(Debug, Clone, Copy)]
struct Meeting {
    own: f64,
    other: f64,
    /// Angle from this car's path to the other one (rad).
    angle: f64,
}

impl RoadSharing {
    /// Creates it. Fails for parameters out of range.
    pub fn new(parameters: RoadSharingParameters) -> Result<Self, ParameterError> {
        parameters.validate()?;
        Ok(Self { parameters, others: Vec::new(), is_stopped: false })
    }

    /// The parameters.
    pub fn parameters(&self) -> &RoadSharingParameters {
        &self.parameters
    }

    /// Hears a message of a robot at a time (s).
    pub fn hear(&mut self, time: f64, from: u32, message: RoadMessage) {
        match message {
            RoadMessage::Stop => self.is_stopped = true,
            RoadMessage::Go => self.is_stopped = false,
            RoadMessage::Car(report) => {
                self.others.retain(|(id, ..)| *id != from);
                self.others.push((from, time, report));
            }
        }
    }

    /// Distances ahead of a car's origin of the places of its path (m).
    pub fn distances() -> impl Iterator<Item = f64> {
        (0..=(SIGHT / STEP) as usize).map(|i| STEP * i as f64)
    }

    /// Maximum speed at a time (s) for a car with a speed (m/s), and what it is about to do. Its path is that
    /// of its origin, at [`distances`](Self::distances) ahead.
    pub fn limit(&self, time: f64, path: &[Pose], speed: f64) -> (f64, CarIntent) {
        if self.is_stopped {
            return (0.0, CarIntent::Stand);
        }
        let (mut most, mut intent) = (f64::INFINITY, CarIntent::Drive);
        for (_, heard, report) in &self.others {
            let age = time - heard;
            if age > self.parameters.memory {
                continue;
            }
            let other = CarReport { pose: along(report, report.speed * age), ..*report };
            most = most.min(self.behind(path, &other));
            if let Some(meeting) = self.meeting(path, &other)
                && self.gives_way(meeting, speed, &other)
            {
                most = most.min(self.stoppable(self.free(meeting.own) - BEFORE));
                intent = CarIntent::GiveWay;
            }
        }
        (most, intent)
    }

    /// Distance from the car's front to a place ahead of its origin (m).
    fn free(&self, ahead: f64) -> f64 {
        ahead - self.parameters.body[1]
    }

    /// Maximum speed that lets a car stop within a distance (m).
    fn stoppable(&self, distance: f64) -> f64 {
        (2.0 * self.parameters.brake * distance.max(0.0)).sqrt()
    }

    /// Distance between the middles of two cars beside each other (m).
    fn apart(&self) -> f64 {
        2.0 * self.parameters.body[2] + self.parameters.clearance
    }

    /// Maximum speed behind a car that drives in about the same direction.
    fn behind(&self, places: &[Pose], other: &CarReport) -> f64 {
        let [back, front, _] = self.parameters.body;
        let ends = [back, 0.5 * (back + front), front].map(|x| other.pose.to_world(Point::new(x, 0.0)));
        let is_there = |place: &Pose| ends.iter().any(|end| place.distance_to(*end) < self.apart());
        // What is beside the car or behind its front is not ahead of it.
        let first = (front / STEP) as usize;
        let Some(index) = (first..places.len()).find(|&index| is_there(&places[index])) else {
            return f64::INFINITY;
        };
        let angle = angle_difference(other.pose.heading, places[index].heading);
        if angle.abs() > CROSSES {
            return f64::INFINITY;
        }
        let free = self.free(STEP * index as f64) + self.apart() - self.parameters.gap;
        self.stoppable(free) + if free > 0.0 { other.speed * math::cos(angle) } else { 0.0 }
    }

    /// Where the path of another car crosses that of this one, if it does within sight of both.
    fn meeting(&self, places: &[Pose], other: &CarReport) -> Option<Meeting> {
        let reach = self.apart();
        let (back, steps) = (self.parameters.body[0], (SIGHT / STEP) as usize);
        let path: Vec<Pose> = (0..steps).map(|i| along(other, back + STEP * i as f64)).collect();
        let is_near = |one: &Pose, other: &Pose| one.distance_to(other.position()) < reach;
        // Where each comes near the other's path first: both cars find the same.
        let i = places.iter().position(|place| path.iter().any(|there| is_near(place, there)))?;
        let j = path.iter().position(|there| places.iter().any(|place| is_near(place, there)))?;
        let angle = angle_difference(path[j].heading, places[i].heading);
        let crosses = angle.abs() > CROSSES && angle.abs() < std::f64::consts::PI - CROSSES;
        crosses.then_some(Meeting { own: STEP * i as f64, other: back + STEP * j as f64, angle })
    }

    /// Whether this car lets the other one go first.
    fn gives_way(&self, meeting: Meeting, speed: f64, other: &CarReport) -> bool {
        let is_in = |ahead: f64, speed: f64| self.free(ahead) < speed * speed / (2.0 * self.parameters.brake);
        match (is_in(meeting.own, speed), is_in(meeting.other, other.speed)) {
            (true, false) => false,
            (false, true) => true,
            _ if other.intent != CarIntent::Drive => false,
            // A car from the right drives to the left.
            _ => meeting.angle > 0.0,
        }
    }
}

/// Pose of a car a distance ahead on the arc of its lane (m).
fn along(report: &CarReport, ahead: f64) -> Pose {
    let turn = 0.5 * ahead * report.curvature;
    let place = report.pose.position() + direction(report.pose.heading + turn) * ahead;
    Pose::new(place.x, place.y, report.pose.heading + 2.0 * turn)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn path(pose: Pose) -> Vec<Pose> {
        RoadSharing::distances().map(|ahead| pose.compose(&Pose::new(ahead, 0.0, 0.0))).collect()
    }

    fn report(pose: Pose, speed: f64) -> CarReport {
        CarReport { pose, speed, curvature: 0.0, is_in_lane: true, intent: CarIntent::Drive }
    }

    /// What a car at a pose does that has just heard another one.
    fn beside(pose: Pose, speed: f64, other: CarReport) -> (f64, CarIntent) {
        let mut sharing = RoadSharing::new(RoadSharingParameters::default()).unwrap();
        sharing.hear(1.0, 2, RoadMessage::Car(other));
        sharing.limit(1.0, &path(pose), speed)
    }

    #[test]
    fn a_car_keeps_its_distance_to_the_one_ahead_and_no_other() {
        let limit = |x: f64, y: f64, heading: f64| {
            beside(Pose::default(), 0.8, report(Pose::new(x, y, heading), 0.0)).0
        };
        assert_eq!(limit(1.0, 0.0, 0.0), 0.0, "too near");
        assert!((0.3..1.5).contains(&limit(2.0, 0.0, 0.1)), "{}", limit(2.0, 0.0, 0.1));
        for (x, y, heading) in [(1.0, 0.42, 0.0), (-0.5, 0.0, 0.0), (1.0, 0.42, PI), (4.0, 0.0, 0.0)] {
            assert_eq!(limit(x, y, heading), f64::INFINITY, "{x} {y}");
        }
        let moving = beside(Pose::default(), 0.8, report(Pose::new(2.0, 0.0, 0.0), 0.8)).0;
        assert!(moving > limit(2.0, 0.0, 0.0) + 0.7);
    }

    #[test]
    fn silent_cars_are_forgotten_and_orders_are_obeyed() {
        let mut sharing = RoadSharing::new(RoadSharingParameters::default()).unwrap();
        sharing.hear(1.0, 2, RoadMessage::Car(report(Pose::new(1.0, 0.0, 0.0), 0.0)));
        let limit = |sharing: &RoadSharing, time: f64| sharing.limit(time, &path(Pose::default()), 0.0);
        assert_eq!((limit(&sharing, 2.0).0, limit(&sharing, 5.0).0), (0.0, f64::INFINITY));
        sharing.hear(6.0, 9, RoadMessage::Stop);
        assert_eq!(limit(&sharing, 60.0), (0.0, CarIntent::Stand));
        sharing.hear(7.0, 9, RoadMessage::Go);
        assert_eq!(limit(&sharing, 60.0), (f64::INFINITY, CarIntent::Drive));
    }

    proptest! {
        #![proptest_config(crate::testing::cases(64))]
        #[test]
        fn of_two_cars_at_a_crossing_one_gives_way(
            own in 0.9..1.6f64, other in 0.9..1.6f64, speed in 0.0..0.8f64, turn in -PI..PI, is_right in any::<bool>(),
        ) {
            let side = if is_right { 1.0 } else { -1.0 };
            let frame = Pose::new(3.0, -2.0, turn);
            let here = frame.compose(&Pose::new(-own, 0.0, 0.0));
            let there = frame.compose(&Pose::new(0.0, -side * other, side * FRAC_PI_2));
            let mine = beside(here, speed, report(there, speed));
            let its = beside(there, speed, report(here, speed));
            prop_assert!((mine.1 == CarIntent::GiveWay) != (its.1 == CarIntent::GiveWay), "{mine:?} {its:?}");
            let can_stop = |way: f64| way - 0.35 - 0.27 > 0.5 * speed * speed / 1.2 + 0.05;
            if can_stop(own) && can_stop(other) {
                prop_assert_eq!(mine.1 == CarIntent::GiveWay, is_right, "from the right");
            }
        }
    }
}
