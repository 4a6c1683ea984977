use image::{Rgb, RgbImage};

use super::driver::wanted;
use super::{NetworkDriver, see_road_into};
use crate::vision::network::{Architecture, MapSize, Network};

const SIZE: MapSize = MapSize { height: 8, width: 16, channels: 1 };

/// A picture with a bright column, in a light.
fn picture(column: u32, light: f64) -> RgbImage {
    RgbImage::from_fn(160, 120, |x, _| Rgb([(light * if x / 10 == column { 200.0 } else { 60.0 }) as u8; 3]))
}

#[test]
fn the_light_does_not_matter() {
    let [mut dark, mut bright] = [vec![0.0; SIZE.len()], vec![0.0; SIZE.len()]];
    see_road_into(&picture(5, 0.5), SIZE, &mut dark).unwrap();
    see_road_into(&picture(5, 1.0), SIZE, &mut bright).unwrap();
    assert!(dark.iter().zip(&bright).all(|(dark, bright)| (dark - bright).abs() < 1e-3));
    let brightest = (0..16).max_by(|&a, &b| bright[a].total_cmp(&bright[b])).unwrap();
    assert_eq!(brightest, 5);
    let mean = bright.iter().sum::<f32>() / bright.len() as f32;
    assert!(mean.abs() < 1e-4, "{mean}");
    see_road_into(&RgbImage::new(160, 120), SIZE, &mut dark).unwrap();
    assert!(dark.iter().all(|value| *value == 0.0), "the dark is no error, and no number is made up");
}

#[test]
fn pictures_that_are_too_small_are_refused() {
    let mut values = vec![0.0; SIZE.len()];
    for (width, height) in [(0, 0), (15, 120), (160, 9)] {
        assert!(see_road_into(&RgbImage::new(width, height), SIZE, &mut values).is_err(), "{width} {height}");
    }
    assert!(see_road_into(&picture(1, 1.0), MapSize { channels: 2, ..SIZE }, &mut values).is_err());
    assert!(see_road_into(&picture(1, 1.0), SIZE, &mut values[1..]).is_err());
}

/// A network whose constants are its results.
fn constant(results: Vec<f32>) -> Network {
    let architecture: Architecture = format!("8x16x1 dense{}", results.len()).parse().unwrap();
    Network::new(architecture, vec![(vec![0.0; 128 * results.len()], results)]).unwrap()
}

#[test]
fn classes_stand_for_curvatures_as_they_were_learned() {
    for curvature in [-2.5, -2.0, -1.3, -0.1, 0.0, 0.7, 1.9, 2.0, 3.0] {
        let part = wanted(curvature, 1);
        let mut driver = NetworkDriver::new(constant(vec![part]), 1.0).unwrap();
        let meant: f64 = f64::clamp(curvature, -2.0, 2.0);
        assert!((driver.steer(&picture(3, 1.0)).unwrap() - meant).abs() < 1e-6);
        let mut classes = vec![0.0; 10];
        classes[wanted(curvature, 10) as usize] = 1.0;
        let mut driver = NetworkDriver::new(constant(classes), 1.0).unwrap();
        assert!((driver.steer(&picture(3, 1.0)).unwrap() - meant).abs() <= 0.2 + 1e-9, "{curvature}");
    }
    assert!(NetworkDriver::new(constant(vec![0.0]), 0.0).is_err());
}
