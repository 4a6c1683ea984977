use std::sync::Arc;

use crate::ParameterError;
use crate::geometry::{Point, Vector};
use crate::nav::grid::StepCosts;
use crate::parameter::require_positive;
use crate::world::{GridCell, HeightField};

/// What a plan minimises.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Objective {
    /// Length along the ground (m).
    Length,
    /// Energy per newton of the robot's weight (J/N): height gained, plus length times rolling resistance.
    /// Braking on descents recovers nothing.
    Energy {
        /// Rolling resistance on level ground, as a fraction of the weight.
        resistance: f64,
    },
    /// Driving time (s).
    Time {
        /// Speed on level ground (m/s).
        speed: f64,
        /// Maximum rate of climb, limited by motor power (m/s).
        climb: f64,
    },
}

impl Objective {
    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        match *self {
            Self::Length => Ok(()),
            Self::Energy { resistance } => require_positive("resistance to rolling", resistance),
            Self::Time { speed, climb } => {
                require_positive("speed", speed)?;
                require_positive("climb speed", climb)
            }
        }
    }

    /// Cost of a straight segment with this horizontal length and rise (m): at least that on level ground.
    #[inline]
    pub fn of_stretch(&self, run: f64, rise: f64) -> f64 {
        match *self {
            Self::Length => (run * run + rise * rise).sqrt(),
            Self::Energy { resistance } => resistance * run + rise.max(0.0),
            Self::Time { speed, climb } => ((run * run + rise * rise).sqrt() / speed).max(rise / climb),
        }
    }

    /// Cost of a metre of level ground.
    pub fn per_metre(&self) -> f64 {
        self.of_stretch(1.0, 0.0)
    }
}

/// Costs of steps between the samples of a surface.
#[derive(Debug, Clone)]
pub struct GroundCosts {
    objective: Objective,
    columns: usize,
    pitch: Vector,
    /// What an edge of the shorter side of a cell costs on level ground.
    pub(super) unit: f64,
    heights: Arc<[f32]>,
}

impl GroundCosts {
    pub(in crate::nav) fn new(field: &HeightField, objective: Objective) -> Self {
        let pitch = field.pitch();
        let (columns, rows) = (field.columns(), field.rows());
        let heights =
            (0..columns * rows).map(|index| field.sample(index % columns, index / columns) as f32).collect();
        let unit = objective.per_metre() * pitch.x.min(pitch.y);
        Self { objective, columns, pitch, unit, heights }
    }

    /// The elevation of a sample in metres.
    #[inline]
    pub(super) fn height(&self, cell: GridCell) -> f64 {
        f64::from(self.heights[cell.row * self.columns + cell.column])
    }

    pub(super) fn set_height(&mut self, cell: GridCell, height: f32) {
        let index = cell.row * self.columns + cell.column;
        Arc::make_mut(&mut self.heights)[index] = height;
    }

    /// What a straight way between two places costs, in samples, by the ground at places about half a cell
    /// apart; `None` if it leads near a sample that is not `open`.
    pub(super) fn straight(&self, from: Point, to: Point, open: impl Fn(GridCell) -> bool) -> Option<f64> {
        let way = to - from;
        let stretches = (2.0 * way.x.abs().max(way.y.abs())).ceil().max(1.0);
        let part = way / stretches;
        let run = part.component_mul(&self.pitch).norm();
        let (mut cost, mut before) = (0.0, self.height_between(from));
        for number in 1..=stretches as usize {
            let at = from + part * number as f64;
            let near = GridCell::new(at.x.round() as usize, at.y.round() as usize);
            if !open(near) {
                return None;
            }
            let height = self.height_between(at);
            cost += self.objective.of_stretch(run, height - before);
            before = height;
        }
        Some(cost)
    }

    /// The elevation at a place, in samples, by the triangles of the surface.
    fn height_between(&self, at: Point) -> f64 {
        let rows = self.heights.len() / self.columns;
        let column = (at.x as usize).min(self.columns - 2);
        let row = (at.y as usize).min(rows - 2);
        let (x, y) = (at.x - column as f64, at.y - row as f64);
        let [a, b] = [0, 1].map(|aside| self.height(GridCell::new(column + aside, row)));
        let [c, d] = [0, 1].map(|aside| self.height(GridCell::new(column + aside, row + 1)));
        if x >= y { a + (b - a) * x + (d - b) * y } else { a + (d - c) * x + (c - a) * y }
    }
}

impl StepCosts for GroundCosts {
    #[inline]
    fn cost(&self, from: GridCell, to: GridCell) -> f64 {
        let along = if from.column == to.column { 0.0 } else { self.pitch.x };
        let across = if from.row == to.row { 0.0 } else { self.pitch.y };
        let run = (along * along + across * across).sqrt();
        self.objective.of_stretch(run, self.height(to) - self.height(from)) / self.unit
    }
}
