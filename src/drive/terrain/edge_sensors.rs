use std::f64::consts::FRAC_PI_2;

use crate::geometry::math;
use crate::io::{DistanceSensors, Psd, Result};
use crate::world::{Footprint, Mount, PsdSpec, RobotSpec};

/// Distance sensors of a robot that look down: two beyond the front corners, where ground that is missing is
/// an edge, and two far aside, which tell to which side ground goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeSensors {
    /// Metres from the robot's middle to where the front ones meet level ground.
    ahead: f64,
}

/// The numbers of the sensors: left and right ahead, left and right aside.
const AHEAD: [u8; 2] = [25, 26];
const ASIDE: [u8; 2] = [27, 28];
/// Metres above the ground.
const HEIGHT: f64 = 0.12;
/// Metres from the outline to where the sensors meet level ground: ahead and aside.
const BEFORE: f64 = 0.05;
const BESIDE: f64 = 0.32;
/// Metres by which a reading exceeds that of level ground where it is missing.
const DROP: f64 = 0.05;

impl EdgeSensors {
    /// Those of a robot; `None` without them.
    pub fn of(spec: &RobotSpec) -> Option<Self> {
        let has = |id: &u8| spec.psds.iter().any(|psd| psd.id == *id);
        AHEAD.iter().chain(&ASIDE).all(has).then(|| Self { ahead: ends(spec).0 + BEFORE })
    }

    /// A robot with four more distance sensors, numbers 25 to 28.
    #[must_use]
    pub fn equip(mut spec: RobotSpec) -> RobotSpec {
        let (front, side) = ends(&spec);
        let looks = |id: u8, (x, y): (f64, f64), yaw: f64, away: f64| PsdSpec {
            id,
            name: format!("PSD_EDGE_{id}"),
            mount: Mount { x, y, z: HEIGHT, pitch: math::atan2(HEIGHT, away), yaw, ..Mount::default() },
            max_range: PsdSpec::DEFAULT_MAX_RANGE,
        };
        spec.psds.extend([
            looks(AHEAD[0], (front, side), 0.0, BEFORE),
            looks(AHEAD[1], (front, -side), 0.0, BEFORE),
            looks(ASIDE[0], (0.0, side), FRAC_PI_2, BESIDE),
            looks(ASIDE[1], (0.0, -side), -FRAC_PI_2, BESIDE),
        ]);
        spec
    }

    /// Metres from the robot's middle to where the front ones meet level ground.
    pub fn ahead(&self) -> f64 {
        self.ahead
    }

    /// Whether the ground ahead is missing, on the left and on the right.
    pub(super) fn missing<R: DistanceSensors + ?Sized>(robot: &mut R) -> Result<[bool; 2]> {
        let most = math::hypot(HEIGHT, BEFORE) + DROP;
        // No return, and what is no number, is no ground.
        let mut is_missing = |id: u8| robot.distance(Psd(id)).map(|range| range.is_nan() || range > most);
        Ok([is_missing(AHEAD[0])?, is_missing(AHEAD[1])?])
    }

    /// Metres to the ground on the left and on the right.
    pub(super) fn aside<R: DistanceSensors + ?Sized>(robot: &mut R) -> Result<[f64; 2]> {
        Ok([robot.distance(Psd(ASIDE[0]))?, robot.distance(Psd(ASIDE[1]))?])
    }
}

/// The outline's front, and its half width.
fn ends(spec: &RobotSpec) -> (f64, f64) {
    match spec.footprint {
        Footprint::Disc { radius } => (radius, radius),
        Footprint::Rectangle(outline) => (outline.max.x, outline.max.y),
    }
}
