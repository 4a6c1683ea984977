//! Estimates the size of a text without a font.

/// Pixels of the letters of all texts but titles.
pub(super) const SIZE: f64 = 12.0;
/// Pixels from one line of a text to the next; the letters of a title are as high.
pub(super) const LINE: f64 = 17.0;

/// Width of a text in pixels at a font size, as for a wide typeface.
pub(super) fn width(text: &str, size: f64) -> f64 {
    text.chars().map(relative_width).sum::<f64>() * size
}

/// The text, or its beginning with an ellipsis if it is wider than `room` pixels.
pub(super) fn fit(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut used = relative_width('…') * size;
    let mut short = String::new();
    for c in text.chars() {
        used += relative_width(c) * size;
        if used > room {
            break;
        }
        short.push(c);
    }
    short.truncate(short.trim_end().len());
    short.push('…');
    short
}

/// The text in lines of at most `room` pixels, broken between words; a word that is too wide is broken too.
pub(super) fn wrapped(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(line, size) + width(" ", size) + width(word, size) <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.extend(broken(word, size, room)),
        }
    }
    lines
}

/// A word in pieces of at most `room` pixels, but of at least one letter.
fn broken(word: &str, size: f64, room: f64) -> Vec<String> {
    let mut pieces = vec![String::new()];
    let mut used = 0.0;
    for c in word.chars() {
        let wide = relative_width(c) * size;
        if used > 0.0 && used + wide > room {
            pieces.push(String::new());
            used = 0.0;
        }
        used += wide;
        pieces.last_mut().expect("it begins with one").push(c);
    }
    pieces
}

/// One line, without line breaks and characters that XML forbids.
pub(super) fn clean(text: &str) -> String {
    let forbidden = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    text.chars().map(|c| if forbidden(c) { ' ' } else { c }).collect::<String>().trim().to_owned()
}

fn relative_width(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | 'I' | '\'' | '|' | '.' | ',' | ':' | ';' | ' ' | '!' => 0.34,
        'f' | 'r' | 't' | '(' | ')' | '[' | ']' | '/' | '-' | '"' => 0.42,
        'm' | 'w' | 'M' | 'W' | '@' | '%' | '…' => 1.0,
        'A'..='Z' | '+' | '=' | '<' | '>' | '~' | '×' | 'Ω' | 'ω' => 0.8,
        ' '..='\u{24f}' => 0.64,
        _ => 1.05,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn a_fitted_text_fits(text in ".{0,60}", room in 12.0..400.0) {
            let short = fit(&text, 11.0, room);
            prop_assert!(width(&short, 11.0) <= room + 1e-9);
            prop_assert!(short == text || short.ends_with('…'));
        }

        #[test]
        fn wrapped_lines_fit_and_lose_no_word(words in prop::collection::vec("[a-z,.]{1,9}", 0..20), room in 90.0..400.0) {
            let lines = wrapped(&words.join(" "), 11.0, room);
            prop_assert!(lines.iter().all(|line| width(line, 11.0) <= room + 1e-9));
            prop_assert_eq!(lines.join(" "), words.join(" "));
        }

        #[test]
        fn wrapped_lines_fit_and_lose_no_letter(text in "[^\\p{C}]{0,80}", room in 20.0..100.0) {
            let lines = wrapped(&text, 11.0, room);
            prop_assert!(lines.iter().all(|line| width(line, 11.0) <= room + 1e-9));
            let letters = |text: &str| text.split_whitespace().collect::<String>();
            prop_assert_eq!(letters(&lines.concat()), letters(&text));
        }

        #[test]
        fn clean_text_is_one_line(text in any::<String>()) {
            prop_assert!(!clean(&text).chars().any(char::is_control));
        }
    }
}
