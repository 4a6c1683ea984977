use super::SpeedProfile;
use super::corridor::{Corridor, CrossSection};
use super::racing_line::{CarOutline, LineSolver, RacingLineParameters};
use crate::geometry::{Point, Vector};

#[cfg(test)]
mod tests;

/// Passing of another car on a known track.
///
/// The other car is tracked in the frame of the centre line: distance along it, offset, speed. It moves the
/// edge of the track: on the stretch where the two cars will be side by side, the racing line is solved again
/// within what it leaves free on one of its sides. Without enough room there, the car follows it.
#[derive(Debug, Clone)]
pub(super) struct Passing {
    corridor: Corridor,
    outline: CarOutline,
    /// Distance of each station from the first one, and of a lap (m).
    along: Vec<f64>,
    length: f64,
    /// Room that the car needs to the right and to the left of its line, and the offsets that this leaves
    /// (m).
    margins: Vec<[f64; 2]>,
    room: Vec<[f64; 2]>,
    /// Speed on the racing line at each station (m/s).
    speeds: Vec<f64>,
    /// Offset of the present line at each station (m).
    offsets: Vec<f64>,
    /// Whether that is not the racing line.
    deviates: bool,
    own: Own,
    other: Option<Other>,
    away: Option<Away>,
    /// Side on which the other car is being passed: 1 for its left, -1 for its right.
    side: Option<f64>,
    /// Number of decisions since the line was solved.
    age: u32,
}

/// This car along the centre line (m), beside it (m), and its speed (m/s).
#[derive(Debug, Clone, Copy, Default)]
struct Own {
    along: f64,
    aside: f64,
    speed: f64,
}

/// Another car: its tail along the centre line (m), its middle beside it (m), its speed along it and to its
/// left (m/s), and the time since it was last seen (s).
#[derive(Debug, Clone, Copy)]
struct Other {
    tail: f64,
    aside: f64,
    speed: f64,
    drift: f64,
    unseen: f64,
}

/// Another car that is out of sight: distances from this car, around the lap, to where it was last seen and
/// to where it is if it has kept its speed (m), and that speed (m/s).
#[derive(Debug, Clone, Copy)]
struct Away {
    between: [f64; 2],
    speed: f64,
}

/// Extent of a thing along the centre line and beside it (m).
#[derive(Debug, Clone, Copy)]
struct Extent {
    along: [f64; 2],
    aside: [f64; 2],
}

/// Distance from the rear axle to the tail (m). The other car is of the same kind.
const TAIL: f64 = 0.45;
/// Least size of a car's visible part (half-widths): more than half of its rear.
const CAR_LIKE: f64 = 1.4;
/// Distance ahead at which another car begins to matter (m).
const HORIZON: f64 = 24.0;
/// Number of decisions between two solutions.
const DECISIONS: u32 = 5;
/// Gains of the filter of the other car, for a residual: position, speed (1/s), offset, lateral speed (1/s).
const GAINS: [f64; 4] = [0.4, 1.0, 0.3, 1.0];
/// Time that it takes to give way to a car that comes nearer from the side (s).
const GIVE_WAY: f64 = 0.5;
/// Residual beyond which a seen car is another one (m).
const ANOTHER: f64 = 5.0;
/// Time after which a car ahead that is not seen any more may be anywhere from there on (s).
const FORGOTTEN: f64 = 3.0;
/// Distance kept to the other car's tail while the line changes, and to its nose after passing (m).
const APART: f64 = 3.0;
/// Time, and least distance, over which the line changes sides (s, m).
const CHANGE: (f64, f64) = (1.2, 6.0);
/// Acceleration expected when the way is free (m/s²): half of what the motors can do.
const GAIN_SPEED: f64 = 4.0;
/// Maximum distance in which a car is to be passed (m).
const LONGEST: f64 = 120.0;
/// Least lateral distance between the sides of two cars (m).
const BESIDE: f64 = 0.25;
/// Least width of the range of offsets in which a line is solved (m).
const NARROWEST: f64 = 0.1;
/// Share of the free width that is kept to the other car.
const SPARE: f64 = 0.5;
/// Preference for the side once chosen (m of room).
const CHOSEN: f64 = 0.3;
/// Distance behind and ahead of the car on which the line stays, for a smooth change (m), and the time that
/// steering takes (s).
const KEPT: ([f64; 2], f64) = ([3.0, 1.5], 0.2);
/// Distance from a line within which a car is on it (m).
const ON_LINE: f64 = 0.3;
/// Maximum speed above that of a car that is passed (m/s).
const CLOSING: f64 = 6.0;

