use std::path::Path;

use super::error::{FormatError, Location, Notes, Parsed};
use super::lexer::shown;
use super::limits::MAX_TEXT_BYTES;
use super::source::{DiskFiles, FileSource, Files, decode, read_limited, unreadable};
use super::world_file::{Kind, kind, parse_world};
use super::{esobj, robi, sim};
use crate::world::{ObjectKind, RobotSpec, Scene};

/// Reads a scene from a file: a `.sim`, or without robots a `.wld`, `.maz`, ROS map (`.yaml`, `.yml`) or
/// MovingAI map (`.map`).
///
/// ```
/// let file = std::env::temp_dir().join(format!("roverlab-{}.wld", std::process::id()));
/// std::fs::write(&file, "floor 2000 1000\n0 0 2000 0\n")?;
/// let scene = roverlab::world::formats::load_scene(&file)?;
/// for warning in &scene.warnings {
///     eprintln!("{warning}");
/// }
/// assert_eq!((scene.value.world.walls.len(), scene.value.robots.len()), (1, 0));
/// std::fs::remove_file(file)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn load_scene(path: impl AsRef<Path>) -> Result<Parsed<Scene>, FormatError> {
    let path = path.as_ref();
    parse_scene(read_file(path)?, &path.display().to_string(), &mut DiskFiles::new())
}

/// Reads a scene from the bytes of its file, with the kind determined by its name, and from the files that it
/// names.
///
/// ```
/// use roverlab::world::formats::{MemoryFiles, parse_scene, parse_scene_tolerantly};
/// let mut files = MemoryFiles::default();
/// files.0.insert("room.wld".into(), b"floor 2000 1000\n0 0 2000 0\n".to_vec());
/// let script = b"world room.wld\nS4 400 500 0\nlamp 900 500 0\n".to_vec();
/// let scene = parse_scene_tolerantly(script.clone(), "room.sim", &mut files)?;
/// assert_eq!((scene.value.robots.len(), scene.value.world.walls.len()), (1, 1));
/// assert!(!scene.warnings.is_empty(), "nobody knows a lamp");
/// let strict = parse_scene(script, "room.sim", &mut files).map(|parsed| parsed.warnings);
/// assert!(strict.is_err() || !strict.unwrap().is_empty());
/// # Ok::<(), roverlab::world::formats::FormatError>(())
/// ```
pub fn parse_scene(
    bytes: Vec<u8>,
    file: &str,
    files: &mut dyn FileSource,
) -> Result<Parsed<Scene>, FormatError> {
    scene_of(bytes, file, &mut Files::new(files, false))
}

/// Like [`parse_scene`], but scripts are read as by [`sim::parse_tolerantly`], and a world with missing
/// images has a gray, level floor.
pub fn parse_scene_tolerantly(
    bytes: Vec<u8>,
    file: &str,
    files: &mut dyn FileSource,
) -> Result<Parsed<Scene>, FormatError> {
    scene_of(bytes, file, &mut Files::new(files, true))
}

fn scene_of(bytes: Vec<u8>, file: &str, files: &mut Files<'_>) -> Result<Parsed<Scene>, FormatError> {
    decoded(bytes, file, |text, file| match kind(file) {
        Kind::Script => sim::parse_with(text, file, files),
        Kind::Other => {
            let expected = "a file that ends in .sim, .wld, .maz, .yaml, .yml or .map";
            Err(FormatError::new(file, Location::START, shown(file), expected))
        }
        _ => Ok(parse_world(text, file, files, file, Location::START)?.map(Scene::new)),
    })
}

/// Reads a robot's description (`.robi`) and its 3D model from files.
pub fn load_robot(path: impl AsRef<Path>) -> Result<Parsed<RobotSpec>, FormatError> {
    let path = path.as_ref();
    robot_of(read_file(path)?, &path.display().to_string(), &mut Files::new(&mut DiskFiles::new(), false))
}

/// Like [`load_robot`], but a missing or broken model is left out.
pub fn load_robot_tolerantly(path: impl AsRef<Path>) -> Result<Parsed<RobotSpec>, FormatError> {
    let path = path.as_ref();
    parse_robot_tolerantly(read_file(path)?, &path.display().to_string(), &mut DiskFiles::new())
}

