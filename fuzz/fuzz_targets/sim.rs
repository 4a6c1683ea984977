//! Reads a script and the files that it names: those of `tests/data/formats`, and one that the input brings
//! along behind a form feed.
#![no_main]

use libfuzzer_sys::fuzz_target;
use roverlab::world::formats::{MemoryFiles, sim};

const FILES: [(&str, &[u8]); 11] = [
    ("small.maz", include_bytes!("../../tests/data/formats/small.maz")),
    (".\\room.wld", include_bytes!("../../tests/data/formats/room.wld")),
    ("cart.robi", include_bytes!("../../tests/data/formats/cart.robi")),
    ("cart.obj", include_bytes!("../../tests/data/formats/cart.obj")),
    ("sign.esObj", include_bytes!("../../tests/data/formats/sign.esObj")),
    ("room.yaml", include_bytes!("../../tests/data/formats/room.yaml")),
    ("room.pgm", include_bytes!("../../tests/data/formats/room.pgm")),
    ("tiles 1.png", include_bytes!("../../tests/data/formats/tiles 1.png")),
    ("sign.obj", include_bytes!("../../tests/data/formats/sign.obj")),
    ("sign.mtl", include_bytes!("../../tests/data/formats/sign.mtl")),
    ("plate.png", include_bytes!("../../tests/data/formats/plate.png")),
];

fuzz_target!(|text: &str| {
    let (script, other) = text.split_once('\u{c}').unwrap_or((text, ""));
    if let Ok(parsed) = sim::parse_document(script, "fuzz.sim") {
        let again = sim::parse_document(&sim::print(&parsed.value), "fuzz.sim").expect("the writer's text reads");
        assert_eq!(again.value, parsed.value);
    }
    let mut files = MemoryFiles::default();
    files.0.extend(FILES.map(|(name, bytes)| (name.to_string(), bytes.to_vec())));
    for name in ["a.wld", "a.maz", "a.robi", "a.esObj", "a.yaml", "a.obj", "a.mtl"] {
        files.0.insert(name.into(), other.as_bytes().to_vec());
    }
    let Ok(scene) = sim::parse(script, "fuzz.sim", &mut files) else { return };
    let script = sim::SimFile::for_scene(&scene.value, "small.maz");
    sim::parse_document(&sim::print(&script), "fuzz.sim").expect("the script of a scene reads");
});
