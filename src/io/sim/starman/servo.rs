/// Setpoint of a servo, which moves towards its target at the servo's speed.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Servo {
    /// Target angle (rad).
    target: f64,
    /// Present angle (rad).
    angle: f64,
}

impl Servo {
    pub(super) fn send(&mut self, target: f64) {
        self.target = target;
    }

    /// Advances the time; returns the angle and rate to hold afterwards.
    pub(super) fn advance(&mut self, speed: f64, seconds: f64) -> (f64, f64) {
        let reach = speed * seconds;
        let step = (self.target - self.angle).clamp(-reach, reach);
        self.angle += step;
        (self.angle, step / seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_servo_takes_its_time_and_then_stands() {
        let mut servo = Servo::default();
        servo.send(-0.25);
        assert_eq!(servo.advance(1.0, 0.1), (-0.1, -1.0));
        assert_eq!(servo.advance(1.0, 0.1), (-0.2, -1.0));
        let (angle, _) = servo.advance(1.0, 0.1);
        assert_eq!((angle, servo.advance(1.0, 0.1)), (-0.25, (-0.25, 0.0)));
    }
}
