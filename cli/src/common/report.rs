use roverlab::geometry::{Point, Pose, normalize_angle, units};
use serde::ser::{Serialize, SerializeMap, Serializer};
use serde_json::Value;

use super::Printed;

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Outcome {
    word: String,
    failed: bool,
}

impl Outcome {
    /// The behaviour came to a verdict, such as `reached` or `unreachable`.
    pub(crate) fn verdict(word: impl Into<String>) -> Self {
        Self { word: word.into(), failed: false }
    }

    /// The behaviour did not do its job: `timed_out`, say.
    pub(crate) fn failure(word: impl Into<String>) -> Self {
        Self { word: word.into(), failed: true }
    }

    /// Whether the behaviour did not do its job.
    pub(crate) fn is_failure(&self) -> bool {
        self.failed
    }
}

/// What a command says about its run: in JSON, or in words.
///
/// What only a simulator knows stays `None` for other robots, and so becomes `null`.
#[derive(Debug, Clone)]
pub(crate) struct Report {
    /// How the run ended, contacts aside.
    pub(crate) outcome: Outcome,
    /// Simulated seconds.
    pub(crate) sim_time: Option<f64>,
    /// Contacts with walls, objects and robots. Any contact makes the outcome `collided`.
    pub(crate) collisions: Option<u64>,
    /// The length of the true path in metres.
    pub(crate) path_length: Option<f64>,
    /// Where the robot really is.
    pub(crate) pose: Option<Pose>,
    /// Where the robot believes to be.
    pub(crate) odometry: Option<Pose>,
    /// What the robot failed with, if that ended the run.
    pub(crate) error: Option<String>,
    /// What went wrong after the run, such as a picture that could not be saved. The run did not fail by it, but the
    /// program did.
    pub(crate) trouble: Option<String>,
    /// Whether the runs have several levels of noise, which the fields tell; that of the options is none of
    /// them.
    pub(crate) mixed_noise: bool,
    /// What people read instead of a summary, if there is such.
    pub(crate) words: Option<String>,
    /// The command's own fields; see [`Report::field`].
    pub(crate) fields: Vec<(String, Value)>,
    /// Those among them that are for programs alone; see [`Report::table`].
    pub(crate) tables: Vec<&'static str>,
    /// What differs from run to run: times on the wall clock, and rates. See [`Report::timing`].
    pub(crate) timing: Vec<(&'static str, f64)>,
}

/// What a report says about the program and its options.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Header {
    pub(crate) command: &'static str,
    pub(crate) seed: u64,
    /// `None` where nothing measures.
    pub(crate) noise: Option<f64>,
    /// Whether to tell what differs from run to run.
    pub(crate) timing: bool,
}

/// The fields that every command has; `error` only after one, `timing` only when asked for.
const COMMON: [&str; 11] = [
    "example",
    "outcome",
    "seed",
    "noise",
    "sim_time_s",
    "timing",
    "collisions",
    "path_length_mm",
    "pose",
    "odometry",
    "error",
];

impl Report {
    /// A report that knows the outcome only.
    pub(crate) fn new(outcome: Outcome) -> Self {
        Self {
            outcome,
            sim_time: None,
            collisions: None,
            path_length: None,
            pose: None,
            odometry: None,
            error: None,
            trouble: None,
            mixed_noise: false,
            words: None,
            fields: Vec::new(),
            tables: Vec::new(),
            timing: Vec::new(),
        }
    }

    /// Adds a field of the command's own. Numbers that are not finite become `null`.
    ///
    /// # Panics
    ///
    /// If the name is taken, or the value has no form in JSON: both are mistakes in the command.
    #[must_use]
    pub(crate) fn field(mut self, name: &str, value: impl Serialize) -> Self {
        let taken = COMMON.contains(&name) || self.fields.iter().any(|(other, _)| other == name);
        assert!(!taken, "the report has a field `{name}` already");
        let value = serde_json::to_value(value).expect("a value that JSON can hold");
        self.fields.push((name.to_owned(), value));
        self
    }

    /// Adds a field that people have read as a table already.
    #[must_use]
    pub(crate) fn table(mut self, name: &'static str, rows: impl Serialize) -> Self {
        self.tables.push(name);
        self.field(name, rows)
    }

    /// Adds a time on the wall clock or a rate, rounded to a millionth; its name ends in its unit. One that
    /// is not finite becomes `null`.
    #[must_use]
    pub(crate) fn timing(mut self, name: &'static str, value: f64) -> Self {
        self.timing.push((name, rounded(value)));
        self
    }

    /// Adds what else went wrong after the run.
    pub(crate) fn add_trouble(&mut self, more: Vec<String>) {
        let all: Vec<String> = self.trouble.take().into_iter().chain(more).collect();
        self.trouble = (!all.is_empty()).then(|| all.join("\n"));
    }

    /// The word for how the run ended, contacts included.
    pub(crate) fn word(&self) -> &str {
        if self.collided() { "collided" } else { &self.outcome.word }
    }

    /// 0 if the behaviour came to a verdict without touching anything and nothing went wrong afterwards, else 1.
    pub(crate) fn status(&self) -> u8 {
        u8::from(self.collided() || self.outcome.failed || self.trouble.is_some())
    }

    /// What belongs on standard error: why the robot failed, and what went wrong afterwards.
    pub(crate) fn message(&self) -> Option<String> {
        let lines: Vec<&str> = self.error.iter().chain(&self.trouble).map(String::as_str).collect();
        (!lines.is_empty()).then(|| lines.join("\n"))
    }

