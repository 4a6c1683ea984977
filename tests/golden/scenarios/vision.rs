//! Image kernels on a drawn picture.

use roverlab::io::Result;
use roverlab::random::Stream;
use roverlab::vision::motion::{MotionDetector, MotionParameters, TurnCompensator};
use roverlab::vision::signs::{Area, SignFinder, SignTrainer};
use roverlab::vision::{
    Border, Canny, CannyThresholds, Components, GaussianKernel, GrayView, GrayViewMut, GrayWeights, Hog,
    HogParameters, HoughLines, HoughSegments, HueLimits, HueRange, HueScale, RgbView, RgbViewMut,
    SegmentDefinition, SegmentParameters, SobelScale, absolute_difference_into, gaussian_into, gray_into,
    gray_to_rgb_into, hsi_into, hsi_to_rgb_into, hsv_into, hsv_to_rgb_into, hue, hue_histogram_into,
    hue_into, hue_match_into, laplace_into, laplace_saturated_into, match_hue_image_into, maximum,
    mean_difference, overlay_gray_into, overlay_into, projections_into, sector_differences, sobel_l1_into,
    sobel_l2_into, threshold_into,
};
use roverlab::world::Colour;

use super::{Scenario, fnv, note, other};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("vision-gray", gray),
    Scenario::new("vision-colour", colour),
    Scenario::new("vision-features", features),
    Scenario::new("vision-motion", motion),
    Scenario::new("signs", signs),
];

/// An odd size, so that no kernel has whole blocks alone.
const WIDTH: usize = 157;
const HEIGHT: usize = 83;

/// A picture of slanted bars, a disc and a box on a slope of light, with noise; the disc at a column.
fn picture(disc: f64, seed: u64) -> Vec<u8> {
    let mut random = Stream::new(seed);
    let mut bytes = Vec::with_capacity(3 * WIDTH * HEIGHT);
    for (x, y) in (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x as f64, y as f64))) {
        let is_disc = (x - disc) * (x - disc) + (y - 40.0) * (y - 40.0) < 400.0;
        let is_box = (90.0..125.0).contains(&x) && (20.0..60.0).contains(&y);
        let is_bar = (0.7 * x + y).rem_euclid(60.0) < 5.0;
        let levels = match (is_disc, is_box, is_bar) {
            (true, ..) => [210.0, 40.0, 30.0],
            (_, true, _) => [30.0, 90.0, 200.0],
            (.., true) => [20.0, 25.0, 20.0],
            _ => [80.0 + 0.8 * x, 120.0 + y, 90.0],
        };
        bytes.extend(levels.map(|level| (level + random.between(-12.0, 12.0)).clamp(0.0, 255.0) as u8));
    }
    bytes
}

fn rgb(bytes: &[u8]) -> Result<RgbView<'_>> {
    RgbView::new(bytes, WIDTH, HEIGHT).map_err(other)
}

fn plane(bytes: &[u8]) -> Result<GrayView<'_>> {
    GrayView::new(bytes, WIDTH, HEIGHT).map_err(other)
}

type Outcome = std::result::Result<(), roverlab::vision::ImageError>;

