use safetensors::tensor::{Dtype, SafeTensors, TensorView};

use super::architecture::{Architecture, Layer};
use super::net::Network;
use crate::vision::WeightsError;

/// A tensor's name, its kind of numbers, shape and bytes.
pub(in crate::vision) type NamedTensor = (String, Dtype, Vec<usize>, Vec<u8>);

/// Key of the architecture in the file's metadata.
pub(in crate::vision) const ARCHITECTURE: &str = "architecture";

impl Network {
    /// The network as a file `.safetensors`, with weights of 16 bits. For each layer with weights, numbered
    /// from 1: `N.weights`, a row for each filter; `N.units`, by which its whole numbers are multiplied; and
    /// `N.constants`.
    ///
    /// # Errors
    ///
    /// If it does not fit into the format.
    pub fn to_safetensors(&self) -> Result<Vec<u8>, WeightsError> {
        let tensors = self.to_tensors();
        let views = tensors.iter().map(|(name, kind, shape, bytes)| {
            Ok((name.as_str(), TensorView::new(*kind, shape.clone(), bytes).map_err(WeightsError::of)?))
        });
        let views: Vec<_> = views.collect::<Result<_, WeightsError>>()?;
        let about = std::iter::once((ARCHITECTURE.to_owned(), self.architecture().to_string())).collect();
        safetensors::serialize(views, Some(about)).map_err(WeightsError::of)
    }

    /// Its tensors, in the order of the layers.
    pub(in crate::vision) fn to_tensors(&self) -> Vec<NamedTensor> {
        let mut tensors = Vec::new();
        let shapes = shapes(self.architecture());
        for ((layer, shape), (weights, constants)) in shapes.into_iter().zip(self.weights()) {
            let filters = constants.len();
            let (mut whole, mut units) = (Vec::new(), Vec::new());
            for row in weights.chunks_exact(weights.len() / filters) {
                let most = row.iter().fold(0.0_f32, |most, weight| most.max(weight.abs()));
                let unit = if most > 0.0 { most / f32::from(i16::MAX) } else { 1.0 };
                whole.extend(
                    row.iter().flat_map(|weight| ((weight / unit).round_ties_even() as i16).to_le_bytes()),
                );
                units.extend(unit.to_le_bytes());
            }
            let constants = constants.iter().flat_map(|constant| constant.to_le_bytes()).collect();
            tensors.push((format!("{layer}.weights"), Dtype::I16, shape, whole));
            tensors.push((format!("{layer}.units"), Dtype::F32, vec![filters], units));
            tensors.push((format!("{layer}.constants"), Dtype::F32, vec![filters], constants));
        }
        tensors
    }

    /// Reads what [`to_safetensors`](Self::to_safetensors) wrote.
    ///
    /// # Errors
    ///
    /// If the file is none of the format, says no architecture, or has other tensors than that has.
    pub fn from_safetensors(bytes: &[u8]) -> Result<Self, WeightsError> {
        let (_, about) = SafeTensors::read_metadata(bytes).map_err(WeightsError::of)?;
        let text = about.metadata().as_ref().and_then(|about| about.get(ARCHITECTURE));
        let text =
            text.ok_or_else(|| WeightsError::File(format!("found no {ARCHITECTURE} in the metadata")))?;
        let architecture: Architecture = text.parse()?;
        let file = SafeTensors::deserialize(bytes).map_err(WeightsError::of)?;
        let (found, expected) = (file.len(), 3 * shapes(&architecture).len());
        if found != expected {
            return Err(WeightsError::File(format!(
                "found {found} tensors; expected {expected} for {architecture}"
            )));
        }
        Self::from_tensors(architecture, &file)
    }

    /// The network whose tensors are in a file, among others.
    pub(in crate::vision) fn from_tensors(
        architecture: Architecture,
        file: &SafeTensors<'_>,
    ) -> Result<Self, WeightsError> {
        let mut weights = Vec::new();
        for (layer, shape) in shapes(&architecture) {
            let filters = vec![shape[0]];
            let units = tensor(file, &format!("{layer}.units"), Dtype::F32, &filters)?;
            let constants = tensor(file, &format!("{layer}.constants"), Dtype::F32, &filters)?;
            let whole = tensor(file, &format!("{layer}.weights"), Dtype::I16, &shape)?;
            let units = floats(units);
            let (whole, _) = whole.as_chunks::<2>();
            let rows = whole.chunks(whole.len() / units.len()).zip(units);
            let rows = rows.flat_map(|(row, unit)| {
                row.iter().map(move |&bytes| f32::from(i16::from_le_bytes(bytes)) * unit)
            });
            weights.push((rows.collect(), floats(constants)));
        }
        Ok(Self::new(architecture, weights)?)
    }
}

/// The layers with weights, and the shapes of these.
fn shapes(architecture: &Architecture) -> Vec<(usize, Vec<usize>)> {
    let layers = architecture.layers().iter().zip(architecture.sizes()).zip(1..);
    let shapes = layers.filter_map(|((&layer, from), index)| match layer {
        Layer::Convolution { channels, size, .. } => Some((index, vec![channels, size, size, from.channels])),
        Layer::Dense { outputs } => Some((index, vec![outputs, from.len()])),
        Layer::Pool { .. } => None,
    });
    shapes.collect()
}

/// The bytes of a tensor.
fn tensor<'a>(
    file: &SafeTensors<'a>,
    name: &str,
    kind: Dtype,
    shape: &[usize],
) -> Result<&'a [u8], WeightsError> {
    let tensor = file.tensor(name).map_err(WeightsError::of)?;
    if tensor.dtype() != kind || tensor.shape() != shape {
        let (found, sizes) = (tensor.dtype(), tensor.shape());
        return Err(WeightsError::File(format!(
            "{name}: found {found:?} {sizes:?}; expected {kind:?} {shape:?}"
        )));
    }
    Ok(tensor.data())
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    let (numbers, _) = bytes.as_chunks::<4>();
    numbers.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect()
}
