use std::hint::black_box;

use image::{GrayImage, RgbImage};
use roverlab::vision::{
    Border, Canny, CannyThresholds, Components, GaussianKernel, GrayView, GrayViewMut, GrayWeights, Hog,
    HogParameters, HoughLines, HoughSegments, HueLimits, HueRange, HueScale, ImageError, RgbViewMut,
    SegmentParameters, SobelScale, absolute_difference_into, gaussian_into, gray_into, gray_to_rgb_into,
    hsi_into, hsv_into, hue_histogram_into, hue_into, hue_match_into, laplace_into, laplace_saturated_into,
    mean_difference, overlay_gray_into, projections_into, sector_differences, sobel_l1_into, sobel_l2_into,
    threshold_into,
};
use roverlab::world::Colour;

use crate::clock::{Effort, median};
use crate::scene::Pair;

/// What one kernel takes at one resolution.
#[derive(Debug, Clone)]
pub(crate) struct Sample {
    pub(crate) kernel: &'static str,
    pub(crate) size: (u32, u32),
    pub(crate) seconds: f64,
    /// Read and written.
    pub(crate) bytes: u64,
    /// The same by imageproc, where it has it.
    pub(crate) imageproc: Option<f64>,
    /// A copy that reads and writes so many bytes: the memory's own limit.
    pub(crate) copy: f64,
}

/// The thresholds that the peers use too.
const THRESHOLDS: CannyThresholds = CannyThresholds { low: 60, high: 150 };

/// All kernels on a pair of images.
pub(crate) fn measure(pair: &Pair, effort: Effort) -> Result<Vec<Sample>, ImageError> {
    let mut bench = Bench::new(pair, effort)?;
    bench.colours()?;
    bench.gradients()?;
    bench.shapes()?;
    bench.motion()?;
    Ok(bench.samples)
}

struct Bench<'a> {
    pair: &'a Pair,
    effort: Effort,
    gray: GrayImage,
    second: GrayImage,
    edges: GrayImage,
    mask: GrayImage,
    output: GrayImage,
    colour: RgbImage,
    samples: Vec<Sample>,
}

/// Red, with the limits for dim light.
const RED: HueRange = HueRange { low: 33, high: 51 };
const LIMITS: HueLimits = HueLimits { min_saturation: 128, min_intensity: 6 };

fn gray_of(image: &RgbImage) -> Result<GrayImage, ImageError> {
    let mut gray = GrayImage::new(image.width(), image.height());
    gray_into(image.try_into()?, (&mut gray).try_into()?, GrayWeights::Rec601)?;
    Ok(gray)
}

impl<'a> Bench<'a> {
    fn new(pair: &'a Pair, effort: Effort) -> Result<Self, ImageError> {
        let (width, height) = pair.first.dimensions();
        let gray = gray_of(&pair.first)?;
        let empty = GrayImage::new(width, height);
        let (mut edges, mut mask) = (empty.clone(), empty.clone());
        Canny::new().find_into((&gray).try_into()?, (&mut edges).try_into()?, THRESHOLDS)?;
        let red = (&mut mask).try_into()?;
        hue_match_into((&pair.first).try_into()?, red, RED, HueScale::Robios, LIMITS)?;
        assert!(edges.iter().any(|&edge| edge > 0) && mask.iter().any(|&red| red > 0), "something to find");
        let second = gray_of(&pair.second)?;
        let colour = RgbImage::new(width, height);
        Ok(Self { pair, effort, gray, second, edges, mask, output: empty, colour, samples: Vec::new() })
    }

    /// Notes what a kernel takes that reads and writes so many bytes a pixel.
    fn add(&mut self, kernel: &'static str, bytes: u64, seconds: f64, imageproc: Option<f64>) {
        let size = self.gray.dimensions();
        let bytes = bytes * u64::from(size.0) * u64::from(size.1);
        let source = vec![1_u8; bytes as usize / 2];
        let mut target = source.clone();
        let copy = median(self.effort, || black_box(&mut target).copy_from_slice(black_box(&source)));
        self.samples.push(Sample { kernel, size, seconds, bytes, imageproc, copy });
    }