    /// The report as it is printed.
    pub(crate) fn printed(&self, header: Header, json: bool) -> Printed {
        let text = if json { self.json(header) } else { self.summary(header) };
        Printed { text, message: self.message(), status: self.status() }
    }

    fn collided(&self) -> bool {
        self.collisions.is_some_and(|contacts| contacts > 0)
    }

    /// The JSON object, in one line.
    pub(crate) fn json(&self, header: Header) -> String {
        serde_json::to_string(&Object { report: self, header }).expect("names and values that JSON can hold")
    }

    /// The same for people, in a few lines.
    pub(crate) fn summary(&self, header: Header) -> String {
        if let Some(words) = &self.words {
            return words.clone();
        }
        let mut lines = vec![format!("{}: {}", header.command, self.word())];
        let mut add = |name: &str, value: String| lines.push(format!("  {name:<18} {value}"));
        if let Some(time) = self.sim_time {
            add("simulated time", format!("{time:.2} s"));
        }
        if let Some(length) = self.path_length {
            add("path length", format!("{:.0} mm", units::to_mm(length)));
        }
        if let Some(contacts) = self.collisions {
            add("collisions", contacts.to_string());
        }
        for (name, pose) in [("pose", self.pose), ("odometry", self.odometry)] {
            if let Some(pose) = pose {
                add(name, in_words(pose));
            }
        }
        let read = |name: &String| self.tables.contains(&name.as_str());
        for (name, value) in self.fields.iter().filter(|(name, _)| !read(name)) {
            add(&name.replace('_', " "), short(value));
        }
        for (name, value) in self.timing.iter().filter(|_| header.timing) {
            add(&name.replace('_', " "), value.to_string());
        }
        add("seed", header.seed.to_string());
        if let Some(noise) = header.noise {
            add("noise", noise.to_string());
        }
        lines.join("\n")
    }
}

/// A report as one JSON object.
struct Object<'a> {
    report: &'a Report,
    header: Header,
}

impl Serialize for Object<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (report, header) = (self.report, self.header);
        let mut object = serializer.serialize_map(None)?;
        object.serialize_entry("example", header.command)?;
        object.serialize_entry("outcome", report.word())?;
        object.serialize_entry("seed", &header.seed)?;
        object.serialize_entry("noise", &header.noise)?;
        object.serialize_entry("sim_time_s", &report.sim_time.map(rounded))?;
        object.serialize_entry("collisions", &report.collisions)?;
        object.serialize_entry("path_length_mm", &report.path_length.map(|m| rounded(units::to_mm(m))))?;
        object.serialize_entry("pose", &report.pose.map(JsonPose::from))?;
        object.serialize_entry("odometry", &report.odometry.map(JsonPose::from))?;
        if let Some(error) = &report.error {
            object.serialize_entry("error", error)?;
        }
        for (name, value) in &report.fields {
            object.serialize_entry(name, value)?;
        }
        if header.timing {
            object.serialize_entry("timing", &Timing(&report.timing))?;
        }
        object.end()
    }
}

/// Times and rates in the order in which they were told.
struct Timing<'a>(&'a [(&'static str, f64)]);

impl Serialize for Timing<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

/// A pose in JSON: millimetres, and degrees from -180 to 180.
#[derive(serde::Serialize)]
struct JsonPose {
    x_mm: f64,
    y_mm: f64,
    heading_deg: f64,
}

impl From<Pose> for JsonPose {
    fn from(pose: Pose) -> Self {
        Self {
            x_mm: rounded(units::to_mm(pose.x)),
            y_mm: rounded(units::to_mm(pose.y)),
            heading_deg: rounded(units::to_deg(normalize_angle(pose.heading))),
        }
    }
}

/// A length as the fields of commands show it: millimetres, to a thousandth.
pub(crate) fn millimetres(metres: f64) -> f64 {
    rounded(units::to_mm(1000.0 * metres).round() / 1000.0)
}

/// The same for both coordinates of a point.
pub(crate) fn point_in_mm(point: Point) -> [f64; 2] {
    [point.x, point.y].map(millimetres)
}

/// Without the tail of digits that a change of unit leaves, and without the sign of zero: a millionth is finer than
/// any sensor.
pub(crate) fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6 + 0.0
}

fn in_words(pose: Pose) -> String {
    let JsonPose { x_mm, y_mm, heading_deg } = pose.into();
    let (x, y, heading) = (x_mm.round() + 0.0, y_mm.round() + 0.0, (10.0 * heading_deg).round() / 10.0 + 0.0);
    format!("{x}, {y} mm, {heading:.1} deg")
}

/// Items of a list that are shown, of a longer one.
const ITEMS: usize = 8;

/// A value in a line: a point as its coordinates, a list as its items, an object as its fields.
fn short(value: &Value) -> String {
    match value {
        Value::Null => "none".into(),
        Value::String(text) => text.clone(),
        Value::Array(items) => match items.as_slice() {
            [] => "none".into(),
            [Value::Number(x), Value::Number(y)] => format!("{x}, {y}"),
            items => {
                let shown: Vec<String> = items.iter().take(ITEMS).map(short).collect();
                let more = items.len().saturating_sub(ITEMS);
                let more = if more > 0 { format!("; and {more} more") } else { String::new() };
                shown.join("; ") + &more
            }
        },
        Value::Object(fields) => {
            let field =
                |(name, value): (&String, &Value)| format!("{} {}", name.replace('_', " "), short(value));
            fields.iter().map(field).collect::<Vec<_>>().join(", ")
        }
        other => other.to_string(),
    }
}
