use std::collections::BTreeMap;
use std::sync::Arc;

use super::super::error::{FormatError, Location, Notes, Parsed};
use super::super::lexer::{self, shown};
use super::super::limits::MAX_PLACED;
use super::super::source::{FileSource, Files};
use super::super::world_file::read_world;
use super::definitions::Definitions;
use super::document::{Position, SimFile, Statement};
use super::read::{SKIPPED, read};
use crate::geometry::{Point, Pose, units};
use crate::random::Stream;
use crate::world::{Object, Place, RobotPlacement, RobotSpec, Scene, World};

/// Default seed of random headings.
pub const HEADING_SEED: u64 = 0;

/// Side of the default world (m).
const DEFAULT_WORLD: f64 = 2.0;

/// Reads a script and all files that it names.
pub fn parse(text: &str, file: &str, files: &mut dyn FileSource) -> Result<Parsed<Scene>, FormatError> {
    parse_with(text, file, &mut Files::new(files, false))
}

/// Reads a script as a non-interactive simulator needs it, with warnings and workarounds:
///
/// - Invalid lines and lines with unreadable files are skipped.
/// - A robot or object whose file is missing is replaced by another one, under the name by which the script
///   places it.
/// - An unreadable world is replaced by a box of 2000 by 2000 mm, or larger if the placed things need it.
/// - A robot at a letter that the world lacks gets a place of its own.
///
/// Fails only if the text is too long.
pub fn parse_tolerantly(
    text: &str,
    file: &str,
    files: &mut dyn FileSource,
) -> Result<Parsed<Scene>, FormatError> {
    parse_with(text, file, &mut Files::new(files, true))
}

pub(in crate::world::formats) fn parse_with(
    text: &str,
    file: &str,
    files: &mut Files<'_>,
) -> Result<Parsed<Scene>, FormatError> {
    let document = read(text, file, files.tolerant)?;
    let scene = document.value.resolve_with(file, files, HEADING_SEED)?;
    let mut notes = Notes::new(file);
    notes.extend(document.warnings);
    notes.extend(scene.warnings);
    Ok(notes.finish(scene.value))
}

impl SimFile {
    /// The scene described by the script, including the files that it names. `file` is the script's own name,
    /// to which others are relative; `seed` is that of unspecified headings.
    pub fn resolve(
        &self,
        file: &str,
        files: &mut dyn FileSource,
        seed: u64,
    ) -> Result<Parsed<Scene>, FormatError> {
        self.resolve_with(file, &mut Files::new(files, false), seed)
    }

    fn resolve_with(
        &self,
        file: &str,
        files: &mut Files<'_>,
        seed: u64,
    ) -> Result<Parsed<Scene>, FormatError> {
        let mut resolver = Resolver {
            script: self,
            notes: Notes::new(file),
            definitions: Definitions::default(),
            letters: BTreeMap::new(),
            scene: Scene::new(World::walled(DEFAULT_WORLD, DEFAULT_WORLD)),
            headings: Stream::new(seed).child("heading", 0),
            strays: files.tolerant.then_some(0),
        };
        let world = resolver.read_world(files);
        let is_missing = world.is_err();
        resolver.get_over(world, "a box takes its place")?;
        for (index, statement) in self.statements.iter().enumerate() {
            let result = resolver.statement(index, statement, files);
            resolver.get_over(result, SKIPPED)?;
        }
        if is_missing {
            resolver.scene.world = box_around(&resolver.scene);
        }
        let start = resolver.scene.robots.first().map(|robot| robot.pose);
        resolver.scene.world.start = start.or(resolver.scene.world.start);
        Ok(resolver.notes.finish(resolver.scene))
    }
}

/// Distance from the farthest thing to the wall of a substitute box (m).
const MARGIN: f64 = 1.0;
/// Longest wall of a substitute box (m).
const LARGEST_BOX: f64 = 100.0;