    /// A kernel from gray to gray.
    fn gray_to_gray(
        &mut self,
        kernel: &'static str,
        imageproc: Option<&dyn Fn(&GrayImage)>,
        mut call: impl FnMut(GrayView<'_>, GrayViewMut<'_>) -> Result<(), ImageError>,
    ) -> Result<(), ImageError> {
        let (gray, output) = (&self.gray, &mut self.output);
        call(gray.try_into()?, (&mut *output).try_into()?)?;
        let seconds = median(self.effort, || {
            let views = (black_box(gray).try_into(), black_box(&mut *output).try_into());
            if let (Ok(input), Ok(output)) = views {
                let _ = black_box(call(input, output));
            }
        });
        let peer = imageproc.map(|peer| median(self.effort, || peer(black_box(&self.gray))));
        self.add(kernel, 2, seconds, peer);
        Ok(())
    }

    /// A kernel from colour to gray.
    fn colour_to_gray(
        &mut self,
        kernel: &'static str,
        imageproc: Option<&dyn Fn(&RgbImage)>,
        mut call: impl FnMut(roverlab::vision::RgbView<'_>, GrayViewMut<'_>) -> Result<(), ImageError>,
    ) -> Result<(), ImageError> {
        let (image, output) = (&self.pair.first, &mut self.output);
        call(image.try_into()?, (&mut *output).try_into()?)?;
        let seconds = median(self.effort, || {
            let views = (black_box(image).try_into(), black_box(&mut *output).try_into());
            if let (Ok(input), Ok(output)) = views {
                let _ = black_box(call(input, output));
            }
        });
        let peer = imageproc.map(|peer| median(self.effort, || peer(black_box(image))));
        self.add(kernel, 4, seconds, peer);
        Ok(())
    }

    /// A kernel from colour to colour.
    fn colour_to_colour(
        &mut self,
        kernel: &'static str,
        mut call: impl FnMut(roverlab::vision::RgbView<'_>, RgbViewMut<'_>) -> Result<(), ImageError>,
    ) -> Result<(), ImageError> {
        let (image, output) = (&self.pair.first, &mut self.colour);
        call(image.try_into()?, (&mut *output).try_into()?)?;
        let seconds = median(self.effort, || {
            let views = (black_box(image).try_into(), black_box(&mut *output).try_into());
            if let (Ok(input), Ok(output)) = views {
                let _ = black_box(call(input, output));
            }
        });
        self.add(kernel, 6, seconds, None);
        Ok(())
    }

    /// Anything that needs no output of the bench's.
    fn plain<T>(
        &mut self,
        kernel: &'static str,
        bytes: u64,
        peer: Option<f64>,
        mut call: impl FnMut(&Self) -> T,
    ) {
        let seconds = median(self.effort, || {
            black_box(call(black_box(self)));
        });
        self.add(kernel, bytes, seconds, peer);
    }

    fn colours(&mut self) -> Result<(), ImageError> {
        let grayscale = |image: &RgbImage| {
            black_box(image::imageops::grayscale(image));
        };
        self.colour_to_gray("gray", Some(&grayscale), |a, b| gray_into(a, b, GrayWeights::Rec601))?;
        self.colour_to_gray("gray (book)", None, |a, b| gray_into(a, b, GrayWeights::Robios))?;
        let gray = self.gray.clone();
        self.colour_to_colour("gray_to_rgb", |_, out| gray_to_rgb_into((&gray).try_into()?, out))?;
        self.colour_to_colour("hsv", hsv_into)?;
        self.colour_to_colour("hsi (exact)", hsi_into)?;
        self.colour_to_gray("hue", None, |a, b| hue_into(a, b, HueScale::Robios, LIMITS))?;
        self.colour_to_gray("hue_match", None, |a, b| hue_match_into(a, b, RED, HueScale::Robios, LIMITS))?;
        self.colour_to_gray("hue_match (opencv)", None, |a, b| {
            hue_match_into(a, b, HueRange { low: 170, high: 10 }, HueScale::OpenCv, HueLimits::NONE)
        })?;
        let mut columns = vec![0; self.gray.width() as usize];
        self.plain("hue_histogram (fused)", 3, None, |bench| {
            let image: roverlab::vision::RgbView<'_> = (&bench.pair.first).try_into()?;
            hue_histogram_into(image, &mut columns, RED, LIMITS)
        });
        let (mask, marks) = (self.gray.clone(), self.edges.clone());
        self.colour_to_colour("overlay", |_, out| {
            overlay_gray_into((&mask).try_into()?, (&marks).try_into()?, Colour::RED, out)
        })
    }

