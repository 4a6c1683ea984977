use super::architecture::{LANES, MapSize};
use crate::vision::dispatch::vectorised;

/// Number of places in a row to which the same filters are applied at once.
const PLACES: usize = 4;

/// Weights of a layer, in the order in which they are used.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Filters {
    /// Number of filters, and of weights of each.
    pub(super) count: usize,
    taps: usize,
    /// For each group of filters, for each place and channel of the filter, a weight of every filter.
    packed: Vec<[f32; LANES]>,
    constants: Vec<[f32; LANES]>,
}

/// How a layer goes over its input.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pass {
    pub(super) from: MapSize,
    pub(super) to: MapSize,
    /// Rows of a filter, and values of a row of it.
    pub(super) rows: usize,
    pub(super) row: usize,
    pub(super) stride: usize,
    /// Whether negative results become 0.
    pub(super) rectify: bool,
}

impl Filters {
    /// Packs weights, a row for each filter, and constants.
    pub(super) fn new(weights: &[f32], constants: &[f32]) -> Self {
        let (count, taps) = (constants.len(), weights.len() / constants.len().max(1));
        let groups = count.div_ceil(LANES);
        let mut packed = vec![[0.0; LANES]; groups * taps];
        let mut first = vec![[0.0; LANES]; groups];
        for filter in 0..count {
            let (group, lane) = (filter / LANES, filter % LANES);
            first[group][lane] = constants[filter];
            for tap in 0..taps {
                packed[group * taps + tap][lane] = weights[filter * taps + tap];
            }
        }
        Self { count, taps, packed, constants: first }
    }

    /// The weights, a row for each filter, and the constants.
    pub(super) fn unpacked(&self) -> (Vec<f32>, Vec<f32>) {
        let lane = |filter: usize| (filter / LANES, filter % LANES);
        let weight = |filter: usize, tap: usize| {
            let (group, lane) = lane(filter);
            self.packed[group * self.taps + tap][lane]
        };
        let weights = (0..self.count).flat_map(|filter| (0..self.taps).map(move |tap| weight(filter, tap)));
        let constants = (0..self.count).map(|filter| {
            let (group, lane) = lane(filter);
            self.constants[group][lane]
        });
        (weights.collect(), constants.collect())
    }

    /// Applies the filters.
    pub(super) fn apply(&self, input: &[f32], output: &mut [f32], pass: Pass) {
        apply(&self.packed, &self.constants, input, output, pass);
    }
}

vectorised! {
    fn apply(packed: &[[f32; LANES]], constants: &[[f32; LANES]], input: &[f32], output: &mut [f32], pass: Pass) {
        let taps = pass.rows * pass.row;
        let (line, step) = (pass.from.width * pass.from.channels, pass.stride * pass.from.channels);
        for y in 0..pass.to.height {
            let above = &input[y * pass.stride * line..];
            let below = &mut output[y * pass.to.width * pass.to.channels..];
            // The last group may write more values than there are channels, which the first ones replace.
            for (group, constants) in constants.iter().enumerate().rev() {
                let weights = &packed[group * taps..][..taps];
                let below = &mut below[group * LANES..];
                let mut x = 0;
                while x + PLACES <= pass.to.width {
                    let below = &mut below[x * pass.to.channels..];
                    block::<PLACES>(weights, constants, &above[x * step..], (line, step), below, pass);
                    x += PLACES;
                }
                for x in x..pass.to.width {
                    let below = &mut below[x * pass.to.channels..];
                    block::<1>(weights, constants, &above[x * step..], (line, step), below, pass);
                }
            }
        }
    }
}

/// Applies filters to neighbouring places. Every sum begins with the constant and goes over rows, columns and
/// channels of the filter, in this order, whatever is computed beside it.
#[inline(always)]
fn block<const P: usize>(
    weights: &[[f32; LANES]],
    constants: &[f32; LANES],
    input: &[f32],
    (line, step): (usize, usize),
    output: &mut [f32],
    pass: Pass,
) {
    let mut sums = [*constants; P];
    for (y, weights) in weights.chunks_exact(pass.row).enumerate() {
        let places: [&[f32]; P] =
            std::array::from_fn(|place| &input[y * line + place * step..][..weights.len()]);
        for (tap, weights) in weights.iter().enumerate() {
            for (sums, place) in sums.iter_mut().zip(&places) {
                let value = place[tap];
                *sums = std::array::from_fn(|lane| sums[lane] + weights[lane] * value);
            }
        }
    }
    for (place, sums) in sums.iter().enumerate() {
        let output = &mut output[place * pass.to.channels..][..LANES];
        for (output, &sum) in output.iter_mut().zip(sums) {
            // Comparison rather than `max`, which may choose either zero.
            *output = if pass.rectify && sum < 0.0 { 0.0 } else { sum };
        }
    }
}
