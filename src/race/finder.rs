use super::cone::Cone;
use super::lane::lane;
use super::lane_model::{Lane, LaneParameters};
use super::map::STRIDE;
use crate::ParameterError;
use crate::geometry::Pose;

/// Finds the lane ahead, step by step, from the known cones.
///
/// It remembers previous poses of the car and the previous lane.
///
/// ```
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::race::{Cone, LaneFinder, LaneParameters};
/// let edge = |y: f64| (0..6).map(move |k| Cone::unknown(Point::new(3.0 * f64::from(k), y)));
/// let cones: Vec<Cone> = edge(1.5).chain(edge(-1.5)).collect();
/// let mut finder = LaneFinder::new(LaneParameters::default())?;
/// let lane = finder.step(Pose::default(), &cones).expect("a lane between two rows");
/// assert!(lane.points.iter().all(|point| point.y.abs() < 0.01), "in the middle between them");
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct LaneFinder {
    parameters: LaneParameters,
    trail: Vec<Pose>,
    lane: Lane,
}

/// Number of remembered positions.
const PLACES: usize = 4;

impl LaneFinder {
    /// A finder without any knowledge.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(parameters: LaneParameters) -> Result<Self, ParameterError> {
        parameters.validate()?;
        Ok(Self { parameters, trail: Vec::new(), lane: Lane::unknown(parameters.usual) })
    }

    /// Finds the lane ahead of a car; see [`lane`]. `car` is the pose of the point that is to stay in the
    /// middle. The lane's edges refer to indices in `cones`. `None` if no cone is at an edge.
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
