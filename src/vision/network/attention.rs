use super::architecture::{Layer, MapSize};
use super::net::Network;

impl Network {
    /// How much each place of the input has contributed to what the layers of convolutions saw in the last
    /// run, from 0 to 1, in the order of rows and columns (Bojarski et al. 2017, *Explaining how a deep
    /// neural network trained with end-to-end learning steers a car*): from the last such layer back to the
    /// first, the mean of each layer's values times what the layer after it looked at. 0 without such layers.
    pub fn attention(&self) -> Vec<f64> {
        let sizes = self.architecture().sizes();
        let seeing = self.architecture().layers().iter().map_while(|layer| match *layer {
            Layer::Convolution { size, stride, .. } => Some((size, stride)),
            Layer::Pool { size } => Some((size, size)),
            Layer::Dense { .. } => None,
        });
        let seeing: Vec<(usize, usize)> = seeing.collect();
        if seeing.is_empty() {
            return vec![0.0; sizes[0].height * sizes[0].width];
        }
        let mut looked = mean(self.map(seeing.len()), sizes[seeing.len()]);
        for (layer, &filter) in seeing.iter().enumerate().rev() {
            looked = spread(&looked, sizes[layer + 1], sizes[layer], filter);
            if layer > 0 {
                let here = mean(self.map(layer), sizes[layer]);
                for (looked, here) in looked.iter_mut().zip(here) {
                    *looked *= here;
                }
            }
        }
        let most = looked.iter().copied().fold(0.0, f64::max);
        if most > 0.0 {
            for value in &mut looked {
                *value /= most;
            }
        }
        looked
    }
}

/// The mean over the channels at each place, at least 0.
fn mean(map: &[f32], size: MapSize) -> Vec<f64> {
    let places = map.chunks_exact(size.channels);
    places
        .map(|place| place.iter().map(|&value| f64::from(value)).sum::<f64>() / size.channels as f64)
        .map(|mean| mean.max(0.0))
        .collect()
}

/// Gives each value to all places that its filter saw.
fn spread(values: &[f64], from: MapSize, to: MapSize, (size, stride): (usize, usize)) -> Vec<f64> {
    let mut result = vec![0.0; to.height * to.width];
    for (index, value) in values.iter().enumerate() {
        let (top, left) = (index / from.width * stride, index % from.width * stride);
        for y in top..(top + size).min(to.height) {
            for place in &mut result[y * to.width + left..y * to.width + (left + size).min(to.width)] {
                *place += value;
            }
        }
    }
    result
}
