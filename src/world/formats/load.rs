use std::path::Path;

use super::error::{FormatError, Location, Notes, Parsed};
use super::lexer::shown;
use super::limits::MAX_TEXT_BYTES;
use super::source::{DiskFiles, FileSource, Files, decode, missing, read_limited, stem, unreadable};
use super::{esobj, maz, movingai, robi, ros_map, sim, wld};
use crate::world::{ObjectKind, RobotSpec, Scene, World};

/// Reads a scene from disk: a `.sim`, or the `.wld`, `.maz`, ROS map (`.yaml`, `.yml`) or MovingAI map (`.map`) of one
/// without robots.
///
/// ```no_run
/// let scene = roverlab::world::formats::load_scene("worlds/soccer.sim")?;
/// for warning in &scene.warnings {
///     eprintln!("{warning}");
/// }
/// println!("{} robots", scene.value.robots.len());
/// # Ok::<(), roverlab::world::formats::FormatError>(())
/// ```
pub fn load_scene(path: impl AsRef<Path>) -> Result<Parsed<Scene>, FormatError> {
    let path = path.as_ref();
    parse_scene(read_file(path)?, &path.display().to_string(), &mut DiskFiles::new())
}

/// Reads a scene from the bytes of its file, whose name says what kind it is, and from the files that it names.
pub fn parse_scene(
    bytes: Vec<u8>,
    file: &str,
    files: &mut dyn FileSource,
) -> Result<Parsed<Scene>, FormatError> {
    scene_of(bytes, file, &mut Files::new(files, false))
}

/// As [`parse_scene`], but that scripts are read as by [`sim::parse_tolerantly`], and that a world without the images that it
/// names has a gray, level floor.
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

/// Reads a robot's description, `.robi`, from disk.
pub fn load_robot(path: impl AsRef<Path>) -> Result<Parsed<RobotSpec>, FormatError> {
    let path = path.as_ref();
    parse_robot(read_file(path)?, &path.display().to_string())
}

/// Reads a robot's description from the bytes of its file.
pub fn parse_robot(bytes: Vec<u8>, file: &str) -> Result<Parsed<RobotSpec>, FormatError> {
    decoded(bytes, file, robi::parse)
}

/// Reads an object's description, `.esObj`, with its 3D model from disk.
pub fn load_object(path: impl AsRef<Path>) -> Result<Parsed<ObjectKind>, FormatError> {
    let path = path.as_ref();
    let read = |text: &str, file: &str| {
        esobj::parse_with_model(text, file, &mut Files::new(&mut DiskFiles::new(), false))
    };
    decoded(read_file(path)?, &path.display().to_string(), read)
}

/// The bytes of a file on disk, for the functions that read formats from bytes. Fails as those do for a file that
/// does not exist, cannot be read or is too long.
pub fn read_file(path: impl AsRef<Path>) -> Result<Vec<u8>, FormatError> {
    let path = path.as_ref();
    let file = path.display().to_string();
    read_limited(path, MAX_TEXT_BYTES)
        .map_err(|error| unreadable(&error, &file, &file, Location::START, MAX_TEXT_BYTES))
}

/// Hands the text of a file and its name to a reader.
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

/// Finds and reads the world that a file calls `reference` at some place, or one of that name which is built in.
pub(super) fn read_world(
    reference: &str,
    (referrer, at): (&str, Location),
    files: &mut Files<'_>,
) -> Result<Parsed<World>, FormatError> {
    // A script that names a script, itself for one, is no world: say so before reading it.
    if !matches!(kind(reference), Kind::World | Kind::Maze | Kind::Map | Kind::Grid) {
        return Err(not_a_world(reference, referrer, at));
    }
    let Some(source) = files.read_if_there(reference, (referrer, at), MAX_TEXT_BYTES)? else {
        let world = World::predefined(&stem(reference));
        let world = world.ok_or_else(|| missing(reference, (referrer, at)))?;
        let mut notes = Notes::new(referrer);
        notes.warn(at, format!("{} does not exist; the built-in world is used", shown(reference)));
        return Ok(notes.finish(world));
    };
    let mut notes = Notes::new(&source.name);
    let text = decode(source.bytes, &mut notes)?;
    let parsed = parse_world(&text, &source.name, files, referrer, at)?;
    notes.extend(parsed.warnings);
    Ok(notes.finish(parsed.value))
}

fn parse_world(
    text: &str,
    file: &str,
    files: &mut Files<'_>,
    referrer: &str,
    at: Location,
) -> Result<Parsed<World>, FormatError> {
    match kind(file) {
        Kind::World => wld::parse_with_images(text, file, files),
        Kind::Maze => maz::parse(text, file),
        Kind::Map => {
            let map = ros_map::parse(text, file, files.source())?;
            let world = ros_map::to_world(&map.value, file)?;
            Ok(map.map(|_| world))
        }
        Kind::Grid => {
            let map = movingai::parse_map(text, file)?;
            let world = ros_map::grid_to_world(&map.value.occupancy(), file)?;
            Ok(map.map(|_| world))
        }
        Kind::Script | Kind::Other => Err(not_a_world(file, referrer, at)),
    }
}

fn not_a_world(name: &str, referrer: &str, at: Location) -> FormatError {
    FormatError::new(referrer, at, shown(name), "a file that ends in .wld, .maz, .yaml, .yml or .map")
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Script,
    World,
    Maze,
    Map,
    Grid,
    Other,
}

/// The kind of a file by its ending, in any case.
fn kind(name: &str) -> Kind {
    let ending = name.rsplit_once('.').map_or(String::new(), |(_, ending)| ending.to_ascii_lowercase());
    match ending.as_str() {
        "sim" => Kind::Script,
        "wld" => Kind::World,
        "maz" => Kind::Maze,
        "yaml" | "yml" => Kind::Map,
        "map" => Kind::Grid,
        _ => Kind::Other,
    }
}
