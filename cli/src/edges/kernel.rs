use image::{DynamicImage, GrayImage, RgbImage};
use roverlab::vision::{
    Canny, Hog, HogParameters, HoughLines, HoughSegments, ImageError, SegmentDefinition, SegmentParameters,
    absolute_difference_into, gaussian_into, gray_into, gray_to_rgb_into, laplace_into,
    laplace_saturated_into, overlay_gray_into, overlay_into, projections_into, sobel_l1_into, sobel_l2_into,
    threshold_into,
};
use serde_json::{Value, json};

use super::parameters::{Parameters, gaussian};
use super::{Args, Definition, colour, marks};

/// Kernel by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum Kernel {
    /// Colour to grayscale.
    Gray,
    /// Grayscale to colour.
    GrayToRgb,
    /// Absolute value of the Laplacian.
    Laplace,
    /// Positive part of the Laplacian.
    LaplaceSaturated,
    /// L1 magnitude of the Sobel gradient, |dx| + |dy|.
    SobelL1,
    /// Euclidean magnitude of the Sobel gradient.
    SobelL2,
    /// Canny edges.
    Canny,
    /// 3 x 3 Gaussian.
    Gaussian3,
    /// 5 x 5 Gaussian.
    Gaussian5,
    /// 7 x 7 Gaussian.
    Gaussian7,
    /// White above a threshold.
    Threshold,
    /// Laplace edges in red over the gray image; with --second, that image over the first.
    Overlay,
    /// The hue of every pixel.
    Hue,
    /// The saturation of every pixel.
    Saturation,
    /// The intensity of every pixel (in `OpenCV`: the value).
    Intensity,
    /// Hue, saturation and intensity (or value) instead of red, green and blue.
    Hsi,
    /// Back to red, green and blue, from hue, saturation and intensity (or value).
    HsiToRgb,
    /// White where the hue matches.
    HueMatch,
    /// Column and row sums of the hue match.
    Projections,
    /// The absolute difference to --second.
    Difference,
    /// Connected components of the hue match.
    Blobs,
    /// Straight lines in Canny edges.
    Hough,
    /// Line segments in Canny edges.
    HoughProbabilistic,
    /// Histograms of oriented gradients.
    Hog,
}

impl Kernel {
    /// Name on the command line.
    pub(crate) fn name(self) -> String {
        use clap::ValueEnum as _;
        self.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned())
    }

    pub(crate) fn uses_canny(self) -> bool {
        matches!(self, Self::Canny | Self::Hough | Self::HoughProbabilistic)
    }

    /// Whether it works on colour images, not on grayscale.
    pub(crate) fn works_on_colours(self) -> bool {
        use Kernel::{Hsi, HsiToRgb, Hue, HueMatch, Intensity, Projections, Saturation};
        matches!(self, Hue | Saturation | Intensity | Hsi | HsiToRgb | HueMatch | Projections)
    }

    /// Whether `--threshold` is a gray level for it.
    pub(crate) fn thresholds_shades(self) -> bool {
        matches!(self, Self::Threshold | Self::Overlay)
    }

    pub(crate) fn needs_second(self) -> bool {
        self == Self::Difference
    }
}

/// Result of a kernel: an image, and further fields.
#[derive(Debug, Clone)]
pub(crate) struct Processed {
    pub(crate) image: DynamicImage,
    pub(crate) fields: Vec<(&'static str, Value)>,
}

impl From<GrayImage> for Processed {
    fn from(image: GrayImage) -> Self {
        Self { image: image.into(), fields: Vec::new() }
    }
}

impl From<RgbImage> for Processed {
    fn from(image: RgbImage) -> Self {
        Self { image: image.into(), fields: Vec::new() }
    }
}

/// A kernel with its options, ready to run.
#[derive(Debug)]
pub(crate) struct Runner {
    pub(crate) kernel: Kernel,
    args: Args,
    parameters: Parameters,
    canny: Canny,
}

impl Runner {
    pub(crate) fn new(args: &Args) -> Result<Self, ImageError> {
        let parameters = Parameters::new(args)?;
        Ok(Self { kernel: args.kernel, args: args.clone(), parameters, canny: Canny::new() })
    }

