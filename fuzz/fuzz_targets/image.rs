//! An image file by all readers that take one: a floor's texture, a ground as a picture and as an ESRI grid.
#![no_main]

use libfuzzer_sys::fuzz_target;
use roverlab::world::formats::{MemoryFiles, parse_scene};

fuzz_target!(|bytes: &[u8]| {
    let mut files = MemoryFiles::default();
    for name in ["a.png", "a.asc"] {
        files.0.insert(name.into(), bytes.to_vec());
    }
    for world in [
        "floor 4000 4000\nfloor_texture a.png\n",
        "terrain 4000 4000 800 a.png\n",
        "terrain 4000 4000 800 a.asc\n",
    ] {
        let _ = parse_scene(world.into(), "fuzz.wld", &mut files);
    }
});
