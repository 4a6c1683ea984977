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

/// Sum of the losses of some examples, and its gradient.
pub(super) fn gradient(
    architecture: &Architecture,
    weights: &Numbers,
    inputs: &[f32],
    targets: &[f32],
    loss: Loss,
) -> Result<(f64, Numbers)> {
    let device = &Device::Cpu;
    let variables = variables(architecture, weights, device)?;
    let results = forward(architecture, &variables, inputs, targets.len())?;
    let targets = Tensor::from_slice(targets, targets.len(), device)?;
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
    let layers = architecture.layers().iter().zip(architecture.sizes());
    let shapes = layers.filter_map(|(&layer, from)| match layer {
        Layer::Convolution { channels, size, .. } => Some(vec![channels, size, size, from.channels]),
        Layer::Dense { outputs } => Some(vec![outputs, from.len()]),
        Layer::Pool { .. } => None,
    });
    let variables = shapes.zip(weights).map(|(shape, (weights, constants))| {
        let constants = Tensor::from_slice(constants, constants.len(), device)?;
        Ok((Var::from_tensor(&Tensor::from_slice(weights, shape, device)?)?, Var::from_tensor(&constants)?))
    });
    variables.collect()
}

/// Results of a number of inputs.
fn forward(
    architecture: &Architecture,
    variables: &[(Var, Var)],
    inputs: &[f32],
    count: usize,
) -> Result<Tensor> {
    let size = architecture.input();
    let inputs = Tensor::from_slice(inputs, (count, size.height, size.width, size.channels), &Device::Cpu)?;
    // Candle has channels before rows and columns.
    let mut values = inputs.permute((0, 3, 1, 2))?.contiguous()?;
    let mut variables = variables.iter();
    let last = architecture.layers().len() - 1;
    for (index, &layer) in architecture.layers().iter().enumerate() {
        let to = architecture.sizes()[index + 1];
        if let Layer::Pool { size } = layer {
            values = reached(&values, to, (size, size))?.max_pool2d(size)?;
            continue;
        }
        let Some((weights, constants)) = variables.next() else { break };
        values = if let Layer::Convolution { size, stride, .. } = layer {
            let values = reached(&values, to, (size, stride))?;
            let weights = weights.permute((0, 3, 1, 2))?.contiguous()?;
            let constants = constants.reshape((1, constants.elem_count(), 1, 1))?;
            values.conv2d(&weights, 0, stride, 1, 1)?.broadcast_add(&constants)?
        } else {
            let flat =
                if values.rank() == 4 { values.permute((0, 2, 3, 1))?.flatten_from(1)? } else { values };
            flat.matmul(&weights.t()?)?.broadcast_add(constants)?
        };
        if index < last {
            values = values.relu()?;
        }
    }
    if values.rank() == 4 { values.permute((0, 2, 3, 1))?.flatten_from(1) } else { Ok(values) }
}

/// The rows and columns that filters of a size reach by their stride: of others candle wants as many below as
/// to the right.
fn reached(values: &Tensor, to: MapSize, (size, stride): (usize, usize)) -> Result<Tensor> {
    let [height, width] = [to.height, to.width].map(|places| (places - 1) * stride + size);
    values.narrow(2, 0, height)?.narrow(3, 0, width)?.contiguous()
}
