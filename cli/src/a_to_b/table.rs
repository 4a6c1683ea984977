use std::fmt::Write as _;

use roverlab::geometry::units::{to_deg, to_mm};
use serde_json::{Value, json};

use super::campaign::{Kind, Row};
use crate::common::rounded;

/// The table, without anything that differs between machines.
pub(crate) fn text(rows: &[Row]) -> String {
    let mut text = String::from(
        "what            noise  method  runs  reached  mean mm  worst mm  worst deg  in ellipse  good\n",
    );
    for row in rows {
        let inside =
            if row.kind == Kind::Odometry { format!("{:.1}%", row.percent_inside()) } else { "-".into() };
        writeln!(
            text,
            "{:<14}  {:>5}  {:<6}  {:>4}  {:>7}  {:>7.2}  {:>8.2}  {:>9.2}  {inside:>10}  {}",
            row.kind.name(),
            row.kind.noise(),
            row.way.name(),
            row.runs,
            row.reached,
            to_mm(row.mean_position),
            to_mm(row.worst_position),
            to_deg(row.worst_heading),
            if row.is_good() { "yes" } else { "NO" },
        )
        .expect("writing to a string does not fail");
    }
    text.push_str("good: 1 mm, 0.1 deg; 6 mm, 0.3 deg; 93.5 to 96.5 % in the 95 % ellipse; 20 mm");
    text
}

pub(super) fn json(rows: &[Row]) -> Vec<Value> {
    let one = |row: &Row| {
        json!({
            "what": row.kind.name(),
            "noise": row.kind.noise(),
            "method": row.way.name(),
            "runs": row.runs,
            "reached": row.reached,
            "contacts": row.contacts,
            "mean_position_error_mm": rounded(to_mm(row.mean_position)),
            "worst_position_error_mm": rounded(to_mm(row.worst_position)),
            "worst_heading_error_deg": rounded(to_deg(row.worst_heading)),
            "inside_ellipse_percent": (row.kind == Kind::Odometry).then(|| rounded(row.percent_inside())),
            "good": row.is_good(),
        })
    };
    rows.iter().map(one).collect()
}
