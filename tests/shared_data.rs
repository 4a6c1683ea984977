//! Published maps with known numbers of cells. They are no part of the project: the tests run when the environment
//! variable `ROVERLAB_DATA` names the folder that holds `ros_maps/`.

use std::fs;
use std::path::{Path, PathBuf};

use roverlab::world::Cell;
use roverlab::world::formats::{load_scene, ros_map};

fn maps() -> Option<PathBuf> {
    std::env::var_os("ROVERLAB_DATA").map(|folder| Path::new(&folder).join("ros_maps"))
}

#[test]
fn cells_are_counted_as_published() {
    let Some(folder) = maps() else { return };
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
        let counts = [Cell::Occupied, Cell::Free, Cell::Unknown].map(|cell| grid.count(cell));
        assert_eq!(counts, [number(6), number(7), number(8)], "{line}");
        assert_eq!(grid.resolution(), columns[4].parse::<f64>().unwrap(), "{line}");
        assert!(load_scene(&path).is_ok());
        compared += 1;
    }
    assert!(compared >= 10, "only {compared} maps");
}

#[test]
fn the_test_map_of_the_map_server_is_read_cell_by_cell() {
    let Some(folder) = maps() else { return };
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
fn a_missing_image_is_named_where_the_map_names_it() {
    let Some(folder) = maps() else { return };
    let error = load_scene(folder.join("nav2/nav2_system_tests/maps/empty_room.yaml")).unwrap_err();
    assert_eq!((error.line, error.column), (1, 8));
    assert_eq!(error.found, "`empty.pgm`, which does not exist");
}
