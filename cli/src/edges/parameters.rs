use roverlab::vision::{
    Border, CannyThresholds, GaussianKernel, GrayWeights, HueLimits, HueRange, HueScale, ImageError,
    SobelScale,
};

use super::{Args, Definition};

/// Parameters of the kernels from options and definition.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Parameters {
    pub(crate) weights: GrayWeights,
    pub(crate) border: Border,
    pub(crate) sobel: SobelScale,
    pub(crate) thresholds: CannyThresholds,
    /// A Gaussian applied first.
    pub(crate) smooth: Option<GaussianKernel>,
    pub(crate) scale: HueScale,
    pub(crate) range: HueRange,
    pub(crate) limits: HueLimits,
    /// The limits for hues by the book's formulas, which have none of their own.
    pub(crate) exact_limits: HueLimits,
}

impl Parameters {
    pub(crate) fn new(args: &Args) -> Result<Self, ImageError> {
        let book = args.definition == Definition::Book;
        let scale = if book { HueScale::Robios } else { HueScale::OpenCv };
        let limits = if book { HueLimits::default() } else { HueLimits::NONE };
        let asked = |limits: HueLimits| HueLimits {
            min_saturation: args.min_saturation.unwrap_or(limits.min_saturation),
            min_intensity: args.min_intensity.unwrap_or(limits.min_intensity),
        };
        let red = if book { 42 } else { 0 };
        Ok(Self {
            weights: if book { GrayWeights::Robios } else { GrayWeights::Rec601 },
            border: if book { Border::Zero } else { Border::Mirror },
            sobel: if book { SobelScale::Third } else { SobelScale::Full },
            thresholds: CannyThresholds { low: args.low, high: args.high },
            smooth: smoothing(args, book)?,
            scale,
            range: match (args.hue_low, args.hue_high) {
                (Some(low), Some(high)) => HueRange::new(low, high, scale)?,
                _ => HueRange::around(args.hue.unwrap_or(red), args.tolerance, scale)?,
            },
            limits: asked(limits),
            exact_limits: asked(HueLimits::NONE),
        })
    }
}

/// A Gaussian of a size, with an optional standard deviation.
pub(crate) fn gaussian(size: usize, sigma: Option<f64>) -> Result<GaussianKernel, ImageError> {
    match (size, sigma) {
        (_, Some(sigma)) => GaussianKernel::new(size, sigma),
        (3, None) => Ok(GaussianKernel::THREE),
        (5, None) => Ok(GaussianKernel::FIVE),
        _ => Ok(GaussianKernel::SEVEN),
    }
}

fn smoothing(args: &Args, book: bool) -> Result<Option<GaussianKernel>, ImageError> {
    match args.smooth {
        Some(0) => Ok(None),
        Some(size) => gaussian(size, args.sigma).map(Some),
        // Program 11.8.
        None if book && args.kernel.uses_canny() && !args.binary => {
            gaussian(7, Some(args.sigma.unwrap_or(1.5))).map(Some)
        }
        None => Ok(None),
    }
}