    fn gradients(&mut self) -> Result<(), ImageError> {
        let threshold = |image: &GrayImage| {
            let kind = imageproc::contrast::ThresholdType::Binary;
            black_box(imageproc::contrast::threshold(image, 128, kind));
        };
        self.gray_to_gray("threshold", Some(&threshold), |a, b| threshold_into(a, b, 128))?;
        let laplace = |image: &GrayImage| {
            black_box(imageproc::filter::laplacian_filter(image));
        };
        self.gray_to_gray("laplace", Some(&laplace), |a, b| laplace_into(a, b, Border::Mirror))?;
        self.gray_to_gray("laplace_saturated", None, |a, b| laplace_saturated_into(a, b, Border::Mirror))?;
        let sobel = |image: &GrayImage| {
            black_box(imageproc::gradients::sobel_gradients(image));
        };
        self.gray_to_gray("sobel_l1", Some(&sobel), |a, b| {
            sobel_l1_into(a, b, SobelScale::Full, Border::Mirror)
        })?;
        self.gray_to_gray("sobel_l2", Some(&sobel), |a, b| {
            sobel_l2_into(a, b, SobelScale::Full, Border::Mirror)
        })?;
        for (name, kernel, sigma) in [
            ("gaussian3", GaussianKernel::THREE, 0.8_f32),
            ("gaussian5", GaussianKernel::FIVE, 1.1),
            ("gaussian7", GaussianKernel::SEVEN, 1.4),
        ] {
            let gaussian = |image: &GrayImage| {
                black_box(imageproc::filter::gaussian_blur_f32(image, sigma));
            };
            self.gray_to_gray(name, Some(&gaussian), |a, b| gaussian_into(a, b, kernel))?;
        }
        let mut canny = Canny::new();
        let peer = |image: &GrayImage| {
            black_box(imageproc::edges::canny(image, 60.0, 150.0));
        };
        self.gray_to_gray("canny", Some(&peer), |a, b| canny.find_into(a, b, THRESHOLDS))
    }

    fn shapes(&mut self) -> Result<(), ImageError> {
        let (mut columns, mut rows) =
            (vec![0; self.gray.width() as usize], vec![0; self.gray.height() as usize]);
        self.plain("projections", 1, None, |bench| {
            projections_into((&bench.gray).try_into()?, &mut columns, &mut rows)
        });
        let mut components = Components::new();
        let peer = median(self.effort, || {
            let connectivity = imageproc::region_labelling::Connectivity::Eight;
            let black = image::Luma([0_u8]);
            black_box(imageproc::region_labelling::connected_components(&self.mask, connectivity, black));
        });
        self.plain("blobs", 1, Some(peer), |bench| {
            let mask: GrayView<'_> = (&bench.mask).try_into()?;
            Ok::<usize, ImageError>(components.find(mask, 10).len())
        });
        let mut hough = HoughLines::new(1.0, 180)?;
        let peer = median(self.effort, || {
            let options =
                imageproc::hough::LineDetectionOptions { vote_threshold: 60, suppression_radius: 2 };
            black_box(imageproc::hough::detect_lines(&self.edges, options));
        });
        self.plain("hough", 1, Some(peer), |bench| {
            let edges: GrayView<'_> = (&bench.edges).try_into()?;
            Ok::<usize, ImageError>(hough.find(edges, 60).len())
        });
        let mut segments = HoughSegments::new(180)?;
        self.plain("hough_probabilistic", 1, None, |bench| {
            let edges: GrayView<'_> = (&bench.edges).try_into()?;
            Ok::<usize, ImageError>(segments.find(edges, SegmentParameters::default()).len())
        });
        let mut hog = Hog::new(HogParameters::default())?;
        self.plain("hog", 1, None, |bench| {
            let gray: GrayView<'_> = (&bench.gray).try_into()?;
            Ok::<usize, ImageError>(hog.describe(gray)?.len())
        });
        Ok(())
    }

    fn motion(&mut self) -> Result<(), ImageError> {
        let second = self.second.clone();
        self.gray_to_gray("difference", None, |a, b| absolute_difference_into(a, (&second).try_into()?, b))?;
        self.plain("mean_difference (fused)", 2, None, |bench| {
            mean_difference((&bench.gray).try_into()?, (&bench.second).try_into()?)
        });
        self.plain("sector_differences (fused)", 2, None, |bench| {
            sector_differences::<3>((&bench.gray).try_into()?, (&bench.second).try_into()?)
        });
        Ok(())
    }
}
