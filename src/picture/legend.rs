//! The legend: meaning of symbols and lines.

use std::collections::BTreeMap;

use svg::node::element::{Group, LinearGradient, Stop};

use super::canvas::{number, rectangle, words};
use super::colours::{INK, PALE_INK, ramp};
use super::frame::{Frame, GAP, Pixel};
use super::items::{Figure, Item, Picture};
use super::relief::contour_step;
use super::scenery::SMALLEST;
use super::{Mark, Style, lines, robots, scenery, text};
use crate::geometry::{Aabb, Vector};
use crate::world::{Colour, Footprint, Shape};

/// Maximum number of listed kinds of objects; the others are counted.
const MOST_KINDS: usize = 8;

/// Identifier of the speed scale's gradient.
const GRADIENT: &str = "speed";

/// Entries of a legend, in order.
#[derive(Debug)]
pub(super) struct Legend {
    entries: Vec<(Key, String)>,
}

/// Symbol in front of an entry's text.
#[derive(Debug, Clone)]
enum Key {
    Line(Style),
    Area(Style),
    Disc(Style),
    Points(Style),
    Robot(Style, Footprint),
    Mark(Mark),
    Object(Shape, Colour),
    Hills,
    Speed,
    Nothing,
}

/// Layout of the entries.
#[derive(Debug, Clone, Copy)]
pub(super) enum Arrangement {
    /// One below the other.
    Column,
    /// Side by side, in rows of at most this many pixels.
    Rows(f64),
}

impl Legend {
    pub(super) fn of(picture: &Picture) -> Self {
        let mut legend = Self { entries: Vec::new() };
        let top = number(picture.top_speed());
        let shortest = SMALLEST / Frame::around(picture.region(), Pixel::origin()).scale;
        for item in picture.items.iter().filter(|item| item.figure.is_visible(shortest)) {
            match Key::of(item) {
                Some(Key::Speed) => legend.add_once(Key::Speed, &format!("true path, 0 to {top} m/s")),
                Some(key) => item.style.label.iter().for_each(|label| legend.add_once(key.clone(), label)),
                None => {}
            }
        }
        legend.add_marks(picture);
        legend.add_objects(picture);
        let worlds = picture.grounds.iter().map(|(ground, _)| ground).chain([&picture.world]);
        for terrain in worlds.filter_map(|world| world.terrain.as_ref()) {
            let height = number(terrain.max_elevation);
            match terrain.surface.as_deref() {
                Some(surface) => {
                    let step = number(contour_step(surface));
                    let line = Style::new(INK).width(0.8).opacity(0.6);
                    legend.add_once(
                        Key::Line(line),
                        &format!("contour lines {step} m apart, up to {height} m"),
                    );
                }
                None => legend.add_once(Key::Hills, &format!("hills up to {height} m")),
            }
        }
        legend
    }

    pub(super) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Width and height of the legend in pixels.
    pub(super) fn size(&self, arrangement: Arrangement) -> Vector {
        let extent = Vector::new(0.0, 0.0);
        self.places(arrangement).into_iter().zip(&self.entries).fold(extent, |extent, (place, (_, text))| {
            extent.sup(&Vector::new(place.x + entry_width(text), place.y + GAP))
        })
    }

    /// The legend with its upper left corner at `corner`.
    pub(super) fn draw(&self, corner: Pixel, arrangement: Arrangement) -> Group {
        let places = self.places(arrangement);
        places.into_iter().zip(&self.entries).fold(Group::new(), |group, (place, (key, text))| {
            let middle = corner + place + Vector::new(0.0, 0.5 * GAP);
            let text = words(text, middle + Vector::new(1.5 * GAP, 4.2), text::SIZE, INK);
            group.add(key.symbol(middle)).add(text)
        })
    }

    /// Upper left corners of the entries.
    fn places(&self, arrangement: Arrangement) -> Vec<Vector> {
        let mut next = Vector::new(0.0, 0.0);
        let mut places = Vec::with_capacity(self.entries.len());
        for (_, text) in &self.entries {
            let width = entry_width(text);
            match arrangement {
                Arrangement::Rows(room) if next.x > 0.0 && next.x + width > room => {
                    next = Vector::new(0.0, next.y + GAP);
                }
                _ => {}
            }
            places.push(next);
            match arrangement {
                Arrangement::Column => next.y += GAP,
                Arrangement::Rows(_) => next.x += width + GAP,
            }
        }
        places
    }

