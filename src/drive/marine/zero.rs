/// The zero of a depth sensor: while its craft still floats, the depth at which it must be is known.
#[derive(Debug, Clone)]
pub(super) struct Zero {
    /// The depth of the sensor of a craft afloat (m).
    afloat: f64,
    begun: Option<f64>,
    is_over: bool,
    /// Readings less that depth: their number, sum and sum of squares.
    count: f64,
    sum: f64,
    squares: f64,
}

/// Seconds afloat.
const SECONDS: f64 = 3.0;
/// Standard deviation of a sensor's zero before any reading (m): the resolution of a Bar30.
const BEFORE: f64 = 0.002;
/// Standard deviation of the depth at which a craft floats (m): its mass is known to 50 g.
const FLOATS: f64 = 0.0004;
/// The most standard deviations that it may be off: a craft that does not float says nothing of the zero.
const GATE: f64 = 4.0;

impl Zero {
    /// Of a sensor that is so deep (m) when its craft floats.
    pub(super) fn afloat(depth: f64) -> Self {
        Self { afloat: depth, begun: None, is_over: false, count: 0.0, sum: 0.0, squares: 0.0 }
    }

    /// Takes notice of a reading.
    pub(super) fn read(&mut self, time: f64, depth: f64) {
        self.is_over |= time - *self.begun.get_or_insert(time) >= SECONDS;
        if !self.is_over {
            let off = depth - self.afloat;
            (self.count, self.sum, self.squares) =
                (self.count + 1.0, self.sum + off, self.squares + off * off);
        }
    }

    /// Whether it is known as well as it will be.
    pub(super) fn is_over(&self) -> bool {
        self.is_over
    }

    /// What the sensor reads too much (m).
    pub(super) fn offset(&self) -> f64 {
        self.seen().map_or(0.0, |(off, variance)| off * BEFORE * BEFORE / (BEFORE * BEFORE + variance))
    }

    /// Its standard deviation (m).
    pub(super) fn sigma(&self) -> f64 {
        self.seen().map_or(BEFORE, |(_, variance)| (1.0 / (1.0 / (BEFORE * BEFORE) + 1.0 / variance)).sqrt())
    }

    /// The mean of the readings less what they should be, and its variance.
    fn seen(&self) -> Option<(f64, f64)> {
        let mean = self.sum / self.count;
        let spread = (self.squares / self.count - mean * mean).max(0.0);
        let variance = spread / (self.count - 1.0) + FLOATS * FLOATS;
        let known = self.count > 1.0 && mean * mean <= GATE * GATE * (BEFORE * BEFORE + variance);
        known.then_some((mean, variance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(off: f64) -> Zero {
        let mut zero = Zero::afloat(0.1);
        for step in 0..=30 {
            let noise = if step % 2 == 0 { 0.002 } else { -0.002 };
            zero.read(0.1 * f64::from(step), 0.1 + off + noise);
        }
        assert!(zero.is_over());
        zero
    }

    #[test]
    fn what_a_sensor_reads_too_much_is_found_afloat() {
        let zero = after(0.003);
        assert!((zero.offset() - 0.003).abs() < 0.0004 && zero.sigma() < 0.0007, "{zero:?}");
    }

    #[test]
    fn a_craft_that_does_not_float_has_no_zero() {
        let zero = after(0.5);
        assert_eq!((zero.offset(), zero.sigma()), (0.0, BEFORE));
    }
}
