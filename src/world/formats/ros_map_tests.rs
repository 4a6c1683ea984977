use std::collections::BTreeMap;

use image::{DynamicImage, GrayAlphaImage, RgbaImage};
use proptest::prelude::*;

use super::*;
use crate::world::Occupancy;
use crate::world::formats::MemoryFiles;

/// A PGM with one row.
fn row(pixels: &[u8]) -> Vec<u8> {
    [format!("P5\n# made by hand\n{} 1\n255\n", pixels.len()).as_bytes(), pixels].concat()
}

fn read(yaml: &str, image: Vec<u8>) -> Result<Parsed<RosMap>, FormatError> {
    parse(yaml, "m.yaml", &mut MemoryFiles(BTreeMap::from([("m.pgm".into(), image)])))
}

fn occupancies(extra: &str, image: Vec<u8>) -> Vec<Option<u8>> {
    let yaml = format!("image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n{extra}\n");
    let grid = read(&yaml, image).unwrap().value.grid;
    (0..grid.width()).map(|column| grid.occupancy(column, 0)).collect()
}

fn png(image: impl Into<DynamicImage>) -> Vec<u8> {
    let mut bytes = Vec::new();
    image.into().write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png).unwrap();
    bytes
}

#[test]
fn trinary_compares_with_both_thresholds() {
    let thresholds = "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196";
    // 89 is p = 0.651, 90 is 0.647; 205 is 0.19608, 206 is 0.192.
    let pixels = row(&[0, 89, 90, 205, 206, 255]);
    let expected = [Some(100), Some(100), None, None, Some(0), Some(0)];
    assert_eq!(occupancies(thresholds, pixels.clone()), expected);
    let negated = "negate: 1\noccupied_thresh: 0.65\nfree_thresh: 0.196\nmode: trinary";
    let expected = [Some(0), None, None, Some(100), Some(100), Some(100)];
    assert_eq!(occupancies(negated, pixels), expected);
    // Values exactly on a threshold are neither above nor below it: p = 0.8 and p = 0.2.
    let edges = "negate: 0\noccupied_thresh: 0.8\nfree_thresh: 0.2";
    assert_eq!(occupancies(edges, row(&[51, 50, 204, 205])), [None, Some(100), None, Some(0)]);
}

#[test]
fn scale_and_raw_give_percentages() {
    let scale = "mode: scale\nnegate: false\noccupied_thresh: 1.0\nfree_thresh: 0.0";
    assert_eq!(occupancies(scale, row(&[0, 255, 102, 254])), [Some(100), Some(0), Some(60), Some(0)]);
    let raw = "mode: RAW\nnegate: 1\noccupied_thresh: 0.65\nfree_thresh: 0.196";
    assert_eq!(occupancies(raw, row(&[0, 42, 100, 101, 255])), [Some(0), Some(42), Some(100), None, None]);
}

#[test]
fn opacity_hides_in_scale_and_does_not_count_otherwise() {
    let rgba = || png(RgbaImage::from_raw(2, 1, vec![0, 0, 0, 255, 0, 0, 0, 0]).unwrap());
    let thresholds = "negate: 0\noccupied_thresh: 0.8\nfree_thresh: 0.2";
    assert_eq!(occupancies(thresholds, rgba()), [Some(100), Some(100)]);
    assert_eq!(occupancies(&format!("{thresholds}\nmode: scale"), rgba()), [Some(100), None]);
    let colour = png(RgbaImage::from_raw(2, 1, vec![255, 0, 0, 255, 255, 255, 0, 255]).unwrap());
    assert_eq!(occupancies(thresholds, colour), [None, None]);
    let gray = png(GrayAlphaImage::from_raw(1, 1, vec![255, 255]).unwrap());
    assert_eq!(occupancies(thresholds, gray), [Some(0)]);
}

#[test]
fn the_lowest_row_of_the_image_is_row_zero() {
    let image = b"P5 2 2 255\n\x00\xff\xff\xff".to_vec();
    let yaml = "image: m.pgm\nresolution: 0.5\norigin: [2, 3, 1.5707963267948966]\n";
    let parsed = read(yaml, image).unwrap();
    let grid = parsed.value.grid;
    assert_eq!((grid.cell(0, 1), grid.count(Occupancy::Occupied)), (Occupancy::Occupied, 1));
    assert!((grid.centre(0, 1) - crate::geometry::Point::new(1.25, 3.25)).norm() < 1e-12);
    let messages: Vec<String> = parsed.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        messages,
        [
            "m.yaml:1:1: no key `negate`; 0 is taken",
            "m.yaml:1:1: no key `occupied_thresh`; 0.65 is taken",
            "m.yaml:1:1: no key `free_thresh`; 0.196 is taken",
        ]
    );
}

