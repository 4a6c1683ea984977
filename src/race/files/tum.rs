use std::f64::consts::TAU;
use std::fmt::Write as _;

use super::MOST;
use super::csv::{field, rows};
use crate::geometry::{Point, cross, math};
use crate::race::round::turning_back;
use crate::race::{Corridor, LineError};
use crate::world::formats::{FormatError, Location, shown};

/// Maximum distance from the centre line to an edge (m). No track is wider, and lining a wider one with cones
/// would take long.
const WIDEST: f64 = 100.0;
/// Longest step to the next point, relative to the median: the course of a circuit over more is unknown.
/// Those of the database are at most 1.1.
const LONGEST_STEP: f64 = 10.0;
/// Header line of the tracks of the TUM racetrack database.
const HEADER: &str = "# x_m,y_m,w_tr_right_m,w_tr_left_m";

/// Reads a circuit of the TUM racetrack database: a closed centre line (m), with the distance to the right
/// and left edge at each point (m).
///
/// ```
/// use roverlab::race::{parse_line, parse_tum, write_tum};
/// let text = "# x_m,y_m,w_tr_right_m,w_tr_left_m\n0,0,5,4\n100,0,5,4\n100,80,5,4\n50,80,5,4\n0,80,5,4\n";
/// let circuit = parse_tum(text, "block.csv")?;
/// assert!((circuit.length() - 360.0).abs() < 1.0 && circuit.stations()[0].left == 4.0);
/// assert_eq!(parse_tum(&write_tum(&circuit), "again.csv")?, circuit);
/// let error = parse_line("# x_m,y_m\n0,0\n1,up\n", "line.csv").unwrap_err();
/// assert!(error.to_string().starts_with("line.csv:3:3"), "{error}");
/// # Ok::<(), roverlab::world::formats::FormatError>(())
/// ```
///
/// # Errors
///
/// If the text is not such a circuit, rows of it are missing (a step is many times the usual one) or in a
/// wrong order (it turns back), or it goes around more than once.
pub fn parse_tum(text: &str, file: &str) -> Result<Corridor, FormatError> {
    let numbers = table::<4>(text, file, HEADER)?;
    for (values, at) in &numbers {
        for (width, side) in [(values[2], "right"), (values[3], "left")] {
            if !(width > 0.0 && width <= WIDEST) {
                let expected = format!("a width to the {side} of more than 0, at most {WIDEST} m");
                return Err(FormatError::new(file, *at, width.to_string(), expected));
            }
        }
    }
    let rows: Vec<_> =
        numbers.iter().map(|([x, y, right, left], _)| (Point::new(*x, *y), *left, *right)).collect();
    let corridor = Corridor::closed(&rows).map_err(|error: LineError| {
        FormatError::new(file, Location::START, error.to_string(), "a closed centre line")
    })?;
    check_steps(&numbers, file)?;
    check_course(&corridor, file)?;
    Ok(corridor)
}

/// Rejects a circuit that turns back, as rows in a wrong order do, or goes around more than once.
fn check_course(corridor: &Corridor, file: &str) -> Result<(), FormatError> {
    let refused =
        |found: String, expected: &str| Err(FormatError::new(file, Location::START, found, expected));
    if let Some(at) = turning_back(corridor) {
        let found = format!("a line that turns back at ({:.0}, {:.0}) m", at.x, at.y);
        return refused(found, "one that a car can drive");
    }
    let stations = corridor.stations();
    let turned = stations.iter().zip(stations.iter().cycle().skip(1)).map(|(station, next)| {
        math::atan2(cross(station.normal, next.normal), station.normal.dot(&next.normal))
    });
    // A figure of eight comes to none.
    let around = (turned.sum::<f64>() / TAU).abs().round();
    if around > 1.0 { refused(format!("a line that goes around {around} times"), "one lap") } else { Ok(()) }
}

/// Rejects a circuit with a gap, which a chord would close.
fn check_steps(rows: &[([f64; 4], Location)], file: &str) -> Result<(), FormatError> {
    let n = rows.len();
    let place = |k: usize| Point::new(rows[k % n].0[0], rows[k % n].0[1]);
    let steps: Vec<f64> = (0..n).map(|k| (place(k + 1) - place(k)).norm()).collect();
    let usual = *steps.clone().select_nth_unstable_by(n / 2, f64::total_cmp).1;
    steps.iter().position(|step| *step > LONGEST_STEP * usual).map_or(Ok(()), |k| {
        let found = format!("a step of {:.1} m to the next point", steps[k]);
        let expected = format!("at most {LONGEST_STEP} times the usual step of {usual:.1} m");
        Err(FormatError::new(file, rows[k].1, found, expected))
    })
}

/// Reads a line without widths, such as the race lines of the same database.
///
/// # Errors
///
/// If the text is not such a line.
pub fn parse_line(text: &str, file: &str) -> Result<Vec<Point>, FormatError> {
    let rows = table::<2>(text, file, "# x_m,y_m")?;
    Ok(rows.iter().map(|([x, y], _)| Point::new(*x, *y)).collect())
}

/// Writes a circuit that [`parse_tum`] reads, if its stations are about evenly spaced.
pub fn write_tum(corridor: &Corridor) -> String {
    let mut text = format!("{HEADER}\n");
    for station in corridor.stations() {
        let p = station.position;
        let _ = writeln!(text, "{},{},{},{}", p.x, p.y, station.right, station.left);
    }
    text
}

/// Rows of numbers after a header line that begins with `#`.
fn table<const N: usize>(
    text: &str,
    file: &str,
    header: &str,
) -> Result<Vec<([f64; N], Location)>, FormatError> {
    let mut rows = rows(text);
    let first = rows.next();
    if !first.as_ref().is_some_and(|row| row[0].text.starts_with('#')) {
        let found = first.map_or_else(|| "an empty file".into(), |row| shown(row[0].text));
        return Err(FormatError::new(file, Location::START, found, format!("the line {header}")));
    }
    let mut table = Vec::new();
    for row in rows {
        let mut values = [0.0; N];
        for (index, value) in values.iter_mut().enumerate() {
            *value = field(&row, index, file, "a number of metres")?.number(file, "a number of metres")?;
        }
        if let Some(more) = row.get(N) {
            return Err(more.error(file, "the end of the line"));
        }
        if table.len() == MOST {
            return Err(FormatError::new(
                file,
                row[0].at,
                "one more point",
                format!("at most {MOST} points"),
            ));
        }
        table.push((values, row[0].at));
    }
    if table.len() < 4 {
        return Err(FormatError::new(
            file,
            Location::START,
            format!("{} points", table.len()),
            "at least 4 points",
        ));
    }
    Ok(table)
}
