//! Animated pictures: SVG with attributes that change over time (SMIL), in an endless loop.

use std::fmt::Write;

use svg::node::element::{Animate, AnimateTransform, Group, Rectangle};

use super::canvas::{number, path_data, rectangle};
use super::colours::PALE_INK;
use super::frame::Pixel;
use crate::geometry::{Aabb, Vector, angle_difference, units};

/// Maps the time of a run to that of a film.
#[derive(Debug, Clone, Copy)]
pub(super) struct Film {
    /// Duration of the run (s).
    duration: f64,
    /// Playing time of the film (s), without the hold at the end.
    playing: f64,
}

/// Maximum duration of a film (s).
const LONGEST: f64 = 14.0;
/// Maximum duration of a film's still end (s).
const HOLD: f64 = 2.0;
/// Nothing, in a film or in a path that stands still, is farther off its place than this many pixels.
pub(super) const TOLERANCE: f64 = 0.35;
/// Difference of heading that counts as a rotation (degrees).
const TURNED: f64 = 2.0;

impl Film {
    /// The film of a run; `None` if nothing moves.
    pub(super) fn of(duration: f64) -> Option<Self> {
        (duration > 0.0).then(|| Self { duration, playing: duration.min(LONGEST) })
    }

    /// Playback speed relative to the run.
    pub(super) fn pace(&self) -> f64 {
        self.duration / self.playing
    }

    /// A time of the run as a fraction of the film.
    fn share(&self, time: f64) -> f64 {
        let share = if time.is_nan() { 0.0 } else { (time / self.duration).clamp(0.0, 1.0) };
        share * self.playing / (self.playing + HOLD)
    }

    /// An animated attribute: its values at times of the run.
    fn change(&self, attribute: &str, values: &[(f64, String)]) -> Animate {
        let mut animate = Animate::new().set("attributeName", attribute);
        self.assign(&mut animate, values);
        animate
    }

    /// The film's length, and values with their times as SMIL requires: from 0 to 1, in order.
    fn assign(&self, element: &mut impl svg::Node, values: &[(f64, String)]) {
        let (mut keys, mut list, mut last) = (String::new(), String::new(), 0.0);
        let first = values.first().map(|(_, value)| (0.0, value));
        let end = values.last().map(|(_, value)| (1.0, value));
        let inner = values.iter().map(|(time, value)| (self.share(*time), value));
        for (share, value) in first.into_iter().chain(inner).chain(end) {
            last = share.max(last);
            let separator = if keys.is_empty() { "" } else { ";" };
            let key = format!("{last:.4}");
            let _ = write!(keys, "{separator}{}", key.trim_end_matches('0').trim_end_matches('.'));
            let _ = write!(list, "{separator}{value}");
        }
        element.assign("dur", format!("{}s", number(self.playing + HOLD)));
        element.assign("repeatCount", "indefinite");
        element.assign("keyTimes", keys);
        element.assign("values", list);
    }

    /// Shows a group only from one time of the run to another.
    pub(super) fn seen(&self, group: Group, from: f64, until: f64) -> Group {
        let [hidden, visible] = ["hidden", "visible"].map(str::to_owned);
        let mut values = vec![(0.0, if from > 0.0 { hidden.clone() } else { visible.clone() })];
        values.extend((from > 0.0).then_some((from, visible)));
        values.extend((until < self.duration).then_some((until, hidden)));
        match values.len() {
            1 => group,
            _ => group.add(self.change("visibility", &values).set("calcMode", "discrete")),
        }
    }

    /// A dash that grows to the whole of a line of this length: its pattern and its animation. `reached`
    /// lists times and pixels along the line.
    pub(super) fn growth(&self, length: f64, reached: &[(f64, f64)]) -> (String, Animate) {
        let off = |between: usize, a: usize, b: usize| {
            let share = part(reached[between].0, reached[a].0, reached[b].0);
            (reached[between].1 - reached[a].1 - share * (reached[b].1 - reached[a].1)).abs()
        };
        let kept = simplified(reached.len(), TOLERANCE, off);
        // Round caps extend slightly beyond the dash.
        let value = |index: usize| {
            let (time, along) = reached[index];
            (time, number(if along <= 0.0 { length + 20.0 } else { length - along }))
        };
        let values: Vec<_> = kept.into_iter().map(value).collect();
        let pattern = format!("{} {}", number(length), number(length + 40.0));
        (pattern, self.change("stroke-dashoffset", &values))
    }

    /// Animation of a line's path data.
    pub(super) fn shapes(&self, shapes: &[(f64, Vec<Pixel>)]) -> Animate {
        let off = |between: usize, a: usize, b: usize| {
            let share = part(shapes[between].0, shapes[a].0, shapes[b].0);
            let places = shapes[between].1.iter().zip(shapes[a].1.iter().zip(&shapes[b].1));
            places.map(|(p, (a, b))| (p - (a + (b - a) * share)).norm()).fold(0.0, f64::max)
        };
        let kept = simplified(shapes.len(), TOLERANCE, off);
        let values: Vec<_> = kept.iter().map(|&i| (shapes[i].0, path_data(&shapes[i].1, false))).collect();
        self.change("d", &values)
    }

