use std::sync::Arc;

use super::super::error::{FormatError, Location, Notes};
use super::super::lexer::shown;
use super::super::limits::{MAX_DEFINITIONS, MAX_TEXT_BYTES};
use super::super::source::{Files, SourceFile, decode, missing, stem};
use super::super::{esobj, robi};
use crate::world::{ObjectKind, RobotSpec};

/// Robots whose names files cannot redefine.
const RESERVED: [&str; 3] = ["S4", "LabBot", "Omni"];

/// Workaround for a missing or broken file, in messages.
const ELSE_INSTEAD: &str = "something else takes its place";

/// Robots and objects known to a script: from its files and built in.
#[derive(Default)]
pub(super) struct Definitions {
    robots: Vec<Definition<RobotSpec>>,
    objects: Vec<Definition<ObjectKind>>,
    /// Built-in things that have been used.
    built_in_robots: Vec<Arc<RobotSpec>>,
    built_in_objects: Vec<Arc<ObjectKind>>,
    /// Missing or broken files; substitutes are created under names that appear later in the script.
    missing: Vec<Missing>,
}

/// A definition from a file.
struct Definition<T> {
    /// Name of the file without folder and extension.
    file: String,
    value: Arc<T>,
}

struct Missing {
    /// File name as in the script.
    reference: String,
    is_robot: bool,
    /// Whether a built-in thing has its name; it then substitutes only for similar names.
    built_in: bool,
}

impl Definitions {
    /// Adds the robot of a file.
    pub(super) fn robot_in(
        &mut self,
        file: &str,
        at: Location,
        files: &mut Files<'_>,
        notes: &mut Notes<'_>,
    ) -> Result<(), FormatError> {
        let built_in = RobotSpec::predefined(&stem(file)).is_some();
        let Some((name, text)) = self.text((file, at), (true, built_in), files, notes)? else {
            return Ok(());
        };
        let parsed = robi::parse_with_model(&text, &name, files);
        let parsed = files.get_over(parsed, ELSE_INSTEAD, notes)?;
        let Some(parsed) = parsed else {
            self.missing.push(Missing { reference: file.into(), is_robot: true, built_in });
            return Ok(());
        };
        notes.extend(parsed.warnings);
        if is_reserved(&parsed.value.name) {
            let message =
                format!("the name {} is reserved; the built-in robot is used", shown(&parsed.value.name));
            notes.warn(at, message);
        }
        self.robots.push(Definition { file: stem(file), value: Arc::new(parsed.value) });
        Ok(())
    }

    /// Adds the object of a file.
    pub(super) fn object_in(
        &mut self,
        file: &str,
        at: Location,
        files: &mut Files<'_>,
        notes: &mut Notes<'_>,
    ) -> Result<(), FormatError> {
        let built_in = ObjectKind::predefined(&stem(file)).is_some();
        let Some((name, text)) = self.text((file, at), (false, built_in), files, notes)? else {
            return Ok(());
        };
        let parsed = esobj::parse_with_model(&text, &name, files);
        let Some(parsed) = files.get_over(parsed, ELSE_INSTEAD, notes)? else {
            self.missing.push(Missing { reference: file.into(), is_robot: false, built_in });
            return Ok(());
        };
        notes.extend(parsed.warnings);
        self.objects.push(Definition { file: stem(file), value: Arc::new(parsed.value) });
        Ok(())
    }

    /// Name and text of a file; `None` if it does not exist and a substitute is used.
    fn text(
        &mut self,
        (file, at): (&str, Location),
        (is_robot, built_in): (bool, bool),
        files: &mut Files<'_>,
        notes: &mut Notes<'_>,
    ) -> Result<Option<(String, String)>, FormatError> {
        if self.robots.len() + self.objects.len() + self.missing.len() >= MAX_DEFINITIONS {
            let expected = format!("at most {MAX_DEFINITIONS} files of robots and objects");
            return Err(FormatError::new(notes.file, at, "one more file", expected));
        }
        let named = (notes.file, at);
        let Some(SourceFile { name, bytes }) = files.read_if_there(file, named, MAX_TEXT_BYTES)? else {
            if built_in {
                let what = if is_robot { "robot" } else { "object" };
                notes.warn(at, format!("{} does not exist; the built-in {what} is used", shown(file)));
            } else if files.tolerant {
                notes.get_over(missing(file, named), ELSE_INSTEAD);
            } else {
                return Err(missing(file, named));
            }
            self.missing.push(Missing { reference: file.into(), is_robot, built_in });
            return Ok(None);
        };
        let mut own = Notes::new(&name);
        let text = decode(bytes, &mut own)?;
        notes.extend(own.finish(()).warnings);
        Ok(Some((name, text)))
    }

