use super::super::args::Args;
use super::super::error::{FormatError, Notes, Parsed};
use super::super::lexer::{self, Line, shown};
use super::super::limits::MAX_STATEMENTS;
use super::super::number;
use super::super::source::check_length;
use super::document::{Position, SimFile, Statement};
use crate::geometry::{Point, Pose};
use crate::world::{Colour, Marker, ObjectKind, RobotSpec, Settings};

/// Workaround for an invalid line, in messages.
pub(super) const SKIPPED: &str = "the line is skipped";
/// Default colour of marks.
const MARKER_COLOUR: Colour = Colour::RED;

/// Reads a script without the files that it names.
pub fn parse_document(text: &str, file: &str) -> Result<Parsed<SimFile>, FormatError> {
    read(text, file, false)
}

/// Reads a script; `tolerant` skips invalid lines.
pub(super) fn read(text: &str, file: &str, tolerant: bool) -> Result<Parsed<SimFile>, FormatError> {
    check_length(text, file)?;
    let mut reader = Reader { script: SimFile::default(), notes: Notes::new(file) };
    for (number, text) in lexer::numbered(text) {
        let line = lexer::line(file, number, text);
        match line.and_then(|line| line.map_or(Ok(()), |line| reader.line(&line))) {
            Err(error) if tolerant => reader.notes.get_over(error, SKIPPED),
            result => result?,
        }
    }
    Ok(reader.notes.finish(reader.script))
}

struct Reader<'f> {
    script: SimFile,
    notes: Notes<'f>,
}

impl Reader<'_> {
    fn line(&mut self, line: &Line<'_>) -> Result<(), FormatError> {
        if self.script.statements.len() == MAX_STATEMENTS {
            let mut error = line.error(0, format!("at most {MAX_STATEMENTS} lines"));
            error.found = "one more line".into();
            return Err(error);
        }
        let keyword = line.words[0].text.to_ascii_lowercase();
        if let Some(instead) = legacy(&keyword, line) {
            let message = format!("a line of EyeSim 6, skipped; expected {instead}");
            self.notes.warn(line.location(0), message);
            return Ok(());
        }
        let mut args = Args::after_keyword(line);
        let (statement, place) = match keyword.as_str() {
            "world" => {
                (Statement::World(self.path(&mut args, "a world", &[".wld", ".maz", ".yaml", ".yml"])?), 1)
            }
            "robot" | "robi" => (Statement::Robot(self.path(&mut args, "a robot", &[".robi"])?), 1),
            "object" | "obj" => (Statement::Object(self.path(&mut args, "an object", &[".esobj"])?), 1),
            "settings" => (Statement::Settings(self.settings(line, &mut args)), 0),
            "marker" => (Statement::Marker(marker(line, &mut args)?), 0),
            _ => match placement(line, &mut args) {
                Ok(statement) => (statement, 0),
                Err(error) if is_predefined(&keyword) => return Err(error),
                Err(error) => {
                    self.script.broken.push((self.script.statements.len(), error));
                    self.script.push(Statement::Unknown(line.rest(0).into()), line.location(0));
                    return Ok(());
                }
            },
        };
        self.script.push(statement, line.location(place));
        args.finish(&mut self.notes);
        Ok(())
    }

    fn path(&mut self, args: &mut Args<'_, '_>, what: &str, endings: &[&str]) -> Result<String, FormatError> {
        args.path(&format!("the file of {what}"), endings, &mut self.notes).map(str::to_string)
    }

    fn settings(&mut self, line: &Line<'_>, args: &mut Args<'_, '_>) -> Settings {
        let mut settings = Settings::default();
        for index in 1..line.words.len() {
            let Ok(word) = args.word("") else { break };
            match word.text.to_ascii_uppercase().as_str() {
                "VIS" => settings.show_sensors = true,
                "TRACE" => settings.show_traces = true,
                _ => {
                    let message = format!("unknown setting {}; ignored", shown(word.text));
                    self.notes.warn(line.location(index), message);
                }
            }
        }
        settings
    }
}

/// Replacement for a line of EyeSim 6.
fn legacy(keyword: &str, line: &Line<'_>) -> Option<&'static str> {
    let is_number = |index: usize| line.words.get(index).is_some_and(|w| number::parse(w.text, 0).is_some());
    match keyword {
        "maze" if line.words.len() == 2 => Some("`world FILE`"),
        "robi" if line.words.len() >= 6 && (3..6).all(is_number) => {
            Some("`robot FILE` and `NAME X Y PHI PROGRAM`")
        }
        "object" if (1..4).all(is_number) => Some("`object FILE` and `NAME X Y PHI`"),
        _ => None,
    }
}

fn is_predefined(name: &str) -> bool {
    RobotSpec::predefined(name).is_some() || ObjectKind::predefined(name).is_some()
}

fn marker(line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<Marker, FormatError> {
    let numbers = args.left();
    let position = Point::new(args.length("the marker's x")?, args.length("the marker's y")?);
    let colour = if numbers == 2 { MARKER_COLOUR } else { args.colour("the marker")? };
    let alpha = if numbers > 5 { args.channel("the marker's opacity")? } else { 255 };
    if numbers > 6 {
        return Err(line.error(7, "2, 5 or 6 numbers for a marker"));
    }
    Ok(Marker { position, colour, alpha })
}

fn placement(line: &Line<'_>, args: &mut Args<'_, '_>) -> Result<Statement, FormatError> {
    let name = line.words[0].text.to_string();
    let letter = args.peek().filter(|word| !word.quoted).and_then(|word| single_letter(word.text));
    let at = if let Some(letter) = letter {
        args.word("a letter")?;
        let heading = if args.numbers_ahead() > 0 { Some(args.direction("the heading")?) } else { None };
        Position::Letter { letter, heading }
    } else {
        let three_dimensional = args.numbers_ahead() >= 4;
        let (x, y) = (args.length("x")?, args.length("y")?);
        let elevation = if three_dimensional { Some(args.length("z")?) } else { None };
        Position::Pose { pose: Pose::new(x, y, args.direction("the heading")?), elevation }
    };
    let program = args.peek().map(|word| word.text.to_string());
    if program.is_some() {
        args.word("a program")?;
    }
    Ok(Statement::Place { name, at, program })
}

fn single_letter(word: &str) -> Option<char> {
    let mut chars = word.chars();
    chars.next().filter(|c| c.is_ascii_alphabetic() && chars.next().is_none())
}
