use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use super::ray::lesser;
use crate::geometry::{Vector, cross, math, normalize_angle};

/// Upper bound of the error of [`rough_angle`] (rad).
const ROUGHNESS: f64 = 2e-5;

/// Beams at equal angles from one point, counter-clockwise.
#[derive(Debug, Clone)]
pub(super) struct Fan {
    /// Directions of the beams in their own frame ...
    own_cos: Vec<f64>,
    own_sin: Vec<f64>,
    /// ... and in the world.
    pub(super) cos: Vec<f64>,
    pub(super) sin: Vec<f64>,
    /// Angle of the first beam in its own frame and in the world, in `-pi..=pi`.
    first: f64,
    base: f64,
    /// Beams per radian and per full turn.
    per_radian: f64,
    turn: f64,
    /// Upper bound of the error of a beam number from a rough angle.
    margin: f64,
}

/// Angular extent of an outline: vectors to its ends, and whether the rotation from the first to the second
/// is counter-clockwise (1) or clockwise (-1).
#[derive(Debug, Clone, Copy)]
pub(super) struct Arc {
    pub(super) from: Vector,
    pub(super) to: Vector,
    pub(super) turn: f64,
}

/// An interval of fractional beam numbers; the start is in the first turn, or slightly before it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sector {
    start: f64,
    end: f64,
}

impl Fan {
    /// `beams` directions from `first` with a positive `increment` (rad).
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

    /// Number of beams.
    #[inline]
    pub(super) fn beams(&self) -> usize {
        self.cos.len()
    }

    /// Direction of a beam in the world.
    #[inline]
    pub(super) fn direction(&self, beam: usize) -> Vector {
        Vector::new(self.cos[beam], self.sin[beam])
    }

    /// Direction of a beam in the beams' own frame.
    #[inline]
    pub(super) fn own_direction(&self, beam: usize) -> Vector {
        Vector::new(self.own_cos[beam], self.own_sin[beam])
    }

    /// Rotates the beams' frame to a heading in the world.
    pub(super) fn turn_to(&mut self, heading: f64) {
        let (sin, cos) = math::sin_cos(heading);
        combine([(cos, &self.own_cos), (-sin, &self.own_sin)], &mut self.cos);
        combine([(sin, &self.own_cos), (cos, &self.own_sin)], &mut self.sin);
        self.base = normalize_angle(self.first + heading);
    }

    /// All beams.
    #[inline]
    pub(super) fn all(&self) -> Sector {
        Sector { start: 0.0, end: self.cos.len() as f64 }
    }

    /// Beams between the ends of an arc of at most half a turn; the interval is slightly too large.
    #[inline]
    pub(super) fn sector(&self, arc: &Arc) -> Sector {
        let (from, to) = (rough_angle(arc.from), rough_angle(arc.to));
        // From end to end along its rotation; this may be slightly negative for an arc of nearly zero length.
        let sweep = arc.turn * (to - from);
        let sweep = if sweep < -1.0 { sweep + TAU } else { sweep };
        self.sector_from(from + lesser(arc.turn * sweep, 0.0), sweep.abs())
    }

    /// Beams within an angle (at most a right one) of a direction; the interval is slightly too large.
    #[inline]
    pub(super) fn sector_about(&self, middle: Vector, half: f64) -> Sector {
        self.sector_from(rough_angle(middle) - half, 2.0 * half)
    }

    /// Beams from a rough angle on, counter-clockwise.
    #[inline]
    fn sector_from(&self, from: f64, sweep: f64) -> Sector {
        let from = from - self.base;
        let from = from - TAU * lesser(0.0, 1.0_f64.copysign(from));
        let start = from * self.per_radian - self.margin;
        Sector { start, end: (from + sweep) * self.per_radian + self.margin }
    }