    fn add(&mut self, key: Key, text: impl Into<String>) {
        self.entries.push((key, text::fit(&text::clean(&text.into()), text::SIZE, 260.0)));
    }

    /// Adds an entry unless its text already exists.
    fn add_once(&mut self, key: Key, text: &str) {
        let text = text::fit(&text::clean(text), text::SIZE, 260.0);
        if !self.entries.iter().any(|(_, other)| *other == text) {
            self.entries.push((key, text));
        }
    }

    fn add_marks(&mut self, picture: &Picture) {
        let mut counts: BTreeMap<Mark, usize> = BTreeMap::new();
        for item in picture.items.iter().filter(|item| item.figure.is_visible(0.0)) {
            if let Figure::Mark { mark: Some(mark), .. } = item.figure {
                *counts.entry(mark).or_default() += 1;
            }
        }
        for (mark, count) in counts {
            self.add(Key::Mark(mark), counted(mark.name(), count));
        }
    }

    /// Adds the kinds of objects in the order of their first use.
    fn add_objects(&mut self, picture: &Picture) {
        let mut kinds: Vec<(&crate::world::ObjectKind, usize)> = Vec::new();
        for object in &picture.world.objects {
            match kinds.iter_mut().find(|(kind, _)| kind.name == object.kind.name) {
                Some((_, count)) => *count += 1,
                None => kinds.push((&object.kind, 1)),
            }
        }
        for (kind, count) in kinds.iter().take(MOST_KINDS) {
            self.add(Key::Object(kind.shape, kind.colour), counted(&kind.name, *count));
        }
        if kinds.len() > MOST_KINDS {
            self.add(Key::Nothing, format!("and {} more kinds", kinds.len() - MOST_KINDS));
        }
    }
}

/// A name, with its count if there are several.
fn counted(name: &str, count: usize) -> String {
    if count > 1 { format!("{name} ×{count}") } else { name.to_owned() }
}

fn entry_width(text: &str) -> f64 {
    1.5 * GAP + text::width(text, text::SIZE)
}

impl Key {
    /// Symbol of a labelled item.
    fn of(item: &Item) -> Option<Self> {
        let style = item.style.clone();
        Some(match &item.figure {
            Figure::Line { speeds, .. } if !speeds.is_empty() => Key::Speed,
            Figure::Line { .. } | Figure::Moving(_) => Key::Line(style),
            Figure::Disc { .. } => Key::Disc(style),
            Figure::Polygon(_) => Key::Area(style),
            Figure::Points(_) => Key::Points(style),
            Figure::Robot { footprint, .. } => Key::Robot(style, *footprint),
            Figure::Mark { .. } => return None,
        })
    }

    /// The symbol, with the middle of its left edge at `at`.
    fn symbol(&self, at: Pixel) -> Group {
        let middle = at + Vector::new(12.0, 0.0);
        let bar = Aabb { min: at + Vector::new(0.0, -4.0), max: at + Vector::new(24.0, 4.0) };
        match self {
            Key::Line(style) => lines::stroke(&[at, at + Vector::new(24.0, 0.0)], style),
            Key::Area(style) => lines::swatch(bar.inflated(1.0), style),
            Key::Disc(style) => lines::circle(middle, 5.5, &style.clone().width(style.width.min(2.4))),
            Key::Robot(style, footprint) => {
                let scale = 8.0 / footprint.bounding_radius().max(1e-6);
                robots::outline(middle, 0.0, footprint, style, scale)
            }
            Key::Points(style) => {
                let spread = [(-8.0, 2.0), (-1.0, -3.0), (3.0, 4.0), (9.0, -1.0)];
                lines::dots(&spread.map(|(x, y)| middle + Vector::new(x, y)), style)
            }
            Key::Mark(mark) => mark.symbol(middle, 0.0),
            Key::Object(shape, colour) => scenery::object_symbol(shape, *colour, middle),
            Key::Hills => scenery::hills_symbol(middle),
            Key::Speed => {
                let scale = rectangle(bar, PALE_INK).set("rx", "2").set("fill", format!("url(#{GRADIENT})"));
                Group::new().add(gradient()).add(scale)
            }
            Key::Nothing => Group::new(),
        }
    }
}

fn gradient() -> LinearGradient {
    (0..=4).map(|i| f64::from(i) / 4.0).fold(LinearGradient::new().set("id", GRADIENT), |gradient, share| {
        let stop = Stop::new().set("offset", number(share)).set("stop-color", ramp(share).to_string());
        gradient.add(stop)
    })
}