    /// Runs the kernel.
    pub(crate) fn run(
        &mut self,
        input: &RgbImage,
        second: Option<&RgbImage>,
    ) -> Result<Processed, ImageError> {
        let p = self.parameters;
        Ok(match self.kernel {
            Kernel::Gray => self.gray(input)?.into(),
            Kernel::GrayToRgb => {
                let gray = self.gray(input)?;
                let mut output = RgbImage::new(gray.width(), gray.height());
                gray_to_rgb_into((&gray).try_into()?, (&mut output).try_into()?)?;
                output.into()
            }
            Kernel::Laplace => self.on_gray(input, |a, b| laplace_into(a, b, p.border))?.into(),
            Kernel::LaplaceSaturated => {
                self.on_gray(input, |a, b| laplace_saturated_into(a, b, p.border))?.into()
            }
            Kernel::SobelL1 => self.on_gray(input, |a, b| sobel_l1_into(a, b, p.sobel, p.border))?.into(),
            Kernel::SobelL2 => self.on_gray(input, |a, b| sobel_l2_into(a, b, p.sobel, p.border))?.into(),
            Kernel::Canny => self.edges(input)?.into(),
            Kernel::Gaussian3 => self.gaussian(input, 3)?.into(),
            Kernel::Gaussian5 => self.gaussian(input, 5)?.into(),
            Kernel::Gaussian7 => self.gaussian(input, 7)?.into(),
            Kernel::Threshold => {
                let threshold = self.threshold(128) as u8;
                self.on_gray(input, |a, b| threshold_into(a, b, threshold))?.into()
            }
            Kernel::Overlay => self.overlay(input, second)?.into(),
            Kernel::Hue if self.args.exact => colour::exact_hue(input, &p)?.into(),
            Kernel::Hue => colour::hue(input, &p)?.into(),
            Kernel::Saturation => colour::channel(input, &p, 1)?.into(),
            Kernel::Intensity => colour::channel(input, &p, 2)?.into(),
            Kernel::Hsi => colour::hsi(input, &p)?.into(),
            Kernel::HsiToRgb => colour::hsi_to_rgb(input, &p)?.into(),
            Kernel::HueMatch => colour::matches(input, &p)?.into(),
            Kernel::Projections => projections(colour::matches(input, &p)?)?,
            Kernel::Difference => self.difference(input, second)?.into(),
            Kernel::Blobs => {
                let mask = if self.args.binary { self.gray(input)? } else { colour::matches(input, &p)? };
                marks::blobs(input, &mask, self.args.min_area)?
            }
            Kernel::Hough => {
                let edges = self.edges_or_input(input)?;
                let mut hough = HoughLines::new(self.args.rho, self.args.angles.into())?;
                let lines = hough.find((&edges).try_into()?, self.threshold(100));
                marks::lines(&edges, &lines)
            }
            Kernel::HoughProbabilistic => {
                let edges = self.edges_or_input(input)?;
                let parameters = SegmentParameters {
                    threshold: self.threshold(50),
                    min_length: self.args.min_length,
                    max_gap: self.args.max_gap,
                    definition: match self.args.definition {
                        Definition::Book => SegmentDefinition::Voted { seed: self.args.common.seed },
                        Definition::OpenCv => SegmentDefinition::OpenCv,
                    },
                };
                let found =
                    HoughSegments::new(self.args.angles.into())?.find((&edges).try_into()?, parameters);
                marks::segments(&edges, &found)
            }
            Kernel::Hog => {
                let mut hog = Hog::new(HogParameters::default())?;
                marks::hog(&self.gray(input)?, &mut hog, self.args.descriptor)?
            }
        })
    }

