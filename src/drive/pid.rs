use crate::io::{Error, Result};
use crate::parameter::{require_finite, require_not_negative, require_positive};

/// Gains and limits of a [`Pid`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PidParameters {
    /// Output per unit of error.
    pub proportional: f64,
    /// Output per unit of error and second.
    pub integral: f64,
    /// Output per unit of rate of change of the measurement, which it opposes.
    pub derivative: f64,
    /// Time constant of the low-pass filter on the derivative (s); 0 disables the filter.
    pub derivative_filter: f64,
    /// Minimum and maximum output.
    pub limits: [f64; 2],
}

impl Default for PidParameters {
    /// A proportional gain of 1 and no limits.
    fn default() -> Self {
        Self {
            proportional: 1.0,
            integral: 0.0,
            derivative: 0.0,
            derivative_filter: 0.0,
            limits: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }
}

/// A PID controller (K. J. Åström and T. Hägglund, "PID controllers: theory, design, and tuning", 1995).
///
/// The derivative acts on the measurement, so a jump of the setpoint does not kick the output. The integral
/// stops growing while the output is saturated (*anti-windup*), which avoids overshoot afterwards.
///
/// ```
/// use roverlab::drive::{Pid, PidParameters};
/// let gains = PidParameters { proportional: 2.0, integral: 1.0, limits: [-1.0, 1.0], ..PidParameters::default() };
/// let mut pid = Pid::new(gains)?;
/// // Something that moves as fast as the output says comes to the setpoint.
/// let mut position = 0.0;
/// for _ in 0..2000 {
///     position += 0.01 * pid.step(3.0, position, 0.01)?;
/// }
/// assert!((position - 3.0_f64).abs() < 1e-3);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pid {
    parameters: PidParameters,
    /// Integral part of the output.
    integral: f64,
    /// Last measurement, and its filtered rate of change.
    last: Option<f64>,
    rate: f64,
}

impl Pid {
    /// Creates a controller at rest. Fails for gains that are not finite, a negative filter time and limits
    /// in the wrong order.
    pub fn new(parameters: PidParameters) -> Result<Self> {
        require_finite("proportional gain", parameters.proportional)?;
        require_finite("integral gain", parameters.integral)?;
        require_finite("derivative gain", parameters.derivative)?;
        require_not_negative("derivative filter", parameters.derivative_filter)?;
        let [least, most] = parameters.limits;
        if least.is_nan() || most.is_nan() || least >= most {
            let found = format!("{least} to {most}");
            return Err(Error::invalid_input("output limits", found, "the smaller one first"));
        }
        Ok(Self { parameters, integral: 0.0, last: None, rate: 0.0 })
    }

    /// The output for a setpoint and a measurement, `seconds` after the last step.
    ///
    /// Fails for numbers that are not finite, such as a missing sensor return; the controller's state stays
    /// unchanged.
    pub fn step(&mut self, setpoint: f64, measurement: f64, seconds: f64) -> Result<f64> {
        require_finite("setpoint", setpoint)?;
        require_finite("measurement", measurement)?;
        require_positive("time since the last step", seconds)?;
        let PidParameters { proportional, integral, derivative, derivative_filter, limits: [least, most] } =
            self.parameters;
        let error = setpoint - measurement;
        let raw = self.last.map_or(0.0, |last| (measurement - last) / seconds);
        self.rate += (raw - self.rate) * seconds / (seconds + derivative_filter);
        self.last = Some(measurement);

        let wound = self.integral + integral * error * seconds;
        let free = proportional * error + wound - derivative * self.rate;
        let growing = wound.abs() > self.integral.abs();
        let pushes = (free > most && wound > self.integral) || (free < least && wound < self.integral);
        if !(pushes && growing) {
            self.integral = wound.clamp(least, most);
        }
        Ok((proportional * error + self.integral - derivative * self.rate).clamp(least, most))
    }

    /// Integral part of the output.
    pub fn integral(&self) -> f64 {
        self.integral
    }

