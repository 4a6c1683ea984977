use crate::geometry::{Point, Pose, Vector, angle_difference};

/// Dead reckoning: the way by the log, along the heading by compass and turn rate.
#[derive(Debug, Clone, Default)]
pub(super) struct Reckoning {
    pose: Pose,
    odometry: Option<Pose>,
    velocity: Vector,
}

impl Reckoning {
    /// Begins at a pose.
    pub(super) fn at(pose: Pose) -> Self {
        Self { pose, ..Self::default() }
    }

    /// Moves on to what the log says, `seconds` after the step before.
    pub(super) fn advance(&mut self, odometry: Pose, heading: f64, seconds: f64) {
        if let Some(before) = self.odometry.replace(odometry) {
            let way = way(&before, &odometry);
            let own = Pose { heading: halfway(self.pose.heading, heading), ..self.pose };
            let place = own.to_world(Point::from(way));
            self.velocity = way / seconds;
            (self.pose.x, self.pose.y) = (place.x, place.y);
        }
        self.pose.heading = heading;
    }

    /// The pose, from where it began; its heading is not bounded.
    pub(super) fn pose(&self) -> Pose {
        self.pose
    }

    /// The speed through the water forward and to the left (m/s).
    pub(super) fn velocity(&self) -> Vector {
        self.velocity
    }
}

/// The way between two poses of a log, forward and to the left: between two steps it moves along the mean of
/// their headings.
pub(super) fn way(before: &Pose, after: &Pose) -> Vector {
    let middle = Pose { heading: halfway(before.heading, after.heading), ..*before };
    middle.to_local(after.position()).coords
}

/// The heading in the middle between two.
pub(super) fn halfway(from: f64, to: f64) -> f64 {
    from + 0.5 * angle_difference(to, from)
}
