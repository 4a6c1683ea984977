//! A map's YAML, a form feed, and its image.
#![no_main]

use std::collections::BTreeMap;

use libfuzzer_sys::fuzz_target;
use roverlab::world::formats::{MemoryFiles, ros_map};

const MAP: &str = "image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n";

fuzz_target!(|bytes: &[u8]| {
    let split = bytes.iter().position(|&b| b == 0x0c).unwrap_or(bytes.len());
    let (yaml, image) = (&bytes[..split], bytes[split..].get(1..).unwrap_or_default());
    // Without any text of its own the image still gets read.
    let yaml = if yaml.is_empty() { MAP } else { std::str::from_utf8(yaml).unwrap_or(MAP) };
    let names = ["m.pgm", "room.pgm", "m.png", "m.bmp", "m"];
    let mut files = MemoryFiles(names.map(|name| (name.to_string(), image.to_vec())).into());
    let Ok(parsed) = ros_map::parse(yaml, "fuzz.yaml", &mut files) else { return };
    if parsed.value.grid.width() * parsed.value.grid.height() > 1 << 16 {
        return;
    }
    let _ = parsed.value.grid.to_world();
    let mut map = parsed.value;
    map.image = "m.png".into();
    let Ok(image) = ros_map::print_image(&map) else { return };
    let mut files = MemoryFiles(BTreeMap::from([("m.png".to_string(), image)]));
    let again = ros_map::parse(&ros_map::print(&map), "fuzz.yaml", &mut files).expect("the writer's map reads");
    assert_eq!(again.value, map);
});
