//! Trained networks of convolutions (book, section 13.6): small, exact, and without a framework.
//!
//! A [`Network`] has the layers of an [`Architecture`] and their weights. Its results have the same bits on
//! every platform and processor: each sum begins with the layer's constant and goes over rows, columns and
//! channels of a filter, in this order, in 32 bits, and products are rounded before they are added. A
//! [`FixedNetwork`] computes the same with integers of 16 bits.
//!
//! Values of images and layers are in the order of rows, columns and channels.
//!
//! ```
//! use roverlab::vision::network::{Architecture, Network};
//!
//! // An edge of a picture of 3 x 4 pixels, and how much of it there is.
//! let architecture: Architecture = "3x4x1 conv1/3/1 dense1".parse()?;
//! let edges = vec![-1.0, 0.0, 1.0, -1.0, 0.0, 1.0, -1.0, 0.0, 1.0];
//! let mut network = Network::new(architecture, vec![(edges, vec![0.0]), (vec![1.0, 1.0], vec![0.5])])?;
//! let picture = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0];
//! assert_eq!(network.run(&picture)?, [6.5]);
//! # Ok::<(), roverlab::ParameterError>(())
//! ```

mod architecture;
mod attention;
#[cfg(feature = "weights")]
mod file;
mod filters;
mod fixed;
mod net;
#[cfg(test)]
mod tests;

#[cfg(feature = "weights")]
pub(super) use file::ARCHITECTURE;

pub use architecture::{Architecture, Layer, MapSize};
pub use fixed::FixedNetwork;
pub use net::{Network, softmax};
