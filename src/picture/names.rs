//! The names beside marked points.

use svg::node::element::Group;

use super::canvas::{line, path_data, words};
use super::colours::{FLOOR, INK, PALE_INK};
use super::frame::Frame;
use super::items::{Marked, Picture};
use super::labels::{self, Labels};
use super::lines::runs;
use super::{Mark, robots, text};

/// The names that fit, each beside its point.
pub(super) fn beside_marks(picture: &Picture, frame: &Frame) -> Group {
    let mut labels = Labels::new(frame.pixels().inflated(4.0));
    for marked in picture.finite_marks() {
        if let Some(mark) = marked.mark {
            labels.keep_off(mark.extent(frame.at(marked.position)));
        }
    }
    for extent in picture.robots.iter().filter_map(|robot| robots::extent(robot, frame)) {
        labels.keep_off(extent);
    }
    for wall in &picture.world.walls {
        labels.avoid(&[frame.at(wall.line.a), frame.at(wall.line.b)]);
    }
    for run in picture.lines.iter().flat_map(|line| runs(&line.points, frame)) {
        labels.avoid(&run);
    }
    picture.finite_marks().fold(Group::new(), |group, marked| match name(marked, frame, &mut labels) {
        Some(text) => group.add(text),
        None => group,
    })
}

fn name(marked: &Marked, frame: &Frame, labels: &mut Labels) -> Option<Group> {
    let name = text::fit(&text::clean(marked.text.as_ref()?), labels::SIZE, 160.0);
    let at = frame.at(marked.position);
    let reach = if marked.mark.is_some() { Mark::REACH } else { 0.0 };
    let placed = labels.place(&name, at, reach)?;
    let shown = words(&name, placed.start, labels::SIZE, INK)
        .set("stroke", FLOOR.to_string())
        .set("stroke-width", "3")
        .set("stroke-linejoin", "round")
        .set("paint-order", "stroke");
    let mut group = Group::new();
    if let Some(end) = placed.lead {
        let start = at + (end - at) * (reach / (end - at).norm().max(reach));
        group = group.add(line(path_data(&[start, end], false), PALE_INK, 0.9));
    }
    Some(group.add(shown))
}
