//! World files (book, chapter 1): EyeSim's worlds (`.wld`) and simulation scripts (`.sim`) are read and
//! written. A file that makes no sense is refused with its line and its column.
//!
//! `cargo run --release --example world_files`

use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{DistanceSensors, Psd};
use roverlab::picture::Picture;
use roverlab::world::formats::sim::SimFile;
use roverlab::world::formats::{MemoryFiles, sim, wld};

/// In millimetres and degrees, as EyeSim has it.
const WORLD: &str = "\
floor 2400 1600
0 0 2400 0
2400 0 2400 1600
2400 1600 0 1600
0 1600 0 0
1400 0 1400 900
";

const SCRIPT: &str = "\
world room.wld
S4 400 500 0
can 900 1200 0
soccer 1900 500 0
marker 2000 1300 0 255 0
";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Files that a script names are found in memory here; `load_scene` reads them from the disk.
    let mut files = MemoryFiles::default();
    files.0.insert("room.wld".into(), WORLD.into());
    let parsed = sim::parse(SCRIPT, "room.sim", &mut files)?;
    let scene = parsed.value;
    println!(
        "{} walls, {} objects, {} robot",
        scene.world.walls.len(),
        scene.world.objects.len(),
        scene.robots.len()
    );
    assert!(parsed.warnings.is_empty());

    // The scene is ready to drive in.
    let simulation = Simulation::new(&scene, SimOptions::ideal())?;
    let ahead = simulation.robot(0)?.distance(Psd::FRONT)?;
    println!("The robot {} sees the wall {ahead:.3} m ahead.", scene.robots[0].spec.name);
    assert!((ahead - 0.935).abs() < 0.01);

    // Written and read again, it is the same world.
    let text = wld::print(&scene.world);
    let again = wld::parse(&text, "written.wld")?.value;
    assert_eq!(again.walls, scene.world.walls);
    let script = sim::print(&SimFile::for_scene(&scene, "room.wld"));
    println!("\n{script}");
    assert_eq!(sim::parse(&script, "written.sim", &mut files)?.value.robots, scene.robots);

    // What is wrong is told with its place: file, line and column.
    let error =
        wld::parse("floor 2400 1600\n0 0 24OO 0\n", "typo.wld").err().ok_or("the typo was not found")?;
    println!("{error}");
    assert_eq!((error.line, error.column), (2, 5));

    let mut picture = Picture::new(&scene.world);
    picture.title("A world from a file").robot(scene.robots[0].pose, &scene.robots[0].spec.footprint);
    picture.save("target/pictures/world_files.svg")?;
    Ok(())
}
