//! EyeSim's objects (`.esObj`).
//!
//! | line | meaning |
//! |---|---|
//! | `obj FILE` | 3D model for cameras, a Wavefront OBJ in metres before scaling |
//! | `name NAME` | name for scenes; default: the name of the file |
//! | `scale S` | factor for the model and its colliders, whose numbers are in millimetres; default 1 |
//! | `mass KG X Y Z` | mass and its centre |
//! | `[collider] box X Y Z SX SY SZ` | solid cuboid: centre, sizes |
//! | `[collider] sphere X Y Z R` | solid ball |
//! | `[collider] capsule X Y Z R H AXIS` | solid capsule along `x`, `y` or `z` |
//! | `buoyancy VOLUME` | displaced water in cubic metres: in water, lighter objects float |
//! | `fixed` | immovable object |
//! | `falls` | robots knock it over; our extension, which EyeSim skips |
//! | `cone R TOP HEIGHT` | cone with these radii of foot and top as the shape; our extension |
//! | `colour R G B` | colour; our extension, which EyeSim skips |
//!
//! The model's axes point right, up and forwards. The object's shape is the upright one that contains all its
//! colliders.
//!
//! ```
//! use roverlab::world::formats::esobj;
//! let text = "name Crate\nmass 2 0 0 0\ncollider box 0 100 0 200 200 300\n";
//! let kind = esobj::parse(text, "crate.esObj")?.value;
//! assert_eq!((kind.name.as_str(), kind.mass, kind.shape.height()), ("Crate", 2.0, 0.2));
//! assert_eq!(esobj::parse(&esobj::print(&kind), "crate.esObj")?.value, kind);
//! # Ok::<(), roverlab::world::formats::FormatError>(())
//! ```

use std::fmt::Write as _;
use std::path::PathBuf;

use super::args::Args;
use super::error::{FormatError, Location, Notes, Parsed};
use super::lexer::{self, Line, quote, shown};
use super::limits::{MAX_METRES, MAX_PARTS};
use super::model;
use super::number::{self, MILLI, millimetres};
use super::source::{Files, check_length};
use crate::world::{Axis, Body, Collider, Colour, ObjectKind, Place3, Shape};

/// Default colour of objects.
pub const DEFAULT_COLOUR: Colour = Colour::new(160, 160, 160);

/// Shape of objects without colliders.
pub const DEFAULT_SHAPE: Shape = Shape::Cylinder { radius: 0.05, height: 0.1 };

/// Reads an object without its 3D model; [`load_object`](super::load_object) and scripts also read the model.
pub fn parse(text: &str, file: &str) -> Result<Parsed<ObjectKind>, FormatError> {
    let (kind, _) = read(text, file)?;
    Ok(kind)
}

/// Reads an object and its 3D model.
pub(super) fn parse_with_model(
    text: &str,
    file: &str,
    files: &mut Files<'_>,
) -> Result<Parsed<ObjectKind>, FormatError> {
    let (Parsed { value: mut kind, warnings }, model_at) = read(text, file)?;
    let mut notes = Notes::new(file);
    notes.extend(warnings);
    if let Some(model) = &kind.model {
        kind.mesh = model::load(model, (file, model_at), (kind.body.scale, kind.colour), files, &mut notes)?;
    }
    Ok(notes.finish(kind))
}

/// Reads an object; also returns the location of its model's name.
fn read(text: &str, file: &str) -> Result<(Parsed<ObjectKind>, Location), FormatError> {
    check_length(text, file)?;
    let kind = ObjectKind::new(super::stem(file), DEFAULT_SHAPE, DEFAULT_COLOUR);
    let mut reader = Reader { kind, cone: None, model_at: Location::START, notes: Notes::new(file) };
    for (number, text) in lexer::numbered(text) {
        if let Some(line) = lexer::line(file, number, text)? {
            reader.line(&line)?;
        }
    }
    let model_at = reader.model_at;
    Ok((reader.finish(), model_at))
}

struct Reader<'f> {
    kind: ObjectKind,
    cone: Option<Shape>,
    model_at: Location,
    notes: Notes<'f>,
}

