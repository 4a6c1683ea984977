//! The middle of a lane as a curve: where it begins, and its curvature from knot to knot.

use nalgebra::SVector;

use super::cone::Cone;
use crate::geometry::{Point, Pose, Vector, angle_difference, cross, direction};

/// Places at which the curvature is unknown; it is linear in between.
pub(super) const KNOTS: usize = 12;
/// What is unknown of a lane: four numbers of where its way begins and how wide it is, and the curvatures.
pub(super) const UNKNOWNS: usize = 4 + KNOTS;
/// Index of the metres aside of where the way begins.
pub(super) const ASIDE: usize = 0;
/// Index of the radians by which it is turned there.
pub(super) const TURNED: usize = 1;
/// Index of half the lane's width beside the car, in metres.
pub(super) const WIDTH: usize = 2;
/// Index of how much that grows with a metre.
pub(super) const WIDENS: usize = 3;
/// Index of the first curvature, in 1/m.
pub(super) const BENDS: usize = 4;

/// Steps in which a curve is followed from knot to knot.
const STEPS_TO_KNOT: usize = 4;
/// Steps from a knot to halfway to the next.
const AROUND_KNOT: usize = STEPS_TO_KNOT / 2;
/// Steps of a whole curve.
pub(super) const STEPS: usize = STEPS_TO_KNOT * (KNOTS - 1);

/// A number for each unknown.
pub(super) type Unknowns = SVector<f64, UNKNOWNS>;

/// A lane, by its unknowns.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    /// Where its way begins, and the unit vector along it there.
    begin: Pose,
    begins: Vector,
    /// Metres from step to step.
    pub(super) step: f64,
    /// The step beside the car.
    pub(super) car: usize,
    pub(super) unknowns: Unknowns,
    /// Where its middle is at each step, and the unit vectors along it.
    pub(super) places: [Point; STEPS + 1],
    pub(super) ahead: [Vector; STEPS + 1],
    /// How much it turns by the curvature at each knot; and by that at the knots before and behind each step, up to there.
    bends: [Bend; KNOTS],
    begun: [[Bend; 2]; STEPS + 1],
}

/// How much a curvature turns a lane: the metres on which it does, and the sum of their places.
#[derive(Debug, Clone, Copy, Default)]
struct Bend {
    metres: f64,
    places: Vector,
}

impl Bend {
    fn add(&mut self, metres: f64, place: Point) {
        self.metres += metres;
        self.places += place.coords * metres;
    }

    /// How far a place beyond it moves to the left of some way, for each 1/m.
    fn moves(&self, place: Point, ahead: Vector) -> f64 {
        (place.coords * self.metres - self.places).dot(&ahead)
    }
}

/// A cone beside a curve.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beside {
    pub(super) cone: usize,
    /// The step that is next to it.
    pub(super) step: usize,
    /// Metres to the left of the middle.
    pub(super) left: f64,
    /// Metres along the middle, from the car.
    pub(super) along: f64,
}

impl Curve {
    /// The curve about along a way, of which one station is beside the car. `None` for one of no length.
    pub(super) fn along(stations: &[Pose], car: usize, half_width: f64) -> Option<Self> {
        let begin = *stations.first()?;
        let way = Headings::of(stations);
        let total = way.total();
        if total <= 0.0 {
            return None;
        }
        let mut unknowns = Unknowns::zeros();
        unknowns[WIDTH] = half_width;
        let spacing = total / (KNOTS - 1) as f64;
        for knot in 0..KNOTS {
            let at = spacing * knot as f64;
            let (from, to) = ((at - 0.5 * spacing).max(0.0), (at + 0.5 * spacing).min(total));
            unknowns[BENDS + knot] = (way.at(to) - way.at(from)) / (to - from);
        }
        let step = total / STEPS as f64;
        let car = ((way.metres[car] / step).round() as usize).min(STEPS);
        let mut curve = Self {
            begin,
            begins: direction(begin.heading),
            step,
            car,
            unknowns,
            places: [Point::origin(); STEPS + 1],
            ahead: [Vector::zeros(); STEPS + 1],
            bends: [Bend::default(); KNOTS],
            begun: [[Bend::default(); 2]; STEPS + 1],
        };
        curve.follow();
        Some(curve)
    }

    /// Changes the unknowns.
    pub(super) fn set(&mut self, unknowns: Unknowns) {
        self.unknowns = unknowns;
        self.follow();
    }

