use image::GrayImage;
use proptest::prelude::*;

use super::*;
use crate::random::Stream;
use crate::vision::{GrayView, ImageError};

fn view(image: &GrayImage) -> GrayView<'_> {
    image.try_into().unwrap()
}

fn detector() -> MotionDetector {
    MotionDetector::new(MotionParameters::default()).unwrap()
}

/// A smooth pattern with camera noise, at a given brightness.
fn hills(light: f64, seed: u64) -> GrayImage {
    let mut stream = Stream::new(seed);
    GrayImage::from_fn(160, 120, |x, y| {
        let shade = 90.0 + f64::from((x / 20 + y / 15) % 4) * 25.0;
        let noise = 2.0 * (shade / 255.0).sqrt() * stream.normal();
        image::Luma([(light * shade + noise).round().clamp(0.0, 255.0) as u8])
    })
}

proptest! {
    #![proptest_config(crate::testing::cases(40))]

    #[test]
    fn noise_and_exposure_are_no_motion(seed in 0..1_000_000_u64, light in 0.9..1.1f64) {
        let motion = detector().compare(view(&hills(1.0, seed)), view(&hills(light, seed + 1))).unwrap();
        prop_assert!(!motion.is_moving(), "{:?}", motion);
    }

    #[test]
    fn a_thing_that_appears_is_motion_in_its_sector(x in 0_u32..148, y in 0_u32..108, seed in 0..1_000_000_u64) {
        let (before, mut after) = (hills(1.0, seed), hills(1.0, seed + 1));
        for dy in 0..12 {
            for dx in 0..12 {
                after.put_pixel(x + dx, y + dy, image::Luma([250]));
            }
        }
        let motion = detector().compare(view(&before), view(&after)).unwrap();
        // If the object lies across two sectors, either is right.
        let sector = |x: u32| (3 * x / 160) as usize;
        let strongest = motion.strongest.unwrap();
        prop_assert!((sector(x.saturating_sub(8))..=sector((x + 19).min(159))).contains(&strongest));
        let expected = crate::vision::mean_difference(view(&before), view(&after)).unwrap();
        prop_assert_eq!(motion.mean_difference, expected);
    }

    #[test]
    fn any_size_has_an_answer(width in 1_u32..40, height in 1_u32..30, block in 2_usize..12) {
        let image = GrayImage::from_fn(width, height, |x, y| image::Luma([(7 * x + 13 * y) as u8]));
        let parameters = MotionParameters { block, ..MotionParameters::default() };
        let motion = MotionDetector::new(parameters).unwrap().compare(view(&image), view(&image)).unwrap();
        prop_assert_eq!(motion.sectors, [0.0; 3]);
        prop_assert!(!motion.is_moving());
    }
}

#[test]
fn parameters_out_of_range() {
    for (block, threshold, least_noise) in
        [(1, 6.0, 1.0), (8, f64::NAN, 1.0), (8, -1.0, 1.0), (8, 6.0, 0.0), (999, 6.0, 1.0)]
    {
        assert!(MotionDetector::new(MotionParameters { block, threshold, least_noise }).is_err());
    }
    assert!(TurnCompensator::new(0.0).is_err());
    let (a, b) = (GrayImage::new(4, 4), GrayImage::new(4, 5));
    assert!(matches!(detector().compare(view(&a), view(&b)), Err(ImageError::Size { .. })));
}