    /// Visits the runs of beams in a sector, as first and last beam.
    #[inline]
    pub(super) fn for_each_run(&self, sector: Sector, mut visit: impl FnMut(usize, usize)) {
        let Sector { mut start, mut end } = sector;
        if end >= self.turn {
            // It includes the first beam, where the fan may start again.
            (start, end) = (start - self.turn, end - self.turn);
        }
        let last_beam = self.cos.len() as i32 - 1;
        while start <= f64::from(last_beam) {
            let first = nearest_whole(start + 0.5).max(0);
            let last = nearest_whole(end - 0.5).min(last_beam);
            if first <= last {
                visit(first as usize, last as usize);
            }
            (start, end) = (start + self.turn, end + self.turn);
        }
    }

    /// Visits the runs of beams in an arc, including its ends, given its sector.
    #[inline]
    pub(super) fn for_each_exact_run(&self, arc: &Arc, sector: Sector, mut visit: impl FnMut(usize, usize)) {
        self.for_each_run(sector, |mut first, mut last| {
            while first < last && !self.holds(arc, first) {
                first += 1;
            }
            while last > first && !self.holds(arc, last) {
                last -= 1;
            }
            if first < last || self.holds(arc, first) {
                visit(first, last);
            }
        });
    }

    /// Whether a beam on the arc's side is between its ends.
    #[inline]
    fn holds(&self, arc: &Arc, beam: usize) -> bool {
        let direction = self.direction(beam);
        (arc.turn * cross(arc.from, direction) >= 0.0) & (arc.turn * cross(direction, arc.to) >= 0.0)
    }
}

/// Linear combination of two lists. Not inlined, which tells the compiler that the slices do not overlap.
#[inline(never)]
fn combine([(a, first), (b, second)]: [(f64, &[f64]); 2], out: &mut [f64]) {
    for ((x, y), sum) in first.iter().zip(second).zip(out) {
        *sum = a * x + b * y;
    }
}

/// The integer nearest to `x` (below 2^31): after adding 1.5 * 2^52 it is in the sum's lowest bits.
#[inline]
fn nearest_whole(x: f64) -> i32 {
    (x + 6_755_399_441_055_744.0).to_bits() as i32
}

/// Angle of a vector in `-pi..=pi`, accurate to 2e-5 rad (series of Abramowitz and Stegun, 4.4.47).
#[inline]
fn rough_angle(v: Vector) -> f64 {
    let (x, y) = (v.x.abs(), v.y.abs());
    // Relative to the quadrant's diagonal, so that the series covers the whole quadrant. No branches, because
    // half of the predictions would fail.
    let q = (y - x) / (y + x + f64::MIN_POSITIVE);
    let p = q * q;
    let series = 0.180_141_0 + p * (-0.085_133_0 + p * 0.020_835_1);
    let to_diagonal = q * (0.999_866_0 + p * (-0.330_299_5 + p * series));
    let to_y_axis = FRAC_PI_4 - to_diagonal;
    (FRAC_PI_2 - to_y_axis.copysign(v.x)).copysign(v.y)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
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
            sweep in prop_oneof![0.0..3.1f64, PI - 1e-5..PI - 1e-9],
            clockwise: bool,
            close in prop::option::of((0..500usize, 0..500usize, -4e-5..4e-5f64, -4e-5..4e-5f64)),
        ) {
            // Either a random arc, or one with its ends close to beams.
            let (from, sweep) = close.map_or((from, sweep), |(start, run, before, behind)| {
                let run = (run as f64).min((3.0 / increment).trunc());
                (first + heading + increment * start as f64 + before, (increment * run + behind).max(0.0))
            });
            let mut fan = Fan::new(first, increment, beams);
            fan.turn_to(heading);
            let end = |angle: f64| Vector::new(math::cos(angle), math::sin(angle)) * 2.5;
            let arc = Arc { from: end(from), to: end(from + sweep), turn: 1.0 };
            let back = Arc { from: arc.to, to: arc.from, turn: -1.0 };
            let mut held = vec![0; beams];
            let arc = if clockwise { back } else { arc };
            fan.for_each_exact_run(&arc, fan.sector(&arc), |a, b| {
                held[a..=b].iter_mut().for_each(|times| *times += 1);
            });
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
            let sector = fan.sector(&Arc { from: along, to: along, turn: 1.0 });
            fan.for_each_run(sector, |a, b| held.push((a, b)));
            assert_eq!(held, [(beam, beam)]);
        }
    }
}
