//! EyeSim's worlds (`.wld`): a floor and straight walls, in millimetres and degrees.
//!
//! | line | meaning |
//! |---|---|
//! | `floor W H`, or `width W` and `height H` | a floor from (0, 0) |
//! | `floor_texture FILE` | an image stretched over it: PNG, JPEG or BMP |
//! | `X1 Y1 X2 Y2 [THICKNESS HEIGHT [R G B]]` | a wall; with other counts, the first four numbers are used |
//! | `push X Y PHI` … `pop` | moves the walls between them by (X, Y), then turns them **clockwise** by PHI |
//! | `position X Y PHI` | the start pose, PHI counter-clockwise |
//! | `terrain W H TOP FILE` | hills, which carry robots and stop rays; sets the floor's size too |
//! | `water_level Z` | the surface of water, which carries craft, and in which other robots drown |
//! | `water_density KG` | of a cubic metre; 1000 without it; a line of our own, as are those below |
//! | `current VX VY [DEPTH]` | a current in mm/s; one that changes with depth has a line for each depth, from above |
//! | `waves HEIGHT PERIOD PHI [jonswap]` | waves: mm from trough to crest, seconds, and where they run; with a spectrum |
//! | `wind VX VY` | in mm/s; it acts on the part of a craft above the water |
//! | `turbidity B` | light scattered per metre of water (1/m); it veils distant objects in camera images |
//!
//! The elevations come from a gray PNG, JPEG or BMP image, with black at 0 and white at TOP, or from an ESRI
//! ASCII grid (`.asc`), with its lowest point at 0 and its highest at TOP. Like a floor image, the image has
//! its first row at the largest y; its outer pixels are the elevations on the border. Beyond the hills there
//! is no ground.
//!
//! Keywords are case-insensitive. As in EyeSim, a line that begins with anything else is skipped with a
//! warning, and so is a wall with fewer than four numbers. The default floor extends from (0, 0) to the
//! walls' extent. Objects, marks and places are not part of this format; simulation scripts contain them.
//!
//! ```
//! use roverlab::world::formats::wld;
//! let text = "floor 3000 2000\n0 0 3000 0\n1500 0 1500 1200 50 300\nsofa\n";
//! let parsed = wld::parse(text, "room.wld")?;
//! assert_eq!(parsed.warnings.len(), 1, "nobody knows what `sofa` means");
//! let wall = &parsed.value.walls[1];
//! assert_eq!((wall.line.length(), wall.thickness, wall.height), (1.2, 0.05, 0.3));
//! assert_eq!(wld::parse(&wld::print(&parsed.value), "again.wld")?.value, parsed.value);
//! # Ok::<(), roverlab::world::formats::FormatError>(())
//! ```

use std::fmt::Write as _;

use super::args::Args;
use super::error::{FormatError, Location, Notes, Parsed};
use super::image_file;
use super::lexer::{self, Line, quote};
use super::limits::{MAX_METRES, MAX_PUSHES, MAX_WALLS};
use super::number::{self, degrees, millimetres};
use super::source::{Files, check_length};
use super::{terrain_file, water};
use crate::geometry::{Aabb, Point, Pose, Segment, math, units};
use crate::world::{Terrain, Wall, World};

/// Reads a world without the images that it names; [`load_scene`](super::load_scene) also reads these.
pub fn parse(text: &str, file: &str) -> Result<Parsed<World>, FormatError> {
    let (world, _) = read(text, file)?;
    Ok(world)
}

/// Reads a world and the images that it names.
pub(super) fn parse_with_images(
    text: &str,
    file: &str,
    files: &mut Files<'_>,
) -> Result<Parsed<World>, FormatError> {
    let (Parsed { value: mut world, warnings }, places) = read(text, file)?;
    let mut notes = Notes::new(file);
    notes.extend(warnings);
    if let Some(texture) = &mut world.floor_texture {
        image_file::load(texture, (file, places.texture), files, &mut notes, "the floor is gray")?;
        if texture.image.is_none() {
            world.floor_texture = None;
        }
    }
    if let Some(terrain) = &mut world.terrain {
        terrain_file::load(terrain, (file, places.terrain), files, &mut notes, "the floor is level")?;
        if terrain.surface.is_none() {
            world.terrain = None;
        }
    }
    Ok(notes.finish(world))
}

/// Locations of image names.
struct Places {
    texture: Location,
    terrain: Location,
}

fn read(text: &str, file: &str) -> Result<(Parsed<World>, Places), FormatError> {
    check_length(text, file)?;
    let mut reader = Reader::new(file);
    for (number, text) in lexer::numbered(text) {
        if let Some(line) = lexer::line(file, number, text)? {
            reader.line(&line)?;
        }
    }
    let places = Places { ..reader.places };
    Ok((reader.finish(), places))
}

