use std::time::{Duration, Instant};

/// How long to measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Effort {
    Full,
    Quick,
}

/// The median time of a call in seconds: of batches that each take long enough for the clock.
#[allow(clippy::disallowed_methods, reason = "a benchmark measures time")]
pub(crate) fn median(effort: Effort, mut call: impl FnMut()) -> f64 {
    let (batches, least) = match effort {
        Effort::Full => (31, Duration::from_millis(2)),
        Effort::Quick => (7, Duration::from_micros(500)),
    };
    let mut calls = 1_u32;
    loop {
        let start = Instant::now();
        (0..calls).for_each(|_| call());
        if start.elapsed() >= least || calls > 1 << 20 {
            break;
        }
        calls *= 2;
    }
    let mut times: Vec<f64> = (0..batches)
        .map(|_| {
            let start = Instant::now();
            (0..calls).for_each(|_| call());
            start.elapsed().as_secs_f64() / f64::from(calls)
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
