use std::collections::BTreeMap;

use roverlab::geometry::{Point, Pose};
use roverlab::io::Key;
use serde_json::Value;

/// A run requested by a page.
#[derive(Debug, Clone, Default)]
pub struct Job {
    /// Command line without the program's name.
    pub words: Vec<String>,
    /// Files opened in the page, by name.
    pub files: BTreeMap<String, Vec<u8>>,
    /// User actions during the run, ordered by time.
    pub wishes: Vec<Wish>,
    /// Drawn walls, given by their ends; robots are not informed of them.
    pub walls: Vec<[Point; 2]>,
    /// Time before which nothing is shown, as the page has it already (s).
    pub from: f64,
}

/// A user action.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wish {
    /// Time (s).
    pub time: f64,
    /// Kind of the action.
    pub thing: Thing,
}

/// Kind of a user action. Robots and objects are given by their indices in the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Thing {
    /// Moves a robot to a pose.
    Robot(usize, Pose),
    /// Moves an object to a pose.
    Object(usize, Pose),
    /// Presses a soft key of a robot.
    Key(usize, Key),
}

impl Job {
    /// Parses `{words, wishes: [{time, robot | object | key, pose | of}], walls: [[x, y, x, y]], from}` in
    /// metres, radians and seconds; keys count from 1. Missing parts are empty, or 0.
    pub fn parse(text: &str, files: BTreeMap<String, Vec<u8>>) -> Result<Self, String> {
        let job: Value = serde_json::from_str(text).map_err(|error| format!("the page's wish: {error}"))?;
        let words = list(&job, "words").iter().map(|word| word.as_str().map(String::from));
        let words = words.collect::<Option<_>>().ok_or("words: found no text; expected texts")?;
        let wishes = list(&job, "wishes").iter().map(wish).collect::<Result<_, _>>()?;
        let walls = list(&job, "walls").iter().map(|wall| {
            let ends = numbers::<4>(wall).ok_or("walls: expected [x, y, x, y] of each")?;
            Ok([Point::new(ends[0], ends[1]), Point::new(ends[2], ends[3])])
        });
        let walls = walls.collect::<Result<_, String>>()?;
        Ok(Self { words, files, wishes, walls, from: job["from"].as_f64().unwrap_or(0.0) })
    }
}

/// A file of the page. Files are opened without their folders, so the last part of a name must suffice.
pub(crate) fn file_of<'a>(files: &'a BTreeMap<String, Vec<u8>>, name: &str) -> Option<&'a Vec<u8>> {
    let last = |name: &str| name.rsplit(['/', '\\']).next().unwrap_or_default().to_lowercase();
    let found = files.get(name);
    found.or_else(|| files.iter().find(|(other, _)| last(other) == last(name)).map(|(_, file)| file))
}

fn list<'a>(job: &'a Value, name: &str) -> &'a [Value] {
    job[name].as_array().map_or(&[], Vec::as_slice)
}

fn numbers<const N: usize>(value: &Value) -> Option<[f64; N]> {
    let numbers: Vec<f64> = value.as_array()?.iter().map(Value::as_f64).collect::<Option<_>>()?;
    numbers.try_into().ok()
}

fn wish(wish: &Value) -> Result<Wish, String> {
    let refused = || {
        format!("wishes: found {wish}; expected a time with a robot or an object and its pose, or with a key")
    };
    let time = wish["time"].as_f64().ok_or_else(refused)?;
    let index = |name: &str| wish[name].as_u64().and_then(|index| usize::try_from(index).ok());
    let pose = numbers::<3>(&wish["pose"]).map(|[x, y, heading]| Pose::new(x, y, heading));
    let key = index("key").and_then(|key| Key::ALL.get(key.checked_sub(1)?).copied());
    let thing = match (index("robot"), index("object"), key, pose) {
        (Some(robot), None, None, Some(pose)) => Thing::Robot(robot, pose),
        (None, Some(object), None, Some(pose)) => Thing::Object(object, pose),
        (None, None, Some(key), None) => Thing::Key(index("of").unwrap_or(0), key),
        _ => return Err(refused()),
    };
    Ok(Wish { time, thing })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_is_read() {
        let text = r#"{"words": ["distbug"], "walls": [[0, 0, 1, 0.5]], "from": 2.5, "wishes": [
            {"time": 1, "robot": 0, "pose": [1, 2, 3]}, {"time": 2, "key": 4}, {"time": 3, "object": 5, "pose": [0, 0, 0]}]}"#;
        let job = Job::parse(text, BTreeMap::new()).unwrap();
        assert_eq!((job.words, job.from), (vec!["distbug".to_owned()], 2.5));
        assert_eq!(job.walls, [[Point::new(0.0, 0.0), Point::new(1.0, 0.5)]]);
        let things = [
            Thing::Robot(0, Pose::new(1.0, 2.0, 3.0)),
            Thing::Key(0, Key::Key4),
            Thing::Object(5, Pose::default()),
        ];
        assert_eq!(job.wishes.iter().map(|wish| wish.thing).collect::<Vec<_>>(), things);
    }

    #[test]
    fn what_makes_no_sense_is_refused_with_what_was_expected() {
        for text in [
            "",
            r#"{"words": [7]}"#,
            r#"{"walls": [[1, 2, 3]]}"#,
            r#"{"wishes": [{"time": 1, "key": 5}]}"#,
            r#"{"wishes": [{"time": 1, "key": 0}]}"#,
            r#"{"wishes": [{"robot": 0, "pose": [0, 0, 0]}]}"#,
            r#"{"wishes": [{"time": 1, "robot": 0}]}"#,
        ] {
            let error = Job::parse(text, BTreeMap::new()).unwrap_err();
            assert!(error.contains("expected") || error.contains("wish:"), "{text}: {error}");
        }
    }
}
