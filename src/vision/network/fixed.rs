use super::architecture::{Architecture, Layer, MapSize};
use super::net::{Network, pool};
use crate::ParameterError;
use crate::parameter::{require, require_count, require_finite};
use crate::vision::dispatch::vectorised;

/// A [`Network`] in integers of 16 bits: values and weights have 16, sums 32, which no input can exceed.
///
/// Values of a layer share a power of two as their unit. It follows from the largest value that each layer
/// had for some inputs; what is more than four times as large is cut off, or less. The unit of a layer's
/// weights is the smallest with which no sum overflows.
///
/// ```
/// use roverlab::vision::network::{FixedNetwork, Network};
///
/// let mut exact = Network::new("1x2x1 dense2 dense1".parse()?, vec![
///     (vec![0.5, -1.0, 2.0, 0.25], vec![0.1, 0.0]),
///     (vec![1.0, 1.0], vec![-0.5]),
/// ])?;
/// let inputs = [[0.3_f32, 0.9], [1.0, -1.0]];
/// let mut fixed = FixedNetwork::new(&mut exact, inputs.iter().map(<[f32; 2]>::as_slice))?;
/// assert!((fixed.run(&inputs[0])?[0] - exact.run(&inputs[0])?[0]).abs() < 1e-3);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FixedNetwork {
    architecture: Architecture,
    layers: Vec<Option<FixedFilters>>,
    maps: Vec<Vec<i16>>,
    /// Binary digits after the point of the input, and of the results.
    digits: [i32; 2],
    results: Vec<f32>,
}

/// Weights of a layer, a row for each filter; constants in the unit of the sums.
#[derive(Debug, Clone, PartialEq)]
struct FixedFilters {
    weights: Vec<i16>,
    constants: Vec<i32>,
    /// Digits by which sums have more after the point than the results.
    shift: u32,
}

/// Largest value of a layer that fits, with one digit in reserve.
const MOST_VALUE: f64 = 16383.0;
/// Largest number of digits after the point, or before it.
const MOST_DIGITS: i32 = 24;
/// Most digits that a sum can have more than the results.
const MOST_SHIFT: i32 = 62;

impl FixedNetwork {
    /// Rounds a network. The inputs show how large the values of its layers become.
    ///
    /// # Errors
    ///
    /// If an input has the wrong size, there is none, or the weights are too large for integers.
    pub fn new<'a>(
        network: &mut Network,
        inputs: impl IntoIterator<Item = &'a [f32]>,
    ) -> Result<Self, ParameterError> {
        let architecture = network.architecture().clone();
        let mut largest = vec![0.0_f64; architecture.sizes().len()];
        let mut count = 0;
        for input in inputs {
            for value in input {
                require_finite("value of an input", f64::from(*value))?;
            }
            network.run(input)?;
            count += 1;
            for (index, largest) in largest.iter_mut().enumerate() {
                *largest =
                    network.map(index).iter().fold(*largest, |most, value| most.max(f64::from(*value).abs()));
            }
        }
        require("number of inputs", f64::from(count), count > 0, "at least 1")?;
        let input = digits_for(largest[0], MOST_VALUE)?;
        let mut digits = input;
        let mut weights = network.weights().into_iter();
        let mut layers = Vec::new();
        for (index, sizes) in architecture.filters().enumerate() {
            // What a pool takes out keeps its unit.
            let filters = sizes.map(|(_, taps)| {
                let (weights, constants) = weights.next().unwrap_or_default();
                FixedFilters::new(&weights, &constants, taps, &mut digits, largest[index + 1])
            });
            layers.push(filters.transpose()?);
        }
        let maps = architecture.sizes().iter().map(|size| vec![0; size.len()]).collect();
        let results = vec![0.0; architecture.outputs()];
        Ok(Self { architecture, layers, maps, digits: [input, digits], results })
    }

    /// Results for an input. Does not allocate.
    ///
    /// # Errors
    ///
    /// If the input has more or fewer values than the architecture says.
    pub fn run(&mut self, input: &[f32]) -> Result<&[f32], ParameterError> {
        let expected = self.architecture.input().len();
        require_count("values of the input", input.len(), expected)?;
        let unit = power(self.digits[0]);
        for (value, &given) in self.maps[0].iter_mut().zip(input) {
            // Conversion saturates, and makes 0 of what is no number.
            *value = (f64::from(given) * unit).round_ties_even() as i16;
        }
        let last = self.layers.len() - 1;
        for index in 0..=last {
            let (from, to) = (self.architecture.sizes()[index], self.architecture.sizes()[index + 1]);
            let (before, after) = self.maps.split_at_mut(index + 1);
            let (before, after) = (&before[index], &mut after[0]);
            match (&self.layers[index], self.architecture.layers()[index]) {
                (Some(filters), layer) => filters.apply(before, after, (layer, from, to), index < last),
                (None, Layer::Pool { size }) => pool(before, after, from, to, size),
                (None, _) => {}
            }
        }
        let unit = power(-self.digits[1]);
        for (result, &value) in self.results.iter_mut().zip(&self.maps[last + 1]) {
            *result = (f64::from(value) * unit) as f32;
        }
        Ok(&self.results)
    }
}

