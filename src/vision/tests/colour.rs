//! Kernels on colours.

use std::f64::consts::TAU;

use proptest::prelude::*;

use super::images;
use crate::geometry::math;
use crate::random::Stream;
use crate::vision::{
    GrayWeights, Hsi, Hsv, HueLimits, HueRange, HueScale, NO_HUE, RgbView, combine, fused, gray, gray_into,
    gray_to_rgb_into, hsi_into, hsi_to_rgb, hsi_to_rgb_into, hsv, hsv_into, hsv_to_rgb, hsv_to_rgb_into, hue,
    hue_histogram_into, hue_into, hue_match, hue_match_into, match_hue_image_into, overlay_gray_into,
    overlay_into, rgb_to_hsi, rgb_to_hsv,
};
use crate::world::Colour;

/// Hue of a pixel in integer arithmetic, step by step.
fn naive_hue([red, green, blue]: [u8; 3], scale: HueScale, limits: HueLimits) -> u8 {
    let (r, g, b) = (i64::from(red), i64::from(green), i64::from(blue));
    let largest = r.max(g).max(b);
    let d = largest - r.min(g).min(b);
    if 255 * d < i64::from(limits.min_saturation) * largest {
        return NO_HUE;
    }
    if (r + b) / 4 + g / 2 < i64::from(limits.min_intensity) {
        return NO_HUE;
    }
    match scale {
        HueScale::Robios if d == 0 => NO_HUE,
        HueScale::Robios if r == largest => (42 + 42 * (g - b) / d) as u8,
        HueScale::Robios if g == largest => (126 + 42 * (b - r) / d) as u8,
        HueScale::Robios => (210 + 42 * (r - g) / d) as u8,
        HueScale::OpenCv if d == 0 => 0,
        HueScale::OpenCv => {
            let n = if r == largest {
                g - b
            } else if g == largest {
                b - r + 2 * d
            } else {
                r - g + 4 * d
            };
            let t = (122_880.0 / d as f64).round() as i64;
            (n * t + 2048).div_euclid(4096).rem_euclid(180) as u8
        }
    }
}

fn hsi_of([hue, saturation, intensity]: [u8; 3]) -> [u8; 3] {
    hsi_to_rgb(Hsi { hue, saturation, intensity })
}

fn hsv_of([hue, saturation, value]: [u8; 3]) -> [u8; 3] {
    hsv_to_rgb(Hsv { hue, saturation, value })
}

fn scales() -> impl Strategy<Value = HueScale> {
    prop_oneof![Just(HueScale::Robios), Just(HueScale::OpenCv)]
}

fn limits() -> impl Strategy<Value = HueLimits> {
    let own = (any::<u8>(), any::<u8>())
        .prop_map(|(min_saturation, min_intensity)| HueLimits { min_saturation, min_intensity });
    prop_oneof![Just(HueLimits::NONE), Just(HueLimits::default()), own]
}

