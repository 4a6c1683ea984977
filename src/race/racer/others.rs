use super::{LOOKS, NEXT_TO_NONE, RacePhase, Racer, curvature_of, tracker_along};
use crate::geometry::{Point, Pose, Twist};
use crate::io::LidarScan;
use crate::race::passing::Passing;
use crate::race::reckoning::Reckoning;
use crate::race::sight::{ConeSighting, bodies};
use crate::race::tracker::LineTracker;

/// Other cars: distance from the line within which one is in the way, distance ahead at which it begins to
/// matter, and distance kept from the centre of this car to the end of the other (m).
const OTHERS: (f64, f64, f64) = (1.5, 24.0, 4.5);
/// Speed by which a car may be too fast for a new line (m/s).
const TOO_FAST: f64 = 0.5;

impl Racer {
    /// Looks for other cars in a scan, before [`decide`](Self::decide).
    pub fn see_others(&mut self, scan: &LidarScan) {
        self.others = bodies(scan);
    }

    /// Starts another race, from a pose in the map, on the track that it knows from the previous one. Returns
    /// whether it knows the track: otherwise nothing changes.
    pub fn start_again(&mut self, start: Pose) -> bool {
        if !self.tracker.as_ref().is_some_and(LineTracker::is_closed) {
            return false;
        }
        self.map.relocate(start);
        self.reckoning = Reckoning::default();
        (self.laps, self.since_line, self.in_front) = (0, 0.0, false);
        (self.looks, self.stopping, self.doubt) = (LOOKS, None, 0.0);
        (self.phase, self.plan_again) = (RacePhase::Racing, true);
        true
    }

    /// Whether no other car is near.
    pub(super) fn is_alone(&self) -> bool {
        self.passing.as_ref().is_none_or(Passing::is_idle)
    }

    /// Takes a new line of the whole track, at once if it passes the car. After a lap behind another car,
    /// which hides cones, the map and with it the line may have changed much.
    pub(super) fn take_line(&mut self, tracker: LineTracker, speed: Twist) {
        let place = self.map.pose().to_world(Point::new(self.parameters.tracker.ahead, 0.0));
        let passing = self.passing.as_mut().filter(|_| self.has_met).zip(self.tracker.as_ref());
        if !passing
            .is_some_and(|(passing, earlier)| passing.leads_over(earlier.points(), place, speed.linear))
        {
            self.tracker = Some(tracker);
        }
    }

    /// Leads the line around another car, where there is room.
    pub(super) fn pass_others(&mut self, speed: Twist) {
        let Some(passing) = &mut self.passing else { return };
        let pose = self.map.pose();
        let bodies: Vec<Vec<Point>> =
            self.others.iter().map(|body| body.iter().map(|place| pose.to_world(*place)).collect()).collect();
        let own = pose.to_world(Point::new(self.parameters.tracker.ahead, 0.0));
        passing.watch(own, speed.linear, &bodies, self.parameters.period);
        self.has_met |= !passing.is_idle();
        let (parameters, present) = (&self.parameters, self.tracker.as_ref());
        // A line on which the car is too fast already is not come to: it would slide across the track.
        let fast = present.map_or(0.0, |line| line.speed_at(own).min(speed.linear) - TOO_FAST);
        let change = |line: &[Point]| {
            tracker_along(line, parameters).ok().filter(|tracker| tracker.speed_at(own) >= fast)
        };
        if let Some(tracker) = passing.change(&mut self.solver, change) {
            self.tracker = Some(tracker);
        }
    }

    /// Limits a command to keep a distance from a car ahead.
    pub(super) fn behind_others(&self, command: Twist, speed: Twist, seen: &[ConeSighting]) -> Twist {
        let brake = self.parameters.first_lap.brake;
        let fastest = match &self.passing {
            Some(passing) if self.phase == RacePhase::Racing => passing.limit(brake, OTHERS.2),
            _ => self.gap_ahead(seen).map(|gap| (brake * (gap - OTHERS.2).max(0.0)).sqrt()),
        };
        match fastest {
            Some(fastest) if command.linear > fastest => {
                // No harder than the tyres allow besides the bend: a car that slides hits something else.
                let softest = self.tracker.as_ref().map_or(0.0, |line| line.slowest(command, speed));
                let slower = fastest.max(softest.min(command.linear)).max(NEXT_TO_NONE);
                Twist::new(slower, slower * curvature_of(command))
            }
            _ => command,
        }
    }

    /// Distance along the line to what is in the way and too large for a cone.
    fn gap_ahead(&self, seen: &[ConeSighting]) -> Option<f64> {
        let line = self.tracker.as_ref()?;
        let others = seen.iter().filter(|sighting| !sighting.is_cone());
        let places = others.map(|sighting| self.map.pose().to_world(sighting.position));
        places.filter_map(|place| line.distance_to(place, OTHERS.0, OTHERS.1)).min_by(f64::total_cmp)
    }
}
