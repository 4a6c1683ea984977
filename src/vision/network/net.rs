use super::architecture::{Architecture, LANES, Layer, MapSize};
use super::filters::{Filters, Pass};
use crate::ParameterError;
use crate::geometry::math;
use crate::parameter::{require_count, require_finite};

/// A trained network; see the [module](super).
#[derive(Debug, Clone)]
pub struct Network {
    architecture: Architecture,
    /// For each layer; `None` for one without weights.
    filters: Vec<Option<Filters>>,
    /// The input, and the results of each layer, of the last run, with some room after them.
    maps: Vec<Vec<f32>>,
}

impl PartialEq for Network {
    fn eq(&self, other: &Self) -> bool {
        self.architecture == other.architecture && self.filters == other.filters
    }
}

impl Network {
    /// Creates a network of weights and constants for each layer that has some. Weights have a row for each
    /// filter, in the order of rows, columns and channels of what the filter sees.
    ///
    /// # Errors
    ///
    /// If there are more or fewer numbers than the architecture has, or they are not finite.
    pub fn new(
        architecture: Architecture,
        weights: Vec<(Vec<f32>, Vec<f32>)>,
    ) -> Result<Self, ParameterError> {
        let layers = architecture.filters().flatten().count();
        require_count("layers with weights", weights.len(), layers)?;
        let mut given = weights.into_iter();
        let mut filters = Vec::new();
        for sizes in architecture.filters() {
            let Some((count, taps)) = sizes else {
                filters.push(None);
                continue;
            };
            let (weights, constants) = given.next().unwrap_or_default();
            let expected = [(weights.len(), count * taps), (constants.len(), count)];
            for (found, expected) in expected {
                require_count("weights of a layer", found, expected)?;
            }
            for weight in weights.iter().chain(&constants) {
                require_finite("weight", f64::from(*weight))?;
            }
            filters.push(Some(Filters::new(&weights, &constants)));
        }
        let maps = architecture.sizes().iter().map(|size| vec![0.0; size.len() + LANES]).collect();
        Ok(Self { architecture, filters, maps })
    }

    /// Input and layers.
    pub fn architecture(&self) -> &Architecture {
        &self.architecture
    }

    /// Weights and constants of the layers that have some, as [`new`](Self::new) takes them.
    pub fn weights(&self) -> Vec<(Vec<f32>, Vec<f32>)> {
        self.filters.iter().flatten().map(Filters::unpacked).collect()
    }

    /// Results for an input. Does not allocate.
    ///
    /// # Errors
    ///
    /// If the input has more or fewer values than the architecture says.
    pub fn run(&mut self, input: &[f32]) -> Result<&[f32], ParameterError> {
        let expected = self.architecture.input().len();
        require_count("values of the input", input.len(), expected)?;
        self.maps[0][..expected].copy_from_slice(input);
        let last = self.filters.len() - 1;
        for index in 0..=last {
            let (from, to) = (self.architecture.sizes()[index], self.architecture.sizes()[index + 1]);
            let (before, after) = self.maps.split_at_mut(index + 1);
            let (before, after) = (&before[index], &mut after[0]);
            let layer = self.architecture.layers()[index];
            match (&self.filters[index], layer) {
                (Some(filters), _) => filters.apply(before, after, pass(layer, from, to, index < last)),
                (None, Layer::Pool { size }) => pool(before, after, from, to, size),
                (None, _) => {}
            }
        }
        Ok(self.map(last + 1))
    }

    /// What went into a layer in the last run, from 0 for the input on, and at the end the results.
    ///
    /// # Panics
    ///
    /// If there are not as many layers.
    pub fn map(&self, layer: usize) -> &[f32] {
        &self.maps[layer][..self.architecture.sizes()[layer].len()]
    }
}

/// How a layer with weights goes over its input. A dense layer is one filter of the size of its input.
pub(super) fn pass(layer: Layer, from: MapSize, to: MapSize, rectify: bool) -> Pass {
    match layer {
        Layer::Convolution { size, stride, .. } => {
            Pass { from, to, rows: size, row: size * from.channels, stride, rectify }
        }
        _ => Pass {
            from: MapSize { height: 1, width: 1, channels: from.len() },
            to,
            rows: 1,
            row: from.len(),
            stride: 1,
            rectify,
        },
    }
}

/// The largest values of squares.
pub(super) fn pool<T: Copy + PartialOrd>(
    input: &[T],
    output: &mut [T],
    from: MapSize,
    to: MapSize,
    size: usize,
) {
    let at = |y: usize, x: usize, channel: usize| input[(y * from.width + x) * from.channels + channel];
    for (index, place) in output[..to.len()].iter_mut().enumerate() {
        let channel = index % to.channels;
        let (y, x) = (index / to.channels / to.width * size, index / to.channels % to.width * size);
        let mut most = at(y, x, channel);
        for inside in 1..size * size {
            let value = at(y + inside / size, x + inside % size, channel);
            if value > most {
                most = value;
            }
        }
        *place = most;
    }
}

/// Probabilities of classes from the results of a network for each.
///
/// ```
/// use roverlab::vision::network::softmax;
/// assert_eq!(softmax(&[1.0, 1.0]), [0.5, 0.5]);
/// assert!(softmax(&[0.0, 1000.0])[1] > 0.999, "large results do not overflow");
/// ```
pub fn softmax(results: &[f32]) -> Vec<f64> {
    let most = results.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let mut shares: Vec<f64> = results.iter().map(|result| math::exp(f64::from(result - most))).collect();
    let sum: f64 = shares.iter().sum();
    for share in &mut shares {
        *share /= sum;
    }
    shares
}
