use crate::ParameterError;
use crate::geometry::{Point, Pose};
use crate::parameter::{require, require_up_to};

/// Parameters of the lane search, all positive and at most 1000.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaneParameters {
    /// Look-ahead distance (m).
    pub ahead: f64,
    /// Maximum curvature (1/m).
    pub curvature: f64,
    /// Distance to a cone at which the car touches it (m).
    pub clearance: f64,
    /// Minimum and maximum distance from the centre line to an edge (m).
    pub half_width: [f64; 2],
    /// Initial estimate of that distance (m).
    pub usual: f64,
    /// Maximum distance of a cone from its edge (m).
    pub loose: f64,
    /// Maximum distance between cones of an edge, with one or two missing (m).
    pub spacing: f64,
    /// Maximum turn of an edge at one cone (rad).
    pub sharpest: f64,
}

impl Default for LaneParameters {
    fn default() -> Self {
        Self {
            ahead: 17.5,
            curvature: 0.38,
            clearance: 1.15,
            half_width: [1.4, 2.8],
            usual: 1.9,
            loose: 0.8,
            spacing: 10.5,
            sharpest: 1.9,
        }
    }
}

/// Maximum of these lengths (m): beyond it, the number of points would have no bound.
pub(super) const FARTHEST: f64 = 1000.0;

impl LaneParameters {
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// If one is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let [least, most] = self.half_width;
        for (name, value) in [
            ("ahead", self.ahead),
            ("curvature", self.curvature),
            ("clearance", self.clearance),
            ("half width", least),
            ("half width", most),
            ("usual half width", self.usual),
            ("loose", self.loose),
            ("spacing", self.spacing),
            ("sharpest", self.sharpest),
        ] {
            require_up_to(name, value, FARTHEST)?;
        }
        require("half width", least, least <= most, "the least before the greatest")
    }
}

/// A lane.
#[derive(Debug, Clone, PartialEq)]
pub struct Lane {
    /// Points of its centre line, about one metre apart.
    pub points: Vec<Point>,
    /// Indices of the cones of its left and its right edge, in order.
    pub edges: [Vec<usize>; 2],
    /// Distance from the centre line to an edge, estimated from its cones (m).
    pub half_width: f64,
}

/// Present and previous poses of a car.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way<'w> {
    /// Recent poses, oldest first.
    pub(super) behind: &'w [Pose],
    pub(super) car: Pose,
    /// Earlier path: the lane does not lead back there. Where a circuit crosses itself, it goes straight on.
    pub(super) earlier: &'w [Pose],
    /// Obstacles that are not cones.
    pub(super) others: &'w [Point],
}

impl Lane {
    /// A lane of which only the width is known.
    pub(super) fn unknown(half_width: f64) -> Self {
        Self { points: Vec::new(), edges: [Vec::new(), Vec::new()], half_width }
    }

    /// Distance of a point from the lane, clipped to 0..1; 0 beyond its end.
    pub(super) fn away(&self, place: Point) -> f64 {
        let mut nearest = (0, f64::INFINITY);
        for (i, point) in self.points.iter().enumerate() {
            let squared = (point - place).norm_squared();
            if squared < nearest.1 {
                nearest = (i, squared);
            }
        }
        if nearest.0 + 2 < self.points.len() { nearest.1.min(1.0) } else { 0.0 }
    }
}
