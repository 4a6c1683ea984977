//! One thing far from all the rest, as by a mistyped coordinate, in every format of worlds and tracks: it is
//! left out of maps with a warning, or the file is refused with the limit.

use roverlab::geometry::Point;
use roverlab::nav::Reachability;
use roverlab::race::{CentreLine, TrackFile, parse_track};
use roverlab::scan::LocalisationMap;
use roverlab::world::formats::{MemoryFiles, parse_scene};
use roverlab::world::{BitGrid, World};

/// Places of something that was meant to be at 1 m, in millimetres: the last is beyond all limits.
const FAR: [&str; 4] = ["1000000", "-1000000", "1000000000", "10000000000"];

fn read(name: &str, text: &str) -> Result<World, String> {
    let mut files = MemoryFiles::default();
    files.0.insert("room.wld".into(), ROOM.into());
    let scene = parse_scene(text.into(), name, &mut files).map_err(|error| error.to_string())?;
    Ok(scene.value.world)
}

const ROOM: &str = "floor 3000 2000\n0 0 3000 0\n3000 0 3000 2000\n3000 2000 0 2000\n0 2000 0 0\n";

/// What is planned and known in a world.
fn mapped(world: &World) -> String {
    let free = Reachability::new(world, 0.1, 0.05).unwrap();
    let localiser = LocalisationMap::new(world);
    format!("{:?} {} {}", world.site(), free.is_free(Point::new(1.0, 1.0)), localiser.is_ok())
}

#[test]
fn worlds_are_mapped_without_what_is_far_off() {
    let room = mapped(&read("room.wld", ROOM).unwrap());
    for far in FAR {
        let wall = format!("{ROOM}{far} 0 {far} 1000\n");
        let pushed = format!("{ROOM}push {far} 0 0\n0 0 0 1000\npop\n");
        let object = format!("world room.wld\ncan {far} 500 0\n");
        for (name, text) in [("wall.wld", wall), ("pushed.wld", pushed), ("object.sim", object)] {
            match read(name, &text) {
                Ok(world) => assert_eq!((mapped(&world), world.strays()), (room.clone(), 1), "{text}"),
                Err(error) => assert!(
                    far == FAR[3] && error.contains(name) && error.contains("1000000000"),
                    "{far} {error}"
                ),
            }
        }
    }
}

/// Grids have no place for anything far off: it is their size that is refused.
#[test]
fn grids_that_are_too_large_are_refused_with_the_limit() {
    let error = |name: &str, text: &str| read(name, text).unwrap_err();
    let maze = error("large.maz", " _ _\n|_ _|\n10000000000\n");
    assert!(maze.starts_with("large.maz:3:1") && maze.contains("at most 1000000000"), "{maze}");
    let map = error("large.map", "type octile\nheight 1000000\nwidth 1000000\nmap\n.\n");
    assert!(map.contains("large.map:") && map.contains("33554432"), "{map}");
    let yaml = "image: room.pgm\nresolution: 1e9\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n";
    let map = error("large.yaml", yaml);
    assert!(map.starts_with("large.yaml:2:"), "{map}");
}

#[test]
fn a_cone_far_off_does_not_change_the_track_unless_it_is_refused() {
    let oval = include_str!("data/cones/oval.csv");
    let line = |text: &str| {
        let Ok(TrackFile::Cones(track)) = parse_track(text, "oval.csv") else { return None };
        let start = track.start_pose().unwrap();
        Some(CentreLine::round_track(&track.cones, start).map(|line| line.corridor.length()))
    };
    let whole = line(oval).unwrap().unwrap();
    for far in ["1e3", "-1e5", "1e6", "1e7"] {
        match line(&format!("{oval}blue,{far},0.0,0,0.01,0.01,0\n")) {
            None => assert_eq!(far, "1e7", "beyond the limit of 1000 km"),
            Some(Ok(length)) => assert!((length - whole).abs() < 0.03 * whole, "{far}: {length} {whole}"),
            Some(Err(error)) => assert!(!error.to_string().is_empty()),
        }
    }
}

/// The table of sizes in the docs names the limit of maps, and they refuse what is larger.
#[test]
fn the_docs_have_the_limits_of_maps() {
    let docs = include_str!("../docs/commands.md");
    let rows = docs.lines().filter(|line| line.starts_with("| ") && line.contains("33,554,432"));
    assert_eq!((BitGrid::MAX_CELLS, rows.count()), (33_554_432, 4));
    assert!(docs.contains("33,554,432 of 50 mm | 288 m x 288 m"));
    let error = LocalisationMap::new(&World::walled(289.5, 289.5)).unwrap_err().to_string();
    assert!(error.contains("expected at most 33554432 of 0.05 m over 290.3"), "{error}");
}