impl Other {
    /// The offsets between which its middle is until one can give way (m).
    fn between(&self) -> [f64; 2] {
        let soon = self.aside + self.drift * GIVE_WAY;
        [self.aside.min(soon), self.aside.max(soon)]
    }
}

impl Passing {
    /// For a racing line, given by its offsets, with its speeds.
    pub(super) fn new(
        corridor: Corridor,
        outline: CarOutline,
        margins: Vec<[f64; 2]>,
        racing: Vec<f64>,
        profile: &SpeedProfile,
    ) -> Self {
        let stations = corridor.stations();
        let n = stations.len();
        let mut along = Vec::with_capacity(n);
        let mut length = 0.0;
        for (i, station) in stations.iter().enumerate() {
            along.push(length);
            length += (stations[(i + 1) % n].position - station.position).norm();
        }
        let speeds = (0..n).map(|i| profile.speeds[i * profile.speeds.len() / n]).collect();
        let room = corridor.room(&margins);
        Self {
            corridor,
            outline,
            along,
            length,
            margins,
            room,
            speeds,
            offsets: racing,
            deviates: false,
            own: Own::default(),
            other: None,
            away: None,
            side: None,
            age: 0,
        }
    }

    /// Whether the car is on its racing line, without another one.
    pub(super) fn is_idle(&self) -> bool {
        self.other.is_none() && !self.deviates
    }

    /// Takes the car's place and speed, and the points of seen cars.
    pub(super) fn watch(&mut self, place: Point, speed: f64, bodies: &[Vec<Point>], period: f64) {
        let [along, aside] = self.locate(place);
        let gained = self.signed(along - self.own.along);
        self.own = Own { along, aside, speed };
        if let Some(other) = &mut self.other {
            other.tail += other.speed * period;
            // Out of sight, it may stay aside as well as not.
            other.drift = if other.unseen > 0.0 { 0.0 } else { other.drift };
            other.aside += other.drift * period;
            other.unseen += period;
        }
        if let Some(Away { between: [seen, expected], speed }) = &mut self.away {
            *seen -= gained;
            *expected += *speed * period - gained;
        }
        self.away = self.away.filter(|away| away.between[1] > 0.0);
        let seen = bodies.iter().filter_map(|body| self.extent(body));
        let near = seen.filter(|extent| (-ANOTHER..HORIZON).contains(&extent.along[0]));
        if let Some(extent) = near.min_by(|a, b| a.along[0].total_cmp(&b.along[0])) {
            self.learn(&extent);
        }
        let Some(other) = self.other else { return };
        let gap = self.ahead(other.tail);
        let passed = gap + self.car_length() + APART < -(self.outline.ahead + TAIL);
        if passed || (other.unseen > FORGOTTEN && gap > self.nose()) {
            let expected = if passed { gap + self.length } else { gap };
            let between = [expected - other.speed * other.unseen, expected];
            (self.other, self.away) = (None, Some(Away { between, speed: other.speed }));
        }
    }

    /// Takes over what the passing on an earlier line knows of a car out of sight, at the place of this car.
    pub(super) fn remember(&mut self, earlier: &Self, place: Point) {
        self.own.along = self.locate(place)[0];
        self.away = earlier.away;
    }

