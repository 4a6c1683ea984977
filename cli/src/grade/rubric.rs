use std::io;
use std::path::{Path, PathBuf};

use roverlab::files::open_regular;
use serde::Deserialize;

use crate::common::{Failure, toml_places};

/// What programs have to do, and under which conditions.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Rubric {
    /// The task in a few words.
    pub(super) title: String,
    /// Built-in robot, or a description beside the rubric.
    #[serde(default = "s4")]
    pub(super) robot: String,
    /// Number of runs in each world, with the seeds from that of the options on.
    pub(super) seeds: u64,
    /// Noise level.
    #[serde(default = "real")]
    pub(super) noise: f64,
    /// Limits of simulated and real time (s).
    pub(super) time_limit: f64,
    #[serde(default = "five")]
    pub(super) real_limit: f64,
    /// The worlds.
    #[serde(rename = "world")]
    pub(super) worlds: Vec<Task>,
}

/// What a program has to do in a world. Places are given by x, y and radius in millimetres.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Task {
    /// File of the world, beside the rubric.
    pub(super) file: PathBuf,
    /// Start: x and y in millimetres, heading in degrees.
    pub(super) start: [f64; 3],
    /// Places to come to, in this order.
    #[serde(default)]
    pub(super) visit: Vec<[f64; 3]>,
    /// Place where the robot has to stand at the end.
    pub(super) end: Option<[f64; 3]>,
    /// Percentage of the floor that the robot has to pass over.
    pub(super) cover: Option<f64>,
}

fn s4() -> String {
    "S4".into()
}

fn real() -> f64 {
    1.0
}

fn five() -> f64 {
    5.0
}

impl Rubric {
    /// Reads a rubric. Fails with the line and column of what is wrong.
    pub(super) fn read(file: &Path) -> Result<Self, Failure> {
        let name = file.display();
        let text = open_regular(file)
            .and_then(io::read_to_string)
            .map_err(|error| Failure::input(format!("{name}: {error}; expected a rubric")))?;
        let mut rubric: Self = toml::from_str(&text).map_err(|error| {
            let place = toml_places::of_byte(&text, error.span().map_or(0, |span| span.start));
            Failure::input(format!("{name}:{place}: {}", error.message().replace('\n', ", ")))
        })?;
        rubric.check().map_err(|Wrong { path, message }| {
            let place = toml_places::of_value(&text, &path);
            Failure::input(format!("{name}:{place}: {message}"))
        })?;
        let folder = file.parent().unwrap_or(Path::new("."));
        for task in &mut rubric.worlds {
            task.file = folder.join(&task.file);
        }
        if Path::new(&rubric.robot).extension().is_some() {
            rubric.robot = folder.join(&rubric.robot).display().to_string();
        }
        Ok(rubric)
    }

    fn check(&self) -> Result<(), Wrong> {
        let numbers = [
            ("seeds", self.seeds as f64, 1.0, 1000.0),
            ("noise", self.noise, 0.0, 5.0),
            ("time_limit", self.time_limit, 0.1, 1e5),
            ("real_limit", self.real_limit, 0.1, 3600.0),
        ];
        numbers.into_iter().try_for_each(|(name, value, least, most)| check(name, value, least, most))?;
        if self.worlds.is_empty() {
            let message = "found no world; expected at least one table [[world]]";
            return Err(Wrong { path: vec!["world".into()], message: message.into() });
        }
        self.worlds.iter().enumerate().try_for_each(|(index, task)| {
            task.check().map_err(|wrong| {
                let path = ["world".into(), index.to_string()].into_iter().chain(wrong.path).collect();
                Wrong { path, ..wrong }
            })
        })
    }
}

impl Task {
    fn check(&self) -> Result<(), Wrong> {
        let visits = self.visit.iter().map(|place| ("visit", place));
        let end = self.end.iter().map(|place| ("end", place));
        for (key, place) in visits.chain(end).chain([("start", &self.start)]) {
            let at = |wrong| Wrong { path: vec![key.into()], ..wrong };
            if key != "start" {
                check("radius of a place", place[2], 1.0, 1e6).map_err(at)?;
            }
            for number in place {
                check("coordinate", *number, -1e6, 1e6).map_err(at)?;
            }
        }
        check("cover", self.cover.unwrap_or(0.0), 0.0, 100.0)?;
        if self.visit.is_empty() && self.end.is_none() && self.cover.is_none() {
            let message = "a world has no visit, end or cover; expected at least one of them";
            return Err(Wrong { path: Vec::new(), message: message.into() });
        }
        Ok(())
    }
}

/// What is wrong with a rubric, and the path to it.
#[derive(Debug)]
struct Wrong {
    path: Vec<String>,
    message: String,
}

fn check(key: &str, value: f64, least: f64, most: f64) -> Result<(), Wrong> {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    let message = format!("{key}: found {value}; expected {least} to {most}");
    Err(Wrong { path: vec![key.into()], message })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// Every rubric of the project reads, and its worlds exist.
    #[test]
    fn the_rubrics_are_read() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("rubrics");
        let mut count = 0;
        for entry in fs::read_dir(folder).unwrap() {
            let file = entry.unwrap().path();
            if file.extension().is_some_and(|kind| kind == "toml") {
                let rubric = Rubric::read(&file).unwrap();
                assert!(rubric.worlds.iter().all(|task| task.file.is_file()), "{}", file.display());
                count += 1;
            }
        }
        assert!(count >= 10, "{count}");
    }

    #[test]
    fn errors_say_where_and_what() {
        let folder = std::env::temp_dir().join(format!("roverlab-rubrics-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let file = folder.join("wrong.toml");
        let whole = "title = 'x'\nseeds = 3\ntime_limit = 9\n[[world]]\nfile = 'a.wld'\nstart = [0, 0, 0]\n";
        for (text, expected) in [
            (format!("{whole}frob = 1\n"), "wrong.toml:7:1: unknown field `frob`"),
            (whole.to_owned(), "wrong.toml:4:1: a world has no visit, end or cover"),
            (format!("{whole}end = [1, 1, 0]\n"), "wrong.toml:7:7: radius of a place: found 0"),
            (whole.replace("seeds = 3", "seeds = 0"), "wrong.toml:2:9: seeds: found 0; expected 1 to 1000"),
            ("title = 'x'".into(), "missing field"),
        ] {
            fs::write(&file, text).unwrap();
            let error = Rubric::read(&file).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
        fs::remove_dir_all(&folder).unwrap();
    }
}
