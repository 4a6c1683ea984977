use std::fmt;
use std::str::FromStr;

use crate::geometry::{Pose, units};
use crate::io::{Error, ErrorKind, Psd, Result};

/// Device affected by a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Sensor {
    /// One distance sensor.
    Psd(Psd),
    /// The laser scanner.
    Lidar,
    /// The camera.
    Camera,
    /// Pose and velocity by odometry.
    Odometry,
    /// The inertial unit.
    Inertial,
    /// The depth sensor of a craft.
    Depth,
    /// All sensors.
    All,
}

impl Sensor {
    /// Whether a fault of this sensor affects `other`.
    pub(super) fn covers(self, other: Sensor) -> bool {
        self == Sensor::All || self == other
    }
}

/// Kind of a fault.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum FaultKind {
    /// The sensor repeats its last reading, or its next one if it had none.
    Stuck(Sensor),
    /// The sensor fails with the kind [`Disconnected`](ErrorKind::Disconnected).
    Lost(Sensor),
    /// The sensor reads NaN; a camera's image is black.
    Nan(Sensor),
    /// Odometry jumps: from its first reading on it is offset as if the robot had been shifted by this pose,
    /// given in the robot's frame, without moving. Setting the pose corrects it.
    Jump(Pose),
    /// Readings are delayed by this many seconds. Readings exist at the times when the program asked for
    /// them; until the first one is old enough, it is repeated.
    Late(Sensor, f64),
    /// The link to the robot is lost: every call fails with [`Disconnected`](ErrorKind::Disconnected). A wait
    /// still takes its time before it fails, so that a program that retries sees the link return.
    Link,
    /// The next call of any kind takes this much longer (s).
    Hang(f64),
    /// The clock stops at the start of the fault, while time continues.
    ClockStop,
    /// The clock jumps by this many seconds, backwards if negative.
    ClockJump(f64),
}

/// A fault at a set time.
///
/// As text, a fault is `KIND@T`, `KIND:DEVICE@T`, `KIND@T-T2` or `KIND:DEVICE@T-T2` with times in seconds.
/// The kinds are `stuck`, `lost`, `nan`, `jump`, `late`, `link`, `hang` and `clock`. The first three and
/// `late` take a device: `front`, `left`, `right`, `back`, `psdN`, `lidar`, `camera`, `odometry`, `inertial`,
/// `depth` or, by default, `all`. An amount may follow kind or device after an equals sign:
///
/// | text | means |
/// |---|---|
/// | `late@5`, `late:lidar=0.2@5` | readings are 0.5 s or 0.2 s old |
/// | `hang@5`, `hang=3@5`, `hang@5-8` | the first call at 5 s or later takes 1 s or 3 s more, 3600 s at most |
/// | `clock@5`, `clock=-2@5` | the clock stands still, or jumps back by 2 s |
/// | `jump@5`, `jump=200,0,90@5` | odometry jumps by 100 mm forward, 100 mm left and 15 degrees, or as given |
///
/// ```
/// use roverlab::io::wrappers::{Fault, FaultKind, Sensor};
/// use roverlab::io::Psd;
/// let fault: Fault = "stuck:front@2.5-4".parse()?;
/// assert_eq!(fault, Fault { at: 2.5, until: Some(4.0), kind: FaultKind::Stuck(Sensor::Psd(Psd::FRONT)) });
/// assert_eq!(fault.to_string(), "stuck:front@2.5-4");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fault {
    /// Start by the robot's clock (s).
    pub at: f64,
    /// End (s); `None` if it lasts.
    pub until: Option<f64>,
    /// Kind of the fault.
    pub kind: FaultKind,
}

impl Fault {
    /// A fault that starts at a time and lasts.
    pub const fn new(at: f64, kind: FaultKind) -> Self {
        Self { at, until: None, kind }
    }

    /// The same fault with an end.
    #[must_use]
    pub const fn until(self, end: f64) -> Self {
        Self { until: Some(end), ..self }
    }

