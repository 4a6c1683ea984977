use super::profile;
use super::shape::{CELL, Shape};
use super::turn::TurnKind;
use crate::ParameterError;
use crate::maze::Scale;
use crate::parameter::require;

/// Limits of a robot on a fast run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunLimits {
    /// Maximum speed along rows and columns (m/s).
    pub speed: f64,
    /// Maximum speed along diagonals, where the corridors are narrower (m/s).
    pub diagonal_speed: f64,
    /// Maximum acceleration along the path (m/s²).
    pub acceleration: f64,
    /// Maximum lateral acceleration in turns (m/s²).
    pub lateral_acceleration: f64,
    /// Maximum angular velocity on the spot (rad/s).
    pub pivot_speed: f64,
    /// Maximum angular acceleration, on the spot and in turns (rad/s²).
    pub angular_acceleration: f64,
}

impl RunLimits {
    /// A small robot with fast motors in a competition maze.
    pub const MICROMOUSE: Self = Self {
        speed: 2.0,
        diagonal_speed: 1.5,
        acceleration: 6.0,
        lateral_acceleration: 5.0,
        pivot_speed: 12.0,
        angular_acceleration: 150.0,
    };

    /// An EyeBot S4, whose motors respond slowly, in the book's maze.
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

/// A turn as it is driven: fixed shape and speed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DrivenTurn {
    pub(super) shape: Shape,
    /// Distance from the corner of the two straights to either end of the curve (m).
    pub(super) tangent: f64,
    pub(super) speed: f64,
    pub(super) time: f64,
}

/// The turns of a robot, and the times of straights between them.
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

    /// Tangent length of a turn (m); 0 for one on the spot.
    pub(super) fn tangent(&self, kind: Option<TurnKind>) -> f64 {
        kind.map_or(0.0, |kind| self.turn(kind).tangent)
    }

    /// Speed at both ends of a turn (m/s); 0 for one on the spot.
    pub(super) fn speed(&self, kind: Option<TurnKind>) -> f64 {
        kind.map_or(0.0, |kind| self.turn(kind).speed)
    }

    /// Time of a turn on the spot (s).
    pub(super) fn pivot_time(&self, angle: f64) -> f64 {
        let RunLimits { pivot_speed, angular_acceleration, .. } = self.limits;
        profile::time(angle.abs(), 0.0, 0.0, pivot_speed, angular_acceleration).unwrap_or(0.0)
    }

    /// Maximum speed on a straight (m/s).
    pub(super) fn top_speed(&self, diagonal: bool) -> f64 {
        if diagonal { self.limits.diagonal_speed } else { self.limits.speed }
    }

    /// Time between two turns whose corners are `distance` (m) apart (s). `None` if they overlap, or the
    /// robot cannot change its speed in time.
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
    // A turn at the edge of a cell must be reachable from standstill in its centre.
    let reachable = (2.0 * limits.acceleration * 0.45 * cell).sqrt();
    let speed = speed.min(reachable);
    let time = shape.length / speed;
    Ok(DrivenTurn { shape, tangent, speed, time })
}
