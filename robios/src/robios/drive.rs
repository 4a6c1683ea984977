use roverlab::geometry::{Twist, math, units};
use roverlab::io::Result;

use super::{Moving, Robios, in_whole, invalid, millimetres, pose_from};
use crate::ask::{Reply, Request};
use crate::identity::Identity;

/// Number of motors and encoders, numbered from 1.
const MOTORS: i32 = 4;
/// Share of a top speed that whole units may round it up by.
const ROUNDING: f64 = 0.01;

impl Robios {
    /// `VWSetSpeed`, in mm/s and degrees/s.
    pub fn vw_set_speed(&mut self, linear: i32, angular: i32) -> Result<()> {
        let twist = Twist::new(units::from_mm(linear.into()), units::from_deg(angular.into()));
        self.note_too_fast(twist.linear);
        self.note_turning_too_fast(twist);
        self.order(&Request::SetSpeed(twist))?;
        self.turning = 0;
        self.drives(if (linear, angular) == (0, 0) { Moving::No } else { Moving::Speeds });
        Ok(())
    }

    /// Notes a speed (m/s) that the robot cannot reach. A walking robot has no wheels, and drives at any.
    fn note_too_fast(&mut self, speed: f64) {
        let most = self.identity.top_speed;
        if most > 0.0 && speed.abs() > most * (1.0 + ROUNDING) {
            self.note_clipped(units::to_mm(speed), units::to_mm(most), "mm/s");
        }
    }

    /// Notes a turn rate that the robot cannot reach, be it alone or at its speed.
    fn note_turning_too_fast(&mut self, Twist { linear, angular }: Twist) {
        let Identity { top_speed, reach, tightest_turn, .. } = self.identity;
        let (most, is_car) = (self.identity.top_turn(), tightest_turn.is_finite());
        if !is_car && angular.abs() > most * (1.0 + ROUNDING) {
            self.note_clipped(units::to_deg(angular), units::to_deg(most), "degrees/s");
            return;
        }
        // A car's steering has an end, and the outer wheel turns faster than the robot drives.
        let steered = if is_car { angular.abs().min(tightest_turn * linear.abs()) } else { angular.abs() };
        let (mm, deg) = (units::to_mm(linear), units::to_deg(angular));
        if angular.abs() > steered * (1.0 + ROUNDING) {
            let most = units::to_deg(steered);
            self.note(&format!(
                "{deg:.0} degrees/s at {mm:.0} mm/s is a tighter turn than this robot can; it does at most \
                 {most:.0} \
                 degrees/s at this speed"
            ));
        }
        let rim = linear.abs() + reach * steered;
        if linear.abs() <= top_speed * (1.0 + ROUNDING) && rim > top_speed * (1.0 + ROUNDING) {
            let (rim, most) = (units::to_mm(rim), units::to_mm(top_speed));
            self.note(&format!(
                "{mm:.0} mm/s and {deg:.0} degrees/s together need {rim:.0} mm/s of a wheel; this robot's \
                 do at \
                 most {most:.0}, so it is slower on the same curve"
            ));
        }
    }

    fn note_clipped(&mut self, value: f64, most: f64, unit: &str) {
        self.note(&format!("{value:.0} {unit} is more than this robot can; it does at most {most:.0}"));
    }

    /// The nearest value of a range, with a note where that is another.
    fn clamped(&mut self, value: i32, least: i32, most: i32) -> i32 {
        let taken = value.clamp(least, most);
        if taken != value {
            self.note(&format!("{value}; expected {least} to {most}, taken as {taken}"));
        }
        taken
    }

    fn drives(&mut self, moving: Moving) {
        if moving == Moving::No && self.moving != Moving::No {
            self.standing_since = self.now();
        }
        self.moving = moving;
    }

    /// Time since which the robot stands (s); now, if it drives.
    pub(super) fn standing_since(&mut self) -> Result<f64> {
        if self.moving == Moving::Manoeuvre && self.queue.is_empty() && self.flag(&Request::IsDone)? {
            self.drives(Moving::No);
        }
        Ok(if self.moving == Moving::No { self.standing_since } else { self.now() })
    }

