use crate::geometry::{Point, direction, meeting};

/// Free distances of a round robot among obstacle points in its own frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Way {
    /// Radius of the robot, and clearance kept beside it (m).
    pub(super) radius: f64,
    pub(super) margin: f64,
}

/// Distance ahead that must be free (m).
pub(super) const AHEAD: f64 = 0.3;
/// Time in which the free distance ahead is driven, and an excessive gap is closed (s).
pub(super) const BRAKING: f64 = 1.0;
/// Turning proportionally to the rest of the angle, in 1/s.
pub(super) const TURN_GAIN: f64 = 2.5;
/// Radians by which a heading may be missed where a turn ends.
pub(super) const ALIGNED: f64 = 0.05;
/// Number of headings tried on either side.
const TRIED: u32 = 18;
/// Distance between them (rad): together they reach somewhat beyond 130 degrees.
const SPACING: f64 = 0.13;

impl Way {
    /// Distance straight on in a direction until the outline touches a point (m). Points already passed do
    /// not count.
    pub(super) fn free(&self, points: &[Point], towards: f64) -> f64 {
        let (ahead, half) = (direction(towards), self.radius + self.margin);
        let room = |(along, before): (f64, f64)| along - (before - self.margin).max(0.0);
        points.iter().filter_map(|point| meeting(point, ahead, half)).map(room).fold(f64::INFINITY, f64::min)
    }

    /// The direction nearest to `wished` with at least `room` metres free, or else the one with the most
    /// room; and the room there (m).
    pub(super) fn towards(&self, points: &[Point], wished: f64, room: f64) -> (f64, f64) {
        let mut best = (wished, self.free(points, wished));
        if best.1 >= room {
            return best;
        }
        for step in 1..=TRIED {
            let aside = f64::from(step) * SPACING;
            let both = [wished + aside, wished - aside].map(|angle| (angle, self.free(points, angle)));
            let [left, right] = both;
            let roomier = if left.1 >= right.1 { left } else { right };
            if roomier.1 >= room {
                return roomier;
            }
            if roomier.1 > best.1 {
                best = roomier;
            }
        }
        best
    }
}