#[test]
fn deep_nesting_is_an_error_and_no_overflow() {
    let error = read("image: [[m.pgm]]", row(&[0])).unwrap_err().to_string();
    assert_eq!(error, "m.yaml:1:9: found a list; expected a value");
    assert!(read(&"[".repeat(100_000), row(&[0])).is_err());
    assert!(read(&"- ".repeat(100_000), row(&[0])).is_err());
    assert!(read(&"? ".repeat(100_000), row(&[0])).is_err());
}

#[test]
fn huge_images_are_refused_before_they_are_decoded() {
    let yaml = "image: m.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n";
    let error = read(yaml, b"P5 4000000 4000000 255\n".to_vec()).unwrap_err();
    assert_eq!((error.file.as_str(), error.line), ("m.pgm", 1));
    assert!(read(yaml, b"P5 10000 10000 255\n".to_vec()).is_err());
}

#[test]
fn what_cannot_be_written_is_an_error() {
    let grid = OccupancyGrid::unknown(2, 1, 0.1, Pose::default()).unwrap();
    let mut map = RosMap::new("m.pgm", grid);
    map.free_threshold = 0.65;
    assert!(print_image(&map).unwrap_err().to_string().contains("an unknown cell"));
    map.mode = Mode::Scale;
    assert!(print_image(&map).unwrap_err().to_string().contains("a PNG"));
    map.image = "m.tiff".into();
    assert!(print_image(&map).unwrap_err().to_string().contains("`m.tiff`"));
}

#[test]
fn what_was_saved_loads_again() {
    let mut grid = OccupancyGrid::unknown(4, 3, 0.05, Pose::new(-1.0, 2.5, 0.25)).unwrap();
    grid.set(0, 0, Occupancy::Occupied);
    grid.set(3, 2, Occupancy::Free);
    let folder = std::env::temp_dir().join(format!("roverlab-ros-map-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for image in ["map.pgm", "map.png", "map.bmp"] {
        let map = RosMap::new(image, grid.clone());
        save(&map, folder.join("map.yaml")).unwrap();
        let loaded = load(folder.join("map.yaml")).unwrap();
        assert_eq!((loaded.value, loaded.warnings), (map, vec![]), "{image}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

prop_compose! {
    fn map()(
        (width, height) in (1..7usize, 1..7usize),
        (resolution, x, y, yaw) in (0.001..2.0f64, -99.0..99.0f64, -99.0..99.0f64, -3.0..3.0f64),
        mode in prop_oneof![Just(Mode::Trinary), Just(Mode::Scale), Just(Mode::Raw)],
        negate in any::<bool>(),
        cells in proptest::collection::vec(proptest::option::of(0..=100u8), 36),
        image in prop_oneof![Just("a \\ \"b\".png"), Just("it's.PNG")],
    ) -> RosMap {
        let mut grid = OccupancyGrid::unknown(width, height, resolution, Pose::new(x, y, yaw)).unwrap();
        for (i, &percent) in cells.iter().enumerate().take(width * height) {
            let percent = if mode == Mode::Trinary { percent.map(|p| if p > 50 { 100 } else { 0 }) } else { percent };
            grid.set_occupancy(i % width, i / width, percent);
        }
        RosMap { mode, negate, ..RosMap::new(image, grid) }
    }
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn what_is_printed_reads_back(map in map()) {
        let files = BTreeMap::from([(map.image.clone(), print_image(&map).unwrap())]);
        let parsed = parse(&print(&map), "m.yaml", &mut MemoryFiles(files)).unwrap();
        prop_assert_eq!(parsed.warnings, vec![]);
        prop_assert_eq!(parsed.value, map);
    }

    #[test]
    fn no_text_panics(text in "((image|origin|mode|negate|resolution): ?(\\[|-|m.pgm|&a|\\*a|[0-9.,]{1,3}|\\]|\"|'|\\||>| |\n|\t){0,6}\n){0,6}") {
        let _ = read(&text, row(&[0, 255]));
    }
}
