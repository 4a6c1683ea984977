//! Starman as a replacement for a robot on wheels: it walks in its own vertical plane, which is placed at the
//! robot's pose along its heading.

use roverlab::geometry::{Pose, math};
use roverlab::io::sim::starman::{Starman, StarmanSpec};
use roverlab::io::{Clock, Error, Result, Servos};
use roverlab::world::RobotSpec;

/// A Starman, its pose, and its servo commands.
#[derive(Debug)]
pub(crate) struct Walker {
    starman: Starman,
    /// Pose before any motion.
    start: Pose,
    /// Odometry before any motion.
    origin: Pose,
    /// Simulated time (s).
    time: f64,
    /// Distance moved, forth and back (m).
    walked: f64,
    /// Servo positions, from -1 to 1.
    positions: [f64; LIMBS],
}

const LIMBS: usize = roverlab::io::sim::starman::LIMBS;
/// Duration of a call (s).
const CALL: f64 = 1e-4;
/// Range of a limb to either side (degrees). RoBIOS counts from 128, the middle: one step is one degree.
const SWING: f64 = 30.0;
/// Number of RoBIOS's steps from the middle to the end.
const STEPS: f64 = 128.0;

impl Walker {
    /// The walker that replaces a robot with legs; `None` for others.
    pub(crate) fn of(spec: &RobotSpec, start: Pose) -> Option<Self> {
        if !is_walker(&spec.name) {
            return None;
        }
        let starman = Starman::new(&StarmanSpec::default()).ok()?;
        Some(Self {
            starman,
            start,
            origin: Pose::default(),
            time: 0.0,
            walked: 0.0,
            positions: [0.0; LIMBS],
        })
    }

    /// Advances it to a time (s).
    pub(crate) fn live_until(&mut self, time: f64) -> Result<()> {
        if time > self.time {
            let before = self.travelled();
            self.starman.wait(time - self.time)?;
            self.walked += (self.travelled() - before).abs();
            self.time = time;
        }
        Ok(())
    }

    /// Moves a limb to RoBIOS's position, from -1 to 1.
    pub(crate) fn set_servo(&mut self, servo: u8, position: f64) -> Result<()> {
        let position = (position * STEPS / SWING).clamp(-1.0, 1.0);
        let limb = usize::from(servo).checked_sub(1).and_then(|limb| self.positions.get_mut(limb));
        *limb.ok_or_else(|| Error::unsupported(format!("servo {servo}")))? = position;
        self.time += CALL;
        self.starman.set_servo(servo, position)
    }

    /// Position along its plane (m).
    fn travelled(&self) -> f64 {
        self.starman.truth().posture.body.0
    }

    /// Distance moved (m).
    pub(crate) fn walked(&self) -> f64 {
        self.walked
    }

    /// True pose.
    pub(crate) fn pose(&self) -> Pose {
        ahead(self.start, self.travelled())
    }

    /// Height of its body's centre above the floor (m).
    pub(crate) fn height(&self) -> f64 {
        self.starman.truth().posture.body.1
    }

    /// Pose by odometry.
    pub(crate) fn odometry(&self) -> Pose {
        ahead(self.origin, self.travelled())
    }

    /// Sets the pose by odometry.
    pub(crate) fn set_odometry(&mut self, pose: Pose) {
        self.origin = ahead(pose, -self.travelled());
    }

    /// Moves it elsewhere, upright, as by hand: this is not a motion, and its limbs return to their commanded
    /// positions.
    pub(crate) fn place(&mut self, pose: Pose) -> Result<()> {
        let odometry = self.odometry();
        self.starman = Starman::new(&StarmanSpec::default())?;
        (self.start, self.origin) = (pose, odometry);
        for (servo, position) in (1..).zip(self.positions) {
            self.time += CALL;
            self.starman.set_servo(servo, position)?;
        }
        Ok(())
    }
}

/// Whether a robot with this name has legs.
pub(crate) fn is_walker(name: &str) -> bool {
    name.eq_ignore_ascii_case("starman")
}

fn ahead(pose: Pose, distance: f64) -> Pose {
    let (sin, cos) = math::sin_cos(pose.heading);
    Pose { x: pose.x + distance * cos, y: pose.y + distance * sin, ..pose }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_degree_is_a_step_and_a_new_place_a_new_beginning() {
        let spec = RobotSpec { name: "Starman".into(), ..RobotSpec::s4() };
        let mut walker = Walker::of(&spec, Pose::new(1.0, 2.0, 0.0)).unwrap();
        assert!(Walker::of(&RobotSpec::s4(), Pose::default()).is_none());
        for step in 0..10 {
            walker.set_servo(3, if step % 2 == 0 { 27.0 / STEPS } else { 0.0 }).unwrap();
            walker.live_until(f64::from(step + 1)).unwrap();
        }
        let moved = walker.pose().x - 1.0;
        assert!(moved < -0.002 && (walker.odometry().x - moved).abs() < 1e-12, "{moved}");
        walker.set_servo(1, 1.0).unwrap();
        assert_eq!(walker.positions[0], 1.0, "as far as it goes");
        assert!(walker.set_servo(6, 0.0).is_err() && walker.set_servo(0, 0.0).is_err());
        walker.place(Pose::new(3.0, 3.0, 0.0)).unwrap();
        assert_eq!(walker.pose(), Pose::new(3.0, 3.0, 0.0));
        walker.set_odometry(Pose::default());
        walker.live_until(20.0).unwrap();
        assert!((walker.pose().x - 3.0 - walker.odometry().x).abs() < 1e-12);
    }
}
