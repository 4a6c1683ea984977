//! Image processing (book, chapter 11): edges, colour, motion, lines and blobs.
//!
//! Every kernel has a written definition in its docs and is tested against a naive version of it, to the bit; line segments
//! by [`SegmentDefinition::OpenCv`] against OpenCV's. Kernels work on [`View`]s, borrowed 8-bit images of one ([`GrayView`]) or three ([`RgbView`]) bytes a pixel with any
//! distance between rows, so that a part of an image is as good as a whole one:
//!
//! ```
//! use roverlab::vision::{Border, GrayView, GrayViewMut, laplace_into};
//!
//! # fn main() -> Result<(), roverlab::vision::ImageError> {
//! let image = [0, 0, 0, 0, 90, 0, 0, 0, 0];
//! let mut edges = [0; 9];
//! laplace_into(GrayView::new(&image, 3, 3)?, GrayViewMut::new(&mut edges, 3, 3)?, Border::Zero)?;
//! assert_eq!(edges, [0, 0, 0, 0, 255, 0, 0, 0, 0]);
//! # Ok(())
//! # }
//! ```
//!
//! [`motion`] has what moves in an image, [`lane_markings`] the lane before a car. The robots that drive by what they see are in
//! [`drive`](crate::drive).
//!
//! The module `images` (feature `image`) has the same kernels on images of the crate `image`, which return new images.
//!
//! The functions in `_into` write into memory of the caller's and allocate nothing. The loops are plain Rust that the
//! compiler vectorises for several generations of processors; the best one that the processor has is chosen at run
//! time, and all give the same bits.
//!
//! # Errors and complexity
//!
//! A kernel fails with [`ImageError`] if its images differ in size, before it writes anything; bad parameters are refused
//! with their name and range. Time is linear in the number of pixels, except for [`HoughLines`] and [`HoughSegments`]: edge
//! pixels times angles.

#![forbid(unsafe_code)]
#![allow(clippy::needless_bitwise_bool, reason = "conditions without branches are what vectorises")]
#![allow(
    clippy::inline_always,
    reason = "loops are to be compiled for the processor that their caller has chosen"
)]

mod blocks;
mod border;
mod camera_geometry;
mod canny;
mod colour_finder;
mod combine;
mod components;
mod difference;
mod dispatch;
mod error;
mod fused;
mod gaussian;
mod gray;
mod hog;
mod hough;
mod hough_segments;
mod hsi;
mod hsv;
mod hue;
mod hue_match;
#[cfg(feature = "image")]
pub mod images;
pub mod lane_markings;
mod laplace;
pub mod motion;
#[cfg(feature = "rayon")]
mod parallel;
mod planes;
mod projection;
mod segment_order;
mod sobel;
#[cfg(test)]
mod tests;
mod view;

pub use border::Border;
pub use camera_geometry::CameraGeometry;
pub use canny::{Canny, CannyThresholds};
pub use colour_finder::{ColourFinder, FindMethod, Sighting, teach_hue};
pub use combine::{overlay_gray_into, overlay_into, threshold_into};
pub use components::{Blob, Components};
pub use difference::{absolute_difference_into, mean_difference, sector_differences};
pub use error::ImageError;
pub use fused::hue_histogram_into;
pub use gaussian::{GaussianKernel, gaussian_into};
pub use gray::{GrayWeights, gray_into, gray_to_rgb_into};
pub use hog::{Hog, HogParameters};
pub use hough::{HoughLine, HoughLines};
pub use hough_segments::{HoughSegments, LineSegment, SegmentParameters};
pub use hsi::{Hsi, hsi_into, hsi_to_rgb, hsi_to_rgb_into, rgb_to_hsi};
pub use hsv::{Hsv, hsv_into, hsv_to_rgb, hsv_to_rgb_into, rgb_to_hsv};
pub use hue::{HueLimits, HueScale, NO_HUE, hue, hue_into};
pub use hue_match::{HueRange, hue_match_into, match_hue_image_into};
pub use laplace::{laplace_into, laplace_saturated_into};
#[cfg(feature = "rayon")]
pub use parallel::in_bands;
pub use projection::{maximum, projections_into};
pub use segment_order::SegmentDefinition;
pub use sobel::{SobelScale, sobel_l1_into, sobel_l2_into};
pub use view::{GrayView, GrayViewMut, RgbView, RgbViewMut, View, ViewMut};
