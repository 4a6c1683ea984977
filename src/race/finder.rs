use super::cone::Cone;
use super::lane::lane;
use super::lane_model::{Lane, LaneParameters};
use super::map::STRIDE;
use crate::ParameterError;
use crate::geometry::Pose;

/// Finds the lane ahead from moment to moment, by the cones that a car knows there, whoever has found them.
///
/// It keeps what one moment tells the next: where the car was, and where the lane was found before.
#[derive(Debug, Clone)]
pub struct LaneFinder {
    parameters: LaneParameters,
    trail: Vec<Pose>,
    lane: Lane,
}

/// Places that are remembered.
const PLACES: usize = 4;

impl LaneFinder {
    /// One that knows nothing yet. Fails with the name of the parameter that is out of range.
    pub fn new(parameters: LaneParameters) -> Result<Self, ParameterError> {
        parameters.validate()?;
        Ok(Self { parameters, trail: Vec::new(), lane: Lane::unknown(parameters.usual) })
    }

    /// The lane ahead of a car, whose pose is that of the point of it that is to be in the middle; see [`lane`]. The cones of
    /// the edges are those of the list. `None` without a cone at an edge.
    pub fn step(&mut self, car: Pose, cones: &[Cone]) -> Option<&Lane> {
        let behind: Vec<Pose> =
            self.trail.iter().copied().filter(|pose| car.to_local(pose.position()).x < -0.5).collect();
        let found = lane(cones, &behind, car, &self.lane, &self.parameters);
        self.remember(car);
        self.lane = found?;
        Some(&self.lane)
    }

    fn remember(&mut self, car: Pose) {
        if self.trail.last().is_none_or(|last| (last.position() - car.position()).norm() >= STRIDE) {
            self.trail.push(car);
            if self.trail.len() > PLACES {
                self.trail.remove(0);
            }
        }
    }
}