    /// Values out of range for a kernel have been rejected.
    fn threshold(&self, default: u32) -> u32 {
        self.args.threshold.unwrap_or(default)
    }

    /// The grayscale image, smoothed if requested.
    fn gray(&self, input: &RgbImage) -> Result<GrayImage, ImageError> {
        let mut gray = GrayImage::new(input.width(), input.height());
        gray_into(input.try_into()?, (&mut gray).try_into()?, self.parameters.weights)?;
        let Some(kernel) = self.parameters.smooth else { return Ok(gray) };
        let mut smooth = GrayImage::new(input.width(), input.height());
        gaussian_into((&gray).try_into()?, (&mut smooth).try_into()?, kernel)?;
        Ok(smooth)
    }

    fn on_gray(
        &self,
        input: &RgbImage,
        kernel: impl FnOnce(
            roverlab::vision::GrayView<'_>,
            roverlab::vision::GrayViewMut<'_>,
        ) -> Result<(), ImageError>,
    ) -> Result<GrayImage, ImageError> {
        let gray = self.gray(input)?;
        let mut output = GrayImage::new(gray.width(), gray.height());
        kernel((&gray).try_into()?, (&mut output).try_into()?)?;
        Ok(output)
    }

    fn gaussian(&self, input: &RgbImage, size: usize) -> Result<GrayImage, ImageError> {
        let kernel = gaussian(size, self.args.sigma)?;
        self.on_gray(input, |a, b| gaussian_into(a, b, kernel))
    }

    fn edges(&mut self, input: &RgbImage) -> Result<GrayImage, ImageError> {
        let gray = self.gray(input)?;
        let mut output = GrayImage::new(gray.width(), gray.height());
        let thresholds = self.parameters.thresholds;
        self.canny.find_into((&gray).try_into()?, (&mut output).try_into()?, thresholds)?;
        Ok(output)
    }

    fn edges_or_input(&mut self, input: &RgbImage) -> Result<GrayImage, ImageError> {
        if self.args.binary { self.gray(input) } else { self.edges(input) }
    }

    fn overlay(&self, input: &RgbImage, second: Option<&RgbImage>) -> Result<RgbImage, ImageError> {
        let mut output = RgbImage::new(input.width(), input.height());
        if let Some(top) = second {
            overlay_into(input.try_into()?, top.try_into()?, (&mut output).try_into()?)?;
            return Ok(output);
        }
        let border = self.parameters.border;
        let laplace = self.on_gray(input, |a, b| laplace_into(a, b, border))?;
        let mut edges = GrayImage::new(input.width(), input.height());
        let threshold = self.threshold(50) as u8;
        threshold_into((&laplace).try_into()?, (&mut edges).try_into()?, threshold)?;
        let gray = self.gray(input)?;
        let red = roverlab::world::Colour::RED;
        overlay_gray_into((&gray).try_into()?, (&edges).try_into()?, red, (&mut output).try_into()?)?;
        Ok(output)
    }

    fn difference(&self, input: &RgbImage, second: Option<&RgbImage>) -> Result<GrayImage, ImageError> {
        let first = self.gray(input)?;
        let second = second.map_or(Ok(first.clone()), |second| self.gray(second))?;
        let mut output = GrayImage::new(first.width(), first.height());
        absolute_difference_into((&first).try_into()?, (&second).try_into()?, (&mut output).try_into()?)?;
        Ok(output)
    }
}

fn projections(mask: GrayImage) -> Result<Processed, ImageError> {
    let (mut columns, mut rows) = (vec![0; mask.width() as usize], vec![0; mask.height() as usize]);
    projections_into((&mask).try_into()?, &mut columns, &mut rows)?;
    // Numbers of matching pixels, as drawn in the book.
    let counts = |sums: Vec<u32>| json!(sums.into_iter().map(|sum| sum / 255).collect::<Vec<u32>>());
    Ok(Processed { image: mask.into(), fields: vec![("columns", counts(columns)), ("rows", counts(rows))] })
}
