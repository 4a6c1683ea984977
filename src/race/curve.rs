//! The centre line of a lane as a curve: a start pose, and curvatures at knots.

use nalgebra::SVector;

use super::cone::Cone;
use crate::geometry::{Point, Pose, Vector, angle_difference, cross, direction};

/// Places at which the curvature is unknown; it is linear in between.
pub(super) const KNOTS: usize = 12;
/// Unknowns of a lane: four for its start and its width, and the curvatures.
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

/// Number of integration steps between two knots.
const STEPS_TO_KNOT: usize = 4;
/// Number of steps from a knot to halfway to the next.
const AROUND_KNOT: usize = STEPS_TO_KNOT / 2;
/// Steps of a whole curve.
pub(super) const STEPS: usize = STEPS_TO_KNOT * (KNOTS - 1);

/// One number per unknown.
pub(super) type Unknowns = SVector<f64, UNKNOWNS>;

/// A lane, given by its unknowns.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    /// Reference start pose; `begins` is the unit vector along it.
    begin: Pose,
    begins: Vector,
    /// Step length (m).
    pub(super) step: f64,
    /// The step beside the car.
    pub(super) car: usize,
    pub(super) unknowns: Unknowns,
    /// Position at each step; `ahead` holds the unit tangents.
    pub(super) places: [Point; STEPS + 1],
    pub(super) ahead: [Vector; STEPS + 1],
    /// Turning by the curvature at each knot; `begun` holds that of the knots before and after each step, up
    /// to there.
    bends: [Bend; KNOTS],
    begun: [[Bend; 2]; STEPS + 1],
}

/// Effect of a curvature: the length over which it acts, and the integral of position over that length.
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

    /// Displacement to the left, per 1/m, of a point beyond it.
    fn moves(&self, place: Point, ahead: Vector) -> f64 {
        (place.coords * self.metres - self.places).dot(&ahead)
    }
}

/// A cone beside a curve.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beside {
    pub(super) cone: usize,
    /// The nearest step.
    pub(super) step: usize,
    /// Lateral offset from the centre line, positive to the left (m).
    pub(super) left: f64,
    /// Distance along the centre line from the car (m).
    pub(super) along: f64,
}

impl Curve {
    /// The curve along a path, with the index of the station beside the car; `None` if the path is too short.
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

    /// Replaces the unknowns.
    pub(super) fn set(&mut self, unknowns: Unknowns) {
        self.unknowns = unknowns;
        self.follow();
    }

    /// Integrates the curve from its unknowns.
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
            // A bend turns everything beyond the middle of its step.
            let turns_at = nalgebra::center(&at, &next);
            self.bends[knot].add(self.step * (1.0 - share), turns_at);
            self.bends[knot + 1].add(self.step * share, turns_at);
            at = next;
            ahead = turned(middle, half);
        }
    }

    /// Half the lane width at a step (m).
    pub(super) fn half_width(&self, step: usize) -> f64 {
        self.unknowns[WIDTH] + self.unknowns[WIDENS] * self.past_car(step)
    }

    /// Distance along the curve from the car to a step (m).
    pub(super) fn past_car(&self, step: usize) -> f64 {
        (step as f64 - self.car as f64) * self.step
    }

    /// Cones within a distance of the centre line, except before its start and beyond its end.
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

    /// The step nearest to a point, if within a distance; slightly farther ones may be returned as well.
    fn nearest(&self, place: Point, within: f64) -> Option<usize> {
        let squared = |step: usize| (self.places[step] - place).norm_squared();
        let from_knots: [f64; KNOTS] = std::array::from_fn(|knot| squared(knot * STEPS_TO_KNOT));
        let least = from_knots.into_iter().fold(f64::INFINITY, f64::min).sqrt();
        // No step is farther than this from the nearest knot.
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

    /// Displacement of the centre line to the left at a step, per unknown.
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

/// The knot at or before a step, and the interpolation weight of the next one.
fn before(step: usize) -> (usize, f64) {
    let knot = (step / STEPS_TO_KNOT).min(KNOTS - 2);
    (knot, step as f64 / STEPS_TO_KNOT as f64 - knot as f64)
}

/// Rotates a unit vector by a small angle, accurate to 1e-6 rad, faster than by sine and cosine.
fn turned(v: Vector, angle: f64) -> Vector {
    let tangent = 0.5 * angle * (1.0 + angle * angle / 12.0);
    let scale = 1.0 / (1.0 + tangent * tangent);
    let (cos, sin) = ((1.0 - tangent * tangent) * scale, 2.0 * tangent * scale);
    Vector::new(v.x * cos - v.y * sin, v.x * sin + v.y * cos)
}

/// Headings along a path.
struct Headings {
    /// Distance of each station from the start (m).
    metres: Vec<f64>,
    /// Heading at each station, without jumps by full turns (rad).
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

    /// Heading at a distance from the start (rad).
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

    /// A path on a circle.
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