    /// `VWGetSpeed`.
    pub fn vw_get_speed(&mut self) -> Result<[i32; 2]> {
        match self.ask(&Request::Speed)? {
            Reply::Twist(twist) => {
                Ok([millimetres(twist.linear), units::to_deg(twist.angular).round() as i32])
            }
            _ => Err(super::foreign()),
        }
    }

    /// `VWSetPosition`.
    pub fn vw_set_position(&mut self, pose: [i32; 3]) -> Result<()> {
        self.order(&Request::SetPose(pose_from(pose)))
    }

    /// `VWGetPosition`.
    pub fn vw_get_position(&mut self) -> Result<[i32; 3]> {
        Ok(in_whole(self.pose_of(&Request::Pose)?.0))
    }

    /// `VWStraight`.
    pub fn vw_straight(&mut self, distance: i32, speed: i32) -> Result<()> {
        self.manoeuvre(units::from_mm(distance.into()), 0.0, units::from_mm(speed.into()))
    }

    /// `VWTurn`.
    pub fn vw_turn(&mut self, angle: i32, speed: i32) -> Result<()> {
        self.manoeuvre(0.0, units::from_deg(angle.into()), units::from_deg(speed.into()))
    }

    /// `VWCurve`: length of the arc, total change of heading, and speed along the arc.
    pub fn vw_curve(&mut self, length: i32, angle: i32, speed: i32) -> Result<()> {
        let speed = f64::from(speed);
        let speed = if length == 0 { units::from_deg(speed) } else { units::from_mm(speed) };
        self.manoeuvre(units::from_mm(length.into()), units::from_deg(angle.into()), speed)
    }

    /// `VWDrive`: the arc to a point ahead and to the left, with length and angle in whole millimetres and
    /// degrees.
    pub fn vw_drive(&mut self, forward: i32, left: i32, speed: i32) -> Result<()> {
        if left == 0 {
            return self.vw_straight(forward, speed);
        }
        let (x, y) = (f64::from(forward), f64::from(left));
        let half = math::atan2(y, x);
        let length = math::hypot(x, y) * half / math::sin(half);
        self.vw_curve(length as i32, (2.0 * units::to_deg(half)) as i32, speed)
    }

    fn manoeuvre(&mut self, length: f64, angle: f64, speed: f64) -> Result<()> {
        if speed == 0.0 {
            return Err(invalid("speed", speed, "more than 0 in size"));
        }
        self.turns = length == 0.0;
        if self.turns {
            self.note_turning_too_fast(Twist::new(0.0, speed));
        } else {
            self.note_too_fast(speed);
            // A car's manoeuvres have the speed of its middle, and turns too tight for it are refused.
            if self.identity.tightest_turn.is_infinite() {
                self.note_turning_too_fast(Twist::new(speed, speed * angle / length));
            }
        }
        self.order(&Request::Curve(length, angle, speed.abs()))?;
        self.turning = 0;
        self.drives(Moving::Manoeuvre);
        Ok(())
    }

    /// `VWRemain`: millimetres, or degrees for a turn on the spot.
    pub fn vw_remain(&mut self) -> Result<i32> {
        let rest = self.number(&Request::Remaining)?;
        Ok(if self.turns { units::to_deg(rest).round() as i32 } else { millimetres(rest) })
    }

    /// `VWDone`.
    pub fn vw_done(&mut self) -> Result<bool> {
        self.flag(&Request::IsDone)
    }

    /// Whether `VWWait` may return: the drive has ended or stalled.
    pub fn vw_arrived(&mut self) -> Result<bool> {
        Ok(self.flag(&Request::IsDone)? || self.flag(&Request::IsStalled)?)
    }

    /// `VWWait`, for a program with nothing else to do.
    pub fn vw_wait(&mut self) -> Result<()> {
        self.order(&Request::WaitDone)?;
        self.finish_frame()
    }