/// Distance between robots at letters that the world lacks (m).
const STRAY_DISTANCE: f64 = 0.5;
/// Number of them per row.
const STRAYS_IN_A_ROW: u32 = 3;

/// Place of a robot whose letter the world lacks.
fn stray_place(number: u32) -> Point {
    let (row, column) = (number / STRAYS_IN_A_ROW, number % STRAYS_IN_A_ROW);
    Point::new(STRAY_DISTANCE * f64::from(column + 1), STRAY_DISTANCE * f64::from(row + 1))
}

struct Resolver<'a> {
    script: &'a SimFile,
    notes: Notes<'a>,
    definitions: Definitions,
    /// Places of each letter, in lower case, in the order of the maze.
    letters: BTreeMap<char, Vec<Place>>,
    scene: Scene,
    headings: Stream,
    /// Number of robots so far at letters that the world lacks; `None` if that is an error, like all others.
    strays: Option<u32>,
}

/// A box that contains all placed things.
fn box_around(scene: &Scene) -> World {
    let robots = scene.robots.iter().map(|robot| robot.pose.position());
    let objects = scene.world.objects.iter().map(|object| object.pose.position());
    let size = |far: f64| (far + MARGIN).ceil().clamp(DEFAULT_WORLD, LARGEST_BOX);
    let far =
        robots.chain(objects).fold(Point::origin(), |far, p| Point::new(far.x.max(p.x), far.y.max(p.y)));
    let World { floor, walls, .. } = World::walled(size(far.x), size(far.y));
    World { floor, walls, ..scene.world.clone() }
}

