use std::path::PathBuf;

use clap::value_parser;

use super::Kernel;
use crate::common::CommonArgs;

/// Command line of `edges`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Edges, colours and lines: a kernel on an image file, or live on the robot's display",
    after_help = "\
With --input, the kernel processes an image file (PNG, PNM or BMP), and --output saves the result (.png, .pgm, .ppm or
.bmp). Without it, a robot in its room turns and shows the processed images of its camera on its display; --output saves
the last display.

--definition decides where the book and OpenCV differ:
                 book (the default)                               opencv
  gray           (R + B) / 4 + G / 2                              0.299 R + 0.587 G + 0.114 B
  laplace        border 0                                         border by mirror image
  sobel_l1, _l2  a third of the gradient, border 0                the gradient, border by mirror image
  canny          after a Gaussian of 7 x 7 with sigma 1.5         without smoothing
  hue            a circle of 252, 255 without colour or light     a circle of 180
  saturation     255 - 255 min / I                                255 (max - min) / max
  intensity      (R + G + B) / 3                                  max
  hue_match      255-hue circle of the book's Program 11.9        180-hue circle
  hough_prob...  pixels vote in an order drawn by --seed          OpenCV's order, and its rule of withdrawn votes
--smooth, --min-saturation and --min-intensity apply to both.

JSON fields:
  kernel, definition, width, height, output
  timing                      with --timing: ns_per_pixel of the fastest of --repeat runs
  mean                        of the result's bytes
  lines                       hough: [{rho, theta_deg, votes}]; hough_probabilistic: [[x0, y0, x1, y1]]
  blobs                       blobs: [{area, x, y, min, max}]
  columns, rows               projections: the sums
  descriptor_length, descriptor_digest   hog; with --descriptor, its numbers in `descriptor`
  frames                      live: images shown
Outcomes: filtered, shown, collided, timed_out, failed."
)]
pub(crate) struct Args {
    /// Input image.
    #[arg(long, value_name = "FILE")]
    pub(crate) input: Option<PathBuf>,

    /// Kernel to apply.
    #[arg(long, value_enum, default_value = "laplace")]
    pub(crate) kernel: Kernel,

    /// File for the result.
    #[arg(long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// Definition to use where they differ.
    #[arg(long, value_enum, default_value = "book")]
    pub(crate) definition: Definition,

    /// Second image, for difference and overlay.
    #[arg(long, value_name = "FILE")]
    pub(crate) second: Option<PathBuf>,

    /// canny and kernels on its edges: gradient that continues an edge.
    #[arg(long, value_name = "N", default_value_t = 50, allow_hyphen_values = true)]
    pub(crate) low: u16,

    /// canny and kernels on its edges: gradient that starts an edge.
    #[arg(long, value_name = "N", default_value_t = 100, allow_hyphen_values = true)]
    pub(crate) high: u16,

    /// threshold: gray levels above this become white [128]; hough: votes [100, 50 for segments]; overlay:
    /// edges [50].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) threshold: Option<u32>,

    /// Standard deviation of a Gaussian in pixels; by default the fixed weights of its size.
    #[arg(long, value_name = "F", allow_hyphen_values = true)]
    pub(crate) sigma: Option<f64>,

    /// Size of a Gaussian applied first: 0, 3, 5 or 7 [canny by the book: 7, otherwise 0].
    #[arg(long, value_name = "N", value_parser = parse_smooth)]
    pub(crate) smooth: Option<usize>,

    /// Hue to look for [that of red].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) hue: Option<u8>,

    /// Hue tolerance: smaller differences match.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = value_parser!(u8).range(1..), allow_hyphen_values = true)]
    pub(crate) tolerance: u8,

    /// First hue that matches, instead of --hue; it may be larger than the last.
    #[arg(long, value_name = "N", requires = "hue_high", allow_hyphen_values = true)]
    pub(crate) hue_low: Option<u8>,

    /// Last hue that matches.
    #[arg(long, value_name = "N", requires = "hue_low", allow_hyphen_values = true)]
    pub(crate) hue_high: Option<u8>,

