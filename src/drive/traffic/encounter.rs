//! What a car does at one element in one lap.

use super::actors::{MEETS, STANDS, TrafficActors, between};
use super::scene::{BoxMotion, RoadBox, TrafficScene, ZEBRA};
use super::score::EvasionElement;
use super::turn::RoadTurn;

/// An element of the course, and what the car has done there in this lap.
#[derive(Debug, Clone)]
#[allow(clippy::struct_excessive_bools, reason = "what the car has done, each for itself")]
pub(super) struct Encounter {
    pub(super) element: EvasionElement,
    /// Its box.
    pub(super) index: Option<usize>,
    /// Where it begins along the line, and its length (m).
    along: f64,
    length: f64,
    pub(super) is_touched: bool,
    /// Width of a barred area, and length of the road that a turn skips (m).
    width: f64,
    /// Whether cars have to stand for 3 s.
    is_stop: bool,
    /// Whether the solid line was crossed, whether the car came too near to the box ahead, and whether a
    /// wheel was in the barred area, or in the way of an oncoming box.
    has_crossed: bool,
    is_near: bool,
    has_entered: bool,
    /// Right and fault, as they were when the car left its line behind.
    verdict: (bool, bool),
    /// Longest time that the car stood before it, and since when it stands there (s).
    stood: f64,
    since: Option<f64>,
    progress: Progress,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Progress {
    /// Not within reach in this lap.
    Away,
    /// Ahead, and whether it was near.
    Before(bool),
    /// Passed, at a distance driven (m).
    Behind(f64),
    Done,
}

/// What the referee sees of the car at a time.
pub(super) struct Moment<'m> {
    pub(super) scene: &'m TrafficScene,
    pub(super) actors: &'m TrafficActors,
    /// Position of the front along the line, and distance driven (m).
    pub(super) front: f64,
    pub(super) driven: f64,
    pub(super) time: f64,
    pub(super) speed: f64,
    /// The wheels: position along the line, and distance from the lane's centre towards the edge line (m).
    pub(super) wheels: [(f64, f64); 4],
    /// Whether two wheels have just crossed the centre line.
    pub(super) has_crossed_centre: bool,
    /// Whether the whole car is in its lane.
    pub(super) is_back: bool,
}

/// Result of an encounter: right, fault.
type Verdict = Option<(bool, bool)>;

/// Longest distance between a line and a car that stands before it, by the rules (m).
const BEFORE: f64 = 0.150;
/// The same before an empty crosswalk, where a halt counts against the car (m).
const NEAR: f64 = 0.6;
/// Halt at stop lines and crosswalks, by the rules (s).
const LONG_HALT: f64 = 3.0;
/// Halt at give-way lines, by the rules (s).
const SHORT_HALT: f64 = 1.0;
/// Distance behind an obstacle within which the car has to be back in its lane, by the rules (m).
const BACK: f64 = 2.0;
/// Least distance behind a box in a no-passing zone, by the rules (m).
const FOLLOWING: f64 = 0.3;
/// Distance of an oncoming box behind what blocks the own lane within which cars give way, by the rules (m).
const YIELD: f64 = 1.0;
/// Distance of an oncoming box behind a car's front at which both have passed each other (m).
const APART: f64 = 1.0;
/// Largest distance of a turn's line before the middle of its crossing (m).
const BEFORE_TURN: f64 = 0.9;
/// Distance behind that line within which a car has turned off (m).
const BEHIND_TURN: f64 = 2.0;
/// Distance ahead of a car at which an obstacle counts as met (m).
const MET: f64 = 1.0;
/// Distance from an element beyond which its encounter is over (m).
const AWAY: f64 = 4.0;

impl Encounter {
    fn new(element: EvasionElement, index: Option<usize>, along: f64, length: f64) -> Self {
        Self {
            element,
            index,
            along,
            length,
            is_touched: false,
            width: 0.0,
            is_stop: false,
            has_crossed: false,
            is_near: false,
            has_entered: false,
            verdict: (false, false),
            stood: 0.0,
            since: None,
            progress: Progress::Away,
        }
    }

    /// Whether cars leave their lane for it.
    pub(super) fn is_obstacle(&self, scene: &TrafficScene) -> bool {
        let is_in_lane = |index: usize| scene.boxes[index].is_in_lane(&scene.course);
        matches!(
            self.element,
            EvasionElement::StaticObstacle | EvasionElement::DynamicObstacle | EvasionElement::BarredArea
        ) && self.index.is_none_or(is_in_lane)
    }

    /// Where it is now along the line, and its end (m); `None` off the road.
    pub(super) fn place(&self, actors: &TrafficActors) -> Option<(f64, f64)> {
        let along = self.index.map_or(Some(self.along), |index| actors.along(index))?;
        Some((along, along + self.length))
    }

