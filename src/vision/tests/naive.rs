//! Kernels on gray levels.

use proptest::prelude::*;

use super::{Image, images};
use crate::vision::{
    Border, GaussianKernel, GrayView, GrayViewMut, SobelScale, absolute_difference_into, canny, combine,
    difference, gaussian, gaussian_into, laplace, laplace_into, laplace_saturated_into, mean_difference,
    projection, projections_into, sector_differences, sobel, sobel_l1_into, sobel_l2_into, threshold_into,
};
use crate::vision::{Canny, CannyThresholds};

/// A naive kernel of 3 x 3 pixels.
fn stencil(image: &Image<1>, border: Border, f: impl Fn(&dyn Fn(isize, isize) -> i32) -> i32) -> Vec<u8> {
    image.map(|x, y| {
        let edge = x == 0 || y == 0 || x + 1 == image.width || y + 1 == image.height;
        if border == Border::Zero && edge {
            return [0];
        }
        let at = |dx: isize, dy: isize| i32::from(image.mirrored(x as isize + dx, y as isize + dy)[0]);
        [f(&at).clamp(0, 255) as u8]
    })
}

fn sobel_at(at: &dyn Fn(isize, isize) -> i32) -> (i32, i32) {
    let dx = at(1, -1) + 2 * at(1, 0) + at(1, 1) - at(-1, -1) - 2 * at(-1, 0) - at(-1, 1);
    let dy = at(-1, 1) + 2 * at(0, 1) + at(1, 1) - at(-1, -1) - 2 * at(0, -1) - at(1, -1);
    (dx, dy)
}

fn borders() -> impl Strategy<Value = Border> {
    prop_oneof![Just(Border::Zero), Just(Border::Mirror)]
}