struct Reader<'f> {
    world: World,
    places: Places,
    width: Option<f64>,
    height: Option<f64>,
    frames: Vec<Frame>,
    /// Which lines of [`ONCE`] have been read.
    seen: [bool; ONCE.len()],
    notes: Notes<'f>,
}

/// Lines of which only the last one counts.
const ONCE: [&str; 4] = ["floor_texture", "position", "terrain", "water_level"];

impl<'f> Reader<'f> {
    fn new(file: &'f str) -> Self {
        let (world, notes) = (World::empty(0.0, 0.0), Notes::new(file));
        let places = Places { texture: Location::START, terrain: Location::START };
        Self {
            world,
            places,
            width: None,
            height: None,
            frames: Vec::new(),
            seen: [false; ONCE.len()],
            notes,
        }
    }

    fn line(&mut self, line: &Line<'_>) -> Result<(), FormatError> {
        let keyword = line.words[0].text.to_ascii_lowercase();
        if number::looks_like_number(&keyword) {
            return self.wall(line);
        }
        let mut args = Args::after_keyword(line);
        self.warn_of_a_second(line, &keyword);
        match keyword.as_str() {
            "floor" => self.floor(args.size("the floor's width")?, args.size("the floor's height")?),
            "width" => self.width = Some(args.size("the floor's width")?),
            "height" => self.height = Some(args.size("the floor's height")?),
            "floor_texture" => {
                let image =
                    args.path("an image file", &[".png", ".jpg", ".jpeg", ".bmp"], &mut self.notes)?;
                self.world.floor_texture = Some(image.into());
                self.places.texture = line.location(1);
            }
            "push" => self.push(line, &mut args)?,
            "pop" => drop(self.frames.pop()),
            "position" => self.world.start = Some(pose(&mut args)?),
            "terrain" => self.terrain(line, &mut args)?,
            "water_level" => self.world.water_level = Some(args.length("the water level")?),
            keyword if water::line(keyword, line, &mut args, &mut self.world.water)? => {}
            _ => {
                let unknown = lexer::shown(line.words[0].text);
                self.notes.warn(line.location(0), format!("unknown keyword {unknown}; the line is skipped"));
                return Ok(());
            }
        }
        args.finish(&mut self.notes);
        Ok(())
    }

    fn warn_of_a_second(&mut self, line: &Line<'_>, keyword: &str) {
        let Some(index) = ONCE.iter().position(|once| *once == keyword) else { return };
        if std::mem::replace(&mut self.seen[index], true) {
            let message = format!("a second `{keyword}`; the one before does not count");
            self.notes.warn(line.location(0), message);
        }
    }

    fn floor(&mut self, width: f64, height: f64) {
        (self.width, self.height) = (Some(width), Some(height));
    }

