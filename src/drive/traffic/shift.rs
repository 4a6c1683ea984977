/// A change of the distance from the lane's middle along the road, by a polynomial of the fifth degree: slope
/// and curvature vanish at its ends.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Shift {
    from: f64,
    to: f64,
    begin: f64,
    length: f64,
}

/// Largest curvature that it adds to the lane's (1/m): a car at a scale of 1:10 turns with 2.0, bends take
/// 0.8. From a standstill, it is larger: there the car follows it without delay.
const CURVATURE: [f64; 2] = [1.3, 1.7];
/// Largest second derivative of the polynomial from 0 to 1.
const STEEPEST: f64 = 5.774;

impl Shift {
    /// From one distance to another (m to the left), from a place along the road on (m).
    pub(super) fn new(from: f64, to: f64, begin: f64) -> Self {
        Self::within(CURVATURE[0], from, to, begin)
    }

    /// The same from a standstill.
    pub(super) fn from_rest(from: f64, to: f64, begin: f64) -> Self {
        Self::within(CURVATURE[1], from, to, begin)
    }

    fn within(curvature: f64, from: f64, to: f64, begin: f64) -> Self {
        let length = (STEEPEST * (to - from).abs() / curvature).sqrt().max(0.1);
        Self { from, to, begin, length }
    }

    /// Distance at the end (m).
    pub(super) fn to(&self) -> f64 {
        self.to
    }

    pub(super) fn is_over(&self, along: f64) -> bool {
        along >= self.begin + self.length
    }

    /// Distance to the left of the lane's middle (m), its slope, and its second derivative (1/m).
    pub(super) fn at(&self, along: f64) -> [f64; 3] {
        if self.length == 0.0 {
            return [self.to, 0.0, 0.0];
        }
        let u = ((along - self.begin) / self.length).clamp(0.0, 1.0);
        let (high, long) = (self.to - self.from, self.length);
        [
            self.from + high * u * u * u * (10.0 + u * (6.0 * u - 15.0)),
            high * u * u * (30.0 + u * (30.0 * u - 60.0)) / long,
            high * u * (60.0 + u * (120.0 * u - 180.0)) / (long * long),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_differences() {
        let shift = Shift::new(0.0, 0.4, 1.0);
        for along in [1.1, 1.3, 1.6, 2.0] {
            let ([before, ..], [here, slope, bend], [after, ..]) =
                (shift.at(along - 1e-4), shift.at(along), shift.at(along + 1e-4));
            assert!(((after - before) / 2e-4 - slope).abs() < 1e-6);
            assert!(((after + before - 2.0 * here) / 1e-8 - bend).abs() < 1e-2);
            assert!(bend.abs() < CURVATURE[0] + 1e-3);
        }
        assert_eq!(shift.at(0.5), [0.0, 0.0, 0.0]);
        assert!(shift.is_over(9.0) && (shift.at(9.0)[0] - 0.4).abs() < 1e-12);
    }
}
