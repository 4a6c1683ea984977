use roverlab::geometry::Point;
use roverlab::picture::{Picture, Style};
use roverlab::world::{Colour, World};

use super::evaluation::Evaluation;

/// Colours of the bars of precision and of recall.
const COLOURS: [(u32, &str); 2] = [(0x1f_6f_b4, "precision"), (0xe0_8a_1e, "recall")];
/// Extent of the bars, of the names before them, and of a class.
const BAR: f64 = 10.0;
const NAMES: f64 = 4.0;
const CLASS: f64 = 1.2;

/// Bars of precision and recall, a pair for each class.
pub(super) fn picture(evaluation: &Evaluation) -> Picture {
    let classes: Vec<_> = evaluation.classes().collect();
    let mut picture = Picture::new(&World::empty(NAMES + BAR + 0.5, CLASS * (classes.len() as f64 + 0.5)));
    picture
        .title("Traffic signs")
        .caption("full bars: all that was found is right, and all that is there was found");
    picture.without_scale();
    for (row, (name, measures, _)) in classes.iter().rev().enumerate() {
        let bottom = CLASS * (row as f64 + 0.3);
        picture.text(Point::new(0.4, bottom + 0.3), *name);
        for (bar, ((colour, label), measure)) in COLOURS.into_iter().zip(measures).enumerate() {
            let low = bottom + 0.42 * (1 - bar) as f64;
            let right = NAMES + BAR * measure;
            let corners = [(NAMES, low), (right, low), (right, low + 0.36), (NAMES, low + 0.36)];
            let style = Style::new(Colour::from_hex(colour)).filled(0.9).labelled(label);
            picture.polygon(corners.map(|(x, y)| Point::new(x, y)), style);
        }
    }
    picture
}
