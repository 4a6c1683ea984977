use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use super::place::Place;
use super::run::Ran;
use crate::common::rounded;

/// The runs of a program.
#[derive(Debug, Clone)]
pub(super) struct Graded {
    pub(super) name: String,
    pub(super) runs: Vec<Ran>,
}

/// Longest name and output in the text table (characters).
const NAME: usize = 28;
const OUTPUT: usize = 40;

impl Graded {
    pub(super) fn reached(&self) -> usize {
        self.good().count()
    }

    fn good(&self) -> impl Iterator<Item = &Ran> {
        self.runs.iter().filter(|ran| ran.outcome == "reached")
    }

    pub(super) fn contacts(&self) -> u64 {
        self.runs.iter().map(|ran| ran.contacts).sum()
    }

    /// Median simulated time of the runs that reached (s).
    pub(super) fn time(&self) -> Option<f64> {
        median(self.good().map(|ran| ran.time).collect())
    }

    /// Median of their path lengths relative to the shortest way.
    pub(super) fn ratio(&self, places: &[Place]) -> Option<f64> {
        let ratio = |ran: &Ran| places[ran.place].shortest.map(|shortest| ran.length / shortest);
        median(self.good().filter_map(ratio).collect())
    }

    /// Number of runs by how they ended.
    pub(super) fn outcomes(&self) -> BTreeMap<&'static str, usize> {
        let mut counts = BTreeMap::new();
        for ran in &self.runs {
            *counts.entry(ran.outcome).or_default() += 1;
        }
        counts
    }

    fn names(&self, of: fn(&Ran) -> &Vec<String>) -> BTreeSet<&str> {
        self.runs.iter().flat_map(|ran| of(ran).iter().map(String::as_str)).collect()
    }

    /// The output of the first run that has one.
    pub(super) fn output(&self) -> &str {
        self.runs.iter().map(|ran| ran.output.as_str()).find(|text| !text.is_empty()).unwrap_or_default()
    }

    fn error(&self) -> Option<&str> {
        self.runs.iter().find_map(|ran| ran.error.as_deref())
    }

    /// What a teacher has to know beside the figures.
    pub(super) fn remarks(&self) -> String {
        let beyond: Vec<&str> = self.names(|ran| &ran.beyond).into_iter().collect();
        let written: Vec<&str> = self.names(|ran| &ran.written).into_iter().collect();
        let mut remarks = Vec::new();
        if !beyond.is_empty() {
            remarks.push(format!("calls {}, which no robot has", beyond.join(", ")));
        }
        if !written.is_empty() {
            remarks.push(format!("wrote {}", written.join(", ")));
        }
        remarks.extend(self.error().map(str::to_owned));
        remarks.join("; ")
    }

    /// How its runs ended, apart from those that reached.
    pub(super) fn others(&self) -> String {
        let others = self.outcomes().into_iter().filter(|(word, _)| *word != "reached");
        others.map(|(word, count)| format!("{count} {word}")).collect::<Vec<_>>().join(", ")
    }

    pub(super) fn value(&self, places: &[Place]) -> Value {
        json!({
            "program": self.name,
            "reached": self.reached(),
            "runs": self.runs.len(),
            "collisions": self.contacts(),
            "time_s": self.time().map(rounded),
            "path_ratio": self.ratio(places).map(rounded),
            "outcomes": self.outcomes(),
            "beyond_robots": self.names(|ran| &ran.beyond),
            "written": self.names(|ran| &ran.written),
            "output": self.output(),
            "error": self.error(),
        })
    }

    /// Its line of the text table.
    pub(super) fn line(&self, places: &[Place]) -> String {
        let number =
            |value: Option<f64>, digits: usize| value.map_or("-".into(), |value| format!("{value:.digits$}"));
        let remarks = [self.others(), self.remarks()].into_iter().filter(|text| !text.is_empty());
        let line = format!(
            "{:<NAME$}  {:>7}  {:>8}  {:>6}  {:>5}  {:<OUTPUT$}  {}",
            shortened(&self.name, NAME),
            format!("{}/{}", self.reached(), self.runs.len()),
            self.contacts(),
            number(self.time(), 1),
            number(self.ratio(places), 2),
            shortened(self.output(), OUTPUT),
            remarks.collect::<Vec<_>>().join("; ")
        );
        line.trim_end().to_owned()
    }
}

/// Heading of the text table.
pub(super) fn heading() -> String {
    let (name, output) = ("program", "output");
    format!("{name:<NAME$}  reached  contacts  time s   path  {output:<OUTPUT$}  remarks")
}

/// The end of a text that is too long: names of files differ there.
fn shortened(text: &str, most: usize) -> String {
    let count = text.chars().count();
    if count <= most {
        return text.to_owned();
    }
    format!("…{}", text.chars().skip(count - most + 1).collect::<String>())
}

fn median(mut numbers: Vec<f64>) -> Option<f64> {
    numbers.sort_by(f64::total_cmp);
    let count = numbers.len();
    (count > 0).then(|| 0.5 * (numbers[(count - 1) / 2] + numbers[count / 2]))
}
