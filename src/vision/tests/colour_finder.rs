//! Detection of a colour and of its position on the floor.

use image::{Rgb, RgbImage};
use proptest::prelude::*;

use crate::geometry::{Point, math};
use crate::vision::{CameraGeometry, ColourFinder, FindMethod, HueLimits, teach_hue};
use crate::world::{CameraSpec, RobotSpec};

fn camera() -> CameraGeometry {
    CameraGeometry::from(&RobotSpec::s4().camera.unwrap())
}

fn finder(method: FindMethod) -> ColourFinder {
    ColourFinder::new(42, 10, method, camera()).unwrap()
}

/// A gray image with a red rectangle.
fn red_at(columns: std::ops::Range<u32>, rows: std::ops::Range<u32>) -> RgbImage {
    RgbImage::from_fn(160, 120, |x, y| {
        if columns.contains(&x) && rows.contains(&y) { Rgb([180, 10, 12]) } else { Rgb([140, 140, 136]) }
    })
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn both_methods_find_the_middle(left in 0_u32..150, top in 0_u32..100, width in 4_u32..40, height in 6_u32..40) {
        let (right, bottom) = ((left + width).min(160), (top + height).min(120));
        prop_assume!(right - left >= 4);
        let image = red_at(left..right, top..bottom);
        for method in [FindMethod::Histogram, FindMethod::Blob] {
            let found = finder(method).find(&image).unwrap().unwrap();
            prop_assert_eq!(found.columns, (left as usize, right as usize - 1));
            prop_assert_eq!(found.column, f64::from(left + right - 1) / 2.0);
            let column = 79.5 - math::tan(found.bearing) * camera().focal(160);
            prop_assert!((column - found.column).abs() < 1e-9);
        }
        prop_assert!(finder(FindMethod::Blob).find(&RgbImage::from_pixel(160, 120, Rgb([90; 3]))).unwrap().is_none());
    }

    #[test]
    fn a_foot_on_the_floor_tells_the_place(x in 0.15..3.0f64, aside in -0.5..0.5f64) {
        let place = Point::new(camera().ahead + x, aside * x);
        let focal = camera().focal(320);
        let (column, row) = (159.5 - focal * aside, 119.5 + focal * camera().height / x);
        let found = camera().floor(column, row, (320, 240));
        if row > 120.5 {
            prop_assert!((found.unwrap() - place).norm() < 1e-9);
        }
        prop_assert!(camera().floor(column, 119.0, (320, 240)).is_none());
    }

    #[test]
    fn a_hue_is_taught_in_any_light(hue in 0_u32..6, light in 40_u32..256) {
        let corner = |on: u32| if on & 1 == 1 { light as u8 } else { 0 };
        // Red, yellow, green, cyan, blue, magenta.
        let mix = [0b001, 0b011, 0b010, 0b110, 0b100, 0b101][hue as usize];
        let image = RgbImage::from_pixel(160, 120, Rgb([corner(mix), corner(mix >> 1), corner(mix >> 2)]));
        let taught = teach_hue(&image, ColourFinder::LIMITS).unwrap().unwrap();
        prop_assert_eq!(u32::from(taught), (42 + 42 * hue) % 252);
    }
}

#[test]
fn gray_teaches_nothing() {
    let gray = RgbImage::from_pixel(160, 120, Rgb([120, 121, 120]));
    assert_eq!(teach_hue(&gray, HueLimits { min_saturation: 40, min_intensity: 6 }).unwrap(), None);
    assert!(teach_hue(&RgbImage::default(), ColourFinder::LIMITS).is_err());
    assert!(finder(FindMethod::Blob).find(&RgbImage::default()).is_err());
}

#[test]
fn a_camera_spec_gives_its_geometry() {
    let spec = CameraSpec { field_of_view: 1.0, ..RobotSpec::s4().camera.unwrap() };
    let geometry = CameraGeometry::from(&spec);
    assert_eq!((geometry.field_of_view, geometry.height, geometry.ahead), (1.0, 0.060, 0.062));
}