fn contains(range: HueRange, hue: u8) -> bool {
    let wrapped = (range.low..=255).chain(0..=range.high);
    let found = if range.low <= range.high {
        (range.low..=range.high).any(|member| member == hue)
    } else {
        wrapped.into_iter().any(|member| member == hue)
    };
    found && hue != NO_HUE
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn gray_is_its_definition(image in images::<3>()) {
        let robios = image.map(|x, y| {
            let [r, g, b] = image.at(x, y).map(u32::from);
            [((r + b) / 4 + g / 2) as u8]
        });
        let rec601 = image.map(|x, y| {
            let [r, g, b] = image.at(x, y).map(u64::from);
            [((9798 * r + 19_235 * g + 3735 * b + 16_384) / 32_768) as u8]
        });
        for (weights, expected) in [(GrayWeights::Robios, robios), (GrayWeights::Rec601, rec601)] {
            prop_assert_eq!(image.output(|out| gray_into(image.view(), out, weights).unwrap()), &expected[..]);
            let portable = image.output(|mut out| gray::gray_portable(image.view(), &mut out, weights));
            prop_assert_eq!(portable, expected);
        }
    }

    #[test]
    fn gray_in_colour_is_gray(image in images::<1>()) {
        let expected = image.map(|x, y| [image.at(x, y)[0]; 3]);
        prop_assert_eq!(image.output(|out| gray_to_rgb_into(image.view(), out).unwrap()), &expected[..]);
        let portable = image.output(|mut out| gray::triple_portable(image.view(), &mut out));
        prop_assert_eq!(portable, expected);
    }

    #[test]
    fn hues_are_their_definitions(image in images::<3>(), scale in scales(), limits in limits()) {
        let expected = image.map(|x, y| [naive_hue(image.at(x, y), scale, limits)]);
        let found = image.output(|out| hue_into(image.view(), out, scale, limits).unwrap());
        prop_assert_eq!(found, &expected[..]);
        let portable = image.output(|mut out| hue::hues_portable(image.view(), &mut out, scale, limits));
        prop_assert_eq!(portable, expected);
    }

    #[test]
    fn matches_are_their_definitions(
        image in images::<3>(), scale in scales(), limits in limits(), low in any::<u8>(), high in any::<u8>(),
    ) {
        let range = HueRange { low, high };
        let is_match = |x, y| contains(range, naive_hue(image.at(x, y), scale, limits));
        let expected = image.map(|x, y| [if is_match(x, y) { 255 } else { 0 }]);
        let found = image.output(|out| hue_match_into(image.view(), out, range, scale, limits).unwrap());
        prop_assert_eq!(found, &expected[..]);
        let portable = image.output(|mut out| match scale {
            HueScale::Robios => {
                hue_match::matches_portable(image.view(), &mut out, &hue_match::Sectors::new(range, limits));
            }
            HueScale::OpenCv => {
                hue_match::matches_opencv_portable(image.view(), &mut out, range, limits);
            }
        });
        prop_assert_eq!(portable, &expected[..]);

        if scale == HueScale::Robios {
            let mut columns = vec![5; image.width];
            hue_histogram_into(image.view(), &mut columns, range, limits).unwrap();
            for (x, &count) in columns.iter().enumerate() {
                prop_assert_eq!(count as usize, (0..image.height).filter(|&y| is_match(x, y)).count());
            }
            let mut portable = vec![6; image.width];
            let sectors = hue_match::Sectors::new(range, limits);
            fused::histogram_portable(image.view(), &mut portable, &sectors);
            prop_assert_eq!(columns, portable);
        }
    }

    #[test]
    fn a_hue_image_matches_as_its_colours_do(image in images::<1>(), low in any::<u8>(), high in any::<u8>()) {
        let range = HueRange { low, high };
        let expected = image.map(|x, y| [if contains(range, image.at(x, y)[0]) { 255 } else { 0 }]);
        let found = image.output(|out| match_hue_image_into(image.view(), out, range).unwrap());
        prop_assert_eq!(found, &expected[..]);
        let portable = image.output(|mut out| hue_match::matches_hues_portable(image.view(), &mut out, range));
        prop_assert_eq!(portable, expected);
    }

    #[test]
    fn hues_around_one_are_the_books(hue in 0_u8..255, threshold in 1_u8..=255, other in any::<u8>()) {
        let range = HueRange::around(hue, threshold, HueScale::Robios).unwrap();
        let (difference, threshold) = ((i32::from(other) - i32::from(hue)).abs(), i32::from(threshold));
        let book = (difference < threshold || 255 - difference < threshold) && other != NO_HUE;
        prop_assert_eq!(range.contains(other), book);
    }

    #[test]
    fn hsv_is_its_definition(image in images::<3>()) {
        let expected = image.map(|x, y| {
            let pixel = image.at(x, y);
            let (largest, least) = (*pixel.iter().max().unwrap(), *pixel.iter().min().unwrap());
            let t = if largest == 0 { 0 } else { (1_044_480.0 / f64::from(largest)).round() as u64 };
            let saturation = (u64::from(largest - least) * t + 2048) / 4096;
            [naive_hue(pixel, HueScale::OpenCv, HueLimits::NONE), saturation as u8, largest]
        });
        prop_assert_eq!(image.output(|out| hsv_into(image.view(), out).unwrap()), &expected[..]);
        let portable = image.output(|mut out| hsv::convert_portable(image.view(), &mut out));
        prop_assert_eq!(portable, expected);
    }

    #[test]
    fn hsi_comes_back_to_its_colour(pixel in any::<[u8; 3]>()) {
        let hsi = rgb_to_hsi(pixel);
        let [red, green, blue] = pixel.map(f64::from);
        let intensity = (red + green + blue) / 3.0;
        prop_assert!((f64::from(hsi.intensity) - intensity).abs() <= 0.5);
        if intensity > 0.0 {
            let saturation = 255.0 - 255.0 * red.min(green).min(blue) / intensity;
            prop_assert!((f64::from(hsi.saturation) - saturation).abs() <= 0.5 + 1e-9);
        }
        // Each of the three is rounded to one part in 255, which moves a channel by up to three levels.
        for (back, channel) in hsi_to_rgb(hsi).iter().zip(pixel) {
            prop_assert!(back.abs_diff(channel) <= 9, "{:?} came back as {:?}", pixel, hsi_to_rgb(hsi));
        }
    }

    #[test]
    fn hue_survives_a_cloud(pixel in any::<[u8; 3]>()) {
        // Half the light preserves the hue, except for rounding.
        let half = pixel.map(|channel| channel / 2);
        let spread = half.iter().max().unwrap() - half.iter().min().unwrap();
        prop_assume!(spread >= 32);
        let (bright, dark) = (rgb_to_hsi(pixel).hue, rgb_to_hsi(half).hue);
        let difference = bright.abs_diff(dark);
        prop_assert!(difference.min(255 - difference) <= 3, "{} and {}", bright, dark);
    }

    #[test]
    fn images_convert_as_their_pixels_do(image in images::<3>()) {
        let expected = image.map(|x, y| {
            let hsi = rgb_to_hsi(image.at(x, y));
            [hsi.hue, hsi.saturation, hsi.intensity]
        });
        prop_assert_eq!(image.output(|out| hsi_into(image.view(), out).unwrap()), expected);
        let [rgb, by_value] = [hsi_of, hsv_of].map(|back| image.map(|x, y| back(image.at(x, y))));
        prop_assert_eq!(image.output(|out| hsi_to_rgb_into(image.view(), out).unwrap()), rgb);
        prop_assert_eq!(image.output(|out| hsv_to_rgb_into(image.view(), out).unwrap()), by_value);
    }

    #[test]
    fn overlays_are_their_definitions(image in images::<3>(), marks in images::<1>(), seed in any::<u64>()) {
        let mut top = image.clone();
        Stream::new(seed).shuffle(&mut top.data);
        let expected = image.map(|x, y| if top.at(x, y) == [0; 3] { image.at(x, y) } else { top.at(x, y) });
        let found = image.output(|out| overlay_into(image.view(), top.view(), out).unwrap());
        prop_assert_eq!(found, &expected[..]);
        let portable = image.output(|mut out| combine::cover_portable(image.view(), top.view(), &mut out));
        prop_assert_eq!(portable, expected);

        let mut base = marks.clone();
        Stream::new(seed).shuffle(&mut base.data);
        let colour = Colour::new(200, 100, 50);
        let expected = base.map(|x, y| if marks.at(x, y)[0] > 0 { [200, 100, 50] } else { [base.at(x, y)[0]; 3] });
        let found = base.output(|out| overlay_gray_into(base.view(), marks.view(), colour, out).unwrap());
        prop_assert_eq!(found, &expected[..]);
        let portable = base.output(|mut out| {
            combine::mark_portable(base.view(), marks.view(), [200, 100, 50], &mut out);
        });
        prop_assert_eq!(portable, expected);
    }
}

