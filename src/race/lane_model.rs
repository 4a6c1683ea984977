use crate::ParameterError;
use crate::geometry::{Point, Pose};
use crate::parameter::{require, require_up_to};

/// What a lane is looked for with. All numbers are greater than 0, and at most 1000.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaneParameters {
    /// Metres ahead of the car.
    pub ahead: f64,
    /// The greatest curvature, in 1/m.
    pub curvature: f64,
    /// Metres to a cone at which a car would touch it.
    pub clearance: f64,
    /// Metres from the middle to an edge, from least to most.
    pub half_width: [f64; 2],
    /// The same before cones say more.
    pub usual: f64,
    /// Metres by which a cone of an edge may stand off it.
    pub loose: f64,
    /// Metres from cone to cone of an edge at most, where one or two are missing.
    pub spacing: f64,
    /// Radians by which an edge turns at most at one cone.
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

/// The greatest number, in metres: whoever looks farther makes points without end.
pub(super) const FARTHEST: f64 = 1000.0;

impl LaneParameters {
    /// Fails with the name of the parameter that is out of range.
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

/// The middle of a lane.
#[derive(Debug, Clone, PartialEq)]
pub struct Lane {
    /// Points along it, about a metre apart.
    pub points: Vec<Point>,
    /// The cones of its left and of its right edge, by their indices, in their order along it.
    pub edges: [Vec<usize>; 2],
    /// Metres from the middle to an edge, as its cones say.
    pub half_width: f64,
}

/// Where a car was, is, and has been earlier.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way<'w> {
    /// Where it was just now, oldest first.
    pub(super) behind: &'w [Pose],
    pub(super) car: Pose,
    /// The way by which it came: it does not lead back there. Where a circuit crosses itself, it goes
    /// straight on.
    pub(super) earlier: &'w [Pose],
    /// What is no cone and not to be touched.
    pub(super) others: &'w [Point],
}

impl Lane {
    /// A lane of which nothing is known but half its width.
    pub(super) fn unknown(half_width: f64) -> Self {
        Self { points: Vec::new(), edges: [Vec::new(), Vec::new()], half_width }
    }

    /// How far a place is from the lane, 0 to 1; 0 beyond its end.
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
