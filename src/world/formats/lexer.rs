//! Lines and words, common to all of EyeSim's text formats.
//!
//! Blanks separate words; `"…"` and `'…'` quote blanks. A `;` outside quotes or a `#` at the start of a word
//! begins a comment. Lines end with LF, CR LF or CR; byte order marks are skipped.

use winnow::combinator::{alt, delimited, not, preceded, terminated};
use winnow::prelude::*;
use winnow::stream::{LocatingSlice, Location as _};
use winnow::token::{take_till, take_while};

use super::error::{FormatError, Location};
use super::limits::MAX_WORDS;

/// A word of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Word<'a> {
    /// Text without its quotes.
    pub(super) text: &'a str,
    /// Whether it was in quotes.
    pub(super) quoted: bool,
    /// Byte offset in the line, before any quote.
    start: usize,
}

/// A line with at least one word.
#[derive(Debug, Clone)]
pub(super) struct Line<'a> {
    pub(super) file: &'a str,
    pub(super) number: usize,
    pub(super) words: Vec<Word<'a>>,
    text: &'a str,
    end: usize,
}

impl<'a> Line<'a> {
    /// Location of a word, or of the end of the last word.
    pub(super) fn location(&self, index: usize) -> Location {
        self.at(self.words.get(index).map_or(self.end, |word| word.start))
    }

    /// An error at a word, or at the end of the line.
    pub(super) fn error(&self, index: usize, expected: impl Into<String>) -> FormatError {
        let found = self.words.get(index).map_or_else(|| "the end of the line".into(), |w| shown(w.text));
        FormatError::new(self.file, self.location(index), found, expected)
    }

    /// The rest of the line from a word on, with quotes but without the comment.
    pub(super) fn rest(&self, index: usize) -> &'a str {
        self.words.get(index).map_or("", |word| self.text[word.start..self.end].trim_end())
    }

    fn at(&self, offset: usize) -> Location {
        Location { line: self.number, column: self.text[..offset].chars().count() + 1 }
    }
}

/// Lines of a text with numbers from 1, without line ends and byte order mark.
pub(super) fn numbered(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines = text.split('\n').flat_map(|line| line.strip_suffix('\r').unwrap_or(line).split('\r'));
    (1..).zip(lines)
}

/// Splits a line into words; `None` for blank lines and comments.
pub(super) fn line<'a>(file: &'a str, number: usize, text: &'a str) -> Result<Option<Line<'a>>, FormatError> {
    let mut line = Line { file, number, words: Vec::new(), text, end: 0 };
    let mut input = LocatingSlice::new(text);
    while let Ok(start) = preceded(blanks, position).parse_next(&mut input) {
        if line.words.len() == MAX_WORDS {
            let expected = format!("at most {MAX_WORDS} words in a line");
            return Err(FormatError::new(file, line.at(start), "more words", expected));
        }
        let Ok((text, quoted)) = word.parse_next(&mut input) else {
            return Err(FormatError::new(
                file,
                line.at(start),
                "a quote that is not closed",
                "the closing quote",
            ));
        };
        line.words.push(Word { text, quoted, start });
        line.end = input.current_token_start();
    }
    Ok(if line.words.is_empty() { None } else { Some(line) })
}

type Input<'a> = LocatingSlice<&'a str>;

/// A byte order mark within a file is invisible, like a blank.
fn is_blank(c: char) -> bool {
    c.is_whitespace() || c == '\u{feff}'
}

fn blanks<'a>(input: &mut Input<'a>) -> ModalResult<&'a str> {
    take_while(0.., is_blank).parse_next(input)
}

/// Position of the next word; `None` at the end of the line or its content.
fn position(input: &mut Input<'_>) -> ModalResult<usize> {
    not(alt((winnow::combinator::eof.void(), winnow::token::one_of([';', '#']).void()))).parse_next(input)?;
    Ok(input.current_token_start())
}