    /// Watches the car. Returns a verdict once a lap.
    pub(super) fn judge(&mut self, now: &Moment<'_>) -> Verdict {
        let verdict = match self.element {
            EvasionElement::StaticObstacle | EvasionElement::DynamicObstacle => self.judge_obstacle(now),
            EvasionElement::NoPassing => self.judge_zone(now),
            EvasionElement::OncomingObstacle => self.judge_oncoming(now),
            EvasionElement::BarredArea => self.judge_area(now),
            _ => self.judge_line(now),
        };
        if verdict.is_some() {
            self.progress = Progress::Done;
        }
        verdict
    }

    /// Distance ahead of the front (m), after a new lap begins where it is far away.
    fn approach(&mut self, now: &Moment<'_>, along: f64) -> f64 {
        let ahead = between(&now.scene.course, now.front, along);
        if ahead > AWAY || ahead < -AWAY - self.length {
            let (width, is_stop) = (self.width, self.is_stop);
            *self = Self { width, is_stop, ..Self::new(self.element, self.index, self.along, self.length) };
        } else if self.progress == Progress::Away && ahead > 0.0 {
            self.progress = Progress::Before(false);
        }
        ahead
    }

    fn judge_obstacle(&mut self, now: &Moment<'_>) -> Verdict {
        if let Progress::Behind(from) = self.progress {
            let is_in_time = now.driven - from <= BACK;
            return (now.is_back || !is_in_time).then_some((is_in_time, self.is_touched));
        }
        let Some(along) = self.index.and_then(|index| now.actors.along(index)) else {
            // It has left the road; if it was met before, it was not passed.
            let is_missed = self.progress == Progress::Before(true);
            self.approach(now, self.along);
            return is_missed.then_some((false, self.is_touched));
        };
        let ahead = self.approach(now, along);
        if matches!(self.progress, Progress::Before(_)) {
            if ahead < MET {
                self.progress = Progress::Before(true);
            }
            if ahead + self.length < 0.0 {
                self.progress = Progress::Behind(now.driven);
            }
        }
        None
    }

    fn judge_zone(&mut self, now: &Moment<'_>) -> Verdict {
        let ahead = self.approach(now, self.along);
        if !matches!(self.progress, Progress::Before(_)) {
            return None;
        }
        if ahead <= 0.0 {
            self.has_crossed |= now.has_crossed_centre;
            let gap = self.index.and_then(|index| now.actors.along(index));
            let gap = gap.map(|along| between(&now.scene.course, now.front, along));
            self.is_near |= gap.is_some_and(|gap| (0.0..FOLLOWING).contains(&gap));
        }
        (ahead + self.length < 0.0).then_some((!self.is_near, self.has_crossed || self.is_touched))
    }

    /// A box in the other lane: no wheel may be there while the box is beside what blocks the own lane or
    /// within 1 m behind it. Where nothing does, only touching it counts.
    fn judge_oncoming(&mut self, now: &Moment<'_>) -> Verdict {
        let ahead = self.approach(now, self.along);
        let Progress::Before(is_met) = self.progress else { return None };
        let verdict = |it: &Self| Some((!it.has_entered, it.is_touched));
        let Some(along) = self.index.and_then(|index| now.actors.along(index)) else {
            return if is_met { verdict(self) } else { None };
        };
        let course = &now.scene.course;
        let gap = between(course, now.front, along);
        self.progress = Progress::Before(is_met || gap < MET);
        let is_near = gap > 0.0 && between(course, self.along + self.length, along) < YIELD;
        let is_owed = self.length > 0.0 && ahead < MET && is_near;
        let half = 0.5 * course.edge();
        self.has_entered |= is_owed && now.wheels.iter().any(|(_, out)| -out > half);
        if gap < -APART { verdict(self) } else { None }
    }

    fn judge_area(&mut self, now: &Moment<'_>) -> Verdict {
        let ahead = self.approach(now, self.along);
        let course = &now.scene.course;
        let inner = 0.5 * course.edge() - self.width;
        self.has_entered |= now.wheels.iter().any(|&(along, out)| {
            (0.0..self.length).contains(&between(course, self.along, along)) && out > inner
        });
        // The rear wheels are half a metre behind the front at most.
        let is_past = matches!(self.progress, Progress::Before(_)) && ahead + self.length < -0.5;
        is_past.then_some((!self.has_entered, false))
    }

    fn judge_line(&mut self, now: &Moment<'_>) -> Verdict {
        if let Progress::Behind(from) = self.progress {
            let (is_right, is_fault) = self.verdict;
            // A turn skips a part of the line.
            let has_turned = now.driven - from >= 0.5 * self.width;
            let is_right = is_right && (self.element != EvasionElement::Turn || has_turned);
            return (now.driven - from >= self.length).then_some((is_right, is_fault || self.is_touched));
        }
        let ahead = self.approach(now, self.along);
        let reach = if self.element == EvasionElement::EmptyCrosswalk { NEAR } else { BEFORE };
        if now.speed.abs() < STANDS && (0.0..=reach).contains(&ahead) {
            let since = *self.since.get_or_insert(now.time);
            self.stood = self.stood.max(now.time - since);
        } else {
            self.since = None;
        }
        if matches!(self.progress, Progress::Before(_)) && ahead < 0.0 {
            self.progress = Progress::Behind(now.driven);
            self.verdict = self.at_line(now);
        }
        None
    }

