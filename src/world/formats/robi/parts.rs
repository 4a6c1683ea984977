//! Lines about a robot's solid and wheels.

use super::super::args::Args;
use super::super::error::FormatError;
use super::super::lexer::Line;
use super::super::limits::MAX_DEGREES;
use crate::geometry::{Aabb, Point, units};
use crate::world::{Axis, CarDynamics, Collider, Footprint, InertialSpec, Mast};

/// A `dynamics` line.
pub(super) fn dynamics(args: &mut Args<'_, '_>) -> Result<CarDynamics, FormatError> {
    Ok(CarDynamics {
        mass_centre: args.positive_size("the distance of the mass from the driven axle")?,
        gyration: args.positive_size("the radius of gyration")?,
        grip: args.positive_size("the grip per second squared")?,
        stiffness: args.plain("the tyres' stiffness per radian", f64::MIN_POSITIVE..=1e3)?,
        balance: args.plain("the share of the front tyres", f64::MIN_POSITIVE..=1e3)?,
        brake: args.positive_size("the highest deceleration per second squared")?,
        steering_rate: units::from_deg(
            args.degrees("the steering's rate per second", f64::MIN_POSITIVE..=1e4)?,
        ),
    })
}

/// A `wheel` line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wheel {
    pub(super) diameter: f64,
    pub(super) max_speed: f64,
    pub(super) ticks: f64,
    pub(super) track: f64,
}

impl Wheel {
    /// Diameter, degrees per second, ticks per turn, half of the track.
    pub(super) fn read(args: &mut Args<'_, '_>) -> Result<Self, FormatError> {
        Ok(Self {
            diameter: args.positive_size("the wheel's diameter")?,
            max_speed: units::from_deg(
                args.degrees("the wheel's highest speed per second", f64::MIN_POSITIVE..=MAX_DEGREES)?,
            ),
            ticks: args.plain("the encoder's ticks per turn", f64::MIN_POSITIVE..=1e9)?,
            track: 2.0 * args.positive_size("half the distance between the wheels")?,
        })
    }
}

/// A `collider` line.
pub(super) fn collider(line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<Collider, FormatError> {
    let expected = "`box`, `sphere` or `capsule`";
    match args.word(expected)?.text.to_ascii_lowercase().as_str() {
        "box" => {
            let size = args.model_size("the box's size")?;
            Ok(Collider::Box { size, centre: args.model_place("the box's middle")? })
        }
        "sphere" => {
            let radius = args.positive_size("the sphere's radius")?;
            Ok(Collider::Sphere { radius, centre: args.model_place("the sphere's middle")? })
        }
        "capsule" => {
            let radius = args.positive_size("the capsule's radius")?;
            let height = args.positive_size("the capsule's height")?;
            let centre = args.model_place("the capsule's middle")?;
            Ok(Collider::Capsule { radius, height, axis: Axis::Up, centre })
        }
        _ => Err(line.error(1, expected)),
    }
}

/// An `axis` or `axel` line: forward and up.
pub(super) fn axle(args: &mut Args<'_, '_>) -> Result<[f64; 2], FormatError> {
    let up = args.length("the axle's height")?;
    Ok([args.length("the axle's distance ahead")?, up])
}

/// An `outline` line: footprint and height.
pub(super) fn outline(line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<(Footprint, f64), FormatError> {
    let expected = "`disc` or `rectangle`";
    let footprint = match args.word(expected)?.text.to_ascii_lowercase().as_str() {
        "disc" => Footprint::Disc { radius: args.positive_size("the outline's radius")? },
        "rectangle" => Footprint::Rectangle(rectangle(line, args, "outline")?),
        _ => return Err(line.error(1, expected)),
    };
    Ok((footprint, args.positive_size("the outline's height")?))
}

/// A `mast` line.
pub(super) fn mast(line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<Mast, FormatError> {
    Ok(Mast { outline: rectangle(line, args, "mast")?, top: args.positive_size("the mast's height")? })
}

/// Back, right, front and left side of a rectangle.
fn rectangle(line: &Line<'_>, args: &mut Args<'_, '_>, what: &str) -> Result<Aabb, FormatError> {
    let first = line.words.len() - args.left();
    let mut side = |which: &str| args.length(&format!("the {what}'s {which} side"));
    let (back, right, front, left) = (side("back")?, side("right")?, side("front")?, side("left")?);
    if front == back {
        return Err(line.error(first + 2, format!("the {what}'s front side, apart from its back side")));
    }
    if left == right {
        return Err(line.error(first + 3, format!("the {what}'s left side, apart from its right side")));
    }
    Ok(Aabb::new(Point::new(back, right), Point::new(front, left)))
}

/// An `inertial` line: three channels for each possible measurement.
pub(super) fn inertial(line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<InertialSpec, FormatError> {
    let numbers = args.left();
    if ![3, 6, 9].contains(&numbers) {
        return Err(line.error(1 + numbers.min(9), "3, 6 or 9 channels"));
    }
    let mut groups = [None; 3];
    let mut known = Vec::new();
    for group in &mut groups[..numbers / 3] {
        let mut channel = || args.count("a channel of the inertial unit", 0..=255);
        let channels = [channel()?, channel()?, channel()?].map(|channel| channel as u8);
        let last = line.words.len() - args.left() - 1;
        if channels == [0; 3] {
            continue;
        }
        if channels.contains(&0) {
            return Err(line.error(last, "three channels from 1 to 255, or 0 0 0"));
        }
        for channel in channels {
            if known.contains(&channel) {
                return Err(line.error(last, "each channel once"));
            }
            known.push(channel);
        }
        *group = Some(channels);
    }
    let [attitude, turn_rates, acceleration] = groups;
    Ok(InertialSpec { attitude, turn_rates, acceleration })
}
