use std::f64::consts::PI;

use super::PidParameters;
use crate::io::Result;
use crate::parameter::{require_finite, require_not_negative, require_positive};

/// Tunes a PID controller: a relay in its place makes the process oscillate, and amplitude and period of the
/// oscillation yield the gains (K. J. Åström and T. Hägglund, "Automatic tuning of simple regulators with
/// specifications on phase and amplitude margins", 1984).
///
/// ```
/// use roverlab::drive::RelayTuner;
/// let mut tuner = RelayTuner::new(1.0, 0.0)?;
/// // A slow process: three lags of 0.2 s in series.
/// let (mut lags, step) = ([0.0_f64; 3], 0.002);
/// let result = loop {
///     let output = tuner.step(0.0 - lags[2], step)?;
///     let inputs = [output, lags[0], lags[1]];
///     lags.iter_mut().zip(inputs).for_each(|(lag, input)| *lag += step / 0.2 * (input - *lag));
///     if let Some(result) = tuner.result() {
///         break result;
///     }
/// };
/// // In theory its ultimate gain is 8, its period 2 pi 0.2 / sqrt(3) s.
/// assert!((result.gain - 8.0).abs() < 1.2 && (result.period - 0.7255).abs() < 0.05);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RelayTuner {
    amplitude: f64,
    hysteresis: f64,
    time: f64,
    high: bool,
    /// Time of the last upward switch (s), and the extremes of the error since.
    switched_up: Option<f64>,
    extremes: [f64; 2],
    /// Height and period (s) of each full oscillation.
    swings: Vec<[f64; 2]>,
}

/// Ultimate gain and period: the proportional gain at which the process oscillates for ever, and the period
/// of that oscillation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UltimateGain {
    /// Output for an error of 1.
    pub gain: f64,
    /// Period (s).
    pub period: f64,
}

/// Number of initial oscillations that are ignored.
const SETTLING: usize = 2;
/// Number of measured oscillations.
const MEASURED: usize = 4;
/// Relative difference up to which measured oscillations count as equal.
const STEADY: f64 = 0.05;

impl RelayTuner {
    /// Creates a relay with an output of ±`amplitude` that switches when the error is `hysteresis` beyond 0.
    /// Choose a hysteresis above the measurement noise. Fails for an amplitude that is not positive or a
    /// negative hysteresis.
    pub fn new(amplitude: f64, hysteresis: f64) -> Result<Self> {
        require_positive("amplitude", amplitude)?;
        require_not_negative("hysteresis", hysteresis)?;
        Ok(Self {
            amplitude,
            hysteresis,
            time: 0.0,
            high: true,
            switched_up: None,
            extremes: [f64::INFINITY, f64::NEG_INFINITY],
            swings: Vec::new(),
        })
    }

    /// The output for an error (setpoint minus measurement), `seconds` after the last step. Fails for numbers
    /// that are not finite.
    pub fn step(&mut self, error: f64, seconds: f64) -> Result<f64> {
        require_finite("error", error)?;
        require_positive("time since the last step", seconds)?;
        self.time += seconds;
        self.extremes = [self.extremes[0].min(error), self.extremes[1].max(error)];
        if self.high && error < -self.hysteresis {
            self.high = false;
        } else if !self.high && error > self.hysteresis {
            self.high = true;
            self.end_swing();
        }
        Ok(if self.high { self.amplitude } else { -self.amplitude })
    }

    fn end_swing(&mut self) {
        if let Some(begin) = self.switched_up {
            self.swings.push([0.5 * (self.extremes[1] - self.extremes[0]), self.time - begin]);
        }
        self.switched_up = Some(self.time);
        self.extremes = [f64::INFINITY, f64::NEG_INFINITY];
    }