    /// Updates the other car.
    fn learn(&mut self, extent: &Extent) {
        let ([back, front], [right, left]) = (extent.along, extent.aside);
        // Only what is ahead of the scanner at the nose is visible.
        let is_tail_seen = back > self.nose() + BESIDE;
        let tail = self.own.along + if is_tail_seen { back } else { front - self.car_length() };
        // Beside it, one flank is visible.
        let half_width = self.outline.half_width;
        let middle = 0.5 * (left + right);
        let aside = match (left - right < 1.6 * half_width, self.own.aside > middle) {
            (false, _) => middle,
            (true, true) => left - half_width,
            (true, false) => right + half_width,
        };
        let known = self.other.map(|other| (other, self.signed(tail - other.tail)));
        self.other = Some(match known.filter(|(_, residual)| residual.abs() < ANOTHER) {
            // Unless it was seen to move, it may stand.
            None => {
                let speed = self.away.take().map_or(0.0, |away| away.speed);
                Other { tail, aside, speed, drift: 0.0, unseen: 0.0 }
            }
            Some((other, residual)) => {
                let [place, speed, offset, drift] = GAINS;
                let moved = aside - other.aside;
                let trust = if is_tail_seen { 1.0 } else { 0.25 };
                Other {
                    tail: other.tail + place * trust * residual,
                    aside: other.aside + offset * moved,
                    speed: (other.speed + speed * trust * residual).max(0.0),
                    drift: other.drift + drift * moved,
                    unseen: 0.0,
                }
            }
        });
    }

    /// What `track` makes of a new line, if the line changes. It refuses a line that the car cannot follow.
    pub(super) fn change<T>(
        &mut self,
        solver: &mut LineSolver,
        track: impl FnOnce(&[Point]) -> Option<T>,
    ) -> Option<T> {
        self.age += 1;
        if self.is_idle() || self.age < DECISIONS {
            return None;
        }
        self.age = 0;
        let is_beside = self.other.is_some_and(|other| self.is_beside(&other));
        let (side, offsets) = match self.other.and_then(|other| self.around(&other, solver)) {
            Some((side, offsets)) => (Some(side), offsets),
            None if is_beside || !self.deviates => return None,
            None => (None, self.solve(self.room.clone(), solver)),
        };
        let stations = self.corridor.stations().iter().zip(&offsets);
        let line: Vec<Point> = stations.map(|(station, offset)| station.aside(*offset)).collect();
        let tracker = track(&line)?;
        (self.side, self.deviates, self.offsets) = (side, side.is_some(), offsets);
        Some(tracker)
    }

    /// The side on which a car is passed, and the line.
    fn around(&self, other: &Other, solver: &mut LineSolver) -> Option<(f64, Vec<f64>)> {
        let stretch = self.stretch(other)?;
        let committed = self.side.filter(|_| self.is_beside(other));
        let sides = [1.0, -1.0].into_iter().filter(|side| committed.is_none_or(|chosen| chosen == *side));
        let ways = sides.map(|side| (self.beside(other, side, stretch), side));
        let value = |room: f64, side: f64| room + if self.side == Some(side) { CHOSEN } else { 0.0 };
        let free = ways.filter(|((room, _), _)| *room > NARROWEST);
        let ((_, bounds), side) = free.max_by(|a, b| value(a.0.0, a.1).total_cmp(&value(b.0.0, b.1)))?;
        Some((side, self.solve(bounds, solver)))
    }

    /// The stretch, ahead of this car, on which the line is beside the other one. `None` if that is too long.
    fn stretch(&self, other: &Other) -> Option<[f64; 2]> {
        let gap = self.ahead(other.tail);
        let n = self.along.len();
        let begun = self.station(self.own.along);
        let (mut way, mut time, mut speed) = (0.0, 0.0, self.own.speed.max(1.0));
        for k in 0..n {
            let i = (begun + k) % n;
            let step = self.step(i);
            let gained = (speed * speed + 2.0 * GAIN_SPEED * step).sqrt();
            speed = gained.min(self.speeds[i]).max(1.0);
            (way, time) = (way + step, time + step / speed);
            let nose = gap + self.car_length() + other.speed * time;
            if way > nose + self.outline.ahead + TAIL + APART {
                let clear = (self.own.aside - other.aside).abs() > 2.0 * self.outline.half_width + BESIDE;
                let change = if clear { self.kept()[1] } else { (CHANGE.0 * self.own.speed).max(CHANGE.1) };
                return Some([change.max(gap - APART), way]);
            }
            if way > LONGEST {
                return None;
            }
        }
        None
    }