    /// Assigns an undefined name to a substitute for a missing file: the one with the most similar name,
    /// otherwise the first one.
    pub(super) fn stand_in_for(&mut self, name: &str, at: Location, notes: &mut Notes<'_>) {
        let fitness = |missing: &Missing| {
            let likeness = likeness(&stem(&missing.reference), name);
            (likeness > 0 || !missing.built_in).then_some(likeness)
        };
        let best = self.missing.iter().filter_map(fitness).max();
        let first = self.missing.iter().position(|missing| best.is_some() && fitness(missing) == best);
        let Some(index) = first else { return };
        let Missing { reference, is_robot, .. } = self.missing.remove(index);
        let (file, what) = (stem(&reference), if is_robot { "a robot" } else { "an object" });
        notes.warn(at, format!("{what} takes the place of {}, from {}", shown(name), shown(&reference)));
        if is_robot {
            let like = RobotSpec::predefined(&file).unwrap_or_else(|| robot_like(&reference));
            let value = Arc::new(RobotSpec { name: name.into(), ..like });
            self.robots.push(Definition { file, value });
        } else {
            let plain = || ObjectKind::new(name, esobj::DEFAULT_SHAPE, esobj::DEFAULT_COLOUR);
            let like = ObjectKind::predefined(&file).unwrap_or_else(plain);
            let value = Arc::new(ObjectKind { name: name.into(), ..like });
            self.objects.push(Definition { file, value });
        }
    }

    pub(super) fn knows(&mut self, name: &str) -> bool {
        self.robot(name).is_some() || self.object(name).is_some()
    }

    pub(super) fn robot(&mut self, name: &str) -> Option<Arc<RobotSpec>> {
        let defined = find(&self.robots, name, |spec| &spec.name).filter(|_| !is_reserved(name));
        defined.or_else(|| {
            let make = || RobotSpec::predefined(name);
            built_in(&mut self.built_in_robots, make, |spec| spec.name.eq_ignore_ascii_case(name))
        })
    }

    pub(super) fn object(&mut self, name: &str) -> Option<Arc<ObjectKind>> {
        let defined = find(&self.objects, name, |kind| &kind.name);
        defined.or_else(|| {
            let make = || ObjectKind::predefined(name);
            built_in(&mut self.built_in_objects, make, |kind| kind.name.eq_ignore_ascii_case(name))
        })
    }
}

/// One shared instance for all users.
fn built_in<T>(
    known: &mut Vec<Arc<T>>,
    make: impl Fn() -> Option<T>,
    is_it: impl Fn(&T) -> bool,
) -> Option<Arc<T>> {
    if let Some(value) = known.iter().find(|value| is_it(value)) {
        return Some(Arc::clone(value));
    }
    known.push(Arc::new(make()?));
    known.last().cloned()
}

fn is_reserved(name: &str) -> bool {
    RESERVED.iter().any(|reserved| reserved.eq_ignore_ascii_case(name))
}

/// Similarity of a file's name and another name: 2 if their letters and digits are equal, 1 if one contains
/// the other.
fn likeness(file: &str, name: &str) -> u8 {
    let plain = |text: &str| text.to_ascii_lowercase().replace(|c: char| !c.is_ascii_alphanumeric(), "");
    let (file, name) = (plain(file), plain(name));
    if file == name { 2 } else { u8::from(file.contains(&name) || name.contains(&file)) }
}

/// A robot with the drive suggested by the file's path.
fn robot_like(reference: &str) -> RobotSpec {
    let reference = reference.to_ascii_lowercase();
    let says = |words: &[&str]| words.iter().any(|word| reference.contains(word));
    if says(&["ackermann", "car"]) {
        RobotSpec::car()
    } else if says(&["omni", "mecanum"]) {
        RobotSpec::omni()
    } else {
        RobotSpec::s4()
    }
}

/// The last definition with a stated name, otherwise the last one with that file name.
fn find<T>(definitions: &[Definition<T>], name: &str, stated: impl Fn(&T) -> &str) -> Option<Arc<T>> {
    let named = |what: &str| what.eq_ignore_ascii_case(name);
    let by_name = definitions.iter().rev().find(|definition| named(stated(&definition.value)));
    let found = by_name.or_else(|| definitions.iter().rev().find(|definition| named(&definition.file)));
    found.map(|definition| Arc::clone(&definition.value))
}
