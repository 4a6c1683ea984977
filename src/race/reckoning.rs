//! Dead reckoning with tyre slip.

use super::tyres::Tyres;
use crate::geometry::{Pose, Twist, math};
use crate::world::CarDynamics;

/// Accumulates odometry, and adds the sideslip of the rear axle in bends, which odometry does not measure.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Reckoning {
    last: Option<Pose>,
    pose: Pose,
}

impl Reckoning {
    /// Estimated pose.
    pub(super) fn pose(&self) -> Pose {
        self.pose
    }

    /// Takes a pose by odometry. Returns the distance driven (m).
    pub(super) fn step(&mut self, odometry: Pose, speed: Twist, tyres: &Tyres) -> f64 {
        let step =
            self.last.replace(odometry).map_or(Pose::default(), |last| last.inverse().compose(&odometry));
        let across = speed.linear * speed.angular;
        let slip = if speed.linear > CarDynamics::SLIPS { tyres.slips(across, 0.0)[1] } else { 0.0 };
        let aside = Pose::new(0.0, -step.x * math::tan(slip), 0.0);
        self.pose = self.pose.compose(&aside.compose(&step));
        step.position().coords.norm()
    }
}