impl Resolver<'_> {
    /// Passes an error on, or converts it to a warning.
    fn get_over(&mut self, result: Result<(), FormatError>, instead: &str) -> Result<(), FormatError> {
        match result {
            Err(error) if self.strays.is_some() => {
                self.notes.get_over(error, instead);
                Ok(())
            }
            result => result,
        }
    }

    /// Letters may be used before the line that names the maze.
    fn read_world(&mut self, files: &mut Files<'_>) -> Result<(), FormatError> {
        let worlds =
            self.script.statements.iter().enumerate().filter_map(|(index, statement)| match statement {
                Statement::World(file) => Some((index, file)),
                _ => None,
            });
        let worlds: Vec<_> = worlds.collect();
        let Some(&(last, file)) = worlds.last() else { return Ok(()) };
        for &(index, _) in &worlds[..worlds.len() - 1] {
            self.notes.warn(
                self.script.location(index),
                "another `world` line follows, which counts; this one is skipped",
            );
        }
        let world = read_world(file, (self.notes.file, self.script.location(last)), files)?;
        self.notes.extend(world.warnings);
        self.scene.world = world.value;
        for place in &self.scene.world.places {
            self.letters.entry(place.letter.to_ascii_lowercase()).or_default().push(*place);
        }
        Ok(())
    }

    fn statement(
        &mut self,
        index: usize,
        statement: &Statement,
        files: &mut Files<'_>,
    ) -> Result<(), FormatError> {
        let at = self.script.location(index);
        match statement {
            Statement::World(_) => {}
            Statement::Settings(settings) => {
                self.scene.settings.show_sensors |= settings.show_sensors;
                self.scene.settings.show_traces |= settings.show_traces;
            }
            Statement::Robot(file) => self.definitions.robot_in(file, at, files, &mut self.notes)?,
            Statement::Object(file) => self.definitions.object_in(file, at, files, &mut self.notes)?,
            Statement::Place { name, at: position, program } => {
                self.place(name, *position, program.as_deref(), at)?;
            }
            Statement::Marker(marker) => self.scene.world.markers.push(*marker),
            Statement::Unknown(text) => {
                let line = lexer::line(self.notes.file, at.line, text)?;
                let name = line.as_ref().map_or("", |line| line.words[0].text);
                if self.definitions.knows(name) {
                    let broken = self.script.broken.iter().find(|(i, _)| *i == index);
                    let error = broken.map(|(_, error)| error.clone());
                    return Err(
                        error.unwrap_or_else(|| self.error(at, shown(name), "x, y and heading after it"))
                    );
                }
                self.warn_unknown(name, at);
            }
        }
        Ok(())
    }

    fn place(
        &mut self,
        name: &str,
        position: Position,
        program: Option<&str>,
        at: Location,
    ) -> Result<(), FormatError> {
        if !self.definitions.knows(name) {
            self.definitions.stand_in_for(name, at, &mut self.notes);
        }
        if let Some(spec) = self.definitions.robot(name) {
            return self.place_robot(&spec, position, program, at);
        }
        let Some(kind) = self.definitions.object(name) else {
            self.warn_unknown(name, at);
            return Ok(());
        };
        let Position::Pose { pose, elevation } = position else {
            return Err(self.error(
                at,
                format!("{} at a letter", shown(name)),
                "x, y and heading of the object",
            ));
        };
        if let Some(program) = program {
            let message =
                format!("{} is more than belongs in the line of an object; ignored", shown(program));
            self.notes.warn(at, message);
        }
        self.check_placed(at)?;
        self.scene.world.objects.push(Object { kind, pose, elevation: elevation.unwrap_or(0.0) });
        Ok(())
    }

    fn place_robot(
        &mut self,
        spec: &Arc<RobotSpec>,
        position: Position,
        program: Option<&str>,
        at: Location,
    ) -> Result<(), FormatError> {
        let program = program.map(str::to_string);
        let (letter, heading) = match position {
            Position::Pose { pose, elevation } => {
                self.check_placed(at)?;
                let (spec, elevation) = (Arc::clone(spec), elevation.unwrap_or(0.0));
                self.add_robot(RobotPlacement { elevation, program, ..RobotPlacement::new(spec, pose) });
                return Ok(());
            }
            Position::Letter { letter, heading } => (letter, heading),
        };
        let places = self.letters.get(&letter.to_ascii_lowercase()).cloned().unwrap_or_default();
        if places.is_empty() {
            let error = self.error(at, format!("the letter `{letter}`"), "a letter that stands in the maze");
            let Some(stray) = self.strays.as_mut() else { return Err(error) };
            let position = stray_place(*stray);
            *stray += 1;
            self.notes.get_over(error, "the robot stands at a place of its own");
            self.check_placed(at)?;
            let pose = Pose::new(position.x, position.y, heading.unwrap_or(0.0));
            self.add_robot(RobotPlacement { program, ..RobotPlacement::new(Arc::clone(spec), pose) });
            return Ok(());
        }
        let mut drawn = false;
        for place in places {
            self.check_placed(at)?;
            let heading = heading.or(place.heading).unwrap_or_else(|| {
                drawn = true;
                units::from_deg(self.headings.between(-180.0, 180.0).round())
            });
            let pose = Pose::new(place.position.x, place.position.y, heading);
            let program = program.clone();
            self.add_robot(RobotPlacement { program, ..RobotPlacement::new(Arc::clone(spec), pose) });
        }
        if drawn {
            self.notes.warn(at, "no heading; random ones are taken, the same each time");
        }
        Ok(())
    }

    fn add_robot(&mut self, robot: RobotPlacement) {
        let objects_before = self.scene.world.objects.len();
        self.scene.robots.push(RobotPlacement { objects_before, ..robot });
    }

    fn check_placed(&self, at: Location) -> Result<(), FormatError> {
        if self.scene.robots.len() + self.scene.world.objects.len() < MAX_PLACED {
            return Ok(());
        }
        Err(self.error(at, "one more robot or object".into(), &format!("at most {MAX_PLACED} of them")))
    }

    fn warn_unknown(&mut self, name: &str, at: Location) {
        let message =
            format!("{} is neither a keyword nor a known robot or object; the line is skipped", shown(name));
        self.notes.warn(at, message);
    }

    fn error(&self, at: Location, found: String, expected: &str) -> FormatError {
        FormatError::new(self.notes.file, at, found, expected)
    }
}
