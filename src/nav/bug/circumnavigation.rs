use super::body::Body;
use super::doubt::Doubt;
use super::strategy::{Decision, Sight, Strategy};

/// Goes once round, then to the best place to leave. With `BY_RANGE` free ranges count too.
#[derive(Debug, Clone)]
pub(super) struct Circumnavigation<const BY_RANGE: bool> {
    /// How near to the goal the boundary has come.
    least_distance: f64,
    best: Option<Candidate>,
    /// The same among places whose merit the places before have as well; a free range between two obstacles may be there
    /// for a moment only, and not be met again.
    lasting: Option<Candidate>,
    /// The merits of the latest places, if they could be left.
    latest: [Option<f64>; LASTING],
    returning: Option<Returning>,
    doubt: Doubt,
}

/// A place to leave.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    /// How near to the goal it leads.
    merit: f64,
    /// Metres from the hit point along the boundary.
    at: f64,
}

/// The way back to the best place.
#[derive(Debug, Clone, Copy)]
struct Returning {
    /// Where it began, in metres from the hit point.
    from: f64,
    length: f64,
    /// The merit a step ago.
    before: Option<f64>,
}

/// How much worse, in STEPs, the place may seem when it is met again.
const SLACK: f64 = 0.5;
/// How much worse, in metres, for each metre that the place has been missed by.
const SLACK_PER_METRE: f64 = 0.1;
/// After so many robot radii the place has been missed for good, and the next one that can be left at all will do.
const MISSED: f64 = 3.0;
/// For so many steps a merit lasts.
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
    /// How near to the goal leaving here leads; `None` where the way is blocked.
    fn merit(&self, sight: &Sight) -> Option<f64> {
        let free = if BY_RANGE { sight.free.min(sight.distance) * self.doubt.trust() } else { 0.0 };
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

    /// The best place to leave for a goal outside: nearer to it than all of the boundary.
    fn place(&self) -> Option<Candidate> {
        let leads_out = |place: &Candidate| place.merit <= self.least_distance;
        self.lasting.filter(leads_out).or(self.best.filter(leads_out))
    }

    /// Whether the robot is back at the best place.
    fn is_there(&mut self, sight: &Sight) -> bool {
        let merit = self.merit(sight);
        let Some(way) = &mut self.returning else { return false };
        let before = std::mem::replace(&mut way.before, merit);
        let beyond = sight.travelled - way.from - way.length;
        let slack = SLACK * sight.step + SLACK_PER_METRE * beyond.max(0.0);
        let near = MISSED * sight.radius;
        self.place().zip(merit).is_some_and(|(best, merit)| {
            let receding = before.is_some_and(|before| merit > before);
            // Round a corner the robot drives a little farther out or in than the other way.
            let passing = beyond.abs() < near && receding && merit <= best.merit + sight.step;
            let missed = beyond > near && merit <= self.least_distance;
            merit <= best.merit + slack || passing || missed
        })
    }
}

impl<const BY_RANGE: bool> Strategy for Circumnavigation<BY_RANGE> {
    /// Begins a tour. If the last leave has not brought the robot nearer than all of the boundary before, as it promised,
    /// free ranges are relied upon less from now on; so the robot cannot go round the same obstacle for ever.
    fn meet(&mut self, meeting: &Sight) {
        let least_distance = meeting.distance - meeting.free;
        let kept = least_distance <= self.least_distance - 0.5 * meeting.step;
        let mut doubt = self.doubt;
        if !kept {
            doubt.grow();
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
