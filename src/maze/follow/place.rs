use std::f64::consts::FRAC_PI_2;

use crate::geometry::{Pose, angle_difference, math};
use crate::kinematics::{DISTANCE_ERROR, OUTLIER, SCALE_ERROR, TURN_ERROR};

/// Scale error of odometry (wheel wear), as a fraction of the distance.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    share: f64,
    variance: f64,
    /// Covariance with the longitudinal position.
    along: f64,
}

/// Position and orientation of a robot in a cell: a Kalman filter of odometry and wall readings.
///
/// It continues from cell to cell, so knowledge from cells with walls carries over to those without.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlaceInCell {
    /// Longitudinal position, from the centre of the cell that it left (m).
    pub(super) along: f64,
    /// Lateral offset from the centre line, positive to the left (m).
    pub(super) off: f64,
    /// Orientation, positive to the left (rad).
    pub(super) turn: f64,
    /// Variances of the three; `common` is the covariance of the last two.
    spread: [f64; 3],
    common: f64,
    stretch: Stretch,
    odometry: Pose,
}

impl PlaceInCell {
    /// A robot roughly in the centre of a cell.
    pub(super) fn at(odometry: Pose, cell: f64) -> Self {
        /// Initial standard deviations of the lateral offset (cells) and of the heading (rad).
        const OFF: f64 = 0.05;
        let spread = [OFF * OFF * cell * cell, OFF * OFF * cell * cell, OFF * OFF];
        let stretch = Stretch { share: 0.0, variance: SCALE_ERROR * SCALE_ERROR, along: 0.0 };
        Self { along: 0.0, off: 0.0, turn: 0.0, spread, common: 0.0, stretch, odometry }
    }

    /// Follows odometry. If the robot has turned by more than 45 degrees, the cell frame turns with it.
    pub(super) fn predict(&mut self, odometry: Pose) {
        let moved = self.odometry.to_local(odometry.position());
        let way = moved.coords.norm();
        // Larger wheels turn the robot farther, too.
        let turned = angle_difference(odometry.heading, self.odometry.heading) * (1.0 + self.stretch.share);
        let (sin, cos) = (math::sin(self.turn), math::cos(self.turn));
        self.odometry = odometry;
        let ahead = cos * moved.x - sin * moved.y;
        self.along += ahead * (1.0 + self.stretch.share);
        self.off += sin * moved.x + cos * moved.y;
        let [along, off, turn] = self.spread;
        let missed = DISTANCE_ERROR * DISTANCE_ERROR;
        self.spread = [
            along
                + missed * way * way.max(0.01)
                + ahead * (2.0 * self.stretch.along + ahead * self.stretch.variance),
            off + 2.0 * way * self.common + way * way * turn,
            // The error of a turn is the same fraction for all its parts, so its square grows with the whole
            // turn, a quarter.
            turn + missed * way
                + turned.abs() * FRAC_PI_2 * (self.stretch.variance + TURN_ERROR * TURN_ERROR),
        ];
        self.common += way * turn;
        self.stretch.along += ahead * self.stretch.variance;
        self.turn += turned;
        let quarters = (self.turn / FRAC_PI_2).round();
        self.turn -= quarters * FRAC_PI_2;
        self.turn_cell(quarters as i32);
    }

    /// Turns the cell frame to the left.
    fn turn_cell(&mut self, quarters: i32) {
        (self.along, self.off) = match quarters.rem_euclid(4) {
            1 => (self.off, -self.along),
            2 => (-self.along, -self.off),
            3 => (-self.off, self.along),
            _ => return,
        };
        if quarters % 2 == 0 {
            self.stretch.along = -self.stretch.along;
        } else {
            self.spread.swap(0, 1);
            self.stretch.along = 0.0;
        }
        self.common = 0.0;
    }

    /// Corrects the longitudinal position.
    pub(super) fn correct_along(&mut self, along: f64, error: f64) {
        let Stretch { variance, along: common, .. } = self.stretch;
        let gains = [self.spread[0], common].map(|spread| spread / (self.spread[0] + error * error));
        let innovation = along - self.along;
        self.along += gains[0] * innovation;
        self.stretch.share += gains[1] * innovation;
        self.spread[0] *= 1.0 - gains[0];
        self.stretch.variance = variance - gains[1] * common;
        self.stretch.along = common * (1.0 - gains[0]);
    }

    /// Whether a longitudinal correction passes the innovation test.
    pub(super) fn believes_along(&self, farther: f64, error: f64) -> bool {
        farther * farther < OUTLIER * OUTLIER * (self.spread[0] + error * error)
    }

    /// Whether a lateral measurement passes the innovation test.
    pub(super) fn believes(&self, off: f64, error: f64) -> bool {
        let innovation = off - self.off;
        innovation * innovation < OUTLIER * OUTLIER * (self.spread[1] + error * error)
    }

    /// Increases the lateral variance, because measurements contradict the estimate.
    pub(super) fn doubt(&mut self, off: f64) {
        self.spread[1] += off * off;
    }

    /// Corrects the lateral offset.
    pub(super) fn correct_off(&mut self, off: f64, error: f64) {
        let [_, own, turn] = self.spread;
        let gains = [own, self.common].map(|spread| spread / (own + error * error));
        let innovation = off - self.off;
        self.off += gains[0] * innovation;
        self.turn += gains[1] * innovation;
        self.spread[1] = own * (1.0 - gains[0]);
        self.spread[2] = turn - gains[1] * self.common;
        self.common *= 1.0 - gains[0];
    }
}