    /// `VWStalled`: 3 for both wheels, 0 for none.
    pub fn vw_stalled(&mut self) -> Result<i32> {
        Ok(if self.flag(&Request::IsStalled)? { 3 } else { 0 })
    }

    /// `MOTORDrive`: percent of EyeSim's full speed.
    pub fn motor_drive(&mut self, motor: i32, percent: i32) -> Result<()> {
        let percent = self.clamped(percent, -100, 100);
        let share = self.identity.full_speed / self.identity.top_speed;
        self.motor(motor, f64::from(percent) / 100.0 * share)
    }

    /// `MOTORSpeed`: encoder ticks per hundredth of a second.
    pub fn motor_speed(&mut self, motor: i32, ticks: i32) -> Result<()> {
        let speed = self.identity.tick_length * f64::from(ticks) * 100.0;
        let most = self.identity.top_speed;
        if most > 0.0 && speed.abs() > most * (1.0 + ROUNDING) {
            let most = most / (self.identity.tick_length * 100.0);
            self.note_clipped(ticks.into(), most, "encoder ticks in 10 ms");
        }
        self.motor(motor, speed / self.identity.top_speed)
    }

    /// Drives a motor at a fraction of its maximum speed.
    fn motor(&mut self, motor: i32, fraction: f64) -> Result<()> {
        let number = motor_number(motor)?;
        self.order(&Request::Motor(number, fraction.clamp(-1.0, 1.0)))?;
        let bit = 1 << number;
        self.turning = if fraction == 0.0 { self.turning & !bit } else { self.turning | bit };
        self.drives(if self.turning == 0 { Moving::No } else { Moving::Speeds });
        Ok(())
    }

    /// `MOTORPID` and `MOTORPIDOff`: the simulated motor controllers need no tuning.
    pub fn motor_pid(&mut self, motor: i32) -> Result<()> {
        motor_number(motor)?;
        self.charge()
    }

    /// `ENCODERRead`.
    pub fn encoder_read(&mut self, motor: i32) -> Result<i32> {
        let number = motor_number(motor)?;
        match self.ask(&Request::Encoder(number))? {
            Reply::Count(count) => Ok(count as i32),
            _ => Err(super::foreign()),
        }
    }

    /// `ENCODERReset`.
    pub fn encoder_reset(&mut self, motor: i32) -> Result<()> {
        let number = motor_number(motor)?;
        self.order(&Request::ResetEncoder(number))
    }

    /// `SERVOSet`: 0 to 255, 128 in the middle. Positions of servos without a device are only stored.
    pub fn servo_set(&mut self, servo: i32, angle: i32) -> Result<()> {
        let index = servo_index(servo)?;
        let angle = self.clamped(angle, 0, 255);
        self.servos[index] = angle;
        let position = f64::from(angle - 128) / 128.0;
        match self.order(&Request::Servo(index as u8, position)) {
            Err(error) if error.kind() == roverlab::io::ErrorKind::Unsupported => {
                self.note(&format!("{error}; its position is remembered alone"));
                Ok(())
            }
            result => result,
        }
    }

    /// `SERVOGet`.
    pub fn servo_get(&mut self, servo: i32) -> Result<i32> {
        let index = servo_index(servo)?;
        self.charge()?;
        Ok(self.servos[index])
    }

    /// Whether a servo exists.
    pub fn servo_check(&mut self, servo: i32) -> Result<()> {
        servo_index(servo)?;
        self.charge()
    }
}

fn servo_index(servo: i32) -> Result<usize> {
    let index = usize::try_from(servo).ok().filter(|_| (1..=14).contains(&servo));
    index.ok_or_else(|| invalid("servo", servo, "1 to 14"))
}

/// The simulator's number of a motor.
fn motor_number(motor: i32) -> Result<u8> {
    let number = u8::try_from(motor).ok().filter(|_| (1..=MOTORS).contains(&motor));
    number.ok_or_else(|| invalid("motor", motor, "1 to 4"))
}
