//! Published maps with known numbers of cells, and pictures with known edges. They are no part of the
//! project: the environment variable `ROVERLAB_DATA` names the folder that holds `ros_maps/` and `images/`.

use std::fs;
use std::path::{Path, PathBuf};

use image::GrayImage;
use roverlab::vision::{self, Border, Canny, CannyThresholds, GaussianKernel, SobelScale};
use roverlab::world::Occupancy;
use roverlab::world::formats::{load_scene, ros_map};

fn published(folder: &str) -> PathBuf {
    let data = std::env::var_os("ROVERLAB_DATA").expect("ROVERLAB_DATA names the folder of published data");
    Path::new(&data).join(folder)
}

#[test]
#[ignore = "needs published data: ROVERLAB_DATA=FOLDER .ci/run tests"]
fn cells_are_counted_as_published() {
    let folder = published("ros_maps");
    let table = fs::read_to_string(folder.join("cell_counts.csv")).unwrap();
    let mut compared = 0;
    for line in table.lines().skip(1) {
        let columns: Vec<&str> = line.split(',').collect();
        let path = folder.join(columns[0]);
        if !path.exists() {
            continue;
        }
        let map = ros_map::load(&path).unwrap().value;
        let grid = &map.grid;
        let number = |index: usize| columns[index].parse::<usize>().unwrap();
        assert_eq!((grid.width(), grid.height()), (number(2), number(3)), "{line}");
        let counts = [Occupancy::Occupied, Occupancy::Free, Occupancy::Unknown].map(|cell| grid.count(cell));
        assert_eq!(counts, [number(6), number(7), number(8)], "{line}");
        assert_eq!(grid.resolution(), columns[4].parse::<f64>().unwrap(), "{line}");
        assert!(load_scene(&path).is_ok());
        compared += 1;
    }
    assert!(compared >= 10, "only {compared} maps");
}

#[test]
#[ignore = "needs published data: ROVERLAB_DATA=FOLDER .ci/run tests"]
fn the_test_map_of_the_map_server_is_read_cell_by_cell() {
    let folder = published("ros_maps");
    let folder = folder.join("nav2/nav2_map_server/test");
    let expected = fs::read_to_string(folder.join("testmap_expected.txt")).unwrap();
    let expected: Vec<u8> = expected
        .lines()
        .filter(|line| !line.starts_with('#'))
        .flat_map(|line| line.split_whitespace().map(|cell| cell.parse().unwrap()))
        .collect();
    let yaml = fs::read_to_string(folder.join("testmap.yaml")).unwrap();
    for image in ["testmap.png", "testmap.pgm", "testmap.bmp"] {
        let yaml = yaml.replace("testmap.png", image);
        let name = folder.join("testmap.yaml").display().to_string();
        let mut files = roverlab::world::formats::DiskFiles::with_home(None);
        let grid = ros_map::parse(&yaml, &name, &mut files).unwrap().value.grid;
        let found: Vec<u8> = (0..100).filter_map(|i| grid.occupancy(i % 10, i / 10)).collect();
        assert_eq!(found, expected, "{image}");
        assert_eq!((grid.origin().x, grid.origin().y, grid.origin().heading), (2.0, 3.0, 1.0));
    }
}

#[test]
#[ignore = "needs published data: ROVERLAB_DATA=FOLDER .ci/run tests"]
fn a_missing_image_is_named_where_the_map_names_it() {
    let folder = published("ros_maps");
    let error = load_scene(folder.join("nav2/nav2_system_tests/maps/empty_room.yaml")).unwrap_err();
    assert_eq!((error.line, error.column), (1, 8));
    assert_eq!(error.found, "`empty.pgm`, which does not exist");
}

/// imageproc's pictures: one that it was given, and what it made of it.
fn pictures(name: &str, made: &str) -> (GrayImage, GrayImage) {
    let folder = published("images/imageproc/tests/data");
    let open = |name: &str| image::open(folder.join(name)).unwrap();
    let colour = open(name).into_rgb8();
    // Rec. 709, rounded down: how the pictures were made gray.
    let gray = GrayImage::from_fn(colour.width(), colour.height(), |x, y| {
        let [red, green, blue] = colour.get_pixel(x, y).0.map(u32::from);
        image::Luma([((2126 * red + 7152 * green + 722 * blue) / 10_000) as u8])
    });
    (gray, open(&format!("truth/{made}")).into_luma8())
}

#[test]
#[ignore = "needs published data: ROVERLAB_DATA=FOLDER .ci/run tests"]
fn gradients_are_those_of_imageproc_but_for_rounding() -> Result<(), vision::ImageError> {
    let (elephant, truth) = pictures("elephant.png", "elephant_gradients.png");
    let mut found = elephant.clone();
    vision::sobel_l2_into(
        (&elephant).try_into()?,
        (&mut found).try_into()?,
        SobelScale::Full,
        Border::Mirror,
    )?;
    // imageproc rounds down, and continues the image by its outermost pixels.
    let (width, height) = truth.dimensions();
    let inner = truth
        .enumerate_pixels()
        .filter(|(x, y, _)| (1..width - 1).contains(x) && (1..height - 1).contains(y));
    let far = inner.filter(|(x, y, shade)| {
        !(0..=1).contains(&(i16::from(found[(*x, *y)].0[0]) - i16::from(shade.0[0])))
    });
    let far = far.count();
    assert!(far < 300, "{far} pixels");
    Ok(())
}

#[test]
#[ignore = "needs published data: ROVERLAB_DATA=FOLDER .ci/run tests"]
fn edges_are_those_of_imageproc() -> Result<(), vision::ImageError> {
    let (zebra, truth) = pictures("zebra.png", "zebra_canny.png");
    let (mut smooth, mut found) = (zebra.clone(), zebra.clone());
    let kernel = GaussianKernel::new(7, 1.4)?;
    vision::gaussian_into((&zebra).try_into()?, (&mut smooth).try_into()?, kernel)?;
    // Its thresholds of 250 and 300 are of the gradient's length; ours are of |dx| + |dy|, in the mean 4 / pi
    // of it.
    let thresholds = CannyThresholds { low: 318, high: 382 };
    Canny::new().find_into((&smooth).try_into()?, (&mut found).try_into()?, thresholds)?;
    for (ours, theirs) in [(&found, &truth), (&truth, &found)] {
        let edges: Vec<(u32, u32)> =
            ours.enumerate_pixels().filter(|pixel| pixel.2.0[0] > 0).map(|(x, y, _)| (x, y)).collect();
        let is_near = |&&(x, y): &&(u32, u32)| {
            let columns = x.saturating_sub(1)..(x + 2).min(theirs.width());
            columns
                .flat_map(|x| (y.saturating_sub(1)..(y + 2).min(theirs.height())).map(move |y| (x, y)))
                .any(|place| theirs[place].0[0] > 0)
        };
        let near = edges.iter().filter(is_near).count();
        assert!(near * 100 >= edges.len() * 93, "{near} of {}", edges.len());
    }
    Ok(())
}
