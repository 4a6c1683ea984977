use super::body::Body;
use super::doubt::Doubt;
use super::strategy::{Decision, Sight, Strategy};

/// Follows the whole boundary, then returns to the best leave point. With `BY_RANGE` free ranges count too.
#[derive(Debug, Clone)]
pub(super) struct Circumnavigation<const BY_RANGE: bool> {
    /// Smallest distance of the boundary from the goal (m).
    least_distance: f64,
    best: Option<Candidate>,
    /// Best point whose merit the points just before share: a free range between two obstacles may exist only
    /// for a moment and not be found again.
    lasting: Option<Candidate>,
    /// Merits of the latest points, if they can be left.
    latest: [Option<f64>; LASTING],
    returning: Option<Returning>,
    doubt: Doubt,
}

/// A candidate leave point.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    /// Smallest distance from the goal that it leads to (m).
    merit: f64,
    /// Distance from the hit point along the boundary (m).
    at: f64,
}

/// The return to the best point.
#[derive(Debug, Clone, Copy)]
struct Returning {
    /// Start, as a distance from the hit point (m).
    from: f64,
    length: f64,
    /// Merit at the previous step.
    before: Option<f64>,
}

/// Accepted loss of merit when the place is met again (steps).
const SLACK: f64 = 0.5;
/// Accepted loss of merit per metre by which the place has been missed (m/m).
const SLACK_PER_METRE: f64 = 0.1;
/// Robot radii after which the place has been missed for good, and the next one that can be left at all will
/// do; and free space behind an edge that makes it a node.
pub(super) const MISSED: f64 = 3.0;
/// Number of steps for which a merit lasts.
const LASTING: usize = 3;

impl<const BY_RANGE: bool> Default for Circumnavigation<BY_RANGE> {
    fn default() -> Self {
        let latest = [None; LASTING];
        Self {
            least_distance: f64::INFINITY,
            best: None,
            lasting: None,
            latest,
            returning: None,
            doubt: Doubt::default(),
        }
    }
}

impl<const BY_RANGE: bool> Circumnavigation<BY_RANGE> {
    /// Smallest distance from the goal reached by leaving here; `None` if the way is blocked.
    fn merit(&self, sight: &Sight) -> Option<f64> {
        let free = if BY_RANGE { self.doubt.trusted(sight) } else { 0.0 };
        sight.is_open().then_some(sight.distance - free)
    }

    fn survey(&mut self, sight: &Sight) {
        self.least_distance = self.least_distance.min(sight.corner_distance());
        let merit = self.merit(sight);
        self.latest.rotate_right(1);
        self.latest[0] = merit;
        let lasting = self.latest.into_iter().try_fold(0.0, |most: f64, merit| Some(most.max(merit?)));
        for (best, merit) in [(&mut self.best, merit), (&mut self.lasting, lasting.filter(|_| BY_RANGE))] {
            if let Some(merit) = merit.filter(|&merit| best.is_none_or(|best| merit < best.merit)) {
                *best = Some(Candidate { merit, at: sight.travelled });
            }
        }
    }

    /// The best leave point if the goal is outside: nearer to it than all of the boundary.
    fn place(&self) -> Option<Candidate> {
        let leads_out = |place: &Candidate| place.merit <= self.least_distance;
        self.lasting.filter(leads_out).or(self.best.filter(leads_out))
    }

    /// Whether the robot is back at the best point.
    fn is_there(&mut self, sight: &Sight) -> bool {
        let merit = self.merit(sight);
        let Some(way) = &mut self.returning else { return false };
        let before = std::mem::replace(&mut way.before, merit);
        let beyond = sight.travelled - way.from - way.length;
        let slack = SLACK * sight.step + SLACK_PER_METRE * beyond.max(0.0);
        let near = MISSED * sight.radius;
        self.place().zip(merit).is_some_and(|(best, merit)| {
            let receding = before.is_some_and(|before| merit > before);
            // At a corner the robot drives slightly wider or tighter than on the way there.
            let passing = beyond.abs() < near && receding && merit <= best.merit + sight.step;
            let missed = beyond > near && merit <= self.least_distance;
            merit <= best.merit + slack || passing || missed
        })
    }
}

impl<const BY_RANGE: bool> Strategy for Circumnavigation<BY_RANGE> {
    /// Begins a circumnavigation. If the last leave did not bring the robot nearer than all of the earlier
    /// boundary as predicted, free ranges are trusted less; this prevents endless circling of one obstacle.
    fn meet(&mut self, meeting: &Sight) {
        let least_distance = meeting.distance - meeting.free;
        let kept = least_distance <= self.least_distance - 0.5 * meeting.step;
        let mut doubt = std::mem::take(&mut self.doubt);
        if !kept {
            doubt.grow(meeting.place.point);
        }
        *self = Self { least_distance, doubt, ..Self::default() };
    }

    fn consider(&mut self, _body: &Body, sight: &Sight) -> Decision {
        if self.returning.is_none() {
            self.survey(sight);
        }
        if self.is_there(sight) { Decision::Leave } else { Decision::Follow }
    }

    fn all_round(&mut self, sight: &Sight, lap: f64) -> Decision {
        if self.returning.is_some() {
            return Decision::BeginLap;
        }
        let Some(best) = self.place() else { return Decision::GiveUp };
        let begin = sight.travelled - lap;
        let ahead = (best.at - begin).rem_euclid(lap);
        let forward = ahead <= 0.5 * lap;
        let length = if forward { ahead } else { lap - ahead };
        self.returning = Some(Returning { from: sight.travelled, length, before: None });
        if forward { Decision::BeginLap } else { Decision::Reverse }
    }
}
