//! Histograms of gradients, line segments, and parallel bands.

use std::f64::consts::PI;

use proptest::prelude::*;

use super::{Image, images};
use crate::geometry::math;
use crate::random::Stream;
use crate::vision::{
    GrayView, Hog, HogParameters, HoughSegments, ImageError, LineSegment, SegmentDefinition,
    SegmentParameters, hog,
};

/// Histograms of all whole cells, by angles.
fn naive_cells(image: &Image<1>, cell: usize, bins: usize) -> Vec<Vec<u32>> {
    let (across, down) = (image.width / cell, image.height / cell);
    let mut cells = vec![vec![0; bins]; across * down];
    let at = |x: isize, y: isize| {
        let (x, y) = (x.clamp(0, image.width as isize - 1), y.clamp(0, image.height as isize - 1));
        i32::from(image.at(x as usize, y as usize)[0])
    };
    for y in 0..(down * cell) as isize {
        for x in 0..(across * cell) as isize {
            let (mut dx, mut dy) = (at(x + 1, y) - at(x - 1, y), at(x, y + 1) - at(x, y - 1));
            let magnitude = (8.0 * (f64::from(dx * dx + dy * dy) as f32).sqrt()).round() as u32;
            if dy < 0 || dy == 0 && dx < 0 {
                (dx, dy) = (-dx, -dy);
            }
            let border = |k: usize| {
                let (sin, cos) = math::sin_cos(k as f64 * PI / bins as f64);
                ((16_384.0 * sin).round() as i32, (16_384.0 * cos).round() as i32)
            };
            // A zero gradient adds nothing, whatever its bin.
            let bin = (0..bins).rev().find(|&k| border(k).1 * dy >= border(k).0 * dx).unwrap_or(0);
            cells[y as usize / cell * across + x as usize / cell][bin] += magnitude;
        }
    }
    cells
}

fn naive_hog(image: &Image<1>, parameters: HogParameters) -> Vec<f32> {
    let HogParameters { cell, block, bins } = parameters;
    let cells = naive_cells(image, cell, bins);
    let (across, down) = (image.width / cell, image.height / cell);
    let mut descriptor = Vec::new();
    for y in 0..=down - block {
        for x in 0..=across - block {
            let mut values = Vec::new();
            for cy in y..y + block {
                for cx in x..x + block {
                    values.extend(cells[cy * across + cx].iter().map(|&sum| sum as f32));
                }
            }
            let length = |values: &[f32]| values.iter().fold(0.0_f32, |sum, v| sum + v * v);
            let first = (length(&values) + 1.0).sqrt();
            let clipped: Vec<f32> = values.iter().map(|v| (v / first).min(0.2)).collect();
            let second = length(&clipped).sqrt();
            descriptor.extend(clipped.iter().map(|v| if second > 0.0 { v / second } else { 0.0 }));
        }
    }
    descriptor
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn histograms_are_their_definition(
        image in images::<1>(), cell in 2_usize..6, block in 1_usize..3, bins in 2_usize..19,
    ) {
        let parameters = HogParameters { cell, block, bins };
        let mut hog = Hog::new(parameters).unwrap();
        let fits = image.width / cell >= block && image.height / cell >= block;
        if !fits {
            let refused = matches!(hog.describe(image.view()), Err(ImageError::Size { .. }));
            prop_assert!(refused);
            return Ok(());
        }
        let expected = naive_hog(&image, parameters);
        prop_assert_eq!(hog.describe(image.view()).unwrap(), &expected[..]);
        let (across, down) = hog.blocks((image.width, image.height));
        prop_assert_eq!(expected.len(), across * down * block * block * bins);
        // Again, with the buffers of the first run.
        prop_assert_eq!(hog.describe(image.view()).unwrap(), &expected[..]);
    }

    #[test]
    fn bins_are_angles(dx in -255_i32..256, dy in -255_i32..256) {
        prop_assume!((dx, dy) != (0, 0));
        let byte = |low: i32| (low.max(0) as u8, (-low).max(0) as u8);
        let ((east, west), (south, north)) = (byte(dx), byte(dy));
        let borders: Vec<[i16; 2]> = (1..9).map(|k| {
            let (sin, cos) = math::sin_cos(f64::from(k) * PI / 9.0);
            [(16_384.0 * cos).round() as i16, (16_384.0 * sin).round() as i16]
        }).collect();
        let (mut magnitudes, mut bins) = ([0; 3], [0; 3]);
        let (above, row, below) = ([0, north, 0], [west, 0, east], [0, south, 0]);
        hog::orient_portable(&above, &row, &below, &borders, &mut magnitudes, &mut bins);
        let angle = math::atan2(f64::from(dy), f64::from(dx)).rem_euclid(PI) / PI * 9.0;
        // Angles exactly at a boundary may fall to either side.
        prop_assume!((angle - angle.round()).abs() > 1e-3 || angle == 0.0);
        prop_assert_eq!(f64::from(bins[1]), angle.floor());
        let length = 8.0 * f64::from(dx * dx + dy * dy).sqrt();
        prop_assert!((f64::from(magnitudes[1]) - length).abs() <= 0.501);
    }
}

