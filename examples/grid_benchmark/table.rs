use serde_json::{Value, json};

use super::Args;
use super::job::Result;
use crate::common::rounded;

/// The result in words.
pub(super) fn text(result: &Result) -> String {
    let optional = |value: Option<f64>, digits: usize| value.map_or("-".into(), |v| format!("{v:.digits$}"));
    let lines = [
        format!("{}: {} x {} cells", result.map, result.width, result.height),
        format!(
            "{}: {} queries, {} solved, {} as long as published",
            result.algorithm.name(),
            result.queries,
            result.solved,
            result.optimal
        ),
        format!(
            "length in terms of the published one: mean {}, worst {}",
            optional(mean_ratio(result), 6),
            optional(worst_ratio(result), 6)
        ),
        format!(
            "time: median {} us, 95 % below {} us; {:.2} ms to get ready",
            optional(result.time(0.5), 1),
            optional(result.time(0.95), 1),
            result.preprocess_ms
        ),
        format!("nodes taken off the queue: {} a query", optional(mean_expanded(result), 1)),
    ];
    lines.join("\n")
}

/// The result as one JSON object in one line.
pub(super) fn json(result: &Result, args: &Args, wall_time: f64) -> String {
    // Written piece by piece, because an object of `serde_json` is sorted by name, and the outcome comes early.
    let fields = [
        ("example", json!("grid_benchmark")),
        ("outcome", json!(if result.is_good() { "solved" } else { "wrong" })),
        ("seed", json!(args.seed)),
        ("noise", Value::Null),
        ("sim_time_s", Value::Null),
        ("wall_time_s", json!(rounded(wall_time))),
        ("collisions", Value::Null),
        ("path_length_mm", Value::Null),
        ("pose", Value::Null),
        ("odometry", Value::Null),
        ("map", json!(result.map)),
        ("algorithm", json!(result.algorithm.name())),
        ("width", json!(result.width)),
        ("height", json!(result.height)),
        ("queries", json!(result.queries)),
        ("solved", json!(result.solved)),
        ("optimal", json!(result.optimal)),
        ("mean_ratio", json!(mean_ratio(result))),
        ("worst_ratio", json!(worst_ratio(result))),
        ("median_us", json!(result.time(0.5).map(rounded))),
        ("p95_us", json!(result.time(0.95).map(rounded))),
        ("preprocess_ms", json!(rounded(result.preprocess_ms))),
        ("mean_expanded", json!(mean_expanded(result).map(rounded))),
    ];
    let fields = fields.map(|(name, value)| format!("\"{name}\":{value}"));
    format!("{{{}}}", fields.join(","))
}

fn mean_ratio(result: &Result) -> Option<f64> {
    let count = result.ratios.len();
    (count > 0).then(|| result.ratios.iter().sum::<f64>() / count as f64)
}

fn worst_ratio(result: &Result) -> Option<f64> {
    result.ratios.iter().copied().reduce(f64::max)
}

fn mean_expanded(result: &Result) -> Option<f64> {
    (result.solved > 0).then(|| result.expanded as f64 / result.solved as f64)
}
