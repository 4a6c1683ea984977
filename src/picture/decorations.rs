//! Title and caption above the picture, scale bar below it.

use svg::node::element::Group;

use super::canvas::{line, path_data, words};
use super::colours::{INK, PALE_INK};
use super::film::Film;
use super::frame::{Frame, Pixel};
use super::items::Picture;
use super::text;
use crate::geometry::Vector;

/// Title and caption within a width of `room` pixels, and their height including the space below.
pub(super) fn heading(picture: &Picture, corner: Pixel, room: f64) -> (Group, f64) {
    let mut group = Group::new();
    let mut base = corner.y;
    let rows = |text: &Option<String>, size| {
        text.iter().flat_map(|text| text::wrapped(&text::clean(text), size, room)).collect::<Vec<_>>()
    };
    let title = rows(&picture.title, BOLD * text::LINE);
    for (index, row) in title.iter().enumerate() {
        base += if index == 0 { text::LINE } else { TITLE_LINE };
        group = group.add(words(row, Pixel::new(corner.x, base), text::LINE, INK).set("font-weight", "bold"));
    }
    if !title.is_empty() {
        base += 4.0;
    }
    for row in rows(&picture.caption, text::SIZE) {
        base += text::LINE;
        group = group.add(words(&row, Pixel::new(corner.x, base), text::SIZE, PALE_INK));
    }
    let height = if base > corner.y { base - corner.y + 11.0 } else { 0.0 };
    (group, height)
}

/// Pixels from one line of a title to the next: a quarter more than the height of its letters.
const TITLE_LINE: f64 = 1.25 * text::LINE;
/// Width of bold letters relative to normal ones.
const BOLD: f64 = 1.12;

/// Width of the title in pixels.
pub(super) fn title_width(picture: &Picture) -> f64 {
    picture.title.as_ref().map_or(0.0, |title| text::width(title, BOLD * text::LINE))
}

/// Playback speed of a film, below the frame's lower right corner.
pub(super) fn pace(frame: &Frame, film: &Film) -> Group {
    let words_for =
        if film.pace() > 1.05 { format!("{:.1} times as fast", film.pace()) } else { "real time".into() };
    let corner = frame.pixels().max;
    let left = Pixel::new(corner.x - text::width(&words_for, text::SIZE), corner.y + 23.2);
    Group::new().add(words(&words_for, left, text::SIZE, PALE_INK)).add(film.progress(&frame.pixels()))
}

/// A bar of one grid step with its length, below the frame's lower left corner.
pub(super) fn scale_bar(frame: &Frame) -> Group {
    let bounds = frame.pixels();
    let left = Pixel::new(bounds.min.x, bounds.max.y + 19.0);
    let step = frame.grid_step();
    let right = left + Vector::new(frame.length(step), 0.0);
    let tick = Vector::new(0.0, 4.0);
    let bar = [[left - tick, left + tick], [left, right], [right - tick, right + tick]];
    let data = bar.map(|stroke| path_data(&stroke, false)).concat();
    let text = words(&length_in_words(step), right + Vector::new(9.0, 4.2), text::SIZE, PALE_INK);
    Group::new().add(line(data, PALE_INK, 1.6)).add(text)
}

/// A length in the unit that needs the fewest digits.
fn length_in_words(metres: f64) -> String {
    let (number, unit) = match metres {
        m if m < 0.000_999 => (m * 1e6, "µm"),
        m if m < 0.0999 => (m * 1e3, "mm"),
        m if m < 999.9 => (m, "m"),
        m => (m / 1e3, "km"),
    };
    format!("{} {unit}", super::canvas::number(number))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::World;

    #[test]
    fn long_titles_have_several_lines_and_lose_nothing() {
        let heading = |words: usize| {
            let mut picture = Picture::new(&World::empty(1.0, 1.0));
            picture.title(vec!["highest"; words].join(" "));
            let (group, height) = heading(&picture, Pixel::origin(), 300.0);
            (group.to_string(), height)
        };
        let ((_, short), (text, tall)) = (heading(1), heading(12));
        assert_eq!(text.matches("highest").count(), 12);
        let lines = text.matches("<text").count();
        assert!(lines > 3 && tall == short + TITLE_LINE * (lines - 1) as f64, "{lines} {short} {tall}");
    }

    #[test]
    fn lengths_have_readable_units() {
        let lengths = [0.000_05, 0.02, 0.1, 0.5, 20.0, 5000.0].map(length_in_words);
        assert_eq!(lengths, ["50 µm", "20 mm", "0.1 m", "0.5 m", "20 m", "5 km"]);
    }
}