    /// The result, once the oscillation is steady.
    pub fn result(&self) -> Option<UltimateGain> {
        if self.swings.len() < SETTLING + MEASURED {
            return None;
        }
        let last = &self.swings[self.swings.len() - MEASURED..];
        let mean = |index: usize| last.iter().map(|swing| swing[index]).sum::<f64>() / MEASURED as f64;
        let means = [mean(0), mean(1)];
        let steady =
            last.iter().all(|swing| [0, 1].iter().all(|&i| (swing[i] / means[i] - 1.0).abs() <= STEADY));
        let height = (means[0] * means[0] - self.hysteresis * self.hysteresis).max(0.0).sqrt();
        // The fundamental of a square wave has 4 / pi times its amplitude.
        (steady && height > 0.0)
            .then(|| UltimateGain { gain: 4.0 * self.amplitude / (PI * height), period: means[1] })
    }
}

impl UltimateGain {
    /// Gains by J. G. Ziegler and N. B. Nichols, "Optimum settings for automatic controllers", 1942: fast,
    /// with some overshoot.
    pub fn ziegler_nichols(&self) -> PidParameters {
        self.parameters(0.6, 0.5, 0.125)
    }

    /// Gains by B. D. Tyreus and W. L. Luyben, "Tuning PI controllers for integrator/dead time processes",
    /// 1992: slower, with hardly any overshoot.
    pub fn tyreus_luyben(&self) -> PidParameters {
        self.parameters(1.0 / 2.2, 2.2, 1.0 / 6.3)
    }

    /// Gains from a fraction of the ultimate gain, and from integral and derivative times as multiples of the
    /// period.
    fn parameters(&self, share: f64, integral_time: f64, derivative_time: f64) -> PidParameters {
        let proportional = share * self.gain;
        let derivative_time = derivative_time * self.period;
        PidParameters {
            proportional,
            integral: proportional / (integral_time * self.period),
            derivative: proportional * derivative_time,
            derivative_filter: 0.1 * derivative_time,
            ..PidParameters::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Pid;

    /// First-order lags in series.
    struct Lags([f64; 3]);

    impl Lags {
        fn step(&mut self, input: f64, seconds: f64) -> f64 {
            let inputs = [input, self.0[0], self.0[1]];
            self.0.iter_mut().zip(inputs).for_each(|(lag, input)| *lag += seconds / 0.2 * (input - *lag));
            self.0[2]
        }
    }

    fn tuned(hysteresis: f64) -> UltimateGain {
        let (mut tuner, mut process, mut output) =
            (RelayTuner::new(1.0, hysteresis).unwrap(), Lags([0.0; 3]), 0.0);
        for _ in 0..100_000 {
            let measurement = process.step(output, 0.005);
            output = tuner.step(0.3 - measurement, 0.005).unwrap();
            if let Some(result) = tuner.result() {
                return result;
            }
        }
        panic!("the relay finds nothing: {tuner:?}");
    }

    #[test]
    fn tuned_controllers_come_to_the_setpoint() {
        for (gains, overshoot) in [(tuned(0.0).ziegler_nichols(), 1.8), (tuned(0.01).tyreus_luyben(), 1.35)] {
            let (mut pid, mut process, mut measurement, mut most) =
                (Pid::new(gains).unwrap(), Lags([0.0; 3]), 0.0, 0.0_f64);
            for _ in 0..4000 {
                measurement = process.step(pid.step(1.0, measurement, 0.005).unwrap(), 0.005);
                most = most.max(measurement);
            }
            assert!((measurement - 1.0).abs() < 0.01 && most < overshoot, "{measurement} {most} {gains:?}");
        }
    }

    #[test]
    fn nothing_is_found_before_it_swings() {
        let mut tuner = RelayTuner::new(1.0, 0.0).unwrap();
        for _ in 0..1000 {
            tuner.step(1.0, 0.01).unwrap();
        }
        assert_eq!(tuner.result(), None);
        assert!(tuner.step(f64::NAN, 0.01).is_err());
        assert!(RelayTuner::new(0.0, 0.0).is_err());
        assert!(RelayTuner::new(1.0, -0.1).is_err());
    }
}
