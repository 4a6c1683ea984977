//! Lines and blobs.

use proptest::prelude::*;

use super::{Image, images};
use crate::geometry::math;
use crate::vision::{Blob, Components, GrayView, HoughLines, maximum};

/// Blobs by flooding from each pixel in turn.
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
    #[test]
    fn blobs_are_what_flooding_finds(image in images::<1>(), density in 1_u8..255, min_area in 0_usize..6) {
        let mut mask = image;
        mask.data.iter_mut().for_each(|byte| *byte = u8::from(*byte > density));
        let mut components = Components::new();
        prop_assert_eq!(components.find(mask.view(), min_area), &naive_blobs(&mask, min_area)[..]);
        // Again, with what the first time left behind.
        prop_assert_eq!(components.find(mask.view(), 0), &naive_blobs(&mask, 0)[..]);
        let largest = components.largest(mask.view(), 0).map(|blob| blob.area);
        prop_assert_eq!(largest, naive_blobs(&mask, 0).iter().map(|blob| blob.area).max());
    }

    #[test]
    fn a_line_is_found_where_it_was_drawn(angle in 0_usize..180, rho in -30_i32..60) {
        let (theta, rho) = (std::f64::consts::PI * angle as f64 / 180.0, f64::from(rho));
        let (sin, cos) = math::sin_cos(theta);
        let (width, height) = (80, 60);
        let near = |x: usize, y: usize| (x as f64 * cos + y as f64 * sin - rho).abs() < 0.5;
        let data: Vec<u8> = (0..width * height).map(|i| u8::from(near(i % width, i / width))).collect();
        prop_assume!(data.iter().filter(|&&pixel| pixel > 0).count() >= 30);
        let lines = HoughLines::new(1.0, 180).unwrap().find(GrayView::new(&data, width, height).unwrap(), 10);
        let found = lines[0];
        // The same line has a second form: from the other side, half a turn away.
        let turn = (found.theta - theta).abs();
        let (turn, side) = if turn > 1.5 { (std::f64::consts::PI - turn, -found.rho) } else { (turn, found.rho) };
        prop_assert!(turn < 0.07 && (side - rho).abs() <= 3.0, "{:?} for {} {}", found, theta, rho);
        prop_assert!(lines.windows(2).all(|pair| pair[0].votes >= pair[1].votes));
    }

    #[test]
    fn votes_are_counts(image in images::<1>(), density in 128_u8..255, threshold in 0_u32..4) {
        let mut edges = image;
        edges.data.iter_mut().for_each(|byte| *byte = u8::from(*byte > density));
        let lines = HoughLines::new(1.0, 36).unwrap().find(edges.view(), threshold);
        // A pixel has a line with a vote of its own; the largest of all is a peak.
        let any = (0..edges.height).any(|y| (0..edges.width).any(|x| edges.at(x, y)[0] > 0));
        prop_assert!(threshold > 0 || lines.is_empty() != any);
        for line in lines {
            let (sin, cos) = math::sin_cos(line.theta);
            // Pixels right between two lines may count for either.
            let within = |reach: f64| {
                let near = |x: usize, y: usize| (x as f64 * cos + y as f64 * sin - line.rho).abs() < reach;
                let on = |y: usize| (0..edges.width).filter(|&x| edges.at(x, y)[0] > 0 && near(x, y)).count();
                (0..edges.height).map(on).sum::<usize>()
            };
            prop_assert!((within(0.4999)..=within(0.5001)).contains(&(line.votes as usize)));
            prop_assert!(line.votes > threshold);
        }
    }
}

#[test]
fn the_first_maximum_counts() {
    // The columns of the book's figure 11.9.
    assert_eq!(maximum(&[0, 3, 3, 3, 1, 2, 0, 0]), Some((1, 3)));
    assert_eq!(maximum(&[0, 0]), None);
    assert_eq!(maximum(&[]), None);
}
