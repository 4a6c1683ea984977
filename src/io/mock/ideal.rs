use crate::geometry::{Pose, Twist};
use crate::io::Result;
use crate::kinematics::{Displacement, advance};
use crate::parameter::{require_finite, require_positive};

/// A drive that executes commands exactly and at once.
#[derive(Debug, Clone, Default)]
pub(super) struct IdealDrive {
    pose: Pose,
    motion: Motion,
}

#[derive(Debug, Clone, Copy, Default)]
enum Motion {
    #[default]
    Still,
    Speed(Twist),
    /// Remaining motion of a manoeuvre, and its remaining time (s).
    Manoeuvre(Displacement, f64),
}

impl IdealDrive {
    pub(super) fn pose(&self) -> Pose {
        self.pose
    }

    pub(super) fn set_pose(&mut self, pose: Pose) {
        self.pose = pose;
    }

    pub(super) fn set_speed(&mut self, twist: Twist) -> Result<()> {
        require_finite("speed", twist.linear)?;
        require_finite("turning speed", twist.angular)?;
        self.motion = Motion::Speed(twist);
        Ok(())
    }

    /// Starts a manoeuvre over `extent` (m or rad) at `speed` (1/s of the same unit).
    pub(super) fn start(&mut self, motion: Displacement, extent: f64, speed: f64) -> Result<()> {
        require_finite("length", motion.length)?;
        require_finite("angle", motion.angle)?;
        require_positive("speed", speed.abs())?;
        let seconds = extent.abs() / speed.abs();
        self.motion = if seconds > 0.0 { Motion::Manoeuvre(motion, seconds) } else { Motion::Still };
        Ok(())
    }

    pub(super) fn speed(&self) -> Twist {
        match self.motion {
            Motion::Still => Twist::STOP,
            Motion::Speed(twist) => twist,
            Motion::Manoeuvre(Displacement { length, angle }, seconds) => {
                Twist::new(length / seconds, angle / seconds)
            }
        }
    }

    /// Remaining distance (m), or angle for a turn on the spot (rad).
    pub(super) fn remaining(&self) -> f64 {
        match self.motion {
            Motion::Manoeuvre(left, _) if left.length == 0.0 => left.angle.abs(),
            Motion::Manoeuvre(left, _) => left.length.abs(),
            _ => 0.0,
        }
    }

    /// Remaining time of the manoeuvre (s); 0 when none is running.
    pub(super) fn seconds_left(&self) -> f64 {
        if let Motion::Manoeuvre(_, seconds) = self.motion { seconds } else { 0.0 }
    }

    /// Advances time.
    pub(super) fn pass(&mut self, seconds: f64) {
        match self.motion {
            Motion::Still => {}
            Motion::Speed(Twist { linear, angular }) => {
                let motion = Displacement { length: linear * seconds, angle: angular * seconds };
                self.pose = advance(self.pose, motion);
            }
            Motion::Manoeuvre(left, duration) if seconds >= duration => {
                self.pose = advance(self.pose, left);
                self.motion = Motion::Still;
            }
            Motion::Manoeuvre(left, duration) => {
                let share = seconds / duration;
                let done = Displacement { length: left.length * share, angle: left.angle * share };
                self.pose = advance(self.pose, done);
                let left = Displacement { length: left.length - done.length, angle: left.angle - done.angle };
                self.motion = Motion::Manoeuvre(left, duration - seconds);
            }
        }
    }
}