    fn push(&mut self, line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<(), FormatError> {
        if self.frames.len() == MAX_PUSHES {
            let mut error = line.error(0, format!("at most {MAX_PUSHES} pushes inside one another"));
            error.found = "one more `push`".into();
            return Err(error);
        }
        let (x, y) = (args.length("the shift's x")?, args.length("the shift's y")?);
        let clockwise = args.direction_degrees("the turn")?;
        let outer = self.frames.last().copied().unwrap_or_default();
        self.frames.push(outer.inner(x, y, clockwise));
        Ok(())
    }

    fn terrain(&mut self, line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<(), FormatError> {
        let width = args.size("the terrain's width")?;
        let height = args.size("the terrain's height")?;
        let max_elevation = args.length("the terrain's highest elevation")?;
        let file = args.path("the terrain's image", terrain_file::ENDINGS, &mut self.notes)?;
        self.world.terrain = Some(Terrain { width, height, max_elevation, file: file.into(), surface: None });
        self.places.terrain = line.location(4);
        self.floor(width, height);
        Ok(())
    }

    fn wall(&mut self, line: &Line<'_>) -> Result<(), FormatError> {
        let mut args = Args::all(line);
        let numbers = args.left();
        if args.numbers_ahead() == numbers && numbers < 4 {
            let message = format!("a wall of {numbers} numbers, not 4, 6 or 9; skipped");
            self.notes.warn(line.location(0), message);
            return Ok(());
        }
        let start = Point::new(args.length("the wall's start x")?, args.length("the wall's start y")?);
        let end = Point::new(args.length("the wall's end x")?, args.length("the wall's end y")?);
        let mut wall = Wall::new(self.place(start, line)?, self.place(end, line)?);
        match numbers {
            4 => {}
            6 | 9 => {
                wall.thickness = args.size("the wall's thickness")?;
                wall.height = args.size("the wall's height")?;
                if numbers == 9 {
                    wall.colour = args.colour("the wall")?;
                }
            }
            _ => {
                let message = format!("a wall of {numbers} numbers, not 4, 6 or 9; only the first 4 count");
                self.notes.warn(line.location(4), message);
            }
        }
        if self.world.walls.len() == MAX_WALLS {
            let mut error = line.error(0, format!("at most {MAX_WALLS} walls"));
            error.found = "one more wall".into();
            return Err(error);
        }
        if wall.height > 0.0 {
            self.world.walls.push(wall);
        } else {
            self.notes.warn(line.location(0), "a wall of height 0; skipped");
        }
        Ok(())
    }

    /// A point of the innermost pushed frame, in world coordinates.
    fn place(&self, point: Point, line: &Line<'_>) -> Result<Point, FormatError> {
        let Some(frame) = self.frames.last() else { return Ok(point) };
        let placed = frame.to_world(point);
        if placed.x.abs() <= MAX_METRES && placed.y.abs() <= MAX_METRES {
            return Ok(placed);
        }
        let mut error = line.error(0, format!("a wall within {} km of the origin", MAX_METRES / 1000.0));
        error.found = "a wall that `push` moves far away".into();
        Err(error)
    }

    fn finish(mut self) -> Parsed<World> {
        let reach = |axis: fn(&Point) -> f64| {
            let ends = self.world.walls.iter().flat_map(|w| [w.line.a, w.line.b]);
            ends.map(|p| axis(&p)).fold(0.0, f64::max)
        };
        if self.width.is_none() || self.height.is_none() {
            let message = "no `floor` line; the floor reaches as far as the walls";
            self.notes.warn(Location::START, message);
        }
        let width = self.width.unwrap_or_else(|| reach(|p| p.x));
        let height = self.height.unwrap_or_else(|| reach(|p| p.y));
        self.world.floor = Aabb::new(Point::origin(), Point::new(width, height));
        self.notes.finish(self.world)
    }
}

/// A pushed pose. Angles stay in degrees, so that quarter turns are exact.
#[derive(Debug, Clone, Copy, Default)]
struct Frame {
    x: f64,
    y: f64,
    clockwise: f64,
}

impl Frame {
    fn inner(&self, x: f64, y: f64, clockwise: f64) -> Self {
        let origin = self.to_world(Point::new(x, y));
        let clockwise = number::normalize_degrees(self.clockwise + clockwise);
        Self { x: origin.x, y: origin.y, clockwise }
    }

    fn to_world(self, local: Point) -> Point {
        let (sin, cos) = match self.clockwise {
            0.0 => (0.0, 1.0),
            90.0 => (-1.0, 0.0),
            -90.0 => (1.0, 0.0),
            180.0 | -180.0 => (0.0, -1.0),
            clockwise => math::sin_cos(-units::from_deg(clockwise)),
        };
        Point::new(self.x + cos * local.x - sin * local.y, self.y + sin * local.x + cos * local.y)
    }
}

fn pose(args: &mut Args<'_, '_>) -> Result<Pose, FormatError> {
    let (x, y) = (args.length("the start's x")?, args.length("the start's y")?);
    Ok(Pose::new(x, y, args.direction("the start's heading")?))
}

/// Writes a world in a form that [`parse`] reads back.
///
/// The format's floors begin at (0, 0); of other floors, only the upper right corner is kept. Objects, marks
/// and places are left out.
pub fn print(world: &World) -> String {
    lexer::written(|text| write_world(text, world))
}

fn write_world(text: &mut String, world: &World) -> std::fmt::Result {
    if let Some(t) = &world.terrain {
        let (width, height, top) =
            (millimetres(t.width), millimetres(t.height), millimetres(t.max_elevation));
        writeln!(text, "terrain {width} {height} {top} {}", quote(&t.file.to_string_lossy()))?;
    }
    let corner = world.floor.max;
    writeln!(text, "floor {} {}", millimetres(corner.x.max(0.0)), millimetres(corner.y.max(0.0)))?;
    if let Some(image) = &world.floor_texture {
        writeln!(text, "floor_texture {}", quote(&image.file.to_string_lossy()))?;
    }
    if let Some(level) = world.water_level {
        writeln!(text, "water_level {}", millimetres(level))?;
    }
    water::write(text, &world.water)?;
    if let Some(start) = world.start {
        let heading = degrees(start.heading);
        writeln!(text, "position {} {} {heading}", millimetres(start.x), millimetres(start.y))?;
    }
    world.walls.iter().try_for_each(|wall| write_wall(text, wall))
}

fn write_wall(text: &mut String, wall: &Wall) -> std::fmt::Result {
    let Segment { a, b } = wall.line;
    write!(text, "{} {} {} {}", millimetres(a.x), millimetres(a.y), millimetres(b.x), millimetres(b.y))?;
    let plain = Wall::new(a, b);
    if wall.colour != plain.colour {
        let c = wall.colour;
        write!(text, " {} {}", millimetres(wall.thickness), millimetres(wall.height))?;
        write!(text, " {} {} {}", c.red, c.green, c.blue)?;
    } else if *wall != plain {
        write!(text, " {} {}", millimetres(wall.thickness), millimetres(wall.height))?;
    }
    writeln!(text)
}

#[cfg(test)]
mod tests;
