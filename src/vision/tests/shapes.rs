//! Lines and blobs.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::f64::consts::PI;

use proptest::prelude::*;

use super::{Image, images};
use crate::geometry::math;
use crate::vision::{Blob, Components, GrayView, HoughLine, HoughLines, maximum};

/// Blobs found by flood fill from each pixel.
fn naive_blobs(image: &Image<1>, min_area: usize) -> Vec<Blob> {
    let mut seen = vec![false; image.width * image.height];
    let mut blobs = Vec::new();
    for start in 0..seen.len() {
        let mut open = vec![start];
        let mut pixels = Vec::new();
        while let Some(place) = open.pop() {
            let (x, y) = (place % image.width, place / image.width);
            if seen[place] || image.at(x, y)[0] == 0 {
                continue;
            }
            seen[place] = true;
            pixels.push((x, y));
            for next_y in y.saturating_sub(1)..(y + 2).min(image.height) {
                for next_x in x.saturating_sub(1)..(x + 2).min(image.width) {
                    open.push(next_y * image.width + next_x);
                }
            }
        }
        if !pixels.is_empty() && pixels.len() >= min_area {
            let (xs, ys) = (pixels.iter().map(|p| p.0), pixels.iter().map(|p| p.1));
            let area = pixels.len() as f64;
            blobs.push(Blob {
                area: pixels.len(),
                min: (xs.clone().min().unwrap(), ys.clone().min().unwrap()),
                max: (xs.clone().max().unwrap(), ys.clone().max().unwrap()),
                centroid: (xs.sum::<usize>() as f64 / area, ys.sum::<usize>() as f64 / area),
            });
        }
    }
    blobs
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn blobs_are_what_flooding_finds(image in images::<1>(), density in 1_u8..255, min_area in 0_usize..6) {
        let mut mask = image;
        mask.data.iter_mut().for_each(|byte| *byte = u8::from(*byte > density));
        let mut components = Components::new();
        prop_assert_eq!(components.find(mask.view(), min_area), &naive_blobs(&mask, min_area)[..]);
        // Again, with the buffers of the first run.
        prop_assert_eq!(components.find(mask.view(), 0), &naive_blobs(&mask, 0)[..]);
        let largest = components.largest(mask.view(), 0).map(|blob| blob.area);
        prop_assert_eq!(largest, naive_blobs(&mask, 0).iter().map(|blob| blob.area).max());
    }

    #[test]
    fn a_line_is_found_where_it_was_drawn(angle in 0_usize..180, rho in -30_i32..60) {
        let (theta, rho) = (PI * angle as f64 / 180.0, f64::from(rho));
        let (sin, cos) = math::sin_cos(theta);
        let (width, height) = (80, 60);
        let near = |x: usize, y: usize| (x as f64 * cos + y as f64 * sin - rho).abs() < 0.5;
        let data: Vec<u8> = (0..width * height).map(|i| u8::from(near(i % width, i / width))).collect();
        prop_assume!(data.iter().filter(|&&pixel| pixel > 0).count() >= 30);
        let lines = HoughLines::new(1.0, 180).unwrap().find(GrayView::new(&data, width, height).unwrap(), 10);
        let found = lines[0];
        // A line has two representations: the other one is half a turn away, with opposite sign.
        let turn = (found.theta - theta).abs();
        let (turn, side) = if turn > 1.5 { (PI - turn, -found.rho) } else { (turn, found.rho) };
        prop_assert!(turn < 0.07 && (side - rho).abs() <= 3.0, "{:?} for {} {}", found, theta, rho);
        prop_assert!(lines.windows(2).all(|pair| pair[0].votes >= pair[1].votes));
    }
}

/// All peaks of the votes, counted pixel by pixel and angle by angle.
fn naive_lines(edges: &Image<1>, rho: f64, angles: usize, threshold: u32) -> Vec<HoughLine> {
    let votes = |angle: usize| -> BTreeMap<i32, u32> {
        let mut votes = BTreeMap::new();
        // Steps are accumulated in single precision.
        let step = (PI / angles as f64) as f32;
        let (sin, cos) = math::sin_cos(f64::from((0..angle).fold(0.0_f32, |sum, _| sum + step)));
        let [cos, sin] = [cos, sin].map(|part| (part * f64::from(1.0 / rho as f32)) as f32);
        for (x, y) in (0..edges.height).flat_map(|y| (0..edges.width).map(move |x| (x, y))) {
            if edges.at(x, y)[0] > 0 {
                let place = (x as f32 * cos + y as f32 * sin).round_ties_even() as i32;
                *votes.entry(place).or_insert(0) += 1;
            }
        }
        votes
    };
    let mut lines = Vec::new();
    let none = BTreeMap::new();
    let all: Vec<BTreeMap<i32, u32>> = (0..angles).map(votes).collect();
    for angle in 0..angles {
        let row = |angle: Option<usize>| angle.and_then(|angle| all.get(angle)).unwrap_or(&none);
        let at = |votes: &BTreeMap<i32, u32>, place: i32| votes.get(&place).copied().unwrap_or(0);
        let (before, after) = (row(angle.checked_sub(1)), row(Some(angle + 1)));
        for (&place, &votes) in &all[angle] {
            let larger = votes > at(&all[angle], place - 1) && votes > at(before, place);
            let as_large = votes >= at(&all[angle], place + 1) && votes >= at(after, place);
            if votes > threshold && larger && as_large {
                let theta = PI * angle as f64 / angles as f64;
                lines.push(HoughLine { rho: f64::from(place) * rho, theta, votes });
            }
        }
    }
    lines.sort_by_key(|line| Reverse(line.votes));
    lines
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn lines_are_the_peaks_of_all_votes(
        image in images::<1>(), density in 100_u8..255, threshold in 0_u32..6, angles in 1_usize..40,
        rho in prop_oneof![Just(1.0), Just(0.5), Just(0.7), Just(2.5)],
    ) {
        let mut edges = image;
        edges.data.iter_mut().for_each(|byte| *byte = u8::from(*byte > density));
        let found = HoughLines::new(rho, angles).unwrap().find(edges.view(), threshold);
        prop_assert_eq!(found, naive_lines(&edges, rho, angles, threshold));
    }
}

#[test]
fn the_first_maximum_counts() {
    // The columns of the book's figure 11.9.
    assert_eq!(maximum(&[0, 3, 3, 3, 1, 2, 0, 0]), Some((1, 3)));
    assert_eq!(maximum(&[0, 0]), None);
    assert_eq!(maximum(&[]), None);
}