    /// Right and fault when the car leaves a line behind.
    fn at_line(&self, now: &Moment<'_>) -> (bool, bool) {
        let is_clear = self.index.is_some_and(|index| now.actors.is_clear(index));
        match self.element {
            EvasionElement::StopLine => (self.stood >= LONG_HALT, self.stood == 0.0),
            EvasionElement::Turn if self.is_stop => (self.stood >= LONG_HALT, self.stood == 0.0),
            EvasionElement::GiveWayLine | EvasionElement::Turn => (self.stood >= SHORT_HALT, false),
            EvasionElement::EmptyCrosswalk => (self.stood == 0.0, false),
            EvasionElement::CrossTraffic => (is_clear, false),
            _ => (self.stood >= LONG_HALT && is_clear, false),
        }
    }
}

/// The elements of a scene.
pub(super) fn encounters(scene: &TrafficScene) -> Vec<Encounter> {
    let turns = RoadTurn::of(&scene.course);
    let mut all: Vec<Encounter> =
        scene.lines().into_iter().map(|(at, is_stop)| of_line(&turns, at, is_stop)).collect();
    let crosses = |at: f64| {
        let is_here = |along: f64| (0.0..ZEBRA).contains(&(along - at));
        scene.boxes.iter().position(|it| it.motion == BoxMotion::Across && is_here(it.along))
    };
    all.extend(scene.zebras().into_iter().map(|at| {
        let person = crosses(at);
        let element =
            if person.is_some() { EvasionElement::Crosswalk } else { EvasionElement::EmptyCrosswalk };
        Encounter::new(element, person, at, ZEBRA)
    }));
    all.extend(scene.barred_areas().into_iter().map(|(at, long, width)| Encounter {
        width,
        ..Encounter::new(EvasionElement::BarredArea, None, at, long)
    }));
    all.extend(scene.boxes.iter().enumerate().filter_map(|(index, it)| of_box(scene, index, it)));
    all.retain(|it| !turns.iter().any(|turn| turn.skips(it.along)));
    all
}

/// The element of a line at which cars stop, before a turn or not.
fn of_line(turns: &[RoadTurn], at: f64, is_stop: bool) -> Encounter {
    let turn = turns.iter().find(|turn| (0.0..BEFORE_TURN).contains(&(turn.from - at)));
    let element = match turn {
        Some(_) => EvasionElement::Turn,
        None if is_stop => EvasionElement::StopLine,
        None => EvasionElement::GiveWayLine,
    };
    let (length, width) = turn.map_or((0.0, 0.0), |turn| (BEHIND_TURN, turn.skipped()));
    Encounter { width, is_stop, ..Encounter::new(element, None, at, length) }
}

/// The element of a box that does not cross the road on foot.
fn of_box(scene: &TrafficScene, index: usize, it: &RoadBox) -> Option<Encounter> {
    let zone = scene.no_passing_zones().into_iter().find(|(from, to)| (*from..*to).contains(&it.along));
    match (it.motion, zone) {
        (BoxMotion::Across, _) => None,
        (BoxMotion::Static, _) => {
            Some(Encounter::new(EvasionElement::StaticObstacle, Some(index), it.along, it.size[0]))
        }
        (BoxMotion::Oncoming(_), _) => {
            let (at, long) = blocked(scene, it.along).unwrap_or((it.along, 0.0));
            Some(Encounter::new(EvasionElement::OncomingObstacle, Some(index), at, long))
        }
        (BoxMotion::Along(_), None) => {
            Some(Encounter::new(EvasionElement::DynamicObstacle, Some(index), it.along, it.size[0]))
        }
        (BoxMotion::Along(_), Some((from, to))) => {
            Some(Encounter::new(EvasionElement::NoPassing, Some(index), from, to - from))
        }
        (BoxMotion::Crossing(_), _) => {
            // Its line is the last one before the crossing.
            let lines = scene.lines();
            let line = lines.iter().map(|(at, _)| *at).filter(|at| *at < it.along).max_by(f64::total_cmp);
            line.map(|at| {
                let length = 2.0 * (it.along - at);
                Encounter::new(EvasionElement::CrossTraffic, Some(index), at, length)
            })
        }
    }
}

/// What blocks the own lane before an oncoming box that begins at a place along the line (m): where it
/// begins, and its length (m).
fn blocked(scene: &TrafficScene, from: f64) -> Option<(f64, f64)> {
    let blocks = |it: &&RoadBox| it.motion == BoxMotion::Static && it.is_in_lane(&scene.course);
    let boxes = scene.boxes.iter().filter(blocks).map(|it| (it.along, it.size[0]));
    let areas = scene.barred_areas().into_iter().map(|(at, long, _)| (at, long));
    let before = boxes.chain(areas).filter(|(at, _)| (0.0..MEETS).contains(&(from - at)));
    before.max_by(|a, b| a.0.total_cmp(&b.0))
}