/// Notes the digest of the gray image that a kernel makes, and gives the image back.
fn gray_of(log: &mut String, what: &str, kernel: impl FnOnce(GrayViewMut<'_>) -> Outcome) -> Result<Vec<u8>> {
    let mut bytes = vec![0; WIDTH * HEIGHT];
    kernel(GrayViewMut::new(&mut bytes, WIDTH, HEIGHT).map_err(other)?).map_err(other)?;
    note(log, what, &fnv(bytes.iter().copied()));
    Ok(bytes)
}

/// The same for a colour image.
fn rgb_of(log: &mut String, what: &str, kernel: impl FnOnce(RgbViewMut<'_>) -> Outcome) -> Result<Vec<u8>> {
    let mut bytes = vec![0; 3 * WIDTH * HEIGHT];
    kernel(RgbViewMut::new(&mut bytes, WIDTH, HEIGHT).map_err(other)?).map_err(other)?;
    note(log, what, &fnv(bytes.iter().copied()));
    Ok(bytes)
}

/// The picture in gray.
fn in_gray(disc: f64, seed: u64) -> Result<Vec<u8>> {
    let colours = picture(disc, seed);
    let input = rgb(&colours)?;
    gray_of(&mut String::new(), "gray", |output| gray_into(input, output, GrayWeights::Robios))
}

/// Kernels on gray images.
fn gray() -> Result<String> {
    let mut log = String::new();
    let bytes = in_gray(40.0, 110)?;
    let input = plane(&bytes)?;
    let colours = picture(40.0, 110);
    let colours = rgb(&colours)?;
    gray_of(&mut log, "Rec. 601", |output| gray_into(colours, output, GrayWeights::Rec601))?;
    for border in [Border::Zero, Border::Mirror] {
        gray_of(&mut log, "Laplace", |output| laplace_into(input, output, border))?;
        gray_of(&mut log, "Laplace, saturated", |output| laplace_saturated_into(input, output, border))?;
        for scale in [SobelScale::Full, SobelScale::Third] {
            gray_of(&mut log, "Sobel, L1", |output| sobel_l1_into(input, output, scale, border))?;
            gray_of(&mut log, "Sobel, L2", |output| sobel_l2_into(input, output, scale, border))?;
        }
    }
    for (size, sigma) in [(3, 0.8), (5, 1.1), (7, 2.0)] {
        let kernel = GaussianKernel::new(size, sigma).map_err(other)?;
        note(&mut log, "weights", &kernel.weights());
        gray_of(&mut log, "Gauss", |output| gaussian_into(input, output, kernel))?;
    }
    for (low, high) in [(40, 120), (100, 300)] {
        let thresholds = CannyThresholds { low, high };
        gray_of(&mut log, "Canny", |output| Canny::new().find_into(input, output, thresholds))?;
    }
    let mask = gray_of(&mut log, "threshold", |output| threshold_into(input, output, 120))?;
    let mask = plane(&mask)?;
    gray_of(&mut log, "difference", |output| absolute_difference_into(input, mask, output))?;
    let both = rgb_of(&mut log, "marked", |output| overlay_gray_into(input, mask, Colour::RED, output))?;
    let both = rgb(&both)?;
    rgb_of(&mut log, "overlaid", |output| overlay_into(colours, both, output))?;
    rgb_of(&mut log, "gray as colours", |output| gray_to_rgb_into(input, output))?;
    let (mut columns, mut rows) = ([0; WIDTH], [0; HEIGHT]);
    projections_into(mask, &mut columns, &mut rows).map_err(other)?;
    note(&mut log, "projections", &(maximum(&columns), maximum(&rows), &columns[..], &rows[..]));
    Ok(log)
}

/// Kernels on colours.
fn colour() -> Result<String> {
    let mut log = String::new();
    let bytes = picture(40.0, 110);
    let input = rgb(&bytes)?;
    let limits = HueLimits::default();
    let hsi = rgb_of(&mut log, "HSI", |output| hsi_into(input, output))?;
    let hsi = rgb(&hsi)?;
    rgb_of(&mut log, "from HSI", |output| hsi_to_rgb_into(hsi, output))?;
    let hsv = rgb_of(&mut log, "HSV", |output| hsv_into(input, output))?;
    let hsv = rgb(&hsv)?;
    rgb_of(&mut log, "from HSV", |output| hsv_to_rgb_into(hsv, output))?;
    for scale in [HueScale::Robios, HueScale::OpenCv] {
        let hues = gray_of(&mut log, "hue", |output| hue_into(input, output, scale, limits))?;
        let hues = plane(&hues)?;
        let range = HueRange::around(hue([210, 40, 30], scale, limits), 12, scale).map_err(other)?;
        gray_of(&mut log, "match of hues", |output| match_hue_image_into(hues, output, range))?;
        let mask = gray_of(&mut log, "match", |output| hue_match_into(input, output, range, scale, limits))?;
        let mut components = Components::new();
        note(&mut log, "blobs", &components.find(plane(&mask)?, 4));
        let mut columns = [0; WIDTH];
        hue_histogram_into(input, &mut columns, range, limits).map_err(other)?;
        note(&mut log, "histogram", &columns);
    }
    Ok(log)
}

/// Lines, segments and gradients' histograms.
fn features() -> Result<String> {
    let mut log = String::new();
    let bytes = in_gray(40.0, 110)?;
    let input = plane(&bytes)?;
    let edges = gray_of(&mut log, "edges", |output| {
        Canny::new().find_into(input, output, CannyThresholds { low: 60, high: 160 })
    })?;
    let edges = plane(&edges)?;
    note(&mut log, "lines", &HoughLines::new(1.0, 180).map_err(other)?.find(edges, 28));
    for definition in [SegmentDefinition::Voted { seed: 3 }, SegmentDefinition::OpenCv] {
        let parameters = SegmentParameters { threshold: 18, min_length: 15, max_gap: 3, definition };
        note(&mut log, "segments", &HoughSegments::new(180).map_err(other)?.find(edges, parameters));
    }
    let mut hog = Hog::new(HogParameters::default()).map_err(other)?;
    note(&mut log, "blocks", &hog.blocks((WIDTH, HEIGHT)));
    note(&mut log, "descriptor", &hog.describe(input).map_err(other)?);
    Ok(log)
}

/// What moves between two pictures, seen by a camera that stands and by one that turns.
fn motion() -> Result<String> {
    let mut log = String::new();
    let [first, second] = [in_gray(40.0, 110)?, in_gray(46.0, 111)?];
    let (first, second) = (plane(&first)?, plane(&second)?);
    note(&mut log, "mean", &mean_difference(first, second).map_err(other)?);
    note(&mut log, "sectors", &sector_differences::<5>(first, second).map_err(other)?);
    let mut detector = MotionDetector::new(MotionParameters::default()).map_err(other)?;
    note(&mut log, "standing", &detector.compare(first, second).map_err(other)?);
    for slack in [1, 3] {
        note(&mut log, "loosely", &detector.compare_loosely(first, second, slack).map_err(other)?);
    }
    let mut compensator = TurnCompensator::new(1.0).map_err(other)?;
    for angle in [0.02, -0.2] {
        let turned = compensator.turn(first, second, angle).map_err(other)?;
        let digest = fnv((0..turned.image.height()).flat_map(|row| turned.image.row(row)).copied());
        note(&mut log, "turned", &(turned.from, turned.to, turned.shift, digest));
    }
    Ok(log)
}

/// The disc and the box, learned from six pictures and found in six others.
fn signs() -> Result<String> {
    let areas = |disc: f64| {
        let disc = Area::new(disc - 20.0, 20.0, 40.0, 40.0);
        [(0, disc), (1, Area::new(90.0, 20.0, 35.0, 40.0))]
    };
    let mut trainer = SignTrainer::new(["disc", "box"])?;
    for seed in 0..6 {
        let disc = 25.0 + 8.0 * seed as f64;
        trainer.add(rgb(&picture(disc, seed))?, &areas(disc)).map_err(other)?;
    }
    let mut finder = SignFinder::new(trainer.finder(1).map_err(other)?);
    let mut log = String::new();
    for seed in 6..12 {
        let disc = 27.0 + 7.0 * (seed - 6) as f64;
        note(&mut log, "found", &finder.find(rgb(&picture(disc, seed))?).map_err(other)?);
    }
    Ok(log)
}
