//! Time-optimal speed profile of a straight: full acceleration, top speed, full braking.

/// A phase of constant acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Phase {
    /// Duration (s).
    pub(super) time: f64,
    /// Speed at its start (m/s).
    pub(super) speed: f64,
    pub(super) acceleration: f64,
}

/// Length that may be lost by rounding (m).
const SLACK: f64 = 1e-9;

/// Highest speed on the way; `None` if the length is negative or too short for the change of speed.
fn peak(length: f64, entry: f64, exit: f64, top: f64, acceleration: f64) -> Option<f64> {
    let change = 0.5 * (entry * entry - exit * exit).abs() / acceleration;
    if length < change - SLACK {
        return None;
    }
    let reachable = (0.5 * (entry * entry + exit * exit) + acceleration * length.max(0.0)).sqrt();
    Some(reachable.min(top).max(entry).max(exit))
}

/// Time for a length between two speeds (s); neither may exceed the top speed.
pub(super) fn time(length: f64, entry: f64, exit: f64, top: f64, acceleration: f64) -> Option<f64> {
    peak(length, entry, exit, top, acceleration)?;
    Some(phases(length, entry, exit, top, acceleration).iter().map(|phase| phase.time).sum())
}

/// The three phases; no duration is negative.
pub(super) fn phases(length: f64, entry: f64, exit: f64, top: f64, acceleration: f64) -> [Phase; 3] {
    let peak = peak(length, entry, exit, top, acceleration).unwrap_or(entry.max(exit));
    let (up, down) = ((peak - entry) / acceleration, (peak - exit) / acceleration);
    let ramps = 0.5 * ((entry + peak) * up + (peak + exit) * down);
    let cruise = if peak > 0.0 { ((length - ramps) / peak).max(0.0) } else { 0.0 };
    [
        Phase { time: up, speed: entry, acceleration },
        Phase { time: cruise, speed: peak, acceleration: 0.0 },
        Phase { time: down, speed: peak, acceleration: -acceleration },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn the_phases_cover_the_length(length in 0.0..3.0f64, entry in 0.0..1.0f64, exit in 0.0..1.0f64) {
            let (top, acceleration) = (1.5, 4.0);
            let least = 0.5 * (entry * entry - exit * exit).abs() / acceleration;
            match time(length, entry, exit, top, acceleration) {
                None => prop_assert!(length < least),
                Some(total) => {
                    let phases = phases(length, entry, exit, top, acceleration);
                    let way = phases.iter().map(|p| (p.speed + 0.5 * p.acceleration * p.time) * p.time);
                    prop_assert!((way.sum::<f64>() - length).abs() < 1e-6);
                    prop_assert!(phases.iter().all(|p| p.time >= 0.0));
                    let end = phases[2].speed + phases[2].acceleration * phases[2].time;
                    prop_assert!((end - exit).abs() < 1e-9);
                    prop_assert!(total * top >= length - 1e-9);
                }
            }
        }

        #[test]
        fn a_longer_way_takes_longer(length in 0.1..3.0f64, more in 0.001..1.0f64) {
            let time = |length| time(length, 0.5, 0.7, 2.0, 6.0).unwrap();
            prop_assert!(time(length + more) > time(length));
        }
    }
}