    /// Whether the fault is active at a time.
    pub fn is_active(&self, time: f64) -> bool {
        self.at <= time && self.until.is_none_or(|end| time < end)
    }
}

/// Kinds of faults, for error messages.
const KINDS: &str = "stuck, lost, nan, jump, late, link, hang or clock";
/// Devices, for error messages.
const DEVICES: &str = "front, left, right, back, psdN, lidar, camera, odometry, inertial, depth or all";
/// Default age of late readings (s).
const LATE: f64 = 0.5;
/// Default duration of a hanging call (s).
const HANG: f64 = 1.0;
/// Longest duration of a hanging call (s); a simulated world continues meanwhile.
const LONGEST: f64 = 3600.0;
/// Default jump of odometry (mm, mm, degrees).
const JUMP: [f64; 3] = [100.0, 100.0, 15.0];

impl FromStr for Fault {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        parse(text).map_err(|problem| {
            Error::new(ErrorKind::InvalidInput, format!("fault \"{}\": {problem}", text.escape_debug()))
        })
    }
}

/// Parses a fault; fails with a message about the wrong part.
fn parse(text: &str) -> std::result::Result<Fault, String> {
    let (what, when) = text.split_once('@').ok_or("no time; expected KIND@T, such as stuck:front@2.5")?;
    let (at, until) = parse_times(when)?;
    let (what, amount) = match what.split_once('=') {
        Some((what, amount)) => (what, Some(amount)),
        None => (what, None),
    };
    let (kind, device) = match what.split_once(':') {
        Some((kind, device)) => (kind, Some(device)),
        None => (what, None),
    };
    let is_about_a_sensor = matches!(kind, "stuck" | "lost" | "nan" | "late");
    if let (Some(device), false) = (device, is_about_a_sensor) {
        return Err(match kind {
            "jump" | "link" | "hang" | "clock" => format!("{kind} takes no device, found {device:?}"),
            _ => unknown_kind(kind),
        });
    }
    if let (Some(amount), "stuck" | "lost" | "nan" | "link") = (amount, kind) {
        return Err(format!("{kind} takes no amount, found {amount:?}"));
    }
    let sensor = device.map_or(Ok(Sensor::All), parse_sensor)?;
    let seconds = amount.map(|amount| number("amount", amount));
    let kind = match kind {
        "stuck" => FaultKind::Stuck(sensor),
        "lost" => FaultKind::Lost(sensor),
        "nan" => FaultKind::Nan(sensor),
        "jump" => FaultKind::Jump(parse_jump(amount)?),
        "late" => FaultKind::Late(sensor, not_negative("delay", seconds.unwrap_or(Ok(LATE))?)?),
        "link" => FaultKind::Link,
        "hang" => {
            let default = until.map_or(HANG, |end| end - at);
            let seconds = not_negative("duration", seconds.unwrap_or(Ok(default))?)?;
            if seconds > LONGEST {
                return Err(format!("duration is {seconds:?}; expected at most {LONGEST:?} s"));
            }
            // The interval is the duration of the hang.
            return Ok(Fault::new(at, FaultKind::Hang(seconds)));
        }
        "clock" => seconds.transpose()?.map_or(FaultKind::ClockStop, FaultKind::ClockJump),
        other => return Err(unknown_kind(other)),
    };
    Ok(Fault { at, until, kind })
}

fn unknown_kind(kind: &str) -> String {
    format!("unknown kind {kind:?}; expected {KINDS}")
}

fn parse_times(when: &str) -> std::result::Result<(f64, Option<f64>), String> {
    let (start, end) = match when.split_once('-') {
        Some((start, end)) if !start.is_empty() => (start, Some(end)),
        _ => (when, None),
    };
    let at = not_negative("time", number("time", start)?)?;
    let until = end.map(|end| number("end", end)).transpose()?;
    match until {
        Some(end) if end <= at => Err(format!("the end, {end}, is not after the start, {at}")),
        _ => Ok((at, until)),
    }
}

fn number(name: &str, text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("{name} is {text:?}; expected a finite number")),
    }
}

