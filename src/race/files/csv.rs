use crate::geometry::units::FARTHEST;
use crate::world::formats::{FormatError, Location, shown};

/// A field of a line of comma-separated values.
#[derive(Debug, Clone, Copy)]
pub(super) struct Field<'a> {
    pub(super) text: &'a str,
    pub(super) at: Location,
}

impl Field<'_> {
    /// An error about this field.
    pub(super) fn error(&self, file: &str, expected: &str) -> FormatError {
        let found = if self.text.is_empty() { "nothing".into() } else { shown(self.text) };
        FormatError::new(file, self.at, found, expected)
    }

    /// A finite number of bounded size.
    pub(super) fn number(&self, file: &str, expected: &str) -> Result<f64, FormatError> {
        let value = self.text.parse::<f64>().ok().filter(|value| value.abs() <= FARTHEST);
        value.ok_or_else(|| self.error(file, expected))
    }
}

/// Lines with their fields; empty lines are skipped.
pub(super) fn rows(text: &str) -> impl Iterator<Item = Vec<Field<'_>>> {
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    lines.filter(|(_, line)| !line.trim().is_empty()).map(|(index, line)| {
        let mut column = 1;
        line.split(',')
            .map(|field| {
                let blanks = field.chars().take_while(|c| c.is_whitespace()).count();
                let at = Location { line: index + 1, column: column + blanks };
                column += field.chars().count() + 1;
                Field { text: field.trim(), at }
            })
            .collect()
    })
}

/// A field of a row, or an error at the end of the row.
pub(super) fn field<'a>(
    row: &[Field<'a>],
    index: usize,
    file: &str,
    expected: &str,
) -> Result<Field<'a>, FormatError> {
    if let Some(&field) = row.get(index) {
        return Ok(field);
    }
    let end = row.last().map_or(Location::START, |last| Location {
        line: last.at.line,
        column: last.at.column + last.text.chars().count(),
    });
    Err(FormatError::new(file, end, "the end of the line", expected))
}
