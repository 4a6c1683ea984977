//! A lesson: images pass to the crate `imageproc` and back without a copy.
//!
//! Both work on the images of the crate `image`. What `imageproc` returns is viewed in place by the kernels of
//! `roverlab::vision`, and their masks go to `imageproc` as they are.

use image::{GrayImage, Luma};
use imageproc::region_labelling::{Connectivity, connected_components};
use proptest::prelude::*;
use roverlab::geometry::Pose;
use roverlab::io::Camera;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::vision::{GrayView, GrayViewMut, GrayWeights, images, threshold_into};
use roverlab::world::{RobotSpec, Scene, World};

#[test]
fn a_camera_image_goes_through_both_libraries() {
    let scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(0.5, 1.0, 0.3));
    let simulation = Simulation::new(&scene, SimOptions::ideal()).unwrap();
    let photo = simulation.robot(0).unwrap().image().unwrap();

    let gray = images::gray(&photo, GrayWeights::Robios).unwrap();
    // imageproc takes the image by reference and returns one of the same type.
    let mut smooth = imageproc::filter::median_filter(&gray, 1, 1);
    assert_eq!(smooth.dimensions(), photo.dimensions());

    // Back: the view borrows the pixels where imageproc has left them, and a kernel may write there too.
    let place = smooth.as_raw().as_ptr();
    assert_eq!(GrayView::try_from(&smooth).unwrap().row(0).as_ptr(), place);
    let view = GrayViewMut::try_from(&mut smooth).unwrap();
    threshold_into(GrayView::try_from(&gray).unwrap(), view, 128).unwrap();
    assert_eq!(smooth.as_raw().as_ptr(), place);
    assert!(smooth.pixels().all(|pixel| [0, 255].contains(&pixel.0[0])));
}

proptest! {
    #![proptest_config(roverlab::testing::cases(64))]
    #[test]
    fn both_find_the_same_blobs(width in 1..40_u32, height in 1..40_u32, seed in any::<u64>()) {
        let mut random = roverlab::random::Stream::new(seed);
        let mask = GrayImage::from_fn(width, height, |_, _| Luma([if random.chance(0.4) { 255 } else { 0 }]));
        let mut areas: Vec<usize> = images::blobs(&mask, 1).unwrap().iter().map(|blob| blob.area).collect();
        let labels = connected_components(&mask, Connectivity::Eight, Luma([0]));
        let last = labels.pixels().map(|label| label.0[0]).max().unwrap_or(0) as usize;
        let mut theirs = vec![0; last];
        labels.pixels().filter(|label| label.0[0] > 0).for_each(|label| theirs[label.0[0] as usize - 1] += 1);
        areas.sort_unstable();
        theirs.sort_unstable();
        prop_assert_eq!(areas, theirs);
    }
}