fn not_negative(name: &str, value: f64) -> std::result::Result<f64, String> {
    if value >= 0.0 { Ok(value) } else { Err(format!("{name} is {value}; expected 0 or more")) }
}

fn parse_sensor(device: &str) -> std::result::Result<Sensor, String> {
    Ok(match device {
        "front" => Sensor::Psd(Psd::FRONT),
        "left" => Sensor::Psd(Psd::LEFT),
        "right" => Sensor::Psd(Psd::RIGHT),
        "back" => Sensor::Psd(Psd::BACK),
        "lidar" => Sensor::Lidar,
        "camera" => Sensor::Camera,
        "odometry" => Sensor::Odometry,
        "inertial" => Sensor::Inertial,
        "depth" => Sensor::Depth,
        "all" => Sensor::All,
        other => match other.strip_prefix("psd").map(str::parse) {
            Some(Ok(id)) => Sensor::Psd(Psd(id)),
            _ => return Err(format!("unknown device {other:?}; expected {DEVICES}")),
        },
    })
}

fn parse_jump(amount: Option<&str>) -> std::result::Result<Pose, String> {
    let [x, y, heading] = match amount {
        None => JUMP,
        Some(amount) => {
            let parts: Vec<f64> = amount
                .split(',')
                .map(|part| number("amount", part))
                .collect::<std::result::Result<_, _>>()?;
            parts.try_into().map_err(|_| {
                format!("amount is {amount:?}; expected FORWARD,LEFT,TURN in millimetres and degrees")
            })?
        }
    };
    Ok(Pose::from_mm_deg(x, y, heading))
}

impl fmt::Display for Sensor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Sensor::Psd(Psd::FRONT) => f.write_str("front"),
            Sensor::Psd(Psd::LEFT) => f.write_str("left"),
            Sensor::Psd(Psd::RIGHT) => f.write_str("right"),
            Sensor::Psd(Psd::BACK) => f.write_str("back"),
            Sensor::Psd(Psd(id)) => write!(f, "psd{id}"),
            Sensor::Lidar => f.write_str("lidar"),
            Sensor::Camera => f.write_str("camera"),
            Sensor::Odometry => f.write_str("odometry"),
            Sensor::Inertial => f.write_str("inertial"),
            Sensor::Depth => f.write_str("depth"),
            Sensor::All => f.write_str("all"),
        }
    }
}