/// Draws a line, pixel by pixel along its longer axis.
fn draw(data: &mut [u8], width: usize, line: ((i32, i32), (i32, i32))) {
    let ((x0, y0), (x1, y1)) = line;
    let steps = (x1 - x0).abs().max((y1 - y0).abs());
    for step in 0..=steps {
        let along = |a: i32, b: i32| (f64::from(a) + f64::from((b - a) * step) / f64::from(steps)).round();
        data[along(y0, y1) as usize * width + along(x0, x1) as usize] = 255;
    }
}

/// Number of steps between two pixels.
fn reach(a: (i32, i32), b: (i32, i32)) -> i32 {
    (a.0 - b.0).abs().max((a.1 - b.1).abs())
}

/// Number of voting orders.
const ORDERS: u32 = 20;

/// Fraction of a drawn segment that is found with one voting order; asserts that everything found lies on the
/// segment.
fn share_found(ends: ((i32, i32), (i32, i32)), seed: u64) -> f64 {
    let mut data = vec![0; 120 * 90];
    draw(&mut data, 120, ends);
    let definition = SegmentDefinition::Voted { seed };
    let found = find(&data, 120, SegmentParameters { threshold: 12, min_length: 10, max_gap: 3, definition });
    let pixel = |(x, y): (usize, usize)| (x as i32, y as i32);
    for line in &found {
        assert!(reach(pixel(line.from), pixel(line.to)) >= 10);
        assert!([line.from, line.to].iter().all(|end| data[end.1 * 120 + end.0] == 255));
    }
    let covered: i32 = found.iter().map(|line| reach(pixel(line.from), pixel(line.to)) + 1).sum();
    // Across gaps, parts may count twice.
    (f64::from(covered) / f64::from(reach(ends.0, ends.1) + 1)).min(1.0)
}

#[test]
fn a_bad_order_of_votes_may_miss_a_segment_that_most_orders_find() {
    for (ends, bad) in [
        (((27, 83), (102, 14)), 3_010_065_750_217_881_461),
        (((101, 76), (50, 21)), 6_334_144_914_317_158_164),
    ] {
        share_found(ends, bad);
        assert!((0..u64::from(ORDERS)).filter(|&seed| share_found(ends, seed) >= 0.5).count() > 15);
    }
}

fn find(data: &[u8], width: usize, parameters: SegmentParameters) -> Vec<LineSegment> {
    let view = GrayView::new(data, width, data.len() / width).unwrap();
    HoughSegments::new(180).unwrap().find(view, parameters)
}

#[test]
fn segments_by_opencvs_definition_are_its_own() {
    let (width, height) = (64, 48);
    let is_edge = |x: i32, y: i32| {
        x - y == 8 || (2 * y + x - 70).abs() < 2 || y == 30 || (x * x * 7 + y * 13 + x * y * 3) % 19 == 0
    };
    let pixel = |i: i32| u8::from(is_edge(i % width, i / width));
    let data: Vec<u8> = (0..width * height).map(pixel).collect();
    let lines = |threshold, min_length, max_gap| {
        let definition = SegmentDefinition::OpenCv;
        let found = find(&data, 64, SegmentParameters { threshold, min_length, max_gap, definition });
        found.iter().map(|s| [s.from.0, s.from.1, s.to.0, s.to.1]).collect::<Vec<_>>()
    };
    // Results of `HoughLinesP` with the same parameters.
    assert_eq!(lines(14, 12, 2), [[1, 34, 63, 4], [11, 30, 63, 30], [8, 0, 55, 47], [0, 35, 27, 22]]);
    let shorter = [[4, 32, 63, 4], [10, 30, 63, 30], [8, 0, 55, 47], [42, 13, 62, 4], [12, 29, 27, 22]];
    assert_eq!(lines(10, 8, 1), shorter);
}

