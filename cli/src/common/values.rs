//! Parsers of option values, with messages about wrong ones.

use std::path::PathBuf;

use roverlab::geometry::{Point, Pose, units};
use roverlab::picture::FileType;

/// Maximum coordinate, as in world files (mm).
const FARTHEST: f64 = 1e9;
/// Maximum heading (degrees): larger angles lose their precision.
const LARGEST_ANGLE: f64 = 360_000.0;

/// Parses `X,Y,DEG` in millimetres and degrees.
pub(crate) fn parse_pose(text: &str) -> Result<Pose, String> {
    let [x, y, heading] = numbers(text, "X,Y,DEG: three finite numbers (mm, mm, degrees)")?;
    within([x, y], FARTHEST, "mm")?;
    within([heading], LARGEST_ANGLE, "degrees")?;
    Ok(Pose::from_mm_deg(x, y, heading))
}

/// Parses `X,Y` in millimetres.
pub(crate) fn parse_point(text: &str) -> Result<Point, String> {
    let [x, y] = numbers(text, "X,Y: two finite numbers (mm)")?;
    within([x, y], FARTHEST, "mm")?;
    Ok(Point::new(units::from_mm(x), units::from_mm(y)))
}

/// Goal of the robot: position, and optional heading on arrival.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GoalOption {
    pub(crate) position: Point,
    pub(crate) heading: Option<f64>,
}

/// Parses `X,Y` or `X,Y,DEG` in millimetres and degrees.
pub(crate) fn parse_goal(text: &str) -> Result<GoalOption, String> {
    if text.split(',').count() != 3 {
        return parse_point(text).map(|position| GoalOption { position, heading: None });
    }
    let pose = parse_pose(text)?;
    Ok(GoalOption { position: pose.position(), heading: Some(pose.heading) })
}

/// A noise level, 0 to 5.
pub(crate) fn parse_noise(text: &str) -> Result<f64, String> {
    let expected = "a number from 0 to 5";
    let [level] = numbers(text, expected)?;
    if (0.0..=5.0).contains(&level) { Ok(level) } else { Err(wrong(expected)) }
}

/// A time above 0 (s).
pub(crate) fn parse_seconds(text: &str) -> Result<f64, String> {
    let expected = "a finite number of seconds above 0";
    let [seconds] = numbers(text, expected)?;
    if seconds > 0.0 { Ok(seconds) } else { Err(wrong(expected)) }
}

/// Name of a file for an animated picture.
pub(crate) fn parse_animation(text: &str) -> Result<PathBuf, String> {
    match FileType::of(text) {
        Ok(FileType::Svg) => Ok(text.into()),
        _ => Err("expected a name that ends in .svg".into()),
    }
}

/// Name of a picture file.
pub(crate) fn parse_picture(text: &str) -> Result<PathBuf, String> {
    FileType::of(text).map(|_| PathBuf::from(text)).map_err(|error| error.to_string())
}

/// Name of a PNG file.
pub(crate) fn parse_png(text: &str) -> Result<PathBuf, String> {
    let file = PathBuf::from(text);
    let is_png = file.extension().is_some_and(|end| end.eq_ignore_ascii_case("png"));
    if is_png { Ok(file) } else { Err("expected a name that ends in .png".into()) }
}

/// Exactly `N` finite numbers separated by commas.
fn numbers<const N: usize>(text: &str, expected: &str) -> Result<[f64; N], String> {
    let parsed: Option<Vec<f64>> = text.split(',').map(finite).collect();
    parsed.and_then(|all| all.try_into().ok()).ok_or_else(|| wrong(expected))
}

fn within<const N: usize>(values: [f64; N], limit: f64, unit: &str) -> Result<(), String> {
    if values.iter().all(|value| value.abs() <= limit) {
        return Ok(());
    }
    Err(wrong(&format!("values of at most {limit} {unit}")))
}

fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

/// The parser adds the option and its value to the message.
fn wrong(expected: &str) -> String {
    format!("expected {expected}")
}
