//! The lines of boats and underwater craft, and the defaults of missing ones.

use std::fmt::{Result as Written, Write as _};

use super::super::args::Args;
use super::super::error::{FormatError, Location, Notes};
use super::super::lexer::{Line, quote};
use super::super::limits::MAX_PARTS;
use super::super::number::{self, millimetres};
use crate::geometry::{Point3, Vector3};
use crate::kinematics::marine::{Craft, CraftSpec, HullPart, MAX_THRUSTERS, Thruster};
use crate::world::{Body, Collider, RobotSpec};

/// The properties of a craft stated in a file.
#[derive(Default)]
pub(super) struct CraftLines {
    hull: Vec<HullPart>,
    /// With the lines in which they stand.
    thrusters: Vec<(u32, Thruster, Location)>,
    damping: Option<([f64; 6], [f64; 6])>,
    added_mass: Option<[f64; 6]>,
    inertia: Option<[f64; 6]>,
}

/// Buoyancy of an underwater craft relative to its weight, for a file without a hull.
const RESERVE: f64 = 1.05;
/// Least buoyancy of a boat relative to its weight, for a file without a hull.
const FREEBOARD: f64 = 2.0;
/// Default force of a thruster per mass (N/kg): Mako's.
const STRENGTH: f64 = 0.7;
/// Default position of vertical thrusters as a fraction of half the length: Mako's.
const NEAR_THE_ENDS: f64 = 0.75;
/// Density of fresh water (kg/m³).
const FRESH: f64 = 1000.0;