fn word<'a>(input: &mut Input<'a>) -> ModalResult<(&'a str, bool)> {
    let quoted = |quote: char| {
        delimited(quote, take_till(0.., move |c| c == quote), quote).map(|text: &'a str| (text, true))
    };
    let bare = take_till(1.., |c: char| is_blank(c) || c == ';').map(|text: &'a str| (text, false));
    let unquoted = terminated(winnow::combinator::empty, not(winnow::token::one_of(['"', '\''])));
    alt((quoted('"'), quoted('\''), preceded(unquoted, bare))).parse_next(input)
}

/// A word for a message: in backquotes, on one line and shortened.
pub(crate) fn shown(word: &str) -> String {
    let mut short: String = word.chars().take(40).flat_map(char::escape_debug).collect();
    if word.chars().nth(40).is_some() {
        short.push('…');
    }
    format!("`{short}`")
}

/// A word as written to a file, in quotes if it has blanks or would be read differently.
///
/// Line ends and a second kind of quote cannot be represented; they become blanks and `'`.
pub(super) fn quote(word: &str) -> String {
    let bare = !word.is_empty()
        && !word.starts_with(['"', '\'', '#'])
        && !word.contains(|c: char| is_blank(c) || c == ';');
    if bare {
        return word.into();
    }
    let one_line = word.replace(['\n', '\r'], " ");
    match (one_line.contains('"'), one_line.contains('\'')) {
        (false, _) => format!("\"{one_line}\""),
        (true, false) => format!("'{one_line}'"),
        (true, true) => format!("\"{}\"", one_line.replace('"', "'")),
    }
}

/// The output of a writer.
pub(super) fn written(write: impl FnOnce(&mut String) -> std::fmt::Result) -> String {
    let mut text = String::new();
    // Writing to a string never fails.
    let _ = write(&mut text);
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn words(text: &str) -> Vec<&str> {
        line("f", 1, text).unwrap().map_or(Vec::new(), |l| l.words.iter().map(|w| w.text).collect())
    }

    #[test]
    fn comments_and_quotes() {
        assert_eq!(words("0 0 1685 0  ;add 1685"), ["0", "0", "1685", "0"]);
        assert_eq!(words("width 50510;BIGW"), ["width", "50510"]);
        assert_eq!(words("\t# all comment"), Vec::<&str>::new());
        assert_eq!(words("world \"my ; maze.maz\" # end"), ["world", "my ; maze.maz"]);
        assert_eq!(words("world 'a \"b\".wld'"), ["world", "a \"b\".wld"]);
        assert_eq!(words(r"world ..\a#b\c.wld"), ["world", r"..\a#b\c.wld"]);
        assert_eq!(words("x\"y z"), ["x\"y", "z"]);
    }

    #[test]
    fn an_open_quote_is_named_at_its_place() {
        let error = line("f.sim", 3, "world \"maze.maz").unwrap_err();
        assert_eq!(
            error.to_string(),
            "f.sim:3:7: found a quote that is not closed; expected the closing quote"
        );
    }

    #[test]
    fn all_line_ends_count() {
        let lines: Vec<_> = numbered("\u{feff}a\r\nb\rc\nd").collect();
        assert_eq!(lines, [(1, "a"), (2, "b"), (3, "c"), (4, "d")]);
    }

    #[test]
    fn columns_count_characters() {
        let line = line("f", 1, "äö  ü").unwrap().unwrap();
        assert_eq!(line.location(1), Location { line: 1, column: 5 });
        assert_eq!(line.location(2), Location { line: 1, column: 6 });
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn quoted_words_read_back(word in "[^\"\n\r]{0,20}|[^'\n\r]{0,20}") {
            let text = format!("name {} end", quote(&word));
            prop_assert_eq!(words(&text), vec!["name", word.as_str(), "end"]);
        }

        #[test]
        fn no_line_panics(text in "\\PC*") {
            let _ = line("f", 1, &text);
        }
    }
}