#[test]
fn lines_at_one_of_the_angles_are_found() {
    for ends in [((10, 10), (90, 10)), ((10, 5), (10, 80)), ((10, 10), (80, 80))] {
        let mut data = vec![0; 120 * 90];
        draw(&mut data, 120, ends);
        let found = find(
            &data,
            120,
            SegmentParameters {
                threshold: 25,
                min_length: 40,
                max_gap: 3,
                definition: SegmentDefinition::default(),
            },
        );
        assert!(!found.is_empty(), "{ends:?}");
    }
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn what_is_found_of_a_segment_lies_on_it(ends in [5_i32..115, 5..85, 5..115, 5..85], seed: u64) {
        let ends = ((ends[0], ends[1]), (ends[2], ends[3]));
        prop_assume!(reach(ends.0, ends.1) >= 40);
        // Twelve pixels close together determine the angle poorly: such lines are followed only a short way,
        // leave the vote and form no segment. On average over voting orders, most of the segment is found.
        let mut stream = Stream::new(seed);
        let shares = (0..ORDERS).map(|_| share_found(ends, stream.bits()));
        let mean = shares.sum::<f64>() / f64::from(ORDERS);
        prop_assert!(mean >= 0.5, "{}", mean);
    }

    #[test]
    fn segments_reach_from_edge_to_edge_and_keep_to_their_limits(
        density in 0.0..0.3f64, threshold in 3_u32..12, min_length in 0_usize..12, max_gap in 0_usize..5, seed: u64,
        opencv: bool,
    ) {
        let mut stream = Stream::new(seed);
        let data: Vec<u8> = (0..50 * 40).map(|_| u8::from(stream.chance(density))).collect();
        let definition = if opencv { SegmentDefinition::OpenCv } else { SegmentDefinition::Voted { seed } };
        let parameters = SegmentParameters { threshold, min_length, max_gap, definition };
        let found = find(&data, 50, parameters);
        prop_assert_eq!(&found, &find(&data, 50, parameters));
        for line in found {
            let reach = line.from.0.abs_diff(line.to.0).max(line.from.1.abs_diff(line.to.1));
            prop_assert!(reach >= min_length);
            for (x, y) in [line.from, line.to] {
                prop_assert!(data[y * 50 + x] != 0);
            }
        }
    }
}

#[test]
fn two_crossing_segments_and_a_gap() {
    let mut data = vec![0; 100 * 100];
    draw(&mut data, 100, ((10, 50), (90, 50)));
    draw(&mut data, 100, ((50, 10), (50, 90)));
    let parameters = SegmentParameters {
        threshold: 30,
        min_length: 40,
        max_gap: 2,
        definition: SegmentDefinition::default(),
    };
    let found = find(&data, 100, parameters);
    assert_eq!(found.len(), 2, "{found:?}");
    // A gap that is too wide splits a line.
    let mut parted = vec![0; 100 * 100];
    draw(&mut parted, 100, ((5, 20), (45, 20)));
    draw(&mut parted, 100, ((55, 20), (95, 20)));
    let lines = |max_gap| find(&parted, 100, SegmentParameters { max_gap, ..parameters }).len();
    assert_eq!((lines(8), lines(9)), (2, 1));
}

#[test]
fn parameters_out_of_range() {
    assert!(HoughSegments::new(0).is_err());
    for (cell, block, bins) in [(1, 2, 9), (8, 0, 9), (8, 2, 1), (8, 2, 99), (65, 2, 9)] {
        assert!(Hog::new(HogParameters { cell, block, bins }).is_err());
    }
}

#[cfg(feature = "rayon")]
mod bands {
    use super::super::images;
    use crate::vision::{
        Border, GaussianKernel, GrayWeights, gaussian_into, gray_into, in_bands, laplace_into,
    };
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn bands_change_nothing(image in images::<1>(), rgb in images::<3>(), rows in 1_usize..20) {
            // Taller images, so that there is more than one band.
            let mut tall = image.clone();
            tall.height *= rows;
            tall.data = image.data.repeat(rows);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
            let kernel = GaussianKernel::new(7, 1.5).unwrap();
            let (laplace, smooth, gray) = pool.install(|| {
                let laplace = tall.output(|out| {
                    in_bands(tall.view(), out, 1, |a, b| laplace_into(a, b, Border::Mirror)).unwrap();
                });
                let smooth = tall.output(|out| {
                    in_bands(tall.view(), out, 3, |a, b| gaussian_into(a, b, kernel)).unwrap();
                });
                let gray = rgb.output(|out| {
                    in_bands(rgb.view(), out, 0, |a, b| gray_into(a, b, GrayWeights::Rec601)).unwrap();
                });
                (laplace, smooth, gray)
            });
            prop_assert_eq!(laplace, tall.output(|out| laplace_into(tall.view(), out, Border::Mirror).unwrap()));
            prop_assert_eq!(smooth, tall.output(|out| gaussian_into(tall.view(), out, kernel).unwrap()));
            prop_assert_eq!(gray, rgb.output(|out| gray_into(rgb.view(), out, GrayWeights::Rec601).unwrap()));
        }
    }
}