    /// Goes along it, from its unknowns.
    fn follow(&mut self) {
        let left = Vector::new(-self.begins.y, self.begins.x);
        let mut at = self.begin.position() + left * self.unknowns[ASIDE];
        let mut ahead = direction(self.begin.heading + self.unknowns[TURNED]);
        self.bends = [Bend::default(); KNOTS];
        for step in 0..=STEPS {
            self.places[step] = at;
            self.ahead[step] = ahead;
            let (knot, share) = before(step);
            self.begun[step] = [self.bends[knot], self.bends[knot + 1]];
            let [from, to] = [0, 1].map(|next| self.unknowns[BENDS + knot + next]);
            let half = 0.5 * self.step * (from * (1.0 - share) + to * share);
            let middle = turned(ahead, half);
            let next = at + middle * self.step;
            // A bend there turns all that comes after the middle of its step.
            let turns_at = nalgebra::center(&at, &next);
            self.bends[knot].add(self.step * (1.0 - share), turns_at);
            self.bends[knot + 1].add(self.step * share, turns_at);
            at = next;
            ahead = turned(middle, half);
        }
    }

    /// Half the width of the lane at a step.
    pub(super) fn half_width(&self, step: usize) -> f64 {
        self.unknowns[WIDTH] + self.unknowns[WIDENS] * self.past_car(step)
    }

    /// Metres along it from the car to a step.
    pub(super) fn past_car(&self, step: usize) -> f64 {
        (step as f64 - self.car as f64) * self.step
    }

    /// The cones within some metres of the middle, but for those before its beginning and beyond its end.
    pub(super) fn beside(&self, cones: &[Cone], within: f64) -> Vec<Beside> {
        let beside = |(cone, Cone { position, .. }): (usize, &Cone)| {
            let step = self.nearest(*position, within)?;
            let away = position - self.places[step];
            let (left, beyond) = (cross(self.ahead[step], away), self.ahead[step].dot(&away));
            let near = away.norm_squared() < within * within && beyond.abs() <= self.step;
            near.then_some(Beside { cone, step, left, along: self.past_car(step) + beyond })
        };
        cones.iter().enumerate().filter_map(beside).collect()
    }

    /// The step next to a place, if that is within some metres; one that is a little farther off may be told as well.
    fn nearest(&self, place: Point, within: f64) -> Option<usize> {
        let squared = |step: usize| (self.places[step] - place).norm_squared();
        let from_knots: [f64; KNOTS] = std::array::from_fn(|knot| squared(knot * STEPS_TO_KNOT));
        let least = from_knots.into_iter().fold(f64::INFINITY, f64::min).sqrt();
        // No step is farther than this from one of the knots beside it.
        let between = AROUND_KNOT as f64 * self.step;
        if least > within + between {
            return None;
        }
        let near = (least + between) * (least + between);
        let steps = (0..KNOTS).filter(|&knot| from_knots[knot] <= near).flat_map(|knot| {
            let at = knot * STEPS_TO_KNOT;
            at.saturating_sub(AROUND_KNOT)..=(at + AROUND_KNOT).min(STEPS)
        });
        let nearer = |nearest: (usize, f64), step: usize| {
            let squared = squared(step);
            if squared < nearest.1 { (step, squared) } else { nearest }
        };
        Some(steps.fold((0, f64::INFINITY), nearer).0)
    }

    /// How far the middle moves to the left at a step, with each unknown.
    pub(super) fn moves(&self, step: usize) -> Unknowns {
        let (place, ahead) = (self.places[step], self.ahead[step]);
        let mut moves = Unknowns::zeros();
        moves[ASIDE] = ahead.dot(&self.begins);
        moves[TURNED] = (place - self.places[0]).dot(&ahead);
        let (knot, _) = before(step);
        for (unknown, bend) in self.bends[..knot].iter().chain(&self.begun[step]).enumerate() {
            moves[BENDS + unknown] = bend.moves(place, ahead);
        }
        moves
    }
}

/// The knot before a step, or at it, and the share of the one behind it.
fn before(step: usize) -> (usize, f64) {
    let knot = (step / STEPS_TO_KNOT).min(KNOTS - 2);
    (knot, step as f64 / STEPS_TO_KNOT as f64 - knot as f64)
}

