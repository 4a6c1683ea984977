use crate::geometry::{Pose, Vector, angle_difference};

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
            // Between two steps it moves along the mean of their headings.
            let middle = |from: f64, to: f64| from + 0.5 * angle_difference(to, from);
            let log = Pose { heading: middle(before.heading, odometry.heading), ..before };
            let way = log.to_local(odometry.position());
            let own = Pose { heading: middle(self.pose.heading, heading), ..self.pose };
            let place = own.to_world(way);
            self.velocity = way.coords / seconds;
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