    /// Moves and turns a group drawn at the origin with heading 0.
    pub(super) fn drive(&self, group: Group, poses: &[(f64, Pixel, f64)]) -> Group {
        let place = |(time, at, _): &(f64, Pixel, f64)| (*time, *at);
        let places: Vec<_> = poses.iter().map(place).collect();
        let kept = in_time(&places);
        let moves: Vec<_> = kept
            .iter()
            .map(|&i| (places[i].0, format!("{} {}", number(places[i].1.x), number(places[i].1.y))))
            .collect();
        let turned = unwound(poses);
        let off = |between: usize, a: usize, b: usize| {
            let share = part(poses[between].0, poses[a].0, poses[b].0);
            (turned[between] - turned[a] - share * (turned[b] - turned[a])).abs()
        };
        let kept = simplified(turned.len(), TURNED, off);
        let turns: Vec<_> = kept.iter().map(|&i| (poses[i].0, format!("{:.0}", turned[i]))).collect();
        let change = |kind: &str, sum: &str, values: &[(f64, String)]| {
            let mut animate = AnimateTransform::new()
                .set("attributeName", "transform")
                .set("type", kind)
                .set("additive", sum);
            self.assign(&mut animate, values);
            animate
        };
        let end = poses.len() - 1;
        let (at, heading) = (poses[end].1, turned[end]);
        let rest = format!("translate({} {}) rotate({heading:.0})", number(at.x), number(at.y));
        group
            .set("transform", rest)
            .add(change("translate", "replace", &moves))
            .add(change("rotate", "sum", &turns))
    }

    /// A bar below the plot that grows with time.
    pub(super) fn progress(&self, plot: &Aabb) -> Rectangle {
        let corner = Pixel::new(plot.min.x, plot.max.y + 3.0);
        let width = number(plot.size().x);
        let bar = rectangle(Aabb { min: corner, max: corner + Vector::new(plot.size().x, 2.5) }, PALE_INK);
        bar.add(self.change("width", &[(0.0, "0".into()), (self.duration, width)]))
    }
}

/// Clockwise angles in degrees that continue beyond a full turn, so that nothing spins back.
fn unwound(poses: &[(f64, Pixel, f64)]) -> Vec<f64> {
    let mut total = poses.first().map_or(0.0, |(_, _, heading)| *heading);
    let mut before = total;
    let step = |(_, _, heading): &(f64, Pixel, f64)| {
        total += angle_difference(*heading, before);
        before = *heading;
        -units::to_deg(total)
    };
    poses.iter().map(step).collect()
}

/// Indices of the positions to keep so that interpolation in time stays within the tolerance.
pub(super) fn in_time(places: &[(f64, Pixel)]) -> Vec<usize> {
    simplified(places.len(), TOLERANCE, |between, a, b| {
        let (from, to) = (places[a].1, places[b].1);
        let share = part(places[between].0, places[a].0, places[b].0);
        (places[between].1 - (from + (to - from) * share)).norm()
    })
}

/// Fraction of the way of a time between two others.
fn part(time: f64, from: f64, to: f64) -> f64 {
    if to > from { (time - from) / (to - from) } else { 0.0 }
}

/// Indices of the things to keep, among `count`, so that interpolation between them deviates by at most
/// `tolerance`: the Ramer-Douglas-Peucker algorithm. `off(i, a, b)` returns the deviation of `i` between `a`
/// and `b`.
pub(super) fn simplified(
    count: usize,
    tolerance: f64,
    off: impl Fn(usize, usize, usize) -> f64,
) -> Vec<usize> {
    let mut kept = vec![false; count];
    let mut spans = vec![(0, count.saturating_sub(1))];
    while let Some((a, b)) = spans.pop() {
        for end in [a, b] {
            kept.get_mut(end).into_iter().for_each(|end| *end = true);
        }
        let farthest = (a + 1..b).map(|i| (off(i, a, b), i)).max_by(|x, y| x.0.total_cmp(&y.0));
        if let Some((_, middle)) = farthest.filter(|(distance, _)| *distance > tolerance) {
            spans.extend([(a, middle), (middle, b)]);
        }
    }
    (0..count).filter(|i| kept[*i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn what_is_left_out_was_where_the_rest_says(
            steps in prop::collection::vec((0.0..0.3f64, -9.0..9.0f64, -9.0..9.0f64), 1..80),
        ) {
            let mut time = 0.0;
            let mut at = Pixel::origin();
            let places: Vec<_> = steps.into_iter().map(|(later, x, y)| {
                time += later;
                at += Vector::new(x, y);
                (time, at)
            }).collect();
            let kept = in_time(&places);
            prop_assert_eq!((kept[0], kept[kept.len() - 1]), (0, places.len() - 1));
            for pair in kept.windows(2) {
                let ((from, a), (to, b)) = (places[pair[0]], places[pair[1]]);
                for (time, place) in &places[pair[0]..=pair[1]] {
                    let shown = a + (b - a) * part(*time, from, to);
                    // Two positions at the same time are both kept, or within the tolerance of each other.
                    prop_assert!(to == from || (place - shown).norm() <= TOLERANCE + 1e-9 || *time == to);
                }
            }
        }

        #[test]
        fn times_of_a_film_begin_end_and_never_fall(times in prop::collection::vec(any::<f64>(), 1..20), end in 0.1..900.0f64) {
            let film = Film::of(end).unwrap();
            let values: Vec<_> = times.iter().map(|time| (*time, "x".to_owned())).collect();
            let text = film.change("x", &values).to_string();
            let (_, rest) = text.split_once("keyTimes=\"").unwrap();
            let keys: Vec<f64> = rest.split('"').next().unwrap().split(';').map(|key| key.parse().unwrap()).collect();
            prop_assert_eq!((keys[0], keys[keys.len() - 1], keys.len()), (0.0, 1.0, values.len() + 2));
            prop_assert!(keys.is_sorted());
        }
    }

    #[test]
    fn nothing_moves_without_time() {
        assert!(Film::of(0.0).is_none());
        assert_eq!(Film::of(280.0).unwrap().pace(), 20.0);
    }
}
