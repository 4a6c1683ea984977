use svg::node::element::Group;

use super::canvas::{area, disc, line, path_data};
use super::colours::{GREEN, INK, PAGE, PALE_INK, RED};
use super::frame::Pixel;
use crate::geometry::{Aabb, Vector};
use crate::world::Colour;

/// A point worth a symbol.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Mark {
    /// Where a robot started.
    Start,
    /// Where it was to go.
    Goal,
    /// Where a bug algorithm met an obstacle.
    HitPoint,
    /// Where a bug algorithm left an obstacle.
    LeavePoint,
    /// A point on the way.
    Waypoint,
    /// Where a robot touched something.
    Contact,
}

impl Mark {
    /// Pixels from a mark's point to the end of its symbol.
    pub(super) const REACH: f64 = 7.5;

    /// The box around the symbol at a pixel.
    pub(super) fn extent(self, at: Pixel) -> Aabb {
        let reach = Vector::new(Self::REACH, Self::REACH);
        let upper_right = if self == Mark::Goal { Vector::new(15.0, -21.0) } else { Vector::zeros() };
        Aabb { min: (at - reach).inf(&(at + upper_right)), max: (at + reach).sup(&(at + upper_right)) }
    }

    /// What the legend calls it.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Mark::Start => "start",
            Mark::Goal => "goal",
            Mark::HitPoint => "hit point",
            Mark::LeavePoint => "leave point",
            Mark::Waypoint => "waypoint",
            Mark::Contact => "contact",
        }
    }

    /// The symbol at a pixel.
    pub(super) fn symbol(self, at: Pixel) -> Group {
        let corner = |x: f64, y: f64| at + Vector::new(x, y);
        match self {
            Mark::Start => Group::new().add(ringed(at, 6.0, PAGE, INK)).add(disc(at, 2.4, INK)),
            Mark::Goal => flag(at),
            Mark::HitPoint => Group::new().add(ringed(at, 6.0, RED, PAGE)),
            Mark::LeavePoint => {
                let corners = [corner(0.0, -7.4), corner(7.4, 0.0), corner(0.0, 7.4), corner(-7.4, 0.0)];
                Group::new().add(outlined(&corners, GREEN, PAGE))
            }
            Mark::Waypoint => Group::new().add(ringed(at, 4.0, PAGE, PALE_INK)),
            Mark::Contact => {
                let cross = [[corner(-4.6, -4.6), corner(4.6, 4.6)], [corner(-4.6, 4.6), corner(4.6, -4.6)]];
                let data = cross.map(|stroke| path_data(&stroke, false)).concat();
                Group::new().add(line(data.clone(), PAGE, 6.0)).add(line(data, RED, 3.0))
            }
        }
    }
}

/// A flag whose pole stands on the point.
fn flag(at: Pixel) -> Group {
    let corner = |x: f64, y: f64| at + Vector::new(x, y);
    let pole = path_data(&[at, corner(0.0, -20.0)], false);
    let cloth = [corner(0.0, -20.0), corner(15.0, -15.0), corner(0.0, -9.8)];
    Group::new()
        .add(line(pole.clone(), PAGE, 4.6))
        .add(outlined(&cloth, GREEN, PAGE))
        .add(line(pole, INK, 1.8))
        .add(disc(at, 3.0, PAGE))
        .add(disc(at, 2.2, INK))
}

fn ringed(at: Pixel, radius: f64, fill: Colour, ring: Colour) -> svg::node::element::Circle {
    disc(at, radius, fill).set("stroke", ring.to_string()).set("stroke-width", "1.8")
}

fn outlined(corners: &[Pixel], fill: Colour, edge: Colour) -> svg::node::element::Path {
    area(path_data(corners, true), fill)
        .set("stroke", edge.to_string())
        .set("stroke-width", "1.8")
        .set("stroke-linejoin", "round")
}