    /// The bounds of a line on one side of the other car, and the least room on the stretch (m).
    fn beside(&self, other: &Other, side: f64, [from, to]: [f64; 2]) -> (f64, Vec<[f64; 2]>) {
        let mut bounds = self.room.clone();
        let mut least = f64::INFINITY;
        for (i, bound) in bounds.iter_mut().enumerate() {
            let way = self.ahead(self.along[i]);
            if way < from || way > to {
                continue;
            }
            let [right, left] = self.margins[i];
            let edge = other.aside + side * self.outline.half_width;
            if side > 0.0 {
                bound[0] = bound[0].max(edge + right);
            } else {
                bound[1] = bound[1].min(edge - left);
            }
            let room = bound[1] - bound[0];
            least = least.min(room);
            // Not nearer to the other car than to the cones: it does not keep to a line.
            bound[usize::from(side < 0.0)] += side * SPARE * room.max(0.0);
        }
        (least, bounds)
    }

    /// Solves the line within bounds, without a kink at the car.
    fn solve(&self, mut bounds: Vec<[f64; 2]>, solver: &mut LineSolver) -> Vec<f64> {
        for (i, bound) in bounds.iter_mut().enumerate() {
            if self.is_kept(i) {
                *bound = [self.offsets[i] - 1e-3, self.offsets[i] + 1e-3];
            }
        }
        let parameters = RacingLineParameters::default();
        solver.solve_from(&self.corridor, &bounds, &self.offsets, &parameters).offsets
    }

    /// Distance behind and ahead of the car on which the line stays (m).
    fn kept(&self) -> [f64; 2] {
        let ([behind, ahead], time) = KEPT;
        [behind, ahead.max(time * self.own.speed)]
    }

    fn is_kept(&self, station: usize) -> bool {
        let [behind, ahead] = self.kept();
        (-behind..ahead).contains(&self.ahead(self.along[station]))
    }

    /// Takes an earlier line, of points, on which the car is. If that is not this line there, the next change
    /// leads over, and the car has to stay on the earlier line until then: returns whether this is so.
    pub(super) fn leads_over(&mut self, line: &[Point], place: Point, speed: f64) -> bool {
        let [along, aside] = self.locate(place);
        self.own = Own { along, aside, speed };
        // All of it: a change may be refused, and come farther on.
        let offset = |CrossSection { position, normal, .. }: &CrossSection| {
            let away = |point: &&Point| (*point - position).norm_squared();
            let nearest = line.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            nearest.map_or(0.0, |nearest| (nearest - position).dot(normal))
        };
        let earlier: Vec<f64> = self.corridor.stations().iter().map(offset).collect();
        let mut kept = (0..self.along.len()).filter(|&i| self.is_kept(i));
        let moves = kept.any(|i| (self.offsets[i] - earlier[i]).abs() > ON_LINE);
        if moves {
            (self.offsets, self.deviates, self.age) = (earlier, true, DECISIONS);
        }
        moves
    }

    /// Maximum speed behind or beside a car, and before one comes into sight, for a deceleration (m/s²) and a
    /// distance to keep behind it (m).
    pub(super) fn limit(&self, brake: f64, kept: f64) -> Option<f64> {
        let closing = |speed: f64, gap: f64| {
            let passing = speed + CLOSING;
            (passing * passing + 2.0 * brake * (gap - kept).max(0.0)).sqrt()
        };
        let Some(other) = self.other else {
            // It may come into sight anywhere from where it was last seen on.
            return self.away.map(|away| closing(away.speed, away.between[0].max(HORIZON)));
        };
        let gap = self.ahead(other.tail);
        let closing = closing(other.speed, gap);
        let is_ahead = gap + self.car_length() > self.nose();
        let closing = is_ahead.then_some(closing);
        self.behind(&other, brake, kept).into_iter().chain(closing).reduce(f64::min)
    }