#[test]
fn exact_hues_are_the_angles_of_colours() {
    // By another formula for the same angle.
    let angle = |[r, g, b]: [f64; 3]| math::atan2(3.0_f64.sqrt() * (g - b), 2.0 * r - g - b).rem_euclid(TAU);
    let mut stream = Stream::new(7);
    for _ in 0..50_000 {
        let pixel = [(); 3].map(|()| stream.bits() as u8);
        let [r, g, b] = pixel;
        let expected = if r == g && g == b {
            NO_HUE
        } else {
            let part = angle(pixel.map(f64::from)) * 255.0 / TAU;
            ((part + 1e-6).round() as u32 % 255) as u8
        };
        assert_eq!(rgb_to_hsi(pixel).hue, expected, "{pixel:?}");
    }
    for light in 1..=255 {
        let pixels = [[light, light, 0], [0, light, light], [light, 0, light]];
        assert_eq!(pixels.map(|pixel| rgb_to_hsi(pixel).hue), [43, 128, 213]);
        let pale = pixels.map(|pixel| pixel.map(|channel| channel.max(light / 2)));
        if light > 1 {
            assert_eq!(pale.map(|pixel| rgb_to_hsi(pixel).hue), [43, 128, 213]);
        }
    }
}

#[test]
fn values_come_back_to_their_colours() {
    // Results of OpenCV where rows fill its registers.
    for (hsv, pixel) in [
        ([0, 1, 1], [1, 0, 0]),
        ([1, 135, 170], [170, 83, 79]),
        ([6, 100, 255], [255, 175, 154]),
        ([60, 255, 200], [0, 200, 0]),
        ([179, 90, 85], [85, 55, 55]),
        ([90, 0, 77], [77, 77, 77]),
    ] {
        let [hue, saturation, value] = hsv;
        assert_eq!(hsv_to_rgb(Hsv { hue, saturation, value }), pixel, "{hsv:?}");
    }
    let mut stream = Stream::new(3);
    for _ in 0..20_000 {
        let pixel = [(); 3].map(|()| stream.bits() as u8);
        let back = hsv_to_rgb(rgb_to_hsv(pixel));
        // Half a hue is up to 255 / 60 levels of a channel; saturation and value are rounded as well.
        assert!(back.iter().zip(pixel).all(|(a, b)| a.abs_diff(b) <= 6), "{pixel:?} {back:?}");
    }
}