fn scales() -> impl Strategy<Value = (SobelScale, i32)> {
    prop_oneof![Just((SobelScale::Full, 1)), Just((SobelScale::Third, 3))]
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn laplace_is_its_definition(image in images::<1>(), border in borders()) {
        let sum = |at: &dyn Fn(isize, isize) -> i32| at(0, -1) + at(0, 1) + at(-1, 0) + at(1, 0) - 4 * at(0, 0);
        let expected = stencil(&image, border, |at| sum(at).abs());
        prop_assert_eq!(image.output(|out| laplace_into(image.view(), out, border).unwrap()), &expected[..]);
        let portable = image.output(|mut out| laplace::absolute_portable(image.view(), &mut out, border));
        prop_assert_eq!(portable, expected);
        let expected = stencil(&image, border, sum);
        let found = image.output(|out| laplace_saturated_into(image.view(), out, border).unwrap());
        prop_assert_eq!(found, &expected[..]);
        let portable = image.output(|mut out| laplace::saturated_portable(image.view(), &mut out, border));
        prop_assert_eq!(portable, expected);
    }

    #[test]
    fn sobel_is_its_definition(image in images::<1>(), border in borders(), (scale, divisor) in scales()) {
        let expected = stencil(&image, border, |at| {
            let (dx, dy) = sobel_at(at);
            (dx.abs() + dy.abs()) / divisor
        });
        let found = image.output(|out| sobel_l1_into(image.view(), out, scale, border).unwrap());
        prop_assert_eq!(found, &expected[..]);
        let portable = image.output(|mut out| sobel::portable::sums(image.view(), &mut out, scale, border));
        prop_assert_eq!(portable, expected);

        let expected = stencil(&image, border, |at| {
            let (dx, dy) = sobel_at(at);
            (f64::from(dx * dx + dy * dy).sqrt() / f64::from(divisor)).round() as i32
        });
        let found = image.output(|out| sobel_l2_into(image.view(), out, scale, border).unwrap());
        prop_assert_eq!(found, &expected[..]);
        let portable = image.output(|mut out| sobel::portable::roots(image.view(), &mut out, scale, border));
        prop_assert_eq!(portable, expected);
    }

    #[test]
    fn gaussian_is_its_definition(image in images::<1>(), size in 1_usize..4, sigma in prop::option::of(0.2..4.0)) {
        let size = 2 * size + 1;
        let kernel = match (sigma, size) {
            (Some(sigma), size) => GaussianKernel::new(size, sigma).unwrap(),
            (None, 3) => GaussianKernel::THREE,
            (None, 5) => GaussianKernel::FIVE,
            _ => GaussianKernel::SEVEN,
        };
        let reach = (size / 2) as isize;
        let weights = kernel.weights();
        let sum = u32::from(weights[0]) + 2 * weights[1..].iter().map(|&w| u32::from(w)).sum::<u32>();
        prop_assert_eq!(sum, 256);
        let expected = image.map(|x, y| {
            let mut sum = 0_u64;
            for dy in -reach..=reach {
                for dx in -reach..=reach {
                    let weight = u64::from(weights[dx.unsigned_abs()]) * u64::from(weights[dy.unsigned_abs()]);
                    sum += weight * u64::from(image.mirrored(x as isize + dx, y as isize + dy)[0]);
                }
            }
            [((sum + (1 << 15)) >> 16) as u8]
        });
        prop_assert_eq!(image.output(|out| gaussian_into(image.view(), out, kernel).unwrap()), &expected[..]);
        let portable = image.output(|mut out| match kernel {
            GaussianKernel::THREE => gaussian::three_portable(image.view(), &mut out),
            GaussianKernel::FIVE => gaussian::five_portable(image.view(), &mut out),
            kernel => gaussian::smooth_portable(image.view(), &mut out, kernel),
        });
        prop_assert_eq!(portable, expected);
    }

    #[test]
    fn threshold_is_its_definition(image in images::<1>(), threshold in any::<u8>()) {
        let expected = image.map(|x, y| [if image.at(x, y)[0] > threshold { 255 } else { 0 }]);
        prop_assert_eq!(image.output(|out| threshold_into(image.view(), out, threshold).unwrap()), &expected[..]);
        let portable = image.output(|mut out| combine::above_portable(image.view(), &mut out, threshold));
        prop_assert_eq!(portable, expected);
    }

    #[test]
    fn projections_are_sums(image in images::<1>()) {
        let (mut columns, mut rows) = (vec![7; image.width], vec![7; image.height]);
        projections_into(image.view(), &mut columns, &mut rows).unwrap();
        for (x, &sum) in columns.iter().enumerate() {
            prop_assert_eq!(sum, (0..image.height).map(|y| u32::from(image.at(x, y)[0])).sum::<u32>());
        }
        for (y, &sum) in rows.iter().enumerate() {
            prop_assert_eq!(sum, (0..image.width).map(|x| u32::from(image.at(x, y)[0])).sum::<u32>());
        }
        let (mut other_columns, mut other_rows) = (vec![9; image.width], vec![9; image.height]);
        projection::project_portable(image.view(), &mut other_columns, &mut other_rows);
        prop_assert_eq!((columns, rows), (other_columns, other_rows));
    }

    #[test]
    fn differences_are_their_definitions(image in images::<1>(), seed in any::<u64>()) {
        let mut other = image.clone();
        crate::random::Stream::new(seed).shuffle(&mut other.data);
        let expected = image.map(|x, y| [image.at(x, y)[0].abs_diff(other.at(x, y)[0])]);
        let (a, b) = (image.view(), other.view());
        prop_assert_eq!(image.output(|out| absolute_difference_into(a, b, out).unwrap()), &expected[..]);
        prop_assert_eq!(image.output(|mut out| difference::subtract_portable(a, b, &mut out)), &expected[..]);

        let mean = |from: usize, to: usize| {
            let inside = expected.iter().enumerate().filter(|(i, _)| (from..to).contains(&(i % image.width)));
            let sum: f64 = inside.map(|(_, &value)| f64::from(value)).sum();
            if from == to { 0.0 } else { sum / ((to - from) * image.height) as f64 }
        };
        let width = image.width;
        prop_assert_eq!(mean_difference(a, b).unwrap(), mean(0, width));
        prop_assert_eq!(sector_differences::<3>(a, b).unwrap(),
            [mean(0, width / 3), mean(width / 3, 2 * width / 3), mean(2 * width / 3, width)]);
        let sum = difference::sum_portable(a, b, 0, width);
        prop_assert_eq!(sum as f64, expected.iter().map(|&value| f64::from(value)).sum::<f64>());
    }

    #[test]
    fn canny_is_its_definition(image in images::<1>(), low in 0_u16..300, more in 0_u16..500) {
        let thresholds = CannyThresholds { low, high: low + more };
        let expected = naive_canny(&image, i32::from(low), i32::from(low + more));
        let mut canny = Canny::new();
        // Twice: leftovers of the first image must not affect the second.
        for _ in 0..2 {
            let found = image.output(|out| canny.find_into(image.view(), out, thresholds).unwrap());
            prop_assert_eq!(found, &expected[..]);
        }
        let portable = image.output(|mut out| canny::find_portable(image.view(), &mut out, thresholds));
        prop_assert_eq!(portable, expected);
    }

    #[test]
    fn a_region_is_an_image_of_its_own(image in images::<1>(), x in 0_usize..8, y in 0_usize..8) {
        prop_assume!(x < image.width && y < image.height);
        let (width, height) = (image.width - x, image.height - y);
        let part = image.view().region((x, y), width, height).unwrap();
        let copy: Vec<u8> = (0..height).flat_map(|row| part.row(row).to_vec()).collect();
        let mut expected = vec![0; width * height];
        let view = GrayView::new(&copy, width, height).unwrap();
        gaussian_into(view, GrayViewMut::new(&mut expected, width, height).unwrap(), GaussianKernel::FIVE).unwrap();

        let mut whole = vec![9; image.width * image.height];
        let out = GrayViewMut::new(&mut whole, image.width, image.height).unwrap();
        gaussian_into(part, out.region((x, y), width, height).unwrap(), GaussianKernel::FIVE).unwrap();
        for (place, &value) in whole.iter().enumerate() {
            let (column, row) = (place % image.width, place / image.width);
            let inside = column >= x && row >= y;
            prop_assert_eq!(value, if inside { expected[(row - y) * width + column - x] } else { 9 });
        }
    }
}

