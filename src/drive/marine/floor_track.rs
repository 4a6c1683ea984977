/// The depth of the floor below a craft, and how fast it changes as the craft moves on: an observer of both,
/// driven by soundings (an alpha-beta filter; Bar-Shalom et al., *Estimation with Applications to Tracking
/// and Navigation*, 2001, section 6.5).
#[derive(Debug, Clone, Default)]
pub(super) struct FloorTrack {
    /// In metres, once there has been a sounding.
    depth: Option<f64>,
    /// Downwards, in m/s.
    rate: f64,
    /// How much deeper the last sounding was than expected (m).
    off: f64,
}

/// Bandwidth (rad/s): of an error of 10 mm in each of ten soundings a second 4 mm are left, and it lags
/// behind a slope that begins for two seconds.
const BANDWIDTH: f64 = 1.5;

impl FloorTrack {
    /// Takes in the depth (m) of the floor, `seconds` after the sounding before; without an echo the floor is
    /// level.
    pub(super) fn see(&mut self, depth: Option<f64>, seconds: f64) {
        let Some(depth) = depth else {
            (self.rate, self.off) = (0.0, 0.0);
            return;
        };
        let expected = self.depth.map_or(depth, |before| before + self.rate * seconds);
        self.off = depth - expected;
        self.depth = Some(expected + 2.0 * BANDWIDTH * seconds * self.off);
        self.rate += BANDWIDTH * BANDWIDTH * seconds * self.off;
    }

    /// The depth (m) so many metres above the floor, its speed (m/s) and acceleration (m/s²); `None` before
    /// the first sounding.
    pub(super) fn above(&self, altitude: f64) -> Option<[f64; 3]> {
        // The estimate moves by its rate and by what each sounding corrects.
        let speed = self.rate + 2.0 * BANDWIDTH * self.off;
        self.depth.map(|depth| [depth - altitude, speed, BANDWIDTH * BANDWIDTH * self.off])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_is_followed_without_lag_and_its_noise_averaged() {
        let (mut floor, mut stream, mut squares) =
            (FloorTrack::default(), crate::random::Stream::new(4), 0.0);
        for step in 0..400 {
            let truth = 3.0 + 0.012 * f64::from(step);
            floor.see(Some(truth + 0.01 * stream.normal()), 0.1);
            if step >= 100 {
                let off = floor.above(1.0).unwrap()[0] + 1.0 - truth;
                squares += off * off / 300.0;
            }
        }
        assert!(squares.sqrt() < 0.006, "{squares}");
        assert!((floor.rate - 0.12).abs() < 0.02, "{floor:?}");
        floor.see(None, 0.1);
        assert_eq!((floor.rate, floor.off), (0.0, 0.0));
    }
}