impl FixedFilters {
    /// Rounds weights. `digits` are those of the input, then those of the results, whose largest value is
    /// given.
    fn new(
        weights: &[f32],
        constants: &[f32],
        taps: usize,
        digits: &mut i32,
        largest: f64,
    ) -> Result<Self, ParameterError> {
        let rows = || weights.chunks_exact(taps).zip(constants);
        let heaviest = weights.iter().map(|weight| f64::from(*weight).abs()).fold(0.0, f64::max);
        let sum = rows().map(|(row, constant)| {
            // A constant counts as a weight of an input of 1; half a unit more for each that is rounded up.
            let inputs: f64 = row.iter().map(|weight| f64::from(*weight).abs()).sum();
            inputs + f64::from(*constant).abs() * power(*digits) / f64::from(i16::MAX)
        });
        let sum = sum.fold(0.0, f64::max);
        let room = f64::from(i32::MAX) / 32768.0 - taps as f64;
        require("weights of a filter", taps as f64, room > 0.0, "at most 65000")?;
        let own = digits_for(heaviest, f64::from(i16::MAX))?.min(digits_for(sum, room)?);
        let results = digits_for(largest, MOST_VALUE)?.min(*digits + own);
        let fits = "values and weights that fit into 16 bits";
        require("digits of a layer", results.into(), results >= -MOST_DIGITS, fits)?;
        let shift = *digits + own - results;
        require("digits of a sum", shift.into(), (0..=MOST_SHIFT).contains(&shift), fits)?;
        let round = |value: f32, digits: i32| (f64::from(value) * power(digits)).round_ties_even();
        let filters = Self {
            weights: weights.iter().map(|&weight| round(weight, own) as i16).collect(),
            constants: constants.iter().map(|&constant| round(constant, *digits + own) as i32).collect(),
            shift: shift.unsigned_abs(),
        };
        *digits = results;
        Ok(filters)
    }

    fn apply(
        &self,
        input: &[i16],
        output: &mut [i16],
        (layer, from, to): (Layer, MapSize, MapSize),
        rectify: bool,
    ) {
        let (rows, row, stride) = match layer {
            Layer::Convolution { size, stride, .. } => (size, size * from.channels, stride),
            _ => (1, from.len(), 1),
        };
        let line = from.width * from.channels;
        let half = if self.shift > 0 { 1_i64 << (self.shift - 1) } else { 0 };
        for (place, output) in output.chunks_exact_mut(to.channels).enumerate() {
            let start = place / to.width * stride * line + place % to.width * stride * from.channels;
            let filters = self.weights.chunks_exact(rows * row).zip(&self.constants);
            for (output, (weights, constant)) in output.iter_mut().zip(filters) {
                let lines = weights.chunks_exact(row).enumerate();
                let sum: i32 =
                    lines.map(|(y, weights)| dot(weights, &input[start + y * line..][..row])).sum();
                let value = (i64::from(sum) + i64::from(*constant) + half) >> self.shift;
                let least = if rectify { 0 } else { i64::from(i16::MIN) };
                *output = value.clamp(least, i16::MAX.into()) as i16;
            }
        }
    }
}

vectorised! {
    fn dot(weights: &[i16], values: &[i16]) -> i32 {
        weights.iter().zip(values).map(|(&weight, &value)| i32::from(weight) * i32::from(value)).sum()
    }
}

/// Most digits after the point with which a value is at most a limit.
fn digits_for(value: f64, limit: f64) -> Result<i32, ParameterError> {
    let fits = |digits: &i32| value * power(*digits) <= limit;
    let digits = (-MOST_DIGITS..=MOST_DIGITS).rev().find(fits);
    digits.ok_or_else(|| ParameterError::new("value or weight", value, "one that fits into 16 bits"))
}

/// Two to the power of digits.
fn power(digits: i32) -> f64 {
    let power = (1_u64 << digits.unsigned_abs()) as f64;
    if digits < 0 { 1.0 / power } else { power }
}
