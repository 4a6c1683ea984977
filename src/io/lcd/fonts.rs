use embedded_graphics::mono_font::{MonoFont, iso_8859_1 as latin};

use crate::io::{Font, FontStyle};

/// RoBIOS's font sizes with their normal, bold and italic faces. Where a size lacks a face, the normal one
/// replaces it, so that rows keep their height.
const FACES: [(i32, [&MonoFont<'static>; 3]); 6] = [
    (8, [&latin::FONT_5X8, &latin::FONT_5X8, &latin::FONT_5X8]),
    (10, [&latin::FONT_6X10, &latin::FONT_6X10, &latin::FONT_6X10]),
    (12, [&latin::FONT_6X13, &latin::FONT_6X13_BOLD, &latin::FONT_6X13_ITALIC]),
    (14, [&latin::FONT_7X14, &latin::FONT_7X14_BOLD, &latin::FONT_7X14]),
    (18, [&latin::FONT_9X18, &latin::FONT_9X18_BOLD, &latin::FONT_9X18]),
    (24, [&latin::FONT_10X20, &latin::FONT_10X20, &latin::FONT_10X20]),
];

/// The fixed-width face nearest to a font.
pub(super) fn face(font: Font) -> &'static MonoFont<'static> {
    let wanted = if font.size > 0 { font.size } else { 12 };
    let faces =
        FACES.iter().min_by_key(|(size, _)| (size - wanted).abs()).map_or(&FACES[2].1, |(_, faces)| faces);
    match font.style {
        FontStyle::Normal => faces[0],
        FontStyle::Bold => faces[1],
        FontStyle::Italic => faces[2],
    }
}

/// Width and height of a letter in pixels.
pub(super) fn cell(face: &MonoFont<'_>) -> (i32, i32) {
    ((face.character_size.width + face.character_spacing) as i32, face.character_size.height as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::FontFamily;

    #[test]
    fn sizes_take_the_nearest() {
        let cell_of = |size| cell(face(Font { size, ..Font::default() }));
        for (size, expected) in [(0, 13), (-7, 13), (1, 8), (12, 13), (13, 13), (17, 18), (i32::MAX, 20)] {
            assert_eq!(cell_of(size).1, expected, "{size}");
        }
    }

    #[test]
    fn a_style_never_changes_the_height_of_a_row() {
        for size in [8, 10, 12, 14, 18, 24] {
            let cells = [FontStyle::Normal, FontStyle::Bold, FontStyle::Italic]
                .map(|style| cell(face(Font { family: FontFamily::Times, style, size })));
            assert!(cells.iter().all(|&c| c == cells[0]), "{size}");
        }
    }
}
