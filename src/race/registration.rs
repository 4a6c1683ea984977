//! Recognition of cones at the end of a lap that were seen at its beginning.

use crate::geometry::{Point, Pose, Vector, cross, math, normalize_angle};

/// Prior knowledge of a registration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Expected {
    /// Estimated position of the car (m).
    pub(super) place: Point,
    /// Possible error (m, rad).
    pub(super) wrong: (f64, f64),
}

/// Distance within which two cones are the same one (m).
pub(super) const GATE: f64 = 0.5;
/// Minimum number of matched cones.
const FEWEST: usize = 6;
/// Minimum fraction of matched cones.
const SHARE: f64 = 0.6;
/// Minimum ratio of the best motion's score to any other's: rows of cones look alike a few metres farther on.
const LEAD: f64 = 1.2;
/// Standard deviation of errors as a fraction of the maximum error.
const LIKELY: f64 = 0.4;
/// Distance between two cones that define a direction (m).
const ARM: std::ops::Range<f64> = 4.0..20.0;

/// The motion that maps most of some points onto others, if it is unambiguous. O(n² m²) for n points onto m.
pub(super) fn register(points: &[Point], onto: &[Point], expected: Expected) -> Option<Pose> {
    let mut found: Vec<(f64, Pose)> =
        hypotheses(points, onto, expected).map(|motion| (score(points, onto, motion), motion)).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let best = refined(points, onto, found.first()?.1);
    let apart =
        |motion: &Pose| (motion.to_world(expected.place) - best.to_world(expected.place)).norm() > 2.0 * GATE;
    let rivals = || found.iter().filter(|(_, motion)| apart(motion));
    let rival = rivals().next().map_or(0.0, |(score, _)| *score);
    // Of two equally good motions, prefer the one closer to the estimated position.
    let far = rivals().map(|(score, motion)| score * expected.likely(motion)).fold(0.0, f64::max);
    let again = pairs(points, onto, best).count();
    let enough = again >= FEWEST && again as f64 >= SHARE * points.len() as f64;
    let good = score(points, onto, best);
    let plain = good >= LEAD * rival || good * expected.likely(&best) >= LEAD * far;
    (enough && plain).then_some(best)
}

impl Expected {
    /// Prior likelihood of a motion, relative to that of no motion.
    fn likely(&self, motion: &Pose) -> f64 {
        let way = (motion.to_world(self.place) - self.place).norm() / (LIKELY * self.wrong.0);
        math::exp(-0.5 * way * way)
    }
}

/// Motions that map two points onto two others with the same distance.
fn hypotheses(points: &[Point], onto: &[Point], expected: Expected) -> impl Iterator<Item = Pose> {
    let arms = |points: &[Point]| -> Vec<(Point, Vector)> {
        let all = points.iter().flat_map(|a| points.iter().map(move |b| (*a, b - a)));
        all.filter(|(_, arm)| ARM.contains(&arm.norm())).collect()
    };
    let (from, to) = (arms(points), arms(onto));
    from.into_iter().flat_map(move |(point, arm)| {
        let alike = to.iter().filter(move |(_, wanted)| (arm.norm() - wanted.norm()).abs() < GATE);
        let fits = alike.map(move |(other, wanted)| bringing(point, arm, *other, *wanted));
        let near = fits.filter(move |motion| {
            let way = (motion.to_world(expected.place) - expected.place).norm();
            way < expected.wrong.0 && motion.heading.abs() < expected.wrong.1
        });
        near.collect::<Vec<Pose>>()
    })
}

/// The motion that maps a point and the direction of an arm onto others.
fn bringing(point: Point, arm: Vector, onto: Point, wanted: Vector) -> Pose {
    let turn = math::atan2(cross(arm, wanted), arm.dot(&wanted));
    let turned = Pose::new(0.0, 0.0, turn).to_world(point);
    Pose::new(onto.x - turned.x, onto.y - turned.y, turn)
}

/// Points with their counterparts.
fn pairs<'p>(
    points: &'p [Point],
    onto: &'p [Point],
    motion: Pose,
) -> impl Iterator<Item = (Point, Point)> + 'p {
    points.iter().filter_map(move |point| {
        let place = motion.to_world(*point);
        let squared = |other: &Point| (other - place).norm_squared();
        let nearest = onto.iter().min_by(|a, b| squared(a).total_cmp(&squared(b)))?;
        (squared(nearest) < GATE * GATE).then_some((*point, *nearest))
    })
}

/// Number of points with counterparts, weighted by proximity.
fn score(points: &[Point], onto: &[Point], motion: Pose) -> f64 {
    let near = |(point, other): (Point, Point)| {
        1.0 - (motion.to_world(point) - other).norm_squared() / (GATE * GATE)
    };
    pairs(points, onto, motion).map(near).sum()
}

/// Least-squares motion of the pairs, iterated, because the pairs change with it.
fn refined(points: &[Point], onto: &[Point], mut motion: Pose) -> Pose {
    for _ in 0..4 {
        let pairs: Vec<(Point, Point)> = pairs(points, onto, motion).collect();
        if pairs.len() < 2 {
            break;
        }
        motion = fitted(&pairs);
    }
    motion
}

