use crate::geometry::angle_difference;

/// What a compass reads too much: for some seconds, the heading is that of the start and what turn rates add to it.
#[derive(Debug, Clone)]
pub(super) struct Alignment {
    /// By the start and turn rates (rad).
    heading: f64,
    /// Seconds for which these are still the better ones.
    left: f64,
    off: f64,
}

/// Seconds: the compass's noise of half a degree, which is averaged over a second, is then as little as a turn rate's
/// error of 0.05 degrees per second has become.
const SECONDS: f64 = 2.0;

impl Alignment {
    /// Begins at a heading (rad).
    pub(super) fn at(heading: f64) -> Self {
        Self { heading, left: SECONDS, off: 0.0 }
    }

    /// Takes notice of a turn (rad) in some seconds, and of the heading (rad) by compass after it.
    pub(super) fn learn(&mut self, turned: f64, seconds: f64, compass: f64) {
        if self.left > 0.0 {
            self.heading += turned;
            self.left -= seconds;
            self.off = angle_difference(compass, self.heading);
        }
    }

    /// What the compass reads too much (rad).
    pub(super) fn off(&self) -> f64 {
        self.off
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_compass_is_aligned_by_the_start_and_stays_so() {
        let mut alignment = Alignment::at(0.3);
        for step in 1..=20 {
            alignment.learn(0.01, 0.1, 0.3 + 0.01 * f64::from(step) + 0.02);
        }
        assert!((alignment.off() - 0.02).abs() < 1e-9);
        alignment.learn(0.0, 0.1, 3.0);
        assert!((alignment.off() - 0.02).abs() < 1e-9);
    }
}
