use roverlab::random::Stream;

/// A mean with its 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Interval {
    pub(crate) mean: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

/// Number of bootstrap samples.
const RESAMPLES: usize = 2000;

/// Mean of some values, with its interval by the percentile bootstrap, which assumes no distribution (B.
/// Efron, "Bootstrap methods: another look at the jackknife", Annals of Statistics 7(1), 1979). `None`
/// without values.
pub(crate) fn interval(values: &[f64]) -> Option<Interval> {
    let mean_of = |sum: f64| sum / values.len() as f64;
    if values.is_empty() {
        return None;
    }
    let mut stream = Stream::new(values.len() as u64);
    let mut means: Vec<f64> = (0..RESAMPLES)
        .map(|_| mean_of((0..values.len()).map(|_| values[stream.below(values.len())]).sum()))
        .collect();
    means.sort_by(f64::total_cmp);
    let at = |share: f64| means[(share * (RESAMPLES - 1) as f64).round() as usize];
    Some(Interval { mean: mean_of(values.iter().sum()), low: at(0.025), high: at(0.975) })
}
