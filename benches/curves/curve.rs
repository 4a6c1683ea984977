//! Times of one task in several sizes.

use std::time::Instant;

/// The time of a task of one size.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    pub(crate) size: f64,
    pub(crate) seconds: f64,
}

/// The times of a task.
#[derive(Debug)]
pub(crate) struct Curve {
    pub(crate) name: &'static str,
    /// What its size counts.
    pub(crate) unit: &'static str,
    /// From small to large.
    pub(crate) points: Vec<Sample>,
}

impl Curve {
    /// Measures a task in several sizes. `prepare` makes what is measured, and says its size.
    pub(crate) fn measure<T: FnMut()>(
        name: &'static str,
        unit: &'static str,
        sizes: &[usize],
        mut prepare: impl FnMut(usize) -> (usize, T),
    ) -> Self {
        let points = sizes.iter().map(|&wanted| {
            let (size, task) = prepare(wanted);
            Sample { size: size as f64, seconds: fastest(task) }
        });
        Self { name, unit, points: points.collect() }
    }
}

/// Seconds of real time for which a size is measured at least, and calls.
const LEAST: (f64, usize) = (0.3, 3);

/// The time of the fastest of many calls: what else the machine does counts as little as can be.
#[allow(clippy::disallowed_methods, reason = "a benchmark measures time")]
fn fastest(mut task: impl FnMut()) -> f64 {
    let (begin, mut best, mut calls) = (Instant::now(), f64::INFINITY, 0);
    while calls < LEAST.1 || begin.elapsed().as_secs_f64() < LEAST.0 {
        let start = Instant::now();
        task();
        best = start.elapsed().as_secs_f64().min(best);
        calls += 1;
    }
    best
}

/// The power of the size with which the time grows: the slope of the straight line that fits best to the
/// logarithms of both.
#[allow(clippy::disallowed_methods, reason = "for a table that people read")]
pub(crate) fn exponent(points: &[Sample]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|point| (point.size.ln(), point.seconds.ln())).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(|log| log.0), mean(|log| log.1));
    let spread = |a: fn(&(f64, f64), f64, f64) -> f64| logs.iter().map(|log| a(log, x, y)).sum::<f64>();
    spread(|log, x, y| (log.0 - x) * (log.1 - y)) / spread(|log, x, _| (log.0 - x) * (log.0 - x))
}

/// A number with one or two digits and the unit of a thousand or a million.
pub(crate) fn short(size: f64) -> String {
    match size {
        n if n >= 1e6 => format!("{:.1}M", n / 1e6),
        n if n >= 1e4 => format!("{:.0}k", n / 1e3),
        n if n >= 1e3 => format!("{:.1}k", n / 1e3),
        n => format!("{n:.0}"),
    }
}
