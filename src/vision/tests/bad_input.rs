//! Rejected input and its error messages.

use crate::vision::{
    Border, Canny, CannyThresholds, GaussianKernel, GrayView, GrayViewMut, GrayWeights, HoughLines,
    HueLimits, HueRange, HueScale, ImageError, RgbView, gray_into, hue_histogram_into, laplace_into,
    mean_difference, projections_into,
};

#[test]
fn shapes_that_are_none() {
    assert_eq!(GrayView::new(&[], 0, 3).unwrap_err(), ImageError::Empty { width: 0, height: 3 });
    assert_eq!(GrayView::new(&[1; 5], 2, 3).unwrap_err(), ImageError::Truncated { found: 5, expected: 6 });
    assert_eq!(RgbView::new(&[1; 5], 2, 1).unwrap_err(), ImageError::Truncated { found: 5, expected: 6 });
    assert_eq!(
        GrayView::with_stride(&[1; 9], 3, 3, 2).unwrap_err(),
        ImageError::Stride { stride: 2, row: 3 }
    );
    assert!(GrayView::with_stride(&[1; 11], 3, 3, 4).is_ok(), "no gap needed after the last row");
    let huge = GrayView::with_stride(&[1; 9], 3, usize::MAX, usize::MAX).unwrap_err();
    assert_eq!(huge, ImageError::Truncated { found: 9, expected: usize::MAX });
    assert!(RgbView::new(&[1; 9], usize::MAX, 2).is_err());
    assert_eq!(GrayViewMut::new(&mut [], 3, 0).unwrap_err(), ImageError::Empty { width: 3, height: 0 });
    let image = image::GrayImage::new(0, 0);
    assert!(GrayView::try_from(&image).is_err());
}

#[test]
fn regions_outside() {
    let view = GrayView::new(&[0; 12], 4, 3).unwrap();
    assert_eq!(view.region((2, 0), 3, 1).unwrap_err(), ImageError::Region { end: (5, 1), size: (4, 3) });
    assert!(view.region((usize::MAX, 0), 2, 1).is_err());
    assert_eq!(view.region((0, 0), 0, 1).unwrap_err(), ImageError::Empty { width: 0, height: 1 });
    assert_eq!(view.region((3, 2), 1, 1).unwrap().size(), (1, 1));
}

#[test]
fn sizes_that_differ() {
    let (a, b) = ([0; 12], [0; 6]);
    let (four, three) = (GrayView::new(&a, 4, 3).unwrap(), GrayView::new(&b, 3, 2).unwrap());
    let mut outputs = std::iter::repeat_with(|| GrayViewMut::new(vec![0; 6].leak(), 3, 2).unwrap());
    let mut small = || outputs.next().unwrap();
    let output = ImageError::Size { what: "output", found: (3, 2), expected: (4, 3) };
    assert_eq!(laplace_into(four, small(), Border::Zero).unwrap_err(), output);
    assert_eq!(Canny::new().find_into(four, small(), CannyThresholds::default()).unwrap_err(), output);
    let rgb = RgbView::new(&a, 2, 2).unwrap();
    assert!(gray_into(rgb, small(), GrayWeights::Robios).is_err());
    assert_eq!(
        mean_difference(four, three).unwrap_err().to_string(),
        "the second image is 3 x 2; expected 4 x 3"
    );
    assert!(projections_into(four, &mut [0; 4], &mut [0; 4]).is_err());
    let range = HueRange { low: 1, high: 2 };
    assert!(hue_histogram_into(rgb, &mut [0; 3], range, HueLimits::NONE).is_err());
}

#[test]
fn parameters_out_of_range() {
    let message = GaussianKernel::new(4, 1.0).unwrap_err().to_string();
    assert_eq!(message, "Gaussian size is 4; expected 3, 5 or 7");
    for sigma in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(GaussianKernel::new(3, sigma).is_err(), "{sigma}");
    }
    let (image, mut out) = ([0; 4], [0; 4]);
    let view = GrayView::new(&image, 2, 2).unwrap();
    let thresholds = CannyThresholds { low: 3, high: 2 };
    let out = GrayViewMut::new(&mut out, 2, 2).unwrap();
    let message = Canny::new().find_into(view, out, thresholds).unwrap_err().to_string();
    assert_eq!(message, "low threshold is 3; expected at most the high threshold");
    assert!(HoughLines::new(f64::NAN, 180).is_err());
    assert!(HoughLines::new(0.0, 180).is_err());
    assert!(HoughLines::new(1.0, 0).is_err());
    assert!(HueRange::around(255, 5, HueScale::Robios).is_err());
    assert!(HueRange::around(180, 5, HueScale::OpenCv).is_err());
    assert!(HueRange::around(10, 0, HueScale::Robios).is_err());
    let message = HueRange::new(200, 10, HueScale::OpenCv).unwrap_err().to_string();
    assert_eq!(message, "low hue is 200; expected below 255, or 180 on OpenCV's scale");
    assert!(HueRange::new(200, 255, HueScale::Robios).is_err());
    assert!(HueRange::new(200, 10, HueScale::Robios).unwrap().contains(0));
}
