/// Recorded time (ns).
pub(super) type Nanoseconds = u64;

/// Recorded time from seconds; NaN gives 0.
pub(super) fn nanoseconds(seconds: f64) -> Nanoseconds {
    // The cast saturates.
    (seconds * 1e9).round() as u64
}

/// Recorded time (s).
pub(super) fn seconds(time: Nanoseconds) -> f64 {
    time as f64 / 1e9
}
