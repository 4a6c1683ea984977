use roverlab::geometry::{Point, Pose, Pose3, normalize_angle, units};
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

    /// The behaviour failed, such as `timed_out`.
    pub(crate) fn failure(word: impl Into<String>) -> Self {
        Self { word: word.into(), failed: true }
    }

    /// Whether the behaviour failed.
    pub(crate) fn is_failure(&self) -> bool {
        self.failed
    }
}

/// A command's report on its run, as JSON or text.
///
/// Values known only to a simulator are `None` for other robots, and become `null`.
#[derive(Debug, Clone)]
pub(crate) struct Report {
    /// How the run ended, apart from contacts.
    pub(crate) outcome: Outcome,
    /// Simulated time (s).
    pub(crate) sim_time: Option<f64>,
    /// Number of contacts with walls, objects and robots. Any contact makes the outcome `collided`.
    pub(crate) collisions: Option<u64>,
    /// Length of the true path (m).
    pub(crate) path_length: Option<f64>,
    /// True pose of the robot.
    pub(crate) pose: Option<Pose>,
    /// The same in space, in a world with hills or water.
    pub(crate) in_space: Option<Pose3>,
    /// Pose by odometry.
    pub(crate) odometry: Option<Pose>,
    /// Error of the robot, if it ended the run.
    pub(crate) error: Option<String>,
    /// Problem after the run, such as a picture that could not be saved. The run did not fail, but the
    /// program does.
    pub(crate) trouble: Option<String>,
    /// Whether the runs have several noise levels, given in the fields; that of the options does not apply.
    pub(crate) mixed_noise: bool,
    /// Text that replaces the summary, if any.
    pub(crate) words: Option<String>,
    /// The command's own fields; see [`Report::field`].
    pub(crate) fields: Vec<(String, Value)>,
    /// Fields for programs only; see [`Report::table`].
    pub(crate) tables: Vec<&'static str>,
    /// Values that differ from run to run: wall-clock times and rates. See [`Report::timing`].
    pub(crate) timing: Vec<(&'static str, f64)>,
}

/// Facts about the program and its options in a report.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Header {
    pub(crate) command: &'static str,
    pub(crate) seed: u64,
    /// Noise level; `None` where nothing is measured.
    pub(crate) noise: Option<f64>,
    /// Whether to print values that differ from run to run.
    pub(crate) timing: bool,
}

/// Fields common to all commands; `error` only after one, `timing` only on request.
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
    /// A report with only an outcome.
    pub(crate) fn new(outcome: Outcome) -> Self {
        Self {
            outcome,
            sim_time: None,
            collisions: None,
            path_length: None,
            pose: None,
            in_space: None,
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
    /// If the name is taken, or the value has no JSON form: both are bugs in the command.
    #[must_use]
    pub(crate) fn field(mut self, name: &str, value: impl Serialize) -> Self {
        let taken = COMMON.contains(&name) || self.fields.iter().any(|(other, _)| other == name);
        assert!(!taken, "the report has a field `{name}` already");
        let value = serde_json::to_value(value).expect("a value that JSON can hold");
        self.fields.push((name.to_owned(), value));
        self
    }

    /// Adds a field that the text already shows as a table.
    #[must_use]
    pub(crate) fn table(mut self, name: &'static str, rows: impl Serialize) -> Self {
        self.tables.push(name);
        self.field(name, rows)
    }

    /// Adds a wall-clock time or a rate, rounded to a millionth; its name ends in its unit. Values that are
    /// not finite become `null`.
    #[must_use]
    pub(crate) fn timing(mut self, name: &'static str, value: f64) -> Self {
        self.timing.push((name, rounded(value)));
        self
    }

    /// Adds further problems after the run.
    pub(crate) fn add_trouble(&mut self, more: Vec<String>) {
        let all: Vec<String> = self.trouble.take().into_iter().chain(more).collect();
        self.trouble = (!all.is_empty()).then(|| all.join("\n"));
    }

    /// Word for the outcome, including contacts.
    pub(crate) fn word(&self) -> &str {
        if self.collided() { "collided" } else { &self.outcome.word }
    }

    /// 0 if the behaviour came to a verdict without contacts and without later problems, otherwise 1.
    pub(crate) fn status(&self) -> u8 {
        u8::from(self.collided() || self.outcome.failed || self.trouble.is_some())
    }

    /// Text for standard error: the robot's error and later problems.
    pub(crate) fn message(&self) -> Option<String> {
        let lines: Vec<&str> = self.error.iter().chain(&self.trouble).map(String::as_str).collect();
        (!lines.is_empty()).then(|| lines.join("\n"))
    }

    /// The report for printing.
    pub(crate) fn printed(&self, header: Header, json: bool) -> Printed {
        let text = if json { self.json(header) } else { self.summary(header) };
        Printed { text, message: self.message(), status: self.status() }
    }

    fn collided(&self) -> bool {
        self.collisions.is_some_and(|contacts| contacts > 0)
    }

    /// The JSON object on one line.
    pub(crate) fn json(&self, header: Header) -> String {
        serde_json::to_string(&Object { report: self, header }).expect("names and values that JSON can hold")
    }

    /// The report as short text.
    pub(crate) fn summary(&self, header: Header) -> String {
        if let Some(words) = &self.words {
            return words.clone();
        }
        let mut lines = vec![format!("{}: {}", header.command.replace('_', "-"), self.word())];
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

/// A report as a JSON object.
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
        let pose =
            report.pose.map(|pose| JsonPose { in_space: report.in_space.map(Stance::from), ..pose.into() });
        object.serialize_entry("pose", &pose)?;
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

/// Times and rates in the order of their addition.
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
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    in_space: Option<Stance>,
}

/// Height and tilt of a pose in space, rotated about the forward, left and up axes in this order.
#[derive(serde::Serialize)]
struct Stance {
    z_mm: f64,
    roll_deg: f64,
    pitch_deg: f64,
}

impl From<Pose3> for Stance {
    fn from(pose: Pose3) -> Self {
        let [roll, pitch, _] = pose.roll_pitch_yaw();
        Self {
            z_mm: rounded(units::to_mm(pose.position.z)),
            roll_deg: rounded(units::to_deg(roll)),
            pitch_deg: rounded(units::to_deg(pitch)),
        }
    }
}

impl From<Pose> for JsonPose {
    fn from(pose: Pose) -> Self {
        Self {
            x_mm: rounded(units::to_mm(pose.x)),
            y_mm: rounded(units::to_mm(pose.y)),
            heading_deg: rounded(units::to_deg(normalize_angle(pose.heading))),
            in_space: None,
        }
    }
}

/// A length in the fields of commands: millimetres, rounded to a thousandth.
pub(crate) fn millimetres(metres: f64) -> f64 {
    rounded(units::to_mm(1000.0 * metres).round() / 1000.0)
}

/// Both coordinates of a point in millimetres.
pub(crate) fn point_in_mm(point: Point) -> [f64; 2] {
    [point.x, point.y].map(millimetres)
}

/// Without spurious digits from unit conversion, and without negative zero: a millionth is finer than any
/// sensor.
pub(crate) fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6 + 0.0
}

fn in_words(pose: Pose) -> String {
    let JsonPose { x_mm, y_mm, heading_deg, .. } = pose.into();
    let (x, y, heading) = (x_mm.round() + 0.0, y_mm.round() + 0.0, (10.0 * heading_deg).round() / 10.0 + 0.0);
    format!("{x}, {y} mm, {heading:.1} deg")
}

/// Number of items shown of a longer list.
const ITEMS: usize = 8;

/// A value on one line: a point as its coordinates, a list as its items, an object as its fields.
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