#[test]
fn counts_of_wide_and_of_tall_images() {
    // Wider than a strip, and taller than 16-bit counts.
    let (range, limits) = (HueRange::around(42, 10, HueScale::Robios).unwrap(), HueLimits::default());
    for (width, height) in [(1_300, 3), (2, 70_001)] {
        let is_red = |x: usize, y: usize| height > 100 || (x * 7 + y * 3).is_multiple_of(5);
        let place = |i: usize| (i % width, i / width);
        let red = |i: usize| if is_red(place(i).0, place(i).1) { [200, 0, 0] } else { [0, 0, 200] };
        let data: Vec<u8> = (0..width * height).flat_map(red).collect();
        let mut columns = vec![0; width];
        let view = RgbView::new(&data, width, height).unwrap();
        hue_histogram_into(view, &mut columns, range, limits).unwrap();
        let expected = (0..width).map(|x| (0..height).filter(|&y| is_red(x, y)).count() as u32);
        assert_eq!(columns, expected.collect::<Vec<u32>>());
    }
}

#[test]
fn hues_of_pure_colours() {
    let pure = |pixel| rgb_to_hsi(pixel).hue;
    assert_eq!([pure([200, 0, 0]), pure([0, 200, 0]), pure([0, 0, 200])], [0, 85, 170]);
    assert_eq!(pure([90, 90, 90]), NO_HUE);
    let robios = |pixel| hue::hue(pixel, HueScale::Robios, HueLimits::default());
    assert_eq!([robios([200, 0, 0]), robios([0, 200, 0]), robios([0, 0, 200])], [42, 126, 210]);
    // The book's example: red in sunlight and under a cloud.
    assert_eq!([robios([210, 20, 10]), robios([105, 10, 5])], [44, 44]);
    assert_eq!([robios([20, 0, 0]), robios([200, 150, 150])], [NO_HUE; 2]);
}