/// Least-squares motion that maps the first points of pairs onto the second.
fn fitted(pairs: &[(Point, Point)]) -> Pose {
    let count = pairs.len() as f64;
    let sum =
        pairs.iter().fold((Vector::zeros(), Vector::zeros()), |(a, b), (p, q)| (a + p.coords, b + q.coords));
    let (from, to) = (sum.0 / count, sum.1 / count);
    let (mut sine, mut cosine) = (0.0, 0.0);
    for (p, q) in pairs {
        let (p, q) = (p.coords - from, q.coords - to);
        sine += cross(p, q);
        cosine += p.dot(&q);
    }
    let turn = math::atan2(sine, cosine);
    let turned = Pose::new(0.0, 0.0, turn).to_world(Point::from(from));
    Pose::new(to.x - turned.x, to.y - turned.y, turn)
}

/// Distributes a motion, known at the end of a path, over the whole path: headings change in proportion to
/// `shares` (0 to 1 from the first pose to the last), and the remaining displacement is distributed likewise.
pub(super) fn spread(way: &[Pose], shares: &[f64], motion: Pose) -> Vec<Pose> {
    let turn = normalize_angle(motion.heading);
    let mut turned: Vec<Pose> = Vec::with_capacity(way.len());
    for (index, (pose, share)) in way.iter().zip(shares).enumerate() {
        let place = if index == 0 {
            pose.position()
        } else {
            let (before, half) = (way[index - 1], 0.5 * (shares[index - 1] + share));
            let step = Point::from(pose.position() - before.position());
            turned[index - 1].position() + Pose::new(0.0, 0.0, turn * half).to_world(step).coords
        };
        turned.push(Pose::new(place.x, place.y, normalize_angle(pose.heading + turn * share)));
    }
    let Some((last, end)) = way.last().zip(turned.last()) else { return turned };
    let missing = motion.to_world(last.position()) - end.position();
    for (pose, share) in turned.iter_mut().zip(shares) {
        pose.x += missing.x * share;
        pose.y += missing.y * share;
    }
    turned
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::angle_difference;
    use crate::race::{TrackOptions, generate};
    use proptest::prelude::*;

    const LOST: Expected = Expected { place: Point::new(0.0, 0.0), wrong: (6.0, 0.3) };

    proptest! {
        #![proptest_config(crate::testing::cases(24))]
        /// The cones around the start, shifted, some missing: they are recognised correctly or not at all.
        #[test]
        fn a_start_is_found_again(seed in 0..500_u64, x in -4.0..4.0f64, y in -2.0..2.0f64, turn in -0.2..0.2f64) {
            let track = generate(seed, &TrackOptions::drawn(seed)).unwrap().track;
            let start = track.start.unwrap();
            let near = track.cones.iter().map(|cone| start.to_local(cone.position));
            let onto: Vec<Point> = near.filter(|p| p.coords.norm() < 30.0 && p.x > 0.0).collect();
            let motion = Pose::new(x, y, turn);
            let seen = onto.iter().filter(|p| p.coords.norm() < 22.0).enumerate().filter(|(k, _)| k % 7 != 3);
            let points: Vec<Point> = seen.map(|(_, p)| motion.inverse().to_world(*p)).collect();
            if let Some(found) = register(&points, &onto, LOST) {
                let place = Point::new(5.0, 0.0);
                prop_assert!((found.to_world(place) - motion.to_world(place)).norm() < 0.05);
                prop_assert!(angle_difference(found.heading, motion.heading).abs() < 0.01);
            }
        }

        #[test]
        fn the_whole_motion_is_at_the_end(x in -3.0..3.0f64, y in -3.0..3.0f64, turn in -0.3..0.3f64) {
            let way: Vec<Pose> = (0..50).map(|k| Pose::new(f64::from(k), math::sin(0.1 * f64::from(k)), 0.1)).collect();
            let shares: Vec<f64> = (0..50).map(|k| f64::from(k) / 49.0).collect();
            let motion = Pose::new(x, y, turn);
            let moved = spread(&way, &shares, motion);
            let wanted = motion.compose(&way[49]);
            prop_assert!((moved[49].position() - wanted.position()).norm() < 1e-9 && moved[0] == way[0]);
            prop_assert!(angle_difference(moved[49].heading, wanted.heading).abs() < 1e-9);
        }
    }

    #[test]
    fn even_rows_are_not_found() {
        // For a car that believes to be halfway between, the cones are ambiguous.
        let row: Vec<Point> =
            (0..20).map(|k| Point::new(3.0 * f64::from(k / 2), 3.0 * f64::from(k % 2))).collect();
        let shifted = |aside: f64| row[4..14].iter().map(|p| p + Vector::new(aside, 0.0)).collect::<Vec<_>>();
        assert_eq!(register(&shifted(1.5), &row, LOST), None);
        assert_eq!(register(&[], &row, LOST), None);
    }

    #[test]
    fn rows_that_are_nearly_even_are_found_near_where_the_car_believes_to_be() {
        let row: Vec<Point> = (0..20)
            .map(|k| {
                let off = 0.05 * f64::from(7 * k % 5 - 2);
                Point::new(3.0 * f64::from(k / 2) + off, 3.0 * f64::from(k % 2))
            })
            .collect();
        let shifted = |aside: f64| row[4..14].iter().map(|p| p + Vector::new(aside, 0.0)).collect::<Vec<_>>();
        let found = register(&shifted(0.2), &row, LOST).unwrap();
        assert!((found.x + 0.2).abs() < 1e-6 && found.y.abs() < 1e-6, "{found:?}");
        // Three metres off, another assignment fits as well and is as near.
        assert_eq!(register(&shifted(3.0), &row, LOST), None);
    }
}