impl Reader<'_> {
    fn line(&mut self, line: &Line<'_>) -> Result<(), FormatError> {
        let mut args = Args::after_keyword(line);
        match line.words[0].text.to_ascii_lowercase().as_str() {
            "obj" => {
                let model = args.path("the model's file", &[".obj"], &mut self.notes)?;
                self.kind.model = Some(PathBuf::from(model));
                self.model_at = line.location(1);
            }
            "name" => self.kind.name = args.name("a name")?,
            "scale" => self.kind.body.scale = args.plain("a scale", f64::MIN_POSITIVE..=MAX_METRES)?,
            "mass" => {
                self.kind.mass = args.plain("a mass in kilograms", 0.0..=1e9)?;
                self.kind.body.mass_centre = args.model_place("the mass")?;
            }
            "box" => self.box_collider(line, &mut args)?,
            "sphere" => self.sphere(line, &mut args)?,
            "capsule" => self.capsule(line, &mut args)?,
            "collider" => {
                let kind = args.word("`box`, `sphere` or `capsule`")?;
                match kind.text.to_ascii_lowercase().as_str() {
                    "box" => self.box_collider(line, &mut args)?,
                    "sphere" => self.sphere(line, &mut args)?,
                    "capsule" => self.capsule(line, &mut args)?,
                    _ => return Err(line.error(1, "`box`, `sphere` or `capsule`")),
                }
            }
            "buoyancy" => {
                let volume = args.plain("a volume in cubic metres", 0.0..=1e9)?;
                self.kind.buoyancy = Some(volume);
            }
            "fixed" => self.kind.fixed = true,
            "falls" => self.kind.falls = true,
            "cone" => {
                let radius = args.positive_size("the radius of the cone's foot")?;
                let top = args.positive_size("the radius of the cone's top")?;
                let height = args.positive_size("the cone's height")?;
                self.cone = Some(Shape::Cone { radius, top, height });
            }
            "colour" | "color" => self.kind.colour = args.colour("the object")?,
            _ => {
                let message = format!("unknown keyword {}; the line is skipped", shown(line.words[0].text));
                self.notes.warn(line.location(0), message);
                return Ok(());
            }
        }
        args.finish(&mut self.notes);
        Ok(())
    }

    fn box_collider(&mut self, line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<(), FormatError> {
        let centre = args.model_place("the box's middle")?;
        self.add(line, Collider::Box { size: args.model_size("the box's size")?, centre })
    }

    fn sphere(&mut self, line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<(), FormatError> {
        let centre = args.model_place("the sphere's middle")?;
        self.add(line, Collider::Sphere { radius: args.positive_size("the sphere's radius")?, centre })
    }

    fn capsule(&mut self, line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<(), FormatError> {
        let centre = args.model_place("the capsule's middle")?;
        let radius = args.positive_size("the capsule's radius")?;
        let height = args.positive_size("the capsule's height")?;
        let at = line.words.len() - args.left();
        let axis = match args.word("the axis `x`, `y` or `z`")?.text.to_ascii_lowercase().as_str() {
            "x" => Axis::Left,
            "y" => Axis::Up,
            "z" => Axis::Forward,
            _ => return Err(line.error(at, "the axis `x`, `y` or `z`")),
        };
        self.add(line, Collider::Capsule { radius, height, axis, centre })
    }

    fn add(&mut self, line: &Line<'_>, collider: Collider) -> Result<(), FormatError> {
        if self.kind.body.colliders.len() == MAX_PARTS {
            return Err(line.error(0, format!("at most {MAX_PARTS} colliders")));
        }
        self.kind.body.colliders.push(collider);
        Ok(())
    }

    fn finish(mut self) -> Parsed<ObjectKind> {
        let body = &mut self.kind.body;
        match body.shape() {
            None => {
                let message = "no collider; a cylinder of 100 mm across and 100 mm high is taken";
                self.notes.warn(Location::START, message);
                if self.kind.model.is_none() {
                    // Nothing needs scaling.
                    body.scale = 1.0;
                }
            }
            Some(shape) => {
                self.kind.shape = shape;
                // The shape is sufficient.
                if body.scale == 1.0 && *body.colliders == [Body::collider_of_shape(shape)] {
                    body.colliders.clear();
                }
            }
        }
        self.kind.shape = self.cone.unwrap_or(self.kind.shape);
        self.notes.finish(self.kind)
    }
}

/// Writes an object in a form that [`parse`] reads back.
///
/// If the shape differs from that of the kind's colliders, it replaces them.
pub fn print(kind: &ObjectKind) -> String {
    lexer::written(|text| write_kind(text, kind))
}

fn write_kind(text: &mut String, kind: &ObjectKind) -> std::fmt::Result {
    if let Some(model) = &kind.model {
        writeln!(text, "obj {}", quote(&model.to_string_lossy()))?;
    }
    writeln!(text, "name {}", quote(&kind.name))?;
    // Without colliders, only the model needs scaling.
    let bare = kind.model.is_some() && kind.body.colliders.is_empty() && kind.shape == DEFAULT_SHAPE;
    let keep = bare || kind.body.shape() == Some(kind.shape);
    let scale = if keep { kind.body.scale } else { 1.0 };
    writeln!(text, "scale {}", number::print(scale, 0))?;
    writeln!(text, "mass {} {}", number::print(kind.mass, 0), model_place(kind.body.mass_centre))?;
    if keep {
        kind.body.colliders.iter().try_for_each(|collider| write_collider(text, collider))?;
    } else {
        write_collider(text, &Body::collider_of_shape(kind.shape))?;
    }
    if let Some(volume) = kind.buoyancy {
        writeln!(text, "buoyancy {}", number::print(volume, 0))?;
    }
    if let Shape::Cone { radius, top, height } = kind.shape {
        writeln!(text, "cone {}", [radius, top, height].map(millimetres).join(" "))?;
    }
    if kind.fixed {
        writeln!(text, "fixed")?;
    }
    if kind.falls {
        writeln!(text, "falls")?;
    }
    if kind.colour != DEFAULT_COLOUR {
        writeln!(text, "colour {} {} {}", kind.colour.red, kind.colour.green, kind.colour.blue)?;
    }
    Ok(())
}

fn write_collider(text: &mut String, collider: &Collider) -> std::fmt::Result {
    match *collider {
        Collider::Box { size: [forward, left, up], centre } => {
            let (right, up, forward) = (millimetres(left), millimetres(up), millimetres(forward));
            writeln!(text, "collider box {} {right} {up} {forward}", model_place(centre))
        }
        Collider::Sphere { radius, centre } => {
            writeln!(text, "collider sphere {} {}", model_place(centre), millimetres(radius))
        }
        Collider::Capsule { radius, height, axis, centre } => {
            let axis = match axis {
                Axis::Left => "x",
                Axis::Up => "y",
                Axis::Forward => "z",
            };
            let (radius, height) = (millimetres(radius), millimetres(height));
            writeln!(text, "collider capsule {} {radius} {height} {axis}", model_place(centre))
        }
    }
}

/// A point in the order of the files: right, up, forward.
pub(super) fn model_place([forward, left, up]: Place3) -> String {
    [-left, up, forward].map(|metres| number::print(metres, MILLI)).join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn object(text: &str) -> ObjectKind {
        parse(text, "things/Pole.esObj").unwrap().value
    }

    #[test]
    fn both_spellings_of_colliders() {
        let old = object("obj pole.obj\nscale 0.025\nmass 2 0 100 0\ncapsule 0 7500 0 150 14200 y\nfixed\n");
        let new = object(
            "obj pole.obj\nscale 0.025\nmass 2 0 100 0\ncollider capsule 0 7500 0 150 14200 Y\nfixed\n",
        );
        assert_eq!(old, new);
        assert_eq!((old.name.as_str(), old.mass, old.fixed), ("Pole", 2.0, true));
        assert_eq!(old.body.mass_centre, [0.0, 0.0, 0.1]);
        let Shape::Cylinder { radius, height } = old.shape else { panic!("no cylinder") };
        assert!((radius - 0.003_75).abs() < 1e-12 && (height - 0.365).abs() < 1e-12);
    }

    #[test]
    fn sizes_are_right_up_forward() {
        let kind = object("name Cone-O\nbox 0 50 0 300 100 200 ; flat");
        assert_eq!(kind.name, "Cone-O");
        assert_eq!(kind.shape, Shape::Box { length: 0.2, width: 0.3, height: 0.1 });
        assert!(kind.body.colliders.is_empty());
    }

    #[test]
    fn an_object_without_a_collider_gets_one_with_a_warning() {
        let parsed = parse("obj a.obj\nbuoyancy 0.5", "a.esObj").unwrap();
        assert_eq!(parsed.value.shape, DEFAULT_SHAPE);
        assert_eq!(parsed.value.buoyancy, Some(0.5));
        assert_eq!(parsed.warnings.len(), 1, "{:?}", parsed.warnings);
    }

    #[test]
    fn a_cone_that_falls_survives() {
        let shape = Shape::Cone { radius: 0.129, top: 0.025, height: 0.325 };
        let kind = ObjectKind { falls: true, ..ObjectKind::new("Cone", shape, Colour::BLUE) };
        assert_eq!(object(&print(&kind)), kind);
        let error = parse("cone 129 -3 325\n", "a.esObj").unwrap_err();
        assert!(error.to_string().starts_with("a.esObj:1:10: found `-3`"), "{error}");
    }

    #[test]
    fn predefined_objects_survive() {
        for name in ObjectKind::PREDEFINED {
            // Models drawn in code are in no file.
            let kind = ObjectKind { mesh: None, ..ObjectKind::predefined(name).unwrap() };
            assert_eq!(object(&print(&kind)), kind);
        }
    }

    pub(in crate::world::formats) fn collider() -> impl Strategy<Value = Collider> {
        let place = || proptest::array::uniform3(-9.0..9.0f64);
        let size = || 0.001..9.0f64;
        let axis = prop_oneof![Just(Axis::Up), Just(Axis::Left), Just(Axis::Forward)];
        prop_oneof![
            (proptest::array::uniform3(0.001..9.0f64), place())
                .prop_map(|(size, centre)| Collider::Box { size, centre }),
            (size(), place()).prop_map(|(radius, centre)| Collider::Sphere { radius, centre }),
            (size(), size(), axis, place()).prop_map(|(radius, height, axis, centre)| Collider::Capsule {
                radius,
                height,
                axis,
                centre
            }),
        ]
    }

    prop_compose! {
        fn kind()(
            name in "[A-Za-z0-9 -]{1,9}",
            mass in 0.0..99.0f64,
            fixed in any::<bool>(),
            buoyancy in proptest::option::of(0.0..9.0f64),
            colour in any::<[u8; 3]>(),
            model in proptest::option::of("[a-z\\\\/]{1,9}\\.obj"),
            colliders in proptest::collection::vec(collider(), 1..4),
            mass_centre in proptest::array::uniform3(-9.0..9.0f64),
            scale in 0.001..9.0f64,
        ) -> ObjectKind {
            let body = Body { colliders, mass_centre, scale, ..Body::default() };
            let shape = body.shape().unwrap();
            let colour = Colour::new(colour[0], colour[1], colour[2]);
            ObjectKind { mass, fixed, buoyancy, model: model.map(PathBuf::from), body, ..ObjectKind::new(name, shape, colour) }
        }
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn what_is_printed_reads_back(kind in kind()) {
            let parsed = parse(&print(&kind), "x.esObj").unwrap();
            prop_assert!(parsed.warnings.is_empty());
            prop_assert_eq!(parsed.value, kind);
        }

        #[test]
        fn what_was_read_survives_printing(
            text in "((collider|box|sphere|capsule|scale|mass|name|obj|y| |\n|;|\"|-|[0-9.]{1,3}| 1| 2 3){1,9}\n){0,6}"
        ) {
            if let Ok(parsed) = parse(&text, "x.esObj") {
                prop_assert_eq!(parse(&print(&parsed.value), "x.esObj").unwrap().value, parsed.value);
            }
        }
    }
}
