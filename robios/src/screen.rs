//! Display of a program: its pixels, and its text history.

use roverlab::io::sim::Lcd;
use roverlab::io::{Display, DisplayOption, Font, Result};
use roverlab::world::Colour;

/// A display that remembers its text.
///
/// The text is that of a terminal with history: rows scrolled away or cleared, followed by the visible rows.
/// Overwritten text is forgotten, and repeatedly cleared text is remembered once.
#[derive(Debug, Default)]
pub struct Screen {
    /// The pixels.
    pub lcd: Lcd,
    rows: Vec<Vec<char>>,
    history: String,
    /// Rows cleared last.
    cleared: Vec<Vec<char>>,
    scrolling: Option<bool>,
    line_feed: Option<bool>,
    /// Current font, set part by part.
    pub font: Font,
}

/// Maximum length of the history (bytes); its beginning is kept.
const LONGEST_HISTORY: usize = 60_000;
/// Maximum number of columns kept per row.
const WIDEST: usize = 200;

impl Screen {
    /// Prints at the cursor.
    pub fn print(&mut self, text: &str) -> Result<()> {
        let (mut row, mut column) = self.lcd.cursor()?;
        self.lcd.print(text)?;
        let (rows, columns) = self.lcd.text_size();
        for c in text.chars() {
            match c {
                '\n' => {
                    self.next_row(&mut row, rows);
                    if self.line_feed != Some(false) {
                        column = 0;
                    }
                }
                '\r' => column = 0,
                '\t' => {
                    for _ in 0..8 - column.rem_euclid(8) {
                        self.put(' ', &mut row, &mut column, (rows, columns));
                    }
                }
                c if c.is_control() => {}
                c => self.put(c, &mut row, &mut column, (rows, columns)),
            }
        }
        Ok(())
    }

    fn put(&mut self, c: char, row: &mut i32, column: &mut i32, (rows, columns): (i32, i32)) {
        if *column >= columns {
            self.next_row(row, rows);
            *column = 0;
        }
        if let (Ok(row), Ok(column)) = (usize::try_from(*row), usize::try_from(*column))
            && row < rows.max(0) as usize
            && column < WIDEST
        {
            if self.rows.len() <= row {
                self.rows.resize(row + 1, Vec::new());
            }
            let line = &mut self.rows[row];
            if line.len() <= column {
                line.resize(column + 1, ' ');
            }
            line[column] = c;
        }
        *column = column.saturating_add(1);
    }

    fn next_row(&mut self, row: &mut i32, rows: i32) {
        if *row < rows - 1 || self.scrolling == Some(false) {
            *row = row.saturating_add(1);
            return;
        }
        if !self.rows.is_empty() {
            let line = self.rows.remove(0);
            self.remember(&line);
        }
        *row = rows - 1;
    }

    fn remember(&mut self, line: &[char]) {
        let line: String = line.iter().collect();
        if self.history.len() + line.len() < LONGEST_HISTORY {
            self.history.push_str(line.trim_end());
            self.history.push('\n');
        }
    }

    /// Clears the display.
    pub fn clear(&mut self) -> Result<()> {
        let rows = std::mem::take(&mut self.rows);
        // Programs repeatedly clear and draw the same.
        if rows != self.cleared {
            for line in rows.iter().filter(|line| line.iter().any(|c| !c.is_whitespace())) {
                self.remember(line);
            }
            self.cleared = rows;
        }
        self.lcd.clear_display()
    }

    /// Switches a display setting on or off.
    pub fn switch(&mut self, option: DisplayOption, on: bool) -> Result<()> {
        match option {
            DisplayOption::Scrolling => self.scrolling = Some(on),
            DisplayOption::LineFeed => self.line_feed = Some(on),
            _ => {}
        }
        self.lcd.set_display_option(option, on)
    }

    /// Rows that have left the display.
    pub fn history(&self) -> &str {
        &self.history
    }

    /// The visible rows, without trailing blanks.
    pub fn standing(&self) -> String {
        let rows: Vec<String> = self.rows.iter().map(|row| row.iter().collect()).collect();
        let text = rows.iter().map(|row| row.trim_end()).collect::<Vec<_>>().join("\n");
        text.trim_end_matches('\n').to_owned()
    }
}

/// A colour by RoBIOS's number.
pub fn colour(number: i32) -> Colour {
    Colour::from_hex(number as u32 & 0x00ff_ffff)
}

/// RoBIOS's number of a colour.
pub fn number(colour: Colour) -> i32 {
    i32::from(colour.red) << 16 | i32::from(colour.green) << 8 | i32::from(colour.blue)
}

#[cfg(test)]
mod tests {
    use super::*;
    use roverlab::random::Stream;

    #[test]
    fn text_stands_where_it_was_printed() {
        let mut screen = Screen::default();
        screen.print("Hello\nworld").unwrap();
        screen.lcd.set_cursor(3, 2).unwrap();
        screen.print("row 3").unwrap();
        screen.lcd.set_cursor(0, 1).unwrap();
        screen.print("u").unwrap();
        assert_eq!(screen.standing(), "Hullo\nworld\n\n  row 3");
        assert_eq!(screen.history(), "");
        screen.clear().unwrap();
        screen.print("new").unwrap();
        assert_eq!((screen.history(), screen.standing().as_str()), ("Hullo\nworld\n  row 3\n", "new"));
        screen.clear().unwrap();
        screen.print("new").unwrap();
        screen.clear().unwrap();
        assert_eq!(screen.history(), "Hullo\nworld\n  row 3\nnew\n");
    }

    #[test]
    fn rows_that_scroll_away_are_remembered() {
        let mut screen = Screen::default();
        for i in 0..30 {
            screen.print(&format!("line {i}\n")).unwrap();
        }
        let text = format!("{}{}", screen.history(), screen.standing());
        let lines: Vec<String> = (0..30).map(|i| format!("line {i}")).collect();
        assert_eq!(text, lines.join("\n"));
    }

    /// Text and pixels agree on the cursor position, whatever is printed.
    #[test]
    fn the_cursor_is_where_the_text_ends() {
        let mut stream = Stream::new(3);
        let mut screen = Screen::default();
        for _ in 0..500 {
            let length = stream.below(100);
            let text: String =
                (0..length).map(|_| ['a', 'B', ' ', '\n', '\t', '\r'][stream.below(6)]).collect();
            screen.print(&text).unwrap();
            screen.lcd.set_cursor(stream.below(24) as i32, stream.below(70) as i32).unwrap();
            let (row, column) = screen.lcd.cursor().unwrap();
            screen.print("#").unwrap();
            assert_eq!(screen.rows[row as usize][column as usize], '#');
        }
    }
}