/// A unit vector turned by a small angle, to a millionth of a radian: many are turned, and sines take long.
fn turned(v: Vector, angle: f64) -> Vector {
    let tangent = 0.5 * angle * (1.0 + angle * angle / 12.0);
    let scale = 1.0 / (1.0 + tangent * tangent);
    let (cos, sin) = ((1.0 - tangent * tangent) * scale, 2.0 * tangent * scale);
    Vector::new(v.x * cos - v.y * sin, v.x * sin + v.y * cos)
}

/// The headings along a way.
struct Headings {
    /// Metres from its beginning to each station.
    metres: Vec<f64>,
    /// The heading there, without leaps by a full turn.
    headings: Vec<f64>,
}

impl Headings {
    fn of(stations: &[Pose]) -> Self {
        let mut way = Self { metres: vec![0.0], headings: vec![stations[0].heading] };
        for pair in stations.windows(2) {
            let leg = (pair[1].position() - pair[0].position()).norm();
            let turn = angle_difference(pair[1].heading, pair[0].heading);
            way.metres.push(way.total() + leg);
            way.headings.push(way.headings[way.headings.len() - 1] + turn);
        }
        way
    }

    fn total(&self) -> f64 {
        self.metres[self.metres.len() - 1]
    }

    /// The heading so many metres from the beginning.
    fn at(&self, metres: f64) -> f64 {
        let next = self.metres.partition_point(|way| *way < metres).clamp(1, self.metres.len() - 1);
        let ([from, to], [start, end]) =
            ([self.metres[next - 1], self.metres[next]], [self.headings[next - 1], self.headings[next]]);
        let share = ((metres - from) / (to - from).max(1e-9)).clamp(0.0, 1.0);
        start + (end - start) * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A way on a circle.
    fn circle(curvature: f64, metres: u32) -> Vec<Pose> {
        let mut poses = vec![Pose::new(3.0, -2.0, 0.4)];
        for _ in 0..metres {
            let half = direction(0.5 * curvature);
            poses.push(poses[poses.len() - 1].compose(&Pose::new(half.x, half.y, curvature)));
        }
        poses
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn a_curve_goes_along_its_way(curvature in -0.3..0.3f64) {
            let way = circle(curvature, 24);
            let curve = Curve::along(&way, 8, 1.9).unwrap();
            prop_assert!((curve.past_car(0) + 8.0).abs() < curve.step);
            for pose in &way {
                let nearest = curve.nearest(pose.position(), 1.0).unwrap();
                let aside = cross(curve.ahead[nearest], pose.position() - curve.places[nearest]);
                prop_assert!(aside.abs() < 0.05, "{aside} at {nearest}");
            }
        }

        #[test]
        fn moves_are_the_derivatives(
            bends in proptest::collection::vec(-0.25..0.25f64, KNOTS), step in 1..=STEPS, unknown in 0..UNKNOWNS,
        ) {
            let mut curve = Curve::along(&circle(0.0, 24), 8, 1.9).unwrap();
            let mut unknowns = curve.unknowns;
            for (knot, bend) in bends.iter().enumerate() {
                unknowns[BENDS + knot] = *bend;
            }
            curve.set(unknowns);
            let moves = curve.moves(step);
            let (place, left) = (curve.places[step], Vector::new(-curve.ahead[step].y, curve.ahead[step].x));
            let small = 1e-5;
            unknowns[unknown] += small;
            curve.set(unknowns);
            let moved = (curve.places[step] - place).dot(&left) / small;
            prop_assert!((moved - moves[unknown]).abs() < 0.02 * (1.0 + moved.abs()), "{moved} {}", moves[unknown]);
        }
    }

    #[test]
    fn cones_beyond_its_ends_are_not_beside_it() {
        let curve = Curve::along(&circle(0.0, 24), 8, 1.9).unwrap();
        let begin = Pose::new(3.0, -2.0, 0.4);
        let cone = |x: f64, y: f64| Cone::unknown(begin.to_world(Point::new(x, y)));
        let found = curve.beside(&[cone(-2.0, 1.0), cone(5.0, 1.5), cone(26.0, -1.0), cone(9.0, 6.0)], 4.0);
        assert_eq!(found.len(), 1);
        let one = found[0];
        assert!(one.cone == 1 && (one.left - 1.5).abs() < 1e-3 && (one.along + 3.0).abs() < 0.5, "{one:?}");
        assert!(Curve::along(&circle(0.0, 0), 0, 1.9).is_none());
    }
}
