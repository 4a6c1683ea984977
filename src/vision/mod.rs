//! Image processing (book, chapter 11): edges, colour, motion, lines and blobs.
//!
//! Every kernel is defined in its documentation and tested bit for bit against a naive version; line segments
//! ([`SegmentDefinition::OpenCv`]) are tested against OpenCV. Kernels work on [`View`]s: borrowed 8-bit
//! images of one ([`GrayView`]) or three ([`RgbView`]) bytes per pixel, with any stride, so that a part of an
//! image is an image as well:
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
//! [`motion`] detects motion, [`lane_markings`] the lane ahead of a car, [`road_elements`] what is on it, and
//! [`signs`] what stands beside it; [`network`] runs trained networks. Robots that drive by camera are in
//! [`drive`](crate::drive).
//!
//! The module `images` (feature `image`) has the same kernels on images of the crate `image`; they return new
//! images.
//!
//! Functions ending in `_into` write into the caller's memory and do not allocate. The loops are plain Rust,
//! which the compiler vectorises for several processor generations; the best one is selected at run time, and
//! all give the same bits.
//!
//! # Errors and complexity
//!
//! A kernel fails with [`ImageError`] if its images differ in size, before it writes anything, or if a
//! parameter is out of range. Time is linear in the number of pixels, except for [`HoughLines`] and
//! [`HoughSegments`]: edge pixels times angles.

#![forbid(unsafe_code)]
#![allow(clippy::needless_bitwise_bool, reason = "conditions without branches vectorise")]
#![allow(clippy::inline_always, reason = "loops must be compiled for the processor that the caller selected")]

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
pub mod network;
#[cfg(feature = "rayon")]
mod parallel;
mod planes;
mod projection;
pub mod road_elements;
mod segment_order;
pub mod signs;
mod sobel;
#[cfg(test)]
mod tests;
mod view;
#[cfg(feature = "weights")]
mod weights;

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
#[cfg(feature = "weights")]
pub use weights::WeightsError;
