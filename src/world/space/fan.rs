use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::geometry::{Vector, cross, math, normalize_angle};

/// The largest error of [`rough_angle`], in radians, with room to spare.
const ROUGHNESS: f64 = 2e-5;

/// Beams that spread from one point, evenly and counter-clockwise.
#[derive(Debug, Clone)]
pub(super) struct Fan {
    /// The beams' directions in their own frame, ...
    own_cos: Vec<f64>,
    own_sin: Vec<f64>,
    /// ... and as the world sees them.
    pub(super) cos: Vec<f64>,
    pub(super) sin: Vec<f64>,
    /// The angle of the first beam in its own frame, and as the world sees it, in `-pi..=pi`.
    first: f64,
    base: f64,
    /// Beams in a radian, and in a full turn.
    per_radian: f64,
    turn: f64,
    /// The largest error of a beam's number that is made from a rough angle.
    margin: f64,
}

/// What an outline covers of all directions: vectors to its clockwise and its counter-clockwise end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arc {
    pub(super) start: Vector,
    pub(super) end: Vector,
}

impl Fan {
    /// `beams` directions from `first`, `increment` radians apart, which is more than 0.
    pub(super) fn new(first: f64, increment: f64, beams: usize) -> Self {
        let (own_sin, own_cos): (Vec<f64>, Vec<f64>) =
            (0..beams).map(|beam| math::sin_cos(first + increment * beam as f64)).unzip();
        let per_radian = 1.0 / increment;
        Self {
            cos: own_cos.clone(),
            sin: own_sin.clone(),
            own_cos,
            own_sin,
            first,
            base: normalize_angle(first),
            per_radian,
            turn: TAU * per_radian,
            margin: ROUGHNESS * per_radian + 1e-6,
        }
    }

    /// The number of beams.
    #[inline]
    pub(super) fn beams(&self) -> usize {
        self.cos.len()
    }

    /// The direction of a beam, as the world sees it.
    #[inline]
    pub(super) fn direction(&self, beam: usize) -> Vector {
        Vector::new(self.cos[beam], self.sin[beam])
    }

    /// Turns the beams' frame to a heading in the world.
    pub(super) fn turn_to(&mut self, heading: f64) {
        let (sin, cos) = math::sin_cos(heading);
        let own = self.own_cos.iter().zip(&self.own_sin);
        for ((c, s), (world_c, world_s)) in own.zip(self.cos.iter_mut().zip(&mut self.sin)) {
            *world_c = cos * c - sin * s;
            *world_s = sin * c + cos * s;
        }
        self.base = normalize_angle(self.first + heading);
    }

    /// Visits the runs of beams, first and last, that may lie in an arc of at most half a turn: all that do lie in
    /// it, and at most some at its ends that do not.
    #[inline]
    pub(super) fn for_each_run(&self, arc: &Arc, mut visit: impl FnMut(usize, usize)) {
        let from = rough_angle(arc.start);
        let sweep = rough_angle(arc.end) - from;
        // An arc of about nothing may come out a little negative: that is no full turn.
        let sweep = if sweep < -1.0 { sweep + TAU } else { sweep };
        let from = from - self.base;
        let from = if from < 0.0 { from + TAU } else { from };
        let last_beam = self.cos.len() as i32 - 1;
        let mut start = from * self.per_radian - self.margin;
        let mut end = (from + sweep) * self.per_radian + self.margin;
        if end >= self.turn {
            // The arc reaches over the first beam, where the fan begins, or may begin, anew.
            (start, end) = (start - self.turn, end - self.turn);
        }
        while start <= f64::from(last_beam) {
            let first = if start > 0.0 { round_up(start) } else { 0 };
            let last = (end as i32).min(last_beam);
            if end >= 0.0 && first <= last {
                visit(first as usize, last as usize);
            }
            (start, end) = (start + self.turn, end + self.turn);
        }
    }

    /// Visits the runs of beams that lie in an arc of at most half a turn, its ends included.
    #[inline]
    pub(super) fn for_each_exact_run(&self, arc: &Arc, mut visit: impl FnMut(usize, usize)) {
        self.for_each_run(arc, |mut first, mut last| {
            while first <= last && cross(arc.start, self.direction(first)) < 0.0 {
                first += 1;
            }
            while last > first && cross(self.direction(last), arc.end) < 0.0 {
                last -= 1;
            }
            if first <= last && cross(self.direction(last), arc.end) >= 0.0 {
                visit(first, last);
            }
        });
    }
}

/// The next whole number from a positive one.
#[inline]
fn round_up(x: f64) -> i32 {
    let whole = x as i32;
    if f64::from(whole) < x { whole.saturating_add(1) } else { whole }
}

/// The angle of a vector, in `-pi..=pi`, to within 2e-5 rad (Abramowitz and Stegun, 4.4.47).
#[inline]
fn rough_angle(v: Vector) -> f64 {
    let (x, y) = (v.x.abs(), v.y.abs());
    let steep = y > x;
    let (low, high) = if steep { (x, y) } else { (y, x) };
    let q = low / (high + f64::MIN_POSITIVE);
    let p = q * q;
    let series = 0.180_141_0 + p * (-0.085_133_0 + p * 0.020_835_1);
    let angle = q * (0.999_866_0 + p * (-0.330_299_5 + p * series));
    let angle = if steep { FRAC_PI_2 - angle } else { angle };
    let angle = if v.x < 0.0 { PI - angle } else { angle };
    if v.y < 0.0 { -angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rough_angles_are_near_the_true_ones(x in -10.0..10.0f64, y in -10.0..10.0f64) {
            let error = rough_angle(Vector::new(x, y)) - math::atan2(y, x);
            prop_assert!(error.abs() < ROUGHNESS, "{error}");
        }

        #[test]
        fn an_arc_holds_the_beams_between_its_ends(
            first in -7.0..7.0f64,
            increment in 0.001..3.0f64,
            beams in 1..500usize,
            heading in -4.0..4.0f64,
            from in -3.2..3.2f64,
            sweep in 0.0..3.1f64,
        ) {
            let mut fan = Fan::new(first, increment, beams);
            fan.turn_to(heading);
            let end = |angle: f64| Vector::new(math::cos(angle), math::sin(angle)) * 2.5;
            let arc = Arc { start: end(from), end: end(from + sweep) };
            let mut held = vec![0; beams];
            fan.for_each_exact_run(&arc, |a, b| held[a..=b].iter_mut().for_each(|times| *times += 1));
            for (beam, times) in held.into_iter().enumerate() {
                let middle = from + 0.5 * sweep;
                let off = normalize_angle(first + heading + increment * beam as f64 - middle).abs();
                if (off - 0.5 * sweep).abs() > 1e-9 {
                    prop_assert_eq!(times, i32::from(off < 0.5 * sweep), "beam {} of {}", beam, beams);
                }
            }
        }
    }

    #[test]
    fn an_arc_of_one_direction_holds_the_beam_along_it_and_no_other() {
        let fan = Fan::new(0.0, TAU / 360.0, 360);
        for beam in [0, 1, 90, 179, 180, 359] {
            let along = fan.direction(beam) * 3.0;
            let mut held = Vec::new();
            fan.for_each_run(&Arc { start: along, end: along }, |a, b| held.push((a, b)));
            assert_eq!(held, [(beam, beam)]);
        }
    }
}
