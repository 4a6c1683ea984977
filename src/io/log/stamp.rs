/// Nanoseconds of recorded time.
pub(super) type Nanoseconds = u64;

/// Seconds as a recording holds them; what is no time is 0.
pub(super) fn nanoseconds(seconds: f64) -> Nanoseconds {
    // Casting clips what is out of range.
    (seconds * 1e9).round() as u64
}

/// Recorded time in seconds.
pub(super) fn seconds(time: Nanoseconds) -> f64 {
    time as f64 / 1e9
}
