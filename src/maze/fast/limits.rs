use super::profile;
use super::shape::{CELL, Shape};
use super::turn::TurnKind;
use crate::ParameterError;
use crate::maze::Scale;
use crate::parameter::require;

/// What a robot can do on a fast run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunLimits {
    /// The highest speed along rows and columns, in m/s.
    pub speed: f64,
    /// The highest speed along diagonals, in m/s: the corridors are narrower there.
    pub diagonal_speed: f64,
    /// The largest change of speed along the path, in m/s².
    pub acceleration: f64,
    /// The largest sideways acceleration in a turn, in m/s².
    pub lateral_acceleration: f64,
    /// The highest turning speed on the spot, in rad/s.
    pub pivot_speed: f64,
    /// The largest change of the turning speed, on the spot and in turns, in rad/s².
    pub angular_acceleration: f64,
}

impl RunLimits {
    /// For a small robot with quick motors in a competition maze.
    pub const MICROMOUSE: Self = Self {
        speed: 2.0,
        diagonal_speed: 1.5,
        acceleration: 6.0,
        lateral_acceleration: 5.0,
        pivot_speed: 12.0,
        angular_acceleration: 150.0,
    };

    /// For an EyeBot S4 in the book's maze, whose motors are slow to follow.
    pub const EYEBOT: Self = Self {
        speed: 0.7,
        diagonal_speed: 0.6,
        acceleration: 0.8,
        lateral_acceleration: 0.8,
        pivot_speed: 4.0,
        angular_acceleration: 8.0,
    };

    fn checked(&self) -> Result<(), ParameterError> {
        for (parameter, value) in [
            ("speed", self.speed),
            ("diagonal speed", self.diagonal_speed),
            ("acceleration", self.acceleration),
            ("lateral acceleration", self.lateral_acceleration),
            ("pivot speed", self.pivot_speed),
            ("angular acceleration", self.angular_acceleration),
        ] {
            require(parameter, value, (1e-3..=1e4).contains(&value), "0.001 to 10000")?;
        }
        Ok(())
    }
}

/// A turn as it is driven: always with the same shape and at the same speed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DrivenTurn {
    pub(super) shape: Shape,
    /// Metres from the corner of the two straights to either end of the curve.
    pub(super) tangent: f64,
    pub(super) speed: f64,
    pub(super) time: f64,
}

/// The turns of a robot, and how long it takes for straights between them.
#[derive(Debug, Clone)]
pub(super) struct Repertoire {
    pub(super) limits: RunLimits,
    pub(super) cell: f64,
    turns: Vec<DrivenTurn>,
}

impl Repertoire {
    pub(super) fn new(scale: Scale, limits: RunLimits) -> Result<Self, ParameterError> {
        limits.checked()?;
        require(CELL, scale.cell, (1e-3..=1e3).contains(&scale.cell), "0.001 to 1000 m")?;
        let turns: Result<Vec<DrivenTurn>, ParameterError> =
            TurnKind::ALL.iter().map(|&kind| driven(kind, scale.cell, &limits)).collect();
        Ok(Self { limits, cell: scale.cell, turns: turns? })
    }

    pub(super) fn turn(&self, kind: TurnKind) -> &DrivenTurn {
        &self.turns[kind as usize]
    }

    /// Metres from the corner of a turn, 0 for one on the spot.
    pub(super) fn tangent(&self, kind: Option<TurnKind>) -> f64 {
        kind.map_or(0.0, |kind| self.turn(kind).tangent)
    }

    /// The speed at both ends of a turn, 0 for one on the spot.
    pub(super) fn speed(&self, kind: Option<TurnKind>) -> f64 {
        kind.map_or(0.0, |kind| self.turn(kind).speed)
    }

    /// Seconds for a turn by an angle, on the spot if it has no kind.
    pub(super) fn pivot_time(&self, angle: f64) -> f64 {
        let RunLimits { pivot_speed, angular_acceleration, .. } = self.limits;
        profile::time(angle.abs(), 0.0, 0.0, pivot_speed, angular_acceleration).unwrap_or(0.0)
    }

    /// The highest speed on a straight.
    pub(super) fn top_speed(&self, diagonal: bool) -> f64 {
        if diagonal { self.limits.diagonal_speed } else { self.limits.speed }
    }

    /// Seconds between two turns whose corners are `distance` apart; `None` where they overlap, or where the robot cannot
    /// change its speed so soon.
    pub(super) fn straight_time(
        &self,
        from: Option<TurnKind>,
        to: Option<TurnKind>,
        distance: f64,
        diagonal: bool,
    ) -> Option<f64> {
        let length = distance - self.tangent(from) - self.tangent(to);
        let top = self.top_speed(diagonal);
        profile::time(length, self.speed(from), self.speed(to), top, self.limits.acceleration)
    }
}

fn driven(kind: TurnKind, cell: f64, limits: &RunLimits) -> Result<DrivenTurn, ParameterError> {
    let tangent = kind.tangent() * cell;
    let shape = match kind {
        TurnKind::UTurn => Shape::u_turn(cell)?,
        _ => Shape::turn(kind.angle(), tangent)?,
    };
    let ramp = shape.ramp;
    let speed = (limits.lateral_acceleration / shape.peak)
        .sqrt()
        .min((limits.angular_acceleration * ramp / shape.peak).sqrt())
        .min(limits.speed.min(limits.diagonal_speed));
    // A turn that begins at the edge of a cell can be driven from standstill in its middle.
    let reachable = (2.0 * limits.acceleration * 0.45 * cell).sqrt();
    let speed = speed.min(reachable);
    let time = shape.length / speed;
    Ok(DrivenTurn { shape, tangent, speed, time })
}