impl CraftLines {
    /// Reads a line. Returns whether the keyword is one of a craft.
    pub(super) fn line(
        &mut self,
        keyword: &str,
        line: &Line<'_>,
        args: &mut Args<'_, '_>,
    ) -> Result<bool, FormatError> {
        match keyword {
            "hull" => {
                if self.hull.len() == MAX_PARTS {
                    return Err(line.error(0, format!("at most {MAX_PARTS} of them")));
                }
                self.hull.push(part(line, args)?);
            }
            "thruster" => self.thruster(line, args)?,
            "damping" => {
                let linear = six(args, "the linear damping", 0.0)?;
                self.damping = Some((linear, six(args, "the quadratic damping", 0.0)?));
            }
            "added_mass" => self.added_mass = Some(six(args, "the added mass", 0.0)?),
            "inertia" => self.inertia = Some(six(args, "the inertia", -1e9)?),
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn thruster(&mut self, line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<(), FormatError> {
        let id = args.count("the thruster's number", 1..=MAX_THRUSTERS as u32)?;
        let name = args.name("the thruster's name")?;
        if self.thrusters.iter().any(|thruster| thruster.0 == id) {
            return Err(line.error(1, "a number that no thruster before it has"));
        }
        let place = place(args, "the thruster's place")?;
        let at = line.words.len() - args.left();
        let mut part = |axis| args.plain(&format!("the thruster's direction {axis}"), -1e6..=1e6);
        let direction = Vector3::new(part("x")?, part("y")?, part("z")?);
        if direction.norm() < 1e-6 {
            return Err(line.error(at, "a direction with some length"));
        }
        let force = args.plain("the thruster's force in newtons", 0.0..=1e6)?;
        let mut thruster = Thruster::new(name, place, direction, force);
        if args.left() > 0 {
            thruster.back = args.plain("the thruster's force backward in newtons", 0.0..=force)?;
        }
        self.thrusters.push((id, thruster, line.location(1)));
        Ok(())
    }

    /// The craft of these lines and of a robot's mass and colliders.
    pub(super) fn finish(
        mut self,
        boat: bool,
        spec: &RobotSpec,
        notes: &mut Notes<'_>,
    ) -> Result<CraftSpec, FormatError> {
        let hull = match std::mem::take(&mut self.hull) {
            parts if parts.is_empty() => hull_of(&spec.body, spec.mass, boat, notes),
            parts => parts,
        };
        let wrong =
            |found: String, expected: &str| FormatError::new(notes.file, Location::START, found, expected);
        if spec.mass <= 0.0 {
            return Err(wrong("a craft without a mass".into(), "a `mass` line of more than 0 kg"));
        }
        let mut craft = CraftSpec::of_hull(spec.mass, centre(&spec.body, &hull), hull);
        self.put_numbers(&mut craft);
        self.thrusters.sort_by_key(|thruster| thruster.0);
        for (index, (id, _, at)) in self.thrusters.iter().enumerate() {
            if *id as usize != index + 1 {
                let expected = "thrusters numbered from 1 without a gap";
                return Err(FormatError::new(notes.file, *at, format!("thruster {id}"), expected));
            }
        }
        craft.thrusters = self.thrusters.into_iter().map(|thruster| thruster.1).collect();
        if craft.thrusters.is_empty() {
            notes.warn(
                Location::START,
                "no `thruster` line; thrusters as strong as the craft is heavy are taken",
            );
            craft.thrusters = thrusters_of(&craft, boat);
        }
        for thruster in &mut craft.thrusters {
            thruster.lag = spec.motor.time_constant;
        }
        // Fails for an inertia that no body has too; the steps of a simulation are of no account.
        Craft::new(&craft, 0.01).map_err(|error| {
            let found = format!("a {} of {}", error.name(), number::print(error.value(), 0));
            FormatError::new(notes.file, Location::START, found, error.expected())
        })?;
        Ok(craft)
    }

    /// The radius of the footprint of a craft without colliders.
    pub(super) fn radius(craft: &CraftSpec) -> f64 {
        let (low, high) = bounds(&craft.hull);
        low.abs().sup(&high.abs()).xy().norm()
    }

    fn put_numbers(&self, craft: &mut CraftSpec) {
        if let Some((linear, quadratic)) = self.damping {
            (craft.linear_damping, craft.quadratic_damping) = (linear, quadratic);
        }
        craft.added_mass = self.added_mass.unwrap_or(craft.added_mass);
        if let Some([xx, yy, zz, xy, xz, yz]) = self.inertia {
            craft.inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        }
    }
}

/// A `hull` line: forward, left, up.
fn part(line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<HullPart, FormatError> {
    let expected = "`box`, `capsule` or `ellipsoid`";
    match args.word(expected)?.text.to_ascii_lowercase().as_str() {
        "box" => {
            let size = sizes(args, "the box's size")?;
            Ok(HullPart::Box { size, centre: place(args, "the box's middle")? })
        }
        "ellipsoid" => {
            let half_axes = sizes(args, "the ellipsoid's half axis")?;
            Ok(HullPart::Ellipsoid { half_axes, centre: place(args, "the ellipsoid's middle")? })
        }
        "capsule" => {
            let at = line.words.len() - args.left();
            let radius = args.positive_size("the capsule's radius")?;
            let length = args.positive_size("the capsule's length")?;
            if length < 2.0 * radius {
                return Err(line.error(at + 1, "a capsule at least as long as across"));
            }
            let centre = place(args, "the capsule's middle")?;
            let axes = "the axis `x`, `y` or `z`";
            let at = line.words.len() - args.left();
            let axis = if args.left() > 0 { args.word(axes)?.text.to_ascii_lowercase() } else { "x".into() };
            let axis = ["x", "y", "z"].iter().position(|name| *name == axis);
            Ok(HullPart::Capsule { radius, length, axis: axis.ok_or_else(|| line.error(at, axes))?, centre })
        }
        _ => Err(line.error(1, expected)),
    }
}

fn sizes(args: &mut Args<'_, '_>, what: &str) -> Result<Vector3, FormatError> {
    let mut size = |axis| args.positive_size(&format!("{what} {axis}"));
    Ok(Vector3::new(size("x")?, size("y")?, size("z")?))
}

fn place(args: &mut Args<'_, '_>, what: &str) -> Result<Point3, FormatError> {
    let mut length = |axis| args.length(&format!("{what} {axis}"));
    Ok(Point3::new(length("x")?, length("y")?, length("z")?))
}

fn six(args: &mut Args<'_, '_>, what: &str, least: f64) -> Result<[f64; 6], FormatError> {
    let mut values = [0.0; 6];
    for (value, axis) in values.iter_mut().zip(["surge", "sway", "heave", "roll", "pitch", "yaw"]) {
        *value = args.plain(&format!("{what} in {axis}"), least..=1e9)?;
    }
    Ok(values)
}

/// The hull that follows from a robot's colliders. As these hold a robot rather than water out, they are
/// scaled: an underwater craft has a little volume in reserve, a boat floats by half at the most.
fn hull_of(body: &Body, mass: f64, boat: bool, notes: &mut Notes<'_>) -> Vec<HullPart> {
    let mut parts: Vec<HullPart> = body.colliders.iter().map(part_of).collect();
    if parts.is_empty() {
        notes.warn(
            Location::START,
            "neither `hull` nor `collider` lines; the hull is a ball that carries the mass",
        );
        parts.push(HullPart::Ellipsoid {
            half_axes: Vector3::repeat(0.2),
            centre: Point3::new(0.0, 0.0, 0.2),
        });
    }
    let volume: f64 = parts.iter().map(HullPart::volume).sum();
    let wanted = mass / FRESH * if boat { FREEBOARD } else { RESERVE };
    let scale = crate::geometry::math::pow(wanted / volume, 1.0 / 3.0);
    if scale.is_finite() && scale > 0.0 && (!boat || scale > 1.0) {
        for part in &mut parts {
            *part = scaled(*part, scale);
        }
    }
    parts
}

fn part_of(collider: &Collider) -> HullPart {
    match *collider {
        Collider::Box { size, centre } => HullPart::Box { size: size.into(), centre: centre.into() },
        Collider::Sphere { radius, centre } => {
            HullPart::Ellipsoid { half_axes: Vector3::repeat(radius), centre: centre.into() }
        }
        Collider::Capsule { radius, height, axis, centre } => HullPart::Capsule {
            radius,
            length: height.max(2.0 * radius),
            axis: axis as usize,
            centre: centre.into(),
        },
    }
}

fn scaled(part: HullPart, scale: f64) -> HullPart {
    match part {
        HullPart::Box { size, centre } => HullPart::Box { size: size * scale, centre },
        HullPart::Ellipsoid { half_axes, centre } => {
            HullPart::Ellipsoid { half_axes: half_axes * scale, centre }
        }
        HullPart::Capsule { radius, length, axis, centre } => {
            HullPart::Capsule { radius: radius * scale, length: length * scale, axis, centre }
        }
    }
}

/// The box around a hull.
fn bounds(hull: &[HullPart]) -> (Vector3, Vector3) {
    let none = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    hull.iter().fold(none, |(low, high), part| {
        let (centre, half) = (part.centre().coords, part.half_size());
        (low.inf(&(centre - half)), high.sup(&(centre + half)))
    })
}

/// The middle of the mass: as stated, or a tenth of the hull's height below its middle, so that it stays
/// upright.
fn centre(body: &Body, hull: &[HullPart]) -> Point3 {
    if body.mass_centre != [0.0; 3] {
        return body.mass_centre.into();
    }
    let whole: f64 = hull.iter().map(HullPart::volume).sum();
    let middle: Vector3 = hull.iter().map(|part| part.centre().coords * (part.volume() / whole)).sum();
    let (low, high) = bounds(hull);
    (middle - Vector3::z() * (0.1 * (high.z - low.z))).into()
}

/// The thrusters of a craft whose file states none: those of Mako, or two at the stern of a boat.
fn thrusters_of(craft: &CraftSpec, boat: bool) -> Vec<Thruster> {
    let (low, high) = bounds(&craft.hull);
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let force = STRENGTH * craft.mass;
    let at = |name: &str, x: f64, y: f64, z: f64, direction| {
        let place = Point3::new(middle.x + x * half.x, middle.y + y * half.y, z);
        Thruster::new(name, place, direction, force)
    };
    let level = middle.z;
    if boat {
        return vec![
            at("LEFT", -NEAR_THE_ENDS, 1.0, low.z, Vector3::x()),
            at("RIGHT", -NEAR_THE_ENDS, -1.0, low.z, Vector3::x()),
        ];
    }
    vec![
        at("LEFT", 0.0, 1.0, level, Vector3::x()),
        at("FRONT", NEAR_THE_ENDS, 0.0, level, Vector3::z()),
        at("RIGHT", 0.0, -1.0, level, Vector3::x()),
        at("BACK", -NEAR_THE_ENDS, 0.0, level, Vector3::z()),
    ]
}

/// Writes a craft's own lines.
pub(super) fn write(text: &mut String, craft: &CraftSpec) -> Written {
    let place = |at: &Point3| [at.x, at.y, at.z].map(millimetres).join(" ");
    let numbers =
        |values: &[f64]| values.iter().map(|&value| number::print(value, 0)).collect::<Vec<_>>().join(" ");
    for part in &craft.hull {
        let centre = place(&part.centre());
        match part {
            HullPart::Box { size, .. } => writeln!(text, "hull box {} {centre}", place(&(*size).into()))?,
            HullPart::Ellipsoid { half_axes, .. } => {
                writeln!(text, "hull ellipsoid {} {centre}", place(&(*half_axes).into()))?;
            }
            HullPart::Capsule { radius, length, axis, .. } => {
                let size = [*radius, *length].map(millimetres).join(" ");
                writeln!(text, "hull capsule {size} {centre} {}", ["x", "y", "z"][*axis % 3])?;
            }
        }
    }
    let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = craft.inertia;
    writeln!(text, "inertia {}", numbers(&[xx, yy, zz, xy, xz, yz]))?;
    writeln!(text, "added_mass {}", numbers(&craft.added_mass))?;
    writeln!(text, "damping {} {}", numbers(&craft.linear_damping), numbers(&craft.quadratic_damping))?;
    for (index, thruster) in craft.thrusters.iter().enumerate() {
        let (id, at, to) = (index + 1, place(&thruster.place), numbers(thruster.direction.as_slice()));
        let forces = numbers(&[thruster.force, thruster.back]);
        writeln!(text, "thruster {id} {} {at} {to} {forces}", quote(&thruster.name))?;
    }
    Ok(())
}