impl fmt::Display for Fault {
    /// The text that parses back to this fault (a jump, to within the rounding of its units; the meaningless
    /// end of a hang is omitted).
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind {
            FaultKind::Stuck(sensor) => write!(f, "stuck:{sensor}")?,
            FaultKind::Lost(sensor) => write!(f, "lost:{sensor}")?,
            FaultKind::Nan(sensor) => write!(f, "nan:{sensor}")?,
            FaultKind::Jump(Pose { x, y, heading }) => {
                write!(f, "jump={},{},{}", units::to_mm(x), units::to_mm(y), units::to_deg(heading))?;
            }
            FaultKind::Late(sensor, delay) => write!(f, "late:{sensor}={delay}")?,
            FaultKind::Link => f.write_str("link")?,
            FaultKind::Hang(seconds) => return write!(f, "hang={seconds}@{}", self.at),
            FaultKind::ClockStop => f.write_str("clock")?,
            FaultKind::ClockJump(seconds) => write!(f, "clock={seconds}")?,
        }
        write!(f, "@{}", self.at)?;
        self.until.map_or(Ok(()), |end| write!(f, "-{end}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sensor() -> impl Strategy<Value = Sensor> {
        prop_oneof![
            any::<u8>().prop_map(|id| Sensor::Psd(Psd(id))),
            Just(Sensor::Lidar),
            Just(Sensor::Camera),
            Just(Sensor::Odometry),
            Just(Sensor::Inertial),
            Just(Sensor::Depth),
            Just(Sensor::All)
        ]
    }

    fn kind() -> impl Strategy<Value = FaultKind> {
        prop_oneof![
            sensor().prop_map(FaultKind::Stuck),
            sensor().prop_map(FaultKind::Lost),
            sensor().prop_map(FaultKind::Nan),
            (sensor(), 0.0..9.0).prop_map(|(s, delay)| FaultKind::Late(s, delay)),
            Just(FaultKind::Link),
            Just(FaultKind::ClockStop),
            (-9.0..9.0).prop_map(FaultKind::ClockJump),
        ]
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn text_comes_back(kind in kind(), at in 0.0..99.0f64, length in proptest::option::of(0.01..9.0f64)) {
            let fault = Fault { at, until: length.map(|length| at + length), kind };
            prop_assert_eq!(fault.to_string().parse::<Fault>().unwrap(), fault);
        }

        #[test]
        fn no_text_panics(text in "[a-z:=@,.0-9-]{0,20}") {
            let _ = text.parse::<Fault>();
        }
    }

    #[test]
    fn every_kind_has_a_short_form() {
        let all = Sensor::All;
        for (text, kind) in [
            ("stuck@2", FaultKind::Stuck(all)),
            ("lost@2", FaultKind::Lost(all)),
            ("nan@2", FaultKind::Nan(all)),
            ("jump@2", FaultKind::Jump(Pose::from_mm_deg(100.0, 100.0, 15.0))),
            ("jump=1,-2,90@2", FaultKind::Jump(Pose::from_mm_deg(1.0, -2.0, 90.0))),
            ("late@2", FaultKind::Late(all, 0.5)),
            ("link@2", FaultKind::Link),
            ("hang@2", FaultKind::Hang(1.0)),
            ("hang@2-5", FaultKind::Hang(3.0)),
            ("hang=4@2", FaultKind::Hang(4.0)),
            ("clock@2", FaultKind::ClockStop),
            ("clock=-1.5@2", FaultKind::ClockJump(-1.5)),
        ] {
            assert_eq!(text.parse::<Fault>().unwrap(), Fault::new(2.0, kind), "{text}");
        }
    }

    #[test]
    fn errors_say_what_was_found_and_expected() {
        for (text, message) in [
            (
                "stuk@3",
                "fault \"stuk@3\": unknown kind \"stuk\"; expected stuck, lost, nan, jump, late, link, hang or clock",
            ),
            ("stuck", "fault \"stuck\": no time; expected KIND@T, such as stuck:front@2.5"),
            ("stuck@x", "fault \"stuck@x\": time is \"x\"; expected a finite number"),
            ("stuck@-1", "fault \"stuck@-1\": time is -1; expected 0 or more"),
            ("stuck@5-2", "fault \"stuck@5-2\": the end, 2, is not after the start, 5"),
            (
                "lost:nose@1",
                "fault \"lost:nose@1\": unknown device \"nose\"; expected front, left, right, back, psdN, lidar, camera, odometry, inertial, depth or all",
            ),
            ("link:front@1", "fault \"link:front@1\": link takes no device, found \"front\""),
            (
                "oops:front@1",
                "fault \"oops:front@1\": unknown kind \"oops\"; expected stuck, lost, nan, jump, late, link, hang or clock",
            ),
            ("nan=3@1", "fault \"nan=3@1\": nan takes no amount, found \"3\""),
            ("late=-1@1", "fault \"late=-1@1\": delay is -1; expected 0 or more"),
            (
                "jump=1,2@1",
                "fault \"jump=1,2@1\": amount is \"1,2\"; expected FORWARD,LEFT,TURN in millimetres and degrees",
            ),
            ("hang=1e300@1", "fault \"hang=1e300@1\": duration is 1e300; expected at most 3600.0 s"),
            ("hang@1-9999", "fault \"hang@1-9999\": duration is 9998.0; expected at most 3600.0 s"),
            ("hang=inf@1", "fault \"hang=inf@1\": amount is \"inf\"; expected a finite number"),
        ] {
            let error = text.parse::<Fault>().unwrap_err();
            assert_eq!(error.to_string(), message);
            assert_eq!(error.kind(), ErrorKind::InvalidInput);
        }
    }
}
