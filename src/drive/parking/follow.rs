use super::search::{Stretch, driven};
use crate::geometry::{Pose, Twist, angle_difference, math};

/// Follows a path of straights and arcs, forward and in reverse, and stands at each change between them.
#[derive(Debug, Clone)]
pub(super) struct Follower {
    path: Vec<Stretch>,
    /// Where the present stretch begins.
    from: Pose,
    index: usize,
    speed: f64,
    /// Whether the car has stood since the last change of gear.
    has_stood: bool,
}

/// Distance in which an offset is corrected (m).
const SETTLING: f64 = 0.15;
/// Largest curvature of a command (1/m).
const LOCK: f64 = 2.04;
/// Distance before a change of gear from which the car slows down (m).
const SLOWS: f64 = 0.10;
/// Distance in which the car rolls out (m).
const ROLLS_OUT: f64 = 0.006;
/// Length on which the wheels turn to a new curvature (m).
const TURNS: f64 = 0.01;
/// Speed while the wheels turn (m/s).
const CREEP: f64 = 0.06;

impl Follower {
    pub(super) fn new(path: Vec<Stretch>, from: Pose, speed: f64) -> Self {
        Self { path, from, index: 0, speed, has_stood: true }
    }

    /// The command for a pose. `None` at the end of the path.
    pub(super) fn step(&mut self, pose: &Pose, stands: bool) -> Option<Twist> {
        self.has_stood |= stands;
        let mut stretch = *self.path.get(self.index)?;
        let mut gone = self.gone(stretch, pose);
        if gone >= stretch.length.abs() - self.reserve() {
            let changes = self.path.get(self.index + 1).is_none_or(|next| next.length * stretch.length < 0.0);
            self.from = driven(&self.from, stretch);
            self.index += 1;
            self.has_stood &= !changes;
            stretch = *self.path.get(self.index)?;
            gone = self.gone(stretch, pose);
        }
        if !self.has_stood {
            return Some(Twist::STOP);
        }
        Some(self.command(stretch, gone, pose))
    }

    /// Distance before the end of a stretch at which the next one begins (m).
    fn reserve(&self) -> f64 {
        let Stretch { length, .. } = self.path[self.index];
        let goes_on = self.path.get(self.index + 1).is_some_and(|next| next.length * length > 0.0);
        if goes_on { 0.0 } else { ROLLS_OUT }
    }

    /// Distance that a pose has gone along a stretch (m).
    fn gone(&self, stretch: Stretch, pose: &Pose) -> f64 {
        let own = self.from.to_local(pose.position());
        let way = stretch.length.signum();
        if stretch.curvature == 0.0 {
            return way * own.x;
        }
        // The angle about the centre of the arc.
        let bend = stretch.curvature;
        way * math::atan2(own.x * bend, 1.0 - own.y * bend) / bend
    }

    fn command(&self, stretch: Stretch, gone: f64, pose: &Pose) -> Twist {
        let way = stretch.length.signum();
        let place = driven(&self.from, Stretch { length: way * gone.max(0.0), ..stretch });
        let offset = place.to_local(pose.position()).y;
        let heading = angle_difference(pose.heading, place.heading);
        let back = offset / (SETTLING * SETTLING) + way * 2.0 * math::sin(heading) / SETTLING;
        let bend = (stretch.curvature - back).clamp(-LOCK, LOCK);
        let left = stretch.length.abs() - gone;
        let slow = (left / SLOWS).clamp(0.2, 1.0) * self.speed;
        let speed = way * if gone < TURNS { CREEP } else { slow };
        Twist::new(speed, speed * bend)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_with_changes_of_gear_is_followed_from_beside_it() {
        let path = [(-0.4, 1.8), (-0.3, -1.8), (0.2, 0.0), (0.3, 1.8)];
        let path = path.map(|(length, curvature)| Stretch { length, curvature });
        let end = path.iter().fold(Pose::default(), |pose, stretch| driven(&pose, *stretch));
        let mut pose = Pose::new(0.0, 0.01, 0.02);
        let mut follower = Follower::new(path.to_vec(), Pose::default(), 0.25);
        let mut speed = 0.0;
        for _ in 0..2000 {
            let Some(command) = follower.step(&pose, f64::abs(speed) < 0.02) else { break };
            speed = command.linear;
            let curvature = if speed == 0.0 { 0.0 } else { command.angular / speed };
            pose = driven(&pose, Stretch { length: 0.02 * speed, curvature });
        }
        assert!(pose.distance_to(end.position()) < 0.02, "{pose:?} {end:?}");
        assert!(angle_difference(pose.heading, end.heading).abs() < 0.05, "{pose:?} {end:?}");
    }
}
