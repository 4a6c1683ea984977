use std::fmt::{Result, Write as _};

use super::super::lexer::{self, quote};
use super::super::number::{self, degrees, millimetres};
use super::document::{Position, SimFile, Statement};
use crate::world::Marker;

/// Writes a script in a form that [`parse_document`](super::parse_document) reads back.
pub fn print(script: &SimFile) -> String {
    lexer::written(|text| script.statements.iter().try_for_each(|statement| write_statement(text, statement)))
}

fn write_statement(text: &mut String, statement: &Statement) -> Result {
    match statement {
        Statement::World(file) => writeln!(text, "world {}", quote(file)),
        Statement::Robot(file) => writeln!(text, "robot {}", quote(file)),
        Statement::Object(file) => writeln!(text, "object {}", quote(file)),
        Statement::Settings(settings) => {
            let visible = if settings.show_sensors { " VIS" } else { "" };
            let traced = if settings.show_traces { " TRACE" } else { "" };
            writeln!(text, "settings{visible}{traced}")
        }
        Statement::Marker(marker) => write_marker(text, marker),
        Statement::Place { name, at, program } => {
            write!(text, "{}", quote(name))?;
            write_position(text, at)?;
            if let Some(program) = program {
                write!(text, " {}", not_a_number(program))?;
            }
            writeln!(text)
        }
        Statement::Unknown(line) => writeln!(text, "{}", line.replace(['\n', '\r'], " ")),
    }
}

fn write_position(text: &mut String, at: &Position) -> Result {
    match *at {
        Position::Letter { letter, heading } => {
            write!(text, " {letter}")?;
            heading.map_or(Ok(()), |heading| write!(text, " {}", degrees(heading)))
        }
        Position::Pose { pose, elevation } => {
            write!(text, " {} {}", millimetres(pose.x), millimetres(pose.y))?;
            if let Some(z) = elevation {
                write!(text, " {}", millimetres(z))?;
            }
            write!(text, " {}", degrees(pose.heading))
        }
    }
}

fn write_marker(text: &mut String, marker: &Marker) -> Result {
    let (p, c) = (marker.position, marker.colour);
    write!(text, "marker {} {} {} {} {}", millimetres(p.x), millimetres(p.y), c.red, c.green, c.blue)?;
    if marker.alpha != 255 {
        write!(text, " {}", marker.alpha)?;
    }
    writeln!(text)
}

/// A program name, in quotes if it could be read as a coordinate.
fn not_a_number(program: &str) -> String {
    if number::parse(program, 0).is_some() { format!("\"{program}\"") } else { quote(program) }
}