/// Canny's detector by recursion on whole images, with real-valued angles.
fn naive_canny(image: &Image<1>, low: i32, high: i32) -> Vec<u8> {
    let (width, height) = (image.width as isize, image.height as isize);
    let at = |x: isize, y: isize| {
        i32::from(image.at(x.clamp(0, width - 1) as usize, y.clamp(0, height - 1) as usize)[0])
    };
    let gradient = |x: isize, y: isize| sobel_at(&|dx, dy| at(x + dx, y + dy));
    let magnitude = |x: isize, y: isize| {
        let (dx, dy) = gradient(x, y);
        if (0..width).contains(&x) && (0..height).contains(&y) { dx.abs() + dy.abs() } else { 0 }
    };
    let tangent = 13_573.0 / 32_768.0;
    let is_candidate = |x: isize, y: isize| {
        let (dx, dy) = gradient(x, y);
        let (along, up) = (f64::from(dx.abs()), f64::from(dy.abs()));
        let here = magnitude(x, y);
        let ridge = if up < tangent * along {
            here > magnitude(x - 1, y) && here >= magnitude(x + 1, y)
        } else if up > (tangent + 2.0) * along {
            here > magnitude(x, y - 1) && here >= magnitude(x, y + 1)
        } else {
            let side = if (dx < 0) == (dy < 0) { 1 } else { -1 };
            here > magnitude(x - side, y - 1) && here > magnitude(x + side, y + 1)
        };
        here > low && ridge
    };
    let place = |x: isize, y: isize| (y * width + x) as usize;
    let mut edges = vec![0; (width * height) as usize];
    let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let mut open: Vec<(isize, isize)> =
        all.filter(|&(x, y)| is_candidate(x, y) && magnitude(x, y) > high).collect();
    while let Some((x, y)) = open.pop() {
        if (0..width).contains(&x)
            && (0..height).contains(&y)
            && edges[place(x, y)] == 0
            && is_candidate(x, y)
        {
            edges[place(x, y)] = 255;
            open.extend((-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy))));
        }
    }
    edges
}

#[test]
fn sums_of_large_bright_images_do_not_overflow() {
    let (width, height) = (4200, 300);
    let white = vec![255; width * height];
    let (mut columns, mut rows) = (vec![0; width], vec![0; height]);
    projections_into(GrayView::new(&white, width, height).unwrap(), &mut columns, &mut rows).unwrap();
    assert!(columns.iter().all(|&sum| sum == 255 * height as u32));
    assert!(rows.iter().all(|&sum| sum == 255 * width as u32));
}

#[test]
fn strips_of_wide_images_are_smoothed_alike() {
    // Whatever is cut off on the left, the right end is smoothed as before.
    const RIGHT: usize = 40;
    for width in (4090..4104).chain(8190..8200) {
        let mut stream = crate::random::Stream::new(width as u64);
        let image: Vec<u8> = (0..3 * width).map(|_| stream.bits() as u8).collect();
        let view = GrayView::new(&image, width, 3).unwrap();
        for kernel in [
            GaussianKernel::THREE,
            GaussianKernel::FIVE,
            GaussianKernel::SEVEN,
            GaussianKernel::new(7, 2.0).unwrap(),
        ] {
            let mut whole = vec![0; 3 * width];
            gaussian_into(view, GrayViewMut::new(&mut whole, width, 3).unwrap(), kernel).unwrap();
            let mut part = vec![0; 3 * RIGHT];
            let right = view.region((width - RIGHT, 0), RIGHT, 3).unwrap();
            gaussian_into(right, GrayViewMut::new(&mut part, RIGHT, 3).unwrap(), kernel).unwrap();
            for y in 0..3 {
                let (all, cut) = (&whole[y * width..][..width], &part[y * RIGHT..][..RIGHT]);
                assert_eq!(all[width - RIGHT + 3..], cut[3..], "{width} {kernel:?}");
            }
        }
    }
}

#[test]
fn differences_of_long_rows() {
    // Rows longer than 16-bit sums allow.
    for width in [65_791, 65_792, 65_793, 140_000] {
        let (white, black) = (vec![255; 2 * width], vec![0; 2 * width]);
        let rows = |data| GrayView::new(data, width, 2).unwrap();
        assert_eq!(mean_difference(rows(&white), rows(&black)).unwrap(), 255.0);
        assert_eq!(sector_differences::<1>(rows(&black), rows(&white)).unwrap(), [255.0]);
    }
}