/// Reads a robot's description from the bytes of its file, without its 3D model.
///
/// ```
/// use roverlab::world::formats::{load_object, load_robot, load_robot_tolerantly, parse_robot, read_file};
/// let text = "drive DIFFERENTIAL_DRIVE\nname Mine\nwheel 54 3600 1100 45\npsd 1 FRONT 50 0 20 0 0 0\n";
/// let robot = parse_robot(text.into(), "mine.robi")?;
/// assert_eq!((robot.value.psds.len(), robot.value.name.as_str()), (1, "Mine"));
/// // From a file; errors state its name.
/// for error in [load_robot("none.robi").err(), load_robot_tolerantly("none.robi").err()] {
///     assert!(error.expect("there is none").to_string().contains("none.robi"));
/// }
/// assert!(load_object("none.esObj").is_err() && read_file("none.wld").is_err());
/// # Ok::<(), roverlab::world::formats::FormatError>(())
/// ```
pub fn parse_robot(bytes: Vec<u8>, file: &str) -> Result<Parsed<RobotSpec>, FormatError> {
    decoded(bytes, file, robi::parse)
}

/// As [`load_robot_tolerantly`], from the bytes of the robot's file and from the files that it names.
///
/// ```
/// use roverlab::world::formats::{MemoryFiles, parse_robot_tolerantly};
/// let text = "drive DIFFERENTIAL_DRIVE\nname Mine\nmodel mine.obj\nwheel 54 3600 1100 45\n";
/// let mut files = MemoryFiles::default();
/// let bare = parse_robot_tolerantly(text.into(), "mine.robi", &mut files)?;
/// assert!(bare.value.mesh.is_none() && bare.warnings[0].to_string().contains("mine.obj"));
/// files.0.insert("mine.obj".into(), b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec());
/// assert!(parse_robot_tolerantly(text.into(), "mine.robi", &mut files)?.value.mesh.is_some());
/// # Ok::<(), roverlab::world::formats::FormatError>(())
/// ```
pub fn parse_robot_tolerantly(
    bytes: Vec<u8>,
    file: &str,
    files: &mut dyn FileSource,
) -> Result<Parsed<RobotSpec>, FormatError> {
    robot_of(bytes, file, &mut Files::new(files, true))
}

fn robot_of(bytes: Vec<u8>, file: &str, files: &mut Files<'_>) -> Result<Parsed<RobotSpec>, FormatError> {
    decoded(bytes, file, |text, file| robi::parse_with_model(text, file, files))
}

/// Reads an object's description, `.esObj`, with its 3D model from disk.
pub fn load_object(path: impl AsRef<Path>) -> Result<Parsed<ObjectKind>, FormatError> {
    let path = path.as_ref();
    let read = |text: &str, file: &str| {
        esobj::parse_with_model(text, file, &mut Files::new(&mut DiskFiles::new(), false))
    };
    decoded(read_file(path)?, &path.display().to_string(), read)
}

/// Bytes of a file, for the functions that read formats from bytes. Like these, it fails for a file that does
/// not exist, cannot be read or is too long.
pub fn read_file(path: impl AsRef<Path>) -> Result<Vec<u8>, FormatError> {
    let path = path.as_ref();
    let file = path.display().to_string();
    read_limited(path, MAX_TEXT_BYTES)
        .map_err(|error| unreadable(&error, &file, &file, Location::START, MAX_TEXT_BYTES))
}

/// Passes the text and the name of a file to a reader.
fn decoded<T>(
    bytes: Vec<u8>,
    file: &str,
    read: impl FnOnce(&str, &str) -> Result<Parsed<T>, FormatError>,
) -> Result<Parsed<T>, FormatError> {
    let mut notes = Notes::new(file);
    let text = decode(bytes, &mut notes)?;
    let parsed = read(&text, file)?;
    notes.extend(parsed.warnings);
    Ok(notes.finish(parsed.value))
}
