//! Names of marked points.

use svg::node::element::Group;

use super::canvas::{line, path_data, words};
use super::colours::{FLOOR, INK, PALE_INK};
use super::film::Film;
use super::frame::Frame;
use super::items::{Figure, Item, Picture, is_finite};
use super::labels::Labels;
use super::lines::{runs, thinned};
use super::{Mark, robots, text};

/// The names that fit, each beside its point.
pub(super) fn beside_marks(picture: &Picture, frame: &Frame, film: Option<&Film>) -> Group {
    let mut labels = Labels::new(frame.pixels().inflated(4.0));
    for wall in &picture.world.walls {
        labels.avoid(&[frame.at(wall.line.a), frame.at(wall.line.b)]);
    }
    for item in &picture.items {
        keep_clear(&mut labels, item, frame);
    }
    picture.items.iter().fold(Group::new(), |group, item| match (name(item, frame, &mut labels), film) {
        (Some(text), Some(film)) => group.add(film.seen(text, item.from, item.until)),
        (Some(text), None) => group.add(text),
        (None, _) => group,
    })
}

/// Keeps names off an item.
fn keep_clear(labels: &mut Labels, item: &Item, frame: &Frame) {
    match &item.figure {
        Figure::Mark { mark: Some(_), position, .. } if is_finite(position) => {
            labels.keep_off(Mark::extent(frame.at(*position)));
        }
        Figure::Robot { poses, footprint } => {
            let extent = poses.last().and_then(|(_, pose)| robots::extent(pose, footprint, frame));
            if let Some(extent) = extent {
                labels.keep_off(extent);
            }
        }
        Figure::Line { points, .. } => {
            for run in runs(points) {
                labels.avoid(&thinned(&points[run], frame));
            }
        }
        _ => {}
    }
}

fn name(item: &Item, frame: &Frame, labels: &mut Labels) -> Option<Group> {
    let Figure::Mark { mark, position, text: Some(name) } = &item.figure else { return None };
    if !is_finite(position) {
        return None;
    }
    // A text by itself may be as wide as the picture.
    let room = if mark.is_some() { 240.0 } else { frame.pixels().size().x };
    let name = text::fit(&text::clean(name), text::SIZE, room);
    let at = frame.at(*position);
    let reach = if mark.is_some() { Mark::REACH } else { 0.0 };
    let placed = labels.place(&name, at, reach)?;
    let shown = words(&name, placed.start, text::SIZE, INK)
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