    /// Resets the controller to rest.
    pub fn reset(&mut self) {
        (self.integral, self.last, self.rate) = (0.0, None, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A wheel of unit inertia with friction; returns its maximum and its final speed.
    fn drive_wheel(pid: &mut Pid, setpoint: f64, seconds: f64) -> (f64, f64) {
        let (mut speed, mut most, step) = (0.0_f64, 0.0_f64, 0.01);
        for _ in 0..(seconds / step) as u32 {
            let torque = pid.step(setpoint, speed, step).unwrap();
            speed += step * (torque - 0.5 * speed);
            most = most.max(speed);
        }
        (most, speed)
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn outputs_stay_within_their_limits(
            gains in prop::array::uniform3(-10.0..10.0f64), measurements in prop::collection::vec(-5.0..5.0f64, 1..50),
        ) {
            let [proportional, integral, derivative] = gains;
            let parameters =
                PidParameters { proportional, integral, derivative, limits: [-1.0, 2.0], derivative_filter: 0.05 };
            let mut pid = Pid::new(parameters).unwrap();
            for measurement in measurements {
                let output = pid.step(1.0, measurement, 0.02).unwrap();
                prop_assert!((-1.0..=2.0).contains(&output));
            }
        }

        #[test]
        fn without_an_integral_the_output_is_the_error(error in -5.0..5.0f64, gain in -3.0..3.0f64) {
            let mut pid = Pid::new(PidParameters { proportional: gain, ..PidParameters::default() }).unwrap();
            prop_assert_eq!(pid.step(error, 0.0, 0.1).unwrap(), gain * error);
        }
    }

    #[test]
    fn the_integral_takes_the_last_error_away() {
        let gains = PidParameters { proportional: 2.0, integral: 1.5, ..PidParameters::default() };
        let (_, with) = drive_wheel(&mut Pid::new(gains).unwrap(), 1.0, 20.0);
        let (_, without) =
            drive_wheel(&mut Pid::new(PidParameters { integral: 0.0, ..gains }).unwrap(), 1.0, 20.0);
        assert!((with - 1.0).abs() < 1e-6 && (without - 0.8).abs() < 1e-3, "{with} {without}");
    }

    #[test]
    fn a_saturated_controller_does_not_wind_up() {
        let gains = PidParameters {
            proportional: 1.0,
            integral: 1.0,
            limits: [-0.6, 0.6],
            ..PidParameters::default()
        };
        let mut pid = Pid::new(gains).unwrap();
        // The limit allows a speed of 1.2 at most, so the approach takes long.
        let (most, last) = drive_wheel(&mut pid, 1.1, 40.0);
        assert!(most < 1.1 * 1.02 && (last - 1.1).abs() < 0.01, "{most} {last}");
        assert!(pid.integral() <= 0.6);
    }

    #[test]
    fn a_jump_of_the_setpoint_does_not_kick() {
        let gains = PidParameters { derivative: 5.0, ..PidParameters::default() };
        let mut pid = Pid::new(gains).unwrap();
        assert_eq!(pid.step(0.0, 0.3, 0.01).unwrap(), -0.3);
        assert_eq!(pid.step(1.0, 0.3, 0.01).unwrap(), 0.7);
        // A jump of the measurement kicks the output.
        assert!(pid.step(1.0, 0.4, 0.01).unwrap() < -40.0);
        pid.reset();
        assert_eq!(pid.step(1.0, 0.5, 0.01).unwrap(), 0.5);
    }

    #[test]
    fn wrong_numbers_are_refused() {
        let new = |change: fn(&mut PidParameters)| {
            let mut parameters = PidParameters::default();
            change(&mut parameters);
            Pid::new(parameters)
        };
        assert!(new(|p| p.proportional = f64::NAN).is_err());
        assert!(new(|p| p.derivative_filter = -1.0).is_err());
        assert!(new(|p| p.limits = [1.0, 0.0]).is_err());
        let mut pid = Pid::new(PidParameters::default()).unwrap();
        let before = pid;
        assert!(pid.step(1.0, f64::INFINITY, 0.1).is_err());
        assert!(pid.step(1.0, 0.0, 0.0).is_err());
        assert_eq!(pid, before);
    }
}
