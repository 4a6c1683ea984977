use std::fmt;
use std::str::FromStr;

use crate::ParameterError;
use crate::parameter::require;

/// Height, width and channels of what goes into a [`Network`](super::Network), or out of one of its layers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct MapSize {
    /// Number of rows.
    pub height: usize,
    /// Number of columns.
    pub width: usize,
    /// Number of values at each place.
    pub channels: usize,
}

impl MapSize {
    /// Number of values.
    #[allow(clippy::len_without_is_empty, reason = "none is empty")]
    pub fn len(&self) -> usize {
        self.height.saturating_mul(self.width).saturating_mul(self.channels)
    }
}

/// A layer of a [`Network`](super::Network). Layers with weights set negative results to 0, except for
/// the last layer of a network.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Layer {
    /// Square filters over all channels, without padding.
    Convolution {
        /// Number of filters.
        channels: usize,
        /// Rows and columns of a filter.
        size: usize,
        /// Step from one place to the next (pixels).
        stride: usize,
    },
    /// The largest value of each square, for every channel; what does not fill a square is left out.
    Pool {
        /// Rows and columns of a square.
        size: usize,
    },
    /// Weights for all values of the layer before.
    Dense {
        /// Number of results.
        outputs: usize,
    },
}

impl Layer {
    /// Size of the result for an input. `None` if the input is too small.
    fn result(self, input: MapSize) -> Option<MapSize> {
        let steps = |length: usize, size: usize, stride: usize| Some(length.checked_sub(size)? / stride + 1);
        match self {
            Self::Convolution { channels, size, stride } => Some(MapSize {
                height: steps(input.height, size, stride)?,
                width: steps(input.width, size, stride)?,
                channels,
            }),
            Self::Pool { size } => Some(MapSize {
                height: steps(input.height, size, size)?,
                width: steps(input.width, size, size)?,
                channels: input.channels,
            }),
            Self::Dense { outputs } => Some(MapSize { height: 1, width: 1, channels: outputs }),
        }
    }

    /// Number of filters, and of weights of each; `None` for a layer without weights.
    fn filters(self, input: MapSize) -> Option<(usize, usize)> {
        match self {
            Self::Convolution { channels, size, .. } => {
                Some((channels, (size * size).saturating_mul(input.channels)))
            }
            Self::Dense { outputs } => Some((outputs, input.len())),
            Self::Pool { .. } => None,
        }
    }
}

/// Input and layers of a [`Network`](super::Network).
///
/// Its text has the input as rows, columns and channels, then the layers; `conv` has filters, their size and
/// the stride:
///
/// ```
/// use roverlab::vision::network::Architecture;
/// let small: Architecture = "32x80x1 conv12/5/2 pool2 dense16 dense1".parse()?;
/// assert_eq!(small.to_string(), "32x80x1 conv12/5/2 pool2 dense16 dense1");
/// assert_eq!(small.weights(), 12 * 26 + 16 * (7 * 19 * 12 + 1) + 17);
/// assert_eq!("9x9x1 conv4/11/1".parse::<Architecture>().unwrap_err().name(), "rows and columns of layer 1");
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Architecture {
    layers: Vec<Layer>,
    /// Size of the input, then of the result of each layer.
    sizes: Vec<MapSize>,
}

/// Number of filters that are stored and applied at once. As many values more than there are have room after
/// a layer's results.
pub(super) const LANES: usize = 16;
/// Largest number of layers.
const MOST_LAYERS: usize = 64;
/// Largest side, number of channels, or stride.
const MOST: usize = 4096;
/// Largest number of weights of a network, and of values of all its layers.
const MOST_VALUES: usize = 10_000_000;