    /// Minimum saturation of a pixel with a hue, 0 to 255 [book: 128, opencv: 0].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) min_saturation: Option<u8>,

    /// Minimum intensity of a pixel with a hue, 0 to 255 [book: 26, opencv: 0].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) min_intensity: Option<u8>,

    /// hue: use the book's formulas instead of RoBIOS's integers, for every colour unless a minimum is given.
    #[arg(long)]
    pub(crate) exact: bool,

    /// hough, `hough_probabilistic`, blobs: the input is already an edge image.
    #[arg(long)]
    pub(crate) binary: bool,

    /// hough: number of angle steps in half a turn.
    #[arg(long, value_name = "N", default_value_t = 180, value_parser = value_parser!(u16).range(1..=3600), allow_hyphen_values = true)]
    pub(crate) angles: u16,

    /// hough: distance step in pixels.
    #[arg(long, value_name = "F", default_value_t = 1.0, allow_hyphen_values = true)]
    pub(crate) rho: f64,

    /// `hough_probabilistic`: minimum length of a line in pixels.
    #[arg(long, value_name = "N", default_value_t = 30, allow_hyphen_values = true)]
    pub(crate) min_length: usize,

    /// `hough_probabilistic`: maximum gap in a line in pixels.
    #[arg(long, value_name = "N", default_value_t = 5, allow_hyphen_values = true)]
    pub(crate) max_gap: usize,

    /// hog: include the whole descriptor in the JSON fields.
    #[arg(long)]
    pub(crate) descriptor: bool,

    /// blobs: minimum size in pixels.
    #[arg(long, value_name = "N", default_value_t = 20, allow_hyphen_values = true)]
    pub(crate) min_area: usize,

    /// Runs of the kernel, of which the fastest is reported; live: number of images.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = value_parser!(u32).range(1..=100_000), allow_hyphen_values = true)]
    pub(crate) repeat: u32,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["goal"]),
    ("input", &["noise", "time_limit", "quantised", "realtime"]),
    ("input&kernel!=hough_probabilistic", &["seed"]),
    ("!input", &["descriptor"]),
    ("kernel!=difference,overlay", &["second"]),
    ("kernel!=canny,hough,hough_probabilistic", &["low", "high"]),
    ("binary", &["low", "high", "hue", "hue_low", "hue_high", "tolerance", "min_saturation", "min_intensity"]),
    ("kernel!=threshold,overlay,hough,hough_probabilistic", &["threshold"]),
    ("second&kernel=overlay", &["threshold", "sigma"]),
    ("kernel!=gaussian3,gaussian5,gaussian7,canny,hough,hough_probabilistic&!smooth", &["sigma"]),
    ("definition=opencv&kernel=canny,hough,hough_probabilistic&!smooth", &["sigma"]),
    ("kernel!=hue_match,projections,blobs", &["hue", "hue_low", "hue_high", "tolerance"]),
    ("hue_low", &["hue", "tolerance"]),
    ("kernel!=hue,hue_match,projections,blobs", &["min_saturation", "min_intensity"]),
    ("kernel!=hue", &["exact"]),
    ("kernel!=hough,hough_probabilistic,blobs", &["binary"]),
    ("kernel!=hough,hough_probabilistic", &["angles"]),
    ("kernel!=hough", &["rho"]),
    ("kernel!=hough_probabilistic", &["min_length", "max_gap"]),
    ("kernel!=hog", &["descriptor"]),
    ("kernel!=blobs", &["min_area"]),
]);

/// Definition of a kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Definition {
    /// The book's and RoBIOS's.
    Book,
    /// `OpenCV`'s.
    #[value(name = "opencv")]
    OpenCv,
}

impl Definition {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Book => "book",
            Self::OpenCv => "opencv",
        }
    }
}

fn parse_smooth(text: &str) -> Result<usize, String> {
    let size = text.parse().ok().filter(|size| [0, 3, 5, 7].contains(size));
    size.ok_or_else(|| "expected 0, 3, 5 or 7".into())
}
