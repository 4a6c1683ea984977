use super::error::{FormatError, Location, Notes, Parsed};
use super::lexer::shown;
use super::limits::MAX_TEXT_BYTES;
use super::source::{Files, decode, missing, stem};
use super::{maz, movingai, ros_map, wld};
use crate::world::World;

/// Finds and reads the world that a file calls `reference` at a location, or the built-in one of that name.
pub(super) fn read_world(
    reference: &str,
    (referrer, at): (&str, Location),
    files: &mut Files<'_>,
) -> Result<Parsed<World>, FormatError> {
    // A script is not a world, even if it names one; it is rejected before it is read.
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

/// Reads a world from the text of its file, which is named in another file.
pub(super) fn parse_world(
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

/// Content of a file according to its extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Script,
    World,
    Maze,
    Map,
    Grid,
    Other,
}

/// Kind of a file by its extension, case-insensitive.
pub(super) fn kind(name: &str) -> Kind {
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