impl Architecture {
    /// The architecture of an input and layers.
    ///
    /// # Errors
    ///
    /// If there is no layer with weights at the end, a number is 0 or more than 4096, a layer gets fewer rows
    /// or columns than its filters have, a layer that is not dense comes after a dense one, or there are more
    /// than 64 layers, or 10 million weights or values. For the weights, the filters of a layer count in full
    /// groups of 16, as they are stored.
    pub fn new(input: MapSize, layers: Vec<Layer>) -> Result<Self, ParameterError> {
        let number = |what: String, value: usize| {
            let error = || ParameterError::new(what, value as f64, format!("1 to {MOST}"));
            (1..=MOST).contains(&value).then_some(()).ok_or_else(error)
        };
        for value in [input.height, input.width, input.channels] {
            number("side of the input".into(), value)?;
        }
        let count = layers.len();
        require(
            "number of layers",
            count as f64,
            (1..=MOST_LAYERS).contains(&count),
            format!("1 to {MOST_LAYERS}"),
        )?;
        let pools_last = matches!(layers.last(), Some(Layer::Pool { .. }));
        require("last layer", count as f64, !pools_last, "one with weights")?;
        let (mut sizes, mut values, mut is_flat) = (vec![input], input.len(), false);
        for (index, layer) in (1..).zip(&layers) {
            let numbers = match *layer {
                Layer::Convolution { channels, size, stride } => vec![channels, size, stride],
                Layer::Pool { size } => vec![size],
                Layer::Dense { outputs } => vec![outputs],
            };
            for value in numbers {
                number(format!("size of layer {index}"), value)?;
            }
            let is_dense = matches!(layer, Layer::Dense { .. });
            require("layer after a dense one", f64::from(index), is_dense || !is_flat, "a dense one")?;
            is_flat = is_dense;
            let before = sizes[sizes.len() - 1];
            let least = before.height.min(before.width);
            let result = layer.result(before).ok_or_else(|| {
                let what = format!("rows and columns of layer {index}");
                ParameterError::new(what, least as f64, "at least those of its filters")
            })?;
            values = values.saturating_add(result.len());
            sizes.push(result);
        }
        let most = || format!("at most {MOST_VALUES}");
        require("values of all layers", values as f64, values <= MOST_VALUES, most())?;
        let this = Self { layers, sizes };
        let stored = this.filters().flatten().map(|(filters, taps)| {
            let filters = filters.next_multiple_of(LANES);
            filters.saturating_mul(taps.saturating_add(1))
        });
        let weights = stored.fold(0, usize::saturating_add);
        let most = format!("at most {MOST_VALUES} in full groups of {LANES} filters");
        require("number of weights", weights as f64, weights <= MOST_VALUES, most)?;
        Ok(this)
    }

    /// Size of the input.
    pub fn input(&self) -> MapSize {
        self.sizes[0]
    }

    /// Number of results.
    pub fn outputs(&self) -> usize {
        self.sizes[self.sizes.len() - 1].len()
    }

    /// Layers, from the input on.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Sizes of what goes into each layer, and at the end of the results.
    pub fn sizes(&self) -> &[MapSize] {
        &self.sizes
    }

    /// Number of all weights, constants included.
    pub fn weights(&self) -> usize {
        self.filters()
            .flatten()
            .map(|(filters, taps)| filters.saturating_mul(taps.saturating_add(1)))
            .fold(0, usize::saturating_add)
    }

    /// For each layer, its number of filters, and of weights of each without the constant; `None` for a layer
    /// without.
    pub fn filters(&self) -> impl Iterator<Item = Option<(usize, usize)>> {
        self.layers.iter().zip(&self.sizes).map(|(layer, &size)| layer.filters(size))
    }
}

impl fmt::Display for Architecture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let MapSize { height, width, channels } = self.input();
        write!(f, "{height}x{width}x{channels}")?;
        for layer in &self.layers {
            match layer {
                Layer::Convolution { channels, size, stride } => {
                    write!(f, " conv{channels}/{size}/{stride}")?;
                }
                Layer::Pool { size } => write!(f, " pool{size}")?,
                Layer::Dense { outputs } => write!(f, " dense{outputs}")?,
            }
        }
        Ok(())
    }
}

impl FromStr for Architecture {
    type Err = ParameterError;

    fn from_str(text: &str) -> Result<Self, ParameterError> {
        let bad = |index: usize, expected: &'static str| {
            ParameterError::new("word of an architecture", index as f64, expected)
        };
        let mut words = text.split_ascii_whitespace().enumerate();
        let input = words.next().and_then(|(_, word)| numbers::<3>(word, 'x'));
        let [height, width, channels] =
            input.ok_or_else(|| bad(0, "ROWSxCOLUMNSxCHANNELS as the first word"))?;
        let mut layers = Vec::new();
        for (index, word) in words {
            let layer = if let Some(rest) = word.strip_prefix("conv") {
                numbers(rest, '/').map(|[channels, size, stride]| Layer::Convolution {
                    channels,
                    size,
                    stride,
                })
            } else if let Some(rest) = word.strip_prefix("pool") {
                numbers(rest, '/').map(|[size]| Layer::Pool { size })
            } else {
                word.strip_prefix("dense")
                    .and_then(|rest| numbers(rest, '/'))
                    .map(|[outputs]| Layer::Dense { outputs })
            };
            layers.push(layer.ok_or_else(|| bad(index, "convN/SIZE/STRIDE, poolSIZE or denseN"))?);
        }
        Self::new(MapSize { height, width, channels }, layers)
    }
}

/// As many numbers as a word must have.
fn numbers<const N: usize>(word: &str, between: char) -> Option<[usize; N]> {
    let numbers: Vec<usize> = word.split(between).map(|number| number.parse().ok()).collect::<Option<_>>()?;
    numbers.try_into().ok()
}
