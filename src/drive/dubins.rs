use std::f64::consts::TAU;

use super::Path;
use crate::geometry::{Pose, math};
use crate::io::Result;
use crate::parameter::require_positive;

/// Three parts of a path, each a left turn (1), a line (0) or a right turn (-1).
type Word = [f64; 3];

/// The six sequences of turns that contain the shortest path (L. E. Dubins, 1957).
const WORDS: [Word; 6] = [
    [1.0, 0.0, 1.0],
    [-1.0, 0.0, -1.0],
    [1.0, 0.0, -1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, 1.0, -1.0],
    [1.0, -1.0, 1.0],
];

/// Number of headings tried at a goal without one.
const HEADINGS: u32 = 72;

impl Path {
    /// The shortest path of a car that only drives forward, with a turning circle of `radius` metres (L. E.
    /// Dubins, "On curves of minimal length with a constraint on average curvature", 1957). One always
    /// exists.
    ///
    /// # Errors
    ///
    /// If a pose is not finite, the poses are the same, the path is longer than 10 km, or the radius is not
    /// positive and finite.
    pub fn dubins(start: Pose, goal: Pose, radius: f64) -> Result<Self> {
        require_positive("turning radius", radius)?;
        let (word, parts, _) = shortest(start, goal, radius);
        let pieces: Vec<(f64, f64)> = word
            .iter()
            .zip(parts)
            .filter(|(_, part)| *part * radius > 1e-9)
            .map(|(turn, part)| (part * radius, turn / radius))
            .collect();
        Self::of_arcs(start, &pieces)
    }

    /// The shortest such path to a point, over goal headings in steps of 5 degrees.
    ///
    /// # Errors
    ///
    /// As [`dubins`](Self::dubins).
    pub fn dubins_to_point(start: Pose, goal: crate::geometry::Point, radius: f64) -> Result<Self> {
        require_positive("turning radius", radius)?;
        let headings = (0..HEADINGS).map(|i| TAU * f64::from(i) / f64::from(HEADINGS));
        let line = math::atan2(goal.y - start.y, goal.x - start.x);
        let poses = headings.map(|heading| Pose::new(goal.x, goal.y, line + heading));
        let length = |pose: &Pose| shortest(start, *pose, radius).2;
        let best = poses.min_by(|a, b| length(a).total_cmp(&length(b)));
        Self::dubins(start, best.unwrap_or(start), radius)
    }
}

/// The shortest path's word, the lengths of its parts as multiples of the radius, and their sum.
fn shortest(start: Pose, goal: Pose, radius: f64) -> (Word, [f64; 3], f64) {
    let local = start.to_local(goal.position());
    let (x, y) = (local.x / radius, local.y / radius);
    let turned = goal.heading - start.heading;
    let paths = WORDS.iter().filter_map(|word| parts(word, x, y, turned).map(|parts| (*word, parts)));
    let paths = paths.map(|(word, parts)| (word, parts, parts.iter().sum::<f64>()));
    let best = paths.min_by(|a, b| a.2.total_cmp(&b.2));
    best.unwrap_or(([0.0; 3], [0.0; 3], f64::INFINITY))
}

/// Lengths of a word's parts from the origin, heading along x, to a pose, on circles of radius 1.
///
/// The turning circles at both ends are joined by a common tangent or by a third circle.
fn parts(word: &Word, x: f64, y: f64, heading: f64) -> Option<[f64; 3]> {
    let [first, middle, last] = *word;
    let (sin, cos) = math::sin_cos(heading);
    // From the centre of the first circle to the centre of the last one.
    let (dx, dy) = (x - last * sin, y + last * cos - first);
    let distance = math::hypot(dx, dy);
    let line = math::atan2(dy, dx);
    let (departure, length) = if middle == 0.0 {
        if first == last {
            (line, distance)
        } else {
            // The line crosses between the circles.
            let along = (distance * distance - 4.0).max(-1.0);
            if along < 0.0 {
                return None;
            }
            let along = along.sqrt();
            (line + first * math::atan2(2.0, along), along)
        }
    } else {
        if distance > 4.0 {
            return None;
        }
        // The middle circle touches both others: its centre lies above the line between theirs.
        let tilt = math::acos(distance / 4.0);
        let departure = line + first * (tilt + std::f64::consts::FRAC_PI_2);
        // The arc ends where it touches the last circle; the triangle of centres gives its length.
        let length = wrapped(std::f64::consts::PI + 2.0 * tilt);
        (departure, length)
    };
    let turn = wrapped(first * departure);
    let rest = if middle == 0.0 {
        wrapped(last * (heading - departure))
    } else {
        wrapped(last * (heading - departure - middle * length))
    };
    Some([turn, length, rest])
}

/// Normalises an angle to 0 up to a full turn; rounding errors below 0 count as 0.
fn wrapped(angle: f64) -> f64 {
    let turn = angle - TAU * (angle / TAU).floor();
    if TAU - turn < 1e-9 { 0.0 } else { turn }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, angle_difference};
    use proptest::prelude::*;

    fn pose() -> impl Strategy<Value = Pose> {
        (-2.0..2.0f64, -2.0..2.0f64, -3.1..3.1f64).prop_map(|(x, y, heading)| Pose::new(x, y, heading))
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn every_word_ends_at_the_goal(start in pose(), goal in pose(), radius in 0.2..1.0f64) {
            let local = start.to_local(goal.position());
            for word in WORDS {
                let found = parts(&word, local.x / radius, local.y / radius, goal.heading - start.heading);
                let Some(lengths) = found else { continue };
                let pieces: Vec<_> = word.iter().zip(lengths).map(|(turn, part)| (part * radius, turn / radius)).collect();
                let end = pieces.iter().fold(start, |pose, &(length, curvature)| {
                    crate::kinematics::advance(
                        pose, crate::kinematics::Displacement { length, angle: length * curvature },
                    )
                });
                prop_assert!(end.distance_to(goal.position()) < 1e-6, "{word:?} {lengths:?} {end:?}");
                prop_assert!(angle_difference(end.heading, goal.heading).abs() < 1e-6, "{word:?} {end:?}");
            }
        }

        #[test]
        fn the_path_is_no_shorter_than_the_line_and_bends_no_tighter(start in pose(), goal in pose()) {
            prop_assume!(start.distance_to(goal.position()) > 0.01);
            let path = Path::dubins(start, goal, 0.5).unwrap();
            prop_assert!(path.end().distance_to(goal.position()) < 1e-6);
            prop_assert!(path.length() >= start.distance_to(goal.position()) - 1e-9);
            prop_assert!(path.max_curvature() <= 2.0 + 1e-9);
            // The path to the point alone is no longer, except for headings between the samples.
            let to_point = Path::dubins_to_point(start, goal.position(), 0.5).unwrap();
            prop_assert!(to_point.length() <= path.length() + 0.1);
        }
    }

    #[test]
    fn straight_ahead_it_is_a_line() {
        let path = Path::dubins(Pose::default(), Pose::new(2.0, 0.0, 0.0), 0.5).unwrap();
        assert!((path.length() - 2.0).abs() < 1e-9 && path.max_curvature() == 0.0);
        assert!(Path::dubins(Pose::default(), Pose::new(2.0, 0.0, 0.0), 0.0).is_err());
        assert!(Path::dubins_to_point(Pose::default(), Point::new(1.0, 0.0), f64::NAN).is_err());
    }
}
