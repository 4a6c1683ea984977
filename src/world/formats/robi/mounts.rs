//! Poses of sensors: rules that reconcile existing files.

use super::super::error::FormatError;
use super::super::lexer::Line;
use crate::geometry::units;
use crate::world::Mount;
use crate::world::formats::args::Args;

/// Meaning of the first three columns and of the rotation columns of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Columns {
    /// Forward, left, up; angles to the left.
    ForwardLeftUp,
    /// Side, forward, up; angles clockwise.
    SideForwardUp,
}

/// A sensor's numbers as in the file: metres and degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Raw {
    pub(super) place: [f64; 3],
    pub(super) rotation: [f64; 3],
}

impl Raw {
    /// Three coordinates and three angles.
    pub(super) fn read(args: &mut Args<'_, '_>, what: &str) -> Result<Self, FormatError> {
        let place = Self::place(args, what)?;
        let mut angle = |axis| args.direction_degrees(&format!("{what}'s rotation {axis}"));
        Ok(Self { place, rotation: [angle(1)?, angle(2)?, angle(3)?] })
    }

    /// Three coordinates and one angle, to the left.
    pub(super) fn read_with_yaw(args: &mut Args<'_, '_>, what: &str) -> Result<Self, FormatError> {
        let place = Self::place(args, what)?;
        Ok(Self { place, rotation: [0.0, args.direction_degrees(&format!("{what}'s rotation"))?, 0.0] })
    }

    fn place(args: &mut Args<'_, '_>, what: &str) -> Result<[f64; 3], FormatError> {
        let mut length = |axis| args.length(&format!("{what}'s {axis}"));
        Ok([length("x")?, length("y")?, length("z")?])
    }

    /// Pose relative to the driven axle, which is `ahead` metres before the model's origin, of a sensor with
    /// a name.
    pub(super) fn mount(&self, columns: Columns, name: &str, ahead: f64) -> Mount {
        let ([a, b, z], [down, second, third]) = (self.place, self.rotation);
        let (forward, aside, turn, roll) = match columns {
            Columns::ForwardLeftUp => (a, b, second, third),
            Columns::SideForwardUp => (b, a, -third, -second),
        };
        let (y, yaw) = match side(name) {
            Some(Side::Left) => (aside.abs(), turn.abs()),
            Some(Side::Right) => (-aside.abs(), -turn.abs()),
            None => (aside, turn),
        };
        let [roll, pitch, yaw] = [roll, down, yaw].map(|turn| {
            // A turn of zero has no sign, and a half turn has only one representation.
            units::from_deg(if turn == -180.0 { 180.0 } else { turn + 0.0 })
        });
        Mount { x: forward - ahead, y, z, roll, pitch, yaw }
    }

    /// The one of the last two rotations that turns a single-ray sensor sideways, if exactly one of them is
    /// not zero; the other would rotate it about its line of sight.
    fn yaw_column(&self) -> Option<usize> {
        match (self.rotation[1] != 0.0, self.rotation[2] != 0.0) {
            (true, false) => Some(1),
            (false, true) => Some(2),
            _ => None,
        }
    }
}

/// Columns of a file whose distance sensors have these names and numbers.
pub(super) fn columns<'n>(sensors: &(impl Iterator<Item = (&'n str, Raw)> + Clone)) -> Columns {
    let says = |column| sensors.clone().any(|(_, raw)| raw.yaw_column() == Some(column));
    let ahead = |(name, raw): (&str, Raw)| {
        name.to_ascii_uppercase().contains("FRONT") && raw.place[0] == 0.0 && raw.place[1] != 0.0
    };
    let third = || sensors.clone().any(|(_, raw)| raw.rotation[2] != 0.0);
    if says(2) || (!says(1) && (third() || sensors.clone().any(ahead))) {
        Columns::SideForwardUp
    } else {
        Columns::ForwardLeftUp
    }
}

/// Position of a camera: forward, left, up; except for x = 0 with a sideways offset, where no camera is
/// mounted.
pub(super) fn camera_place([a, b, z]: [f64; 3], ahead: f64) -> Mount {
    let (forward, left) = if a == 0.0 && b != 0.0 { (b, 0.0) } else { (a, b) };
    Mount { x: forward - ahead, y: left, z, ..Mount::default() }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
}

/// Side indicated by a sensor's name.
pub(super) fn side(name: &str) -> Option<Side> {
    let name = name.to_ascii_uppercase();
    let parts = || name.split(|c: char| !c.is_ascii_alphabetic());
    let short = |part: &&str| !part.is_empty() && part.chars().all(|c| "FBLR".contains(c));
    let says = |word: &str, letter: char| {
        name.contains(word) || parts().filter(short).any(|part| part.contains(letter))
    };
    match (says("LEFT", 'L'), says("RIGHT", 'R')) {
        (true, false) => Some(Side::Left),
        (false, true) => Some(Side::Right),
        _ => None,
    }
}

/// Whether a `psd` line begins with the number rather than the name.
pub(super) fn number_first(line: &Line<'_>) -> bool {
    Args::after_keyword(line).numbers_ahead() > 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_sides() {
        for (name, expected) in [
            ("PSD_LEFT", Some(Side::Left)),
            ("psd_right", Some(Side::Right)),
            ("PSD_FL", Some(Side::Left)),
            ("PSD_FFR", Some(Side::Right)),
            ("L", Some(Side::Left)),
            ("PSD_FRONT", None),
            ("PSD_BACK", None),
            ("LEFT_RIGHT", None),
            ("ROLL", None),
        ] {
            assert_eq!(side(name), expected, "{name}");
        }
    }
}
