//! Which part of the library may use which: what `docs/ARCHITECTURE.md` says, held against the paths in the
//! source, however they are written. Tests, comments and texts are left out.

#[path = "wings/source.rs"]
mod source;
#[path = "wings/tokens.rs"]
mod tokens;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use source::Source;

/// What each wing may use. All of it stands further up, so arrows between wings point down and in no circle.
const WINGS: [(&str, &str); 21] = [
    ("files", ""),
    ("parameter", ""),
    ("geometry", ""),
    ("random", "parameter geometry"),
    ("kinematics", "parameter geometry random"),
    ("world", "files parameter geometry random kinematics"),
    ("vision", "parameter geometry random"),
    ("learn", "parameter random vision"),
    ("picture", "files parameter geometry world"),
    ("io", "files parameter geometry random kinematics world"),
    ("io::sim", "parameter geometry random kinematics world io"),
    // It simulates to check that a program does the same again.
    ("io::log", "files parameter geometry random world io io::sim"),
    ("io::robios", "parameter geometry world io"),
    ("scan", "parameter geometry random kinematics world io"),
    ("drive", "parameter geometry random kinematics world vision learn io scan"),
    ("maze", "files parameter geometry random kinematics world io drive"),
    ("nav", "parameter geometry random kinematics world io scan"),
    ("race", "parameter geometry random kinematics world vision io"),
    ("safety", "parameter geometry random kinematics world io"),
    ("evolve", "files parameter geometry random kinematics world picture io"),
    ("testing", "parameter geometry random world maze nav race"),
];

/// Files that use each other. Each line is one thing in several files, and no line may be added without need.
const CIRCLES: [&str; 8] = [
    // A body has a camera, which draws the hills that carry the bodies.
    "io::sim::camera::device io::sim::camera::fisheye io::sim::camera::scenery io::sim::camera::studio io::sim::machine io::sim::terrain::hills",
    // A watcher is shown the world that ticks, and told what is true there.
    "io::sim::engine io::sim::truth io::sim::watch",
    "maze::fast::bound maze::fast::search",
    "maze::flood::register maze::flood::wave",
    "world::body world::object world::robot",
    "world::generate::decor world::generate::room",
    "world::grid world::scene",
    "world::space::shape world::space::solid",
];

fn wing(module: &str) -> &str {
    let backends = ["io::sim", "io::log", "io::robios"];
    let backend =
        backends.into_iter().find(|&wing| module == wing || module.starts_with(&format!("{wing}::")));
    backend.unwrap_or(module.split("::").next().unwrap())
}

fn library() -> Source {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    Source::read(&|file| fs::read_to_string(folder.join(file)).ok())
}

#[test]
fn arrows_between_wings_point_down() {
    let mut known = BTreeMap::new();
    for (wing, uses) in WINGS {
        let uses: Vec<&str> = uses.split_whitespace().collect();
        assert!(uses.iter().all(|used| known.contains_key(used)), "{wing} uses what stands further down");
        known.insert(wing, uses);
    }
    for (module, uses) in library().arrows().into_iter().filter(|(module, _)| !module.is_empty()) {
        let may = known.get(wing(&module)).unwrap_or_else(|| panic!("{module} is in no wing of the table"));
        for used in uses.iter().filter(|used| !used.is_empty() && wing(used) != wing(&module)) {
            assert!(may.contains(&wing(used)), "{module} uses {used}; it may use {may:?}");
        }
    }
}

#[test]
fn files_use_each_other_in_no_new_circle() {
    let source = library();
    let mut reached = source.arrows();
    // Tables of contents name all that is below them.
    reached.retain(|module, _| !source.is_table_of_contents(module));
    let files: Vec<String> = reached.keys().cloned().collect();
    for through in &files {
        let onwards = reached[through].clone();
        for uses in reached.values_mut().filter(|uses| uses.contains(through)) {
            uses.extend(onwards.iter().cloned());
        }
    }
    let circle = |file: &String| {
        let both =
            files.iter().filter(|other| reached[file].contains(*other) && reached[*other].contains(file));
        both.map(String::as_str).collect::<Vec<_>>().join(" ")
    };
    let circles: BTreeSet<String> = files.iter().map(circle).filter(|circle| !circle.is_empty()).collect();
    assert_eq!(circles, CIRCLES.into_iter().map(String::from).collect());
}

/// Ways to name something of the simulator in a behaviour, `nav::bug`.
const WAYS: [&str; 17] = [
    "use crate::io::sim::Engine;",
    "pub(crate) use crate::io::{Clock, sim::{self, Engine as Motor}};",
    "use crate::io; fn f() -> io::sim::Engine { g() }",
    "use crate::io as robots; fn f() { robots::sim::start(); }",
    "use crate::{geometry, io::sim};",
    "use crate::*; fn f() { io::sim::start(); }",
    "use crate::io::*; fn f() { sim::start(); }",
    "fn f() { super::super::io::sim::start(); }",
    "mod inner { fn f() { super::super::super::io::sim::start(); } }",
    "fn f() -> crate :: io :: sim :: Engine { g() }",
    "fn f() { use crate::io; io::sim::start() }",
    "macro_rules! start { ($robot:ident) => { $crate::io::sim::start($robot) }; }",
    "fn f() { start!(crate::io::sim::TICK) }",
    "use crate::io::Handed;",
    "use crate::io::{Handed as Other};",
    "fn f() -> &'static str { \"// no comment\" } use crate::io::sim::Engine;",
    "#[cfg(test)] use a::b; #[cfg(test)] fn g(a: [u8; 2]) { h() } #[cfg(not(test))] use crate::io::sim;",
];

/// What looks like it and is not.
const OTHERS: [&str; 7] = [
    "use crate::io::Clock;",
    "// use crate::io::sim::Engine;\n/* use crate::io::sim::Engine; /* */ use crate::io::sim; */",
    "fn f() -> &'static str { \"crate::io::sim::Engine \\\" crate::io::sim\" }",
    "fn f() -> &'static str { r#\"\"crate::io::sim::Engine\"# }",
    "fn f<'a>(quote: char) -> bool { quote == '\"' || quote == '\\'' } // crate::io::sim",
    "#[cfg(test)] mod tests { use crate::io::sim::Engine; }",
    "#[cfg(test)] mod tests; #[cfg(test)] use crate::io::sim::Engine;",
];

/// What a file that holds a text uses, in a small library.
fn uses(text: &str) -> BTreeSet<String> {
    let files = |file: &str| {
        let text = match file {
            "lib.rs" => "pub mod geometry; pub mod io; mod nav;",
            "geometry.rs" => "pub struct Point;",
            "io/mod.rs" => "mod clock; pub mod sim; pub use clock::Clock; pub use sim::Engine as Handed;",
            "io/clock.rs" => "pub struct Clock;",
            "io/sim/mod.rs" => "mod engine; pub use engine::*;",
            "io/sim/engine.rs" => "pub struct Engine; pub fn start() {}",
            "nav/mod.rs" => "mod bug;",
            "nav/bug.rs" => text,
            _ => return None,
        };
        Some(text.to_owned())
    };
    Source::read(&files).arrows().remove("nav::bug").unwrap()
}

#[test]
fn arrows_are_found_however_they_are_written() {
    for way in WAYS {
        assert!(uses(way).iter().any(|used| wing(used) == "io::sim"), "{way}: {:?}", uses(way));
    }
    for other in OTHERS {
        assert!(uses(other).iter().all(|used| wing(used) != "io::sim"), "{other}: {:?}", uses(other));
    }
}