    /// Maximum speed behind a car that is in the way.
    fn behind(&self, other: &Other, brake: f64, kept: f64) -> Option<f64> {
        let gap = self.ahead(other.tail);
        let needed = 2.0 * self.outline.half_width + BESIDE;
        // Once the nose is past the middle, it passes faster than it falls back.
        if gap + 0.5 * self.car_length() < self.nose() {
            return None;
        }
        let [right, left] = other.between();
        let is_close = |offset: f64| (right - needed..left + needed).contains(&offset);
        let on_line = (0..self.along.len()).filter(|&i| is_close(self.offsets[i]));
        let ways = on_line.map(|i| self.ahead(self.along[i]));
        let last = ways.filter(|way| (0.0..gap + self.car_length() + 1.0).contains(way)).reduce(f64::max);
        // Beside its line, it needs some way to reach it.
        let last =
            last.into_iter().chain(is_close(self.own.aside).then_some(0.5 * CHANGE.1)).reduce(f64::max)?;
        if last + self.nose() + BESIDE < gap {
            return None;
        }
        Some(if gap < self.nose() { 0.7 * other.speed } else { (brake * (gap - kept).max(0.0)).sqrt() })
    }

    /// Whether it is too late to choose the other side.
    fn is_beside(&self, other: &Other) -> bool {
        self.ahead(other.tail) < self.nose() + 0.5 * APART
    }

    /// Distance from the point on the line to the nose (m).
    fn nose(&self) -> f64 {
        self.outline.nose - self.outline.ahead
    }

    fn car_length(&self) -> f64 {
        self.outline.nose + TAIL
    }

    /// Distance from a station to the next one (m).
    fn step(&self, station: usize) -> f64 {
        self.along.get(station + 1).unwrap_or(&self.length) - self.along[station]
    }

    /// The last station before a distance along the centre line.
    fn station(&self, along: f64) -> usize {
        let along = along.rem_euclid(self.length);
        self.along.partition_point(|before| *before <= along).saturating_sub(1)
    }

    /// A distance around the track as that of the shorter way, negative backwards.
    fn signed(&self, way: f64) -> f64 {
        (way + 0.5 * self.length).rem_euclid(self.length) - 0.5 * self.length
    }

    /// Distance from this car to a place along the centre line, negative behind it (m).
    fn ahead(&self, along: f64) -> f64 {
        self.signed(along - self.own.along)
    }

    /// A place along the centre line and beside it.
    fn locate(&self, place: Point) -> [f64; 2] {
        let stations = self.corridor.stations();
        let away = |i: &usize| (stations[*i].position - place).norm_squared();
        let nearest = (0..stations.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0);
        let CrossSection { position, normal, .. } = stations[nearest];
        let arm = place - position;
        let tangent = Vector::new(normal.y, -normal.x);
        [self.along[nearest] + arm.dot(&tangent), arm.dot(&normal)]
    }

    /// Extent of a thing on the track, along the centre line from this car on. `None` beside the track, and
    /// if it is too small for a car: far cones that almost hide each other may look like one thing.
    fn extent(&self, body: &[Point]) -> Option<Extent> {
        let size = (body.last()? - body.first()?).norm();
        if size < CAR_LIKE * self.outline.half_width {
            return None;
        }
        let mut extent =
            Extent { along: [f64::INFINITY, f64::NEG_INFINITY], aside: [f64::INFINITY, f64::NEG_INFINITY] };
        for place in body {
            let [along, aside] = self.locate(*place);
            let along = self.ahead(along);
            extent.along = [extent.along[0].min(along), extent.along[1].max(along)];
            extent.aside = [extent.aside[0].min(aside), extent.aside[1].max(aside)];
        }
        let station = self.corridor.stations()[self.station(self.own.along + extent.along[0])];
        (extent.aside[0] < station.left && extent.aside[1] > -station.right).then_some(extent)
    }
}
