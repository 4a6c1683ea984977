use std::fmt::Write as _;

use roverlab::nav::BugKind;
use serde_json::{Value, json};

use super::contest::{Entry, Setting};
use super::ride::Ride;
use super::statistics::{Interval, interval};
use crate::common::{millimetres, rounded};

/// Runs of one algorithm in the courses of one family.
pub(super) struct Row<'a> {
    kind: BugKind,
    family: &'a str,
    runs: Vec<(&'a Setting, &'a Ride, bool)>,
}

/// Rows of the table, family by family.
pub(super) fn rows(entries: &[Entry], noise: f64) -> Vec<Row<'_>> {
    let mut rows: Vec<Row<'_>> = Vec::new();
    for Entry { setting, rides } in entries {
        for ride in rides {
            let run = (setting, ride, ride.is_correct(setting.reachable, noise));
            let same = |row: &&mut Row<'_>| row.kind == ride.kind && row.family == setting.family;
            match rows.iter_mut().find(same) {
                Some(row) => row.runs.push(run),
                None => rows.push(Row { kind: ride.kind, family: &setting.family, runs: vec![run] }),
            }
        }
    }
    rows
}

impl Row<'_> {
    fn correct(&self) -> usize {
        self.runs.iter().filter(|(_, _, correct)| *correct).count()
    }

    fn contacts(&self) -> u32 {
        self.runs.iter().map(|(_, ride, _)| ride.contacts).sum()
    }

    /// Interval of a figure over the correct runs that have it.
    fn over_correct(&self, figure: impl Fn(&Setting, &Ride) -> Option<f64>) -> Option<Interval> {
        let correct = self.runs.iter().filter(|(_, _, correct)| *correct);
        interval(&correct.filter_map(|(setting, ride, _)| figure(setting, ride)).collect::<Vec<_>>())
    }

    fn path(&self) -> Option<Interval> {
        self.over_correct(|_, ride| Some(ride.path_length))
    }

    fn ratio(&self) -> Option<Interval> {
        self.over_correct(|setting, ride| setting.shortest.map(|shortest| ride.path_length / shortest))
    }

    fn hits(&self) -> Option<f64> {
        self.over_correct(|_, ride| Some(ride.hits.len() as f64)).map(|hits| hits.mean)
    }
}

/// The table as text: the algorithms of every family, the shortest mean path first.
pub(super) fn text(rows: &[Row<'_>]) -> String {
    let mut families: Vec<&str> = rows.iter().map(|row| row.family).collect();
    families.dedup();
    let mut text = String::new();
    for family in families {
        let mut of_family: Vec<&Row<'_>> = rows.iter().filter(|row| row.family == family).collect();
        let length = |row: &Row<'_>| row.path().map_or(f64::INFINITY, |path| path.mean);
        of_family.sort_by(|a, b| length(a).total_cmp(&length(b)));
        writeln!(
            text,
            "{family:<16}{:>8}{:>9}{:>9}{:>16}{:>9}{:>16}{:>7}",
            "correct", "contacts", "path m", "95 %", "ratio", "95 %", "hits"
        )
        .expect("writing to a string does not fail");
        text.extend(of_family.iter().map(|row| line(row)));
        text.push('\n');
    }
    text.push_str(
        "ratio: to the shortest way; paths, ratios and hits are means over the runs with correct verdicts",
    );
    text
}

fn line(row: &Row<'_>) -> String {
    let mean = |interval: Option<Interval>| interval.map_or("-".into(), |i| format!("{:.2}", i.mean));
    let range = |interval: Option<Interval>| {
        interval.map_or("-".into(), |i| format!("{:.2} to {:.2}", i.low, i.high))
    };
    let (path, ratio) = (row.path(), row.ratio());
    format!(
        "  {:<14}{:>8}{:>9}{:>9}{:>16}{:>9}{:>16}{:>7}\n",
        row.kind.name(),
        format!("{}/{}", row.correct(), row.runs.len()),
        row.contacts(),
        mean(path),
        range(path),
        mean(ratio),
        range(ratio),
        row.hits().map_or("-".into(), |hits| format!("{hits:.1}")),
    )
}

/// The rows as JSON.
pub(super) fn json(rows: &[Row<'_>]) -> Value {
    let row = |row: &Row<'_>| {
        let (path, ratio) = (row.path(), row.ratio());
        json!({
            "bug": row.kind.name(),
            "family": row.family,
            "runs": row.runs.len(),
            "correct": row.correct(),
            "contacts": row.contacts(),
            "mean_path_mm": path.map(|path| millimetres(path.mean)),
            "path_ci_mm": path.map(|path| [millimetres(path.low), millimetres(path.high)]),
            "mean_ratio": ratio.map(|ratio| rounded(ratio.mean)),
            "ratio_ci": ratio.map(|ratio| [rounded(ratio.low), rounded(ratio.high)]),
            "mean_hits": row.hits().map(rounded),
        })
    };
    rows.iter().map(row).collect()
}

/// Every run as JSON.
pub(super) fn json_runs(rows: &[Row<'_>]) -> Value {
    let run = |row: &Row<'_>, (setting, ride, correct): &(&Setting, &Ride, bool)| {
        json!({
            "bug": row.kind.name(),
            "family": row.family,
            "seed": setting.seed,
            "outcome": ride.word(),
            "reachable": setting.reachable,
            "correct": correct,
            "contacts": ride.contacts,
            "path_mm": millimetres(ride.path_length),
            "shortest_mm": setting.shortest.map(millimetres),
            "hits": ride.hits.len(),
        })
    };
    rows.iter().flat_map(|row| row.runs.iter().map(move |entry| run(row, entry))).collect()
}

/// Whether every verdict of a complete algorithm is true.
pub(super) fn all_correct(rows: &[Row<'_>]) -> bool {
    rows.iter().all(|row| row.runs.iter().all(|(_, ride, correct)| *correct || !ride.guarantee.complete))
}
