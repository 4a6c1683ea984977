//! The gradient of the loss for a part of a batch, by candle.

use candle_core::{D, Device, Result, Tensor, Var};

use crate::vision::network::{Architecture, Layer, MapSize};

/// What a network is to make small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Loss {
    /// The squared error of a single result.
    Squares,
    /// The negative logarithm of the probability of the right class (cross entropy).
    Classes,
}

/// Weights and constants of a layer, and their gradients alike.
pub(super) type Numbers = Vec<(Vec<f32>, Vec<f32>)>;

/// Some examples.
pub(super) struct Part<'a> {
    /// Inputs, one after the other.
    pub(super) inputs: &'a [f32],
    /// A result for each.
    pub(super) targets: &'a [f32],
    /// Factors of what the last layer sees; none if all is shown.
    pub(super) shown: &'a [f32],
}

/// Sum of the losses of some examples, and its gradient.
pub(super) fn gradient(
    architecture: &Architecture,
    weights: &Numbers,
    examples: &Part<'_>,
    loss: Loss,
) -> Result<(f64, Numbers)> {
    let device = &Device::Cpu;
    let variables = variables(architecture, weights, device)?;
    let results = forward(architecture, &variables, examples)?;
    let targets = Tensor::from_slice(examples.targets, examples.targets.len(), device)?;
    let sum = match loss {
        Loss::Squares => (results.squeeze(1)? - targets)?.sqr()?.sum_all()?,
        Loss::Classes => {
            let classes = targets.to_dtype(candle_core::DType::U32)?.unsqueeze(1)?;
            let right = results.gather(&classes, D::Minus1)?.squeeze(1)?;
            (results.log_sum_exp(D::Minus1)? - right)?.sum_all()?
        }
    };
    let gradients = sum.backward()?;
    let numbers = |variable: &Var| -> Result<Vec<f32>> {
        let gradient = gradients
            .get(variable)
            .ok_or_else(|| candle_core::Error::Msg("a weight without a gradient".into()))?;
        gradient.contiguous()?.flatten_all()?.to_vec1()
    };
    let numbers = variables.iter().map(|(weights, constants)| Ok((numbers(weights)?, numbers(constants)?)));
    Ok((f64::from(sum.to_scalar::<f32>()?), numbers.collect::<Result<_>>()?))
}

/// The weights of layers as candle's variables: a row for each filter, in the order of rows, columns and
/// channels.
fn variables(architecture: &Architecture, weights: &Numbers, device: &Device) -> Result<Vec<(Var, Var)>> {
    let shapes = architecture.filters().flatten().zip(weights);
    let variables = shapes.map(|(shape, (weights, constants))| {
        let constants = Tensor::from_slice(constants, constants.len(), device)?;
        Ok((Var::from_tensor(&Tensor::from_slice(weights, shape, device)?)?, Var::from_tensor(&constants)?))
    });
    variables.collect()
}

/// Results of examples. Maps have a row for each place, of all inputs one after the other, so that
/// a convolution is a product of matrices.
fn forward(architecture: &Architecture, variables: &[(Var, Var)], examples: &Part<'_>) -> Result<Tensor> {
    let count = examples.targets.len();
    let mut values = Tensor::from_slice(examples.inputs, (count, architecture.input().len()), &Device::Cpu)?;
    let mut variables = variables.iter();
    let last = architecture.layers().len() - 1;
    for (index, &layer) in architecture.layers().iter().enumerate() {
        let [from, to] = [architecture.sizes()[index], architecture.sizes()[index + 1]];
        let places = count * to.height * to.width;
        if index == last && !examples.shown.is_empty() {
            values = (values.reshape((count, from.len()))?
                * Tensor::from_slice(examples.shown, (count, from.len()), &Device::Cpu)?)?;
        }
        if let Layer::Pool { size } = layer {
            let squares = seen(&values, count, (from, to), (size, size))?;
            values = squares.reshape((places, size * size, from.channels))?.max(1)?;
            continue;
        }
        let Some((weights, constants)) = variables.next() else { break };
        let columns = if let Layer::Convolution { size, stride, .. } = layer {
            seen(&values, count, (from, to), (size, stride))?
                .reshape((places, size * size * from.channels))?
        } else {
            values.reshape((count, from.len()))?
        };
        values = columns.matmul(&weights.t()?)?.broadcast_add(constants)?;
        if index < last {
            values = values.relu()?;
        }
    }
    values.reshape((count, architecture.outputs()))
}

/// What filters of a size see at each place to which their stride brings them: rows, columns, channels.
fn seen(
    values: &Tensor,
    count: usize,
    (from, to): (MapSize, MapSize),
    (size, stride): (usize, usize),
) -> Result<Tensor> {
    let square = |y: usize, x: usize| {
        (0..size * size)
            .map(move |at| ((y * stride + at / size) * from.width + x * stride + at % size) as u32)
    };
    let places = (0..to.height).flat_map(|y| (0..to.width).flat_map(move |x| square(y, x)));
    let places = Tensor::from_iter(places, &Device::Cpu)?;
    values.reshape((count, from.height * from.width, from.channels))?.index_select(&places, 1)
}
