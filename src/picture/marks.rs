use svg::node::element::Group;

use super::canvas::{area, disc, line, path_data};
use super::colours::{GREEN, INK, PAGE, PALE_INK, RED};
use super::frame::Pixel;
use crate::geometry::{Aabb, Vector};
use crate::world::Colour;

/// A marked point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Mark {
    /// Start of a robot.
    Start,
    /// Goal of a robot.
    Goal,
    /// Hit point of a bug algorithm, where it meets an obstacle.
    HitPoint,
    /// Leave point of a bug algorithm, where it leaves an obstacle.
    LeavePoint,
    /// A waypoint.
    Waypoint,
    /// Contact of a robot with something.
    Contact,
}

impl Mark {
    /// Pixels from a mark's point to the end of its symbol.
    pub(super) const REACH: f64 = 7.5;

    /// Whether it lies on the floor, below robots.
    pub(super) fn is_on_floor(self) -> bool {
        matches!(self, Mark::Start | Mark::Goal)
    }

    /// Bounding box of the symbol at a pixel.
    pub(super) fn extent(at: Pixel) -> Aabb {
        Aabb { min: at, max: at }.inflated(Self::REACH)
    }

    /// Name in the legend.
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

    /// The symbol at a pixel. Marks on the floor are rings with a radius of at least `around` pixels around
    /// what stands there.
    pub(super) fn symbol(self, at: Pixel, around: f64) -> Group {
        let corner = |x: f64, y: f64| at + Vector::new(x, y);
        match self {
            Mark::Start => ring(at, around.max(5.5), INK).add(disc(at, 2.4, INK)),
            Mark::Goal => ring(at, around.max(7.5), GREEN).add(disc(at, 3.2, GREEN)),
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

/// A ring with a light edge on both sides.
fn ring(at: Pixel, radius: f64, colour: Colour) -> Group {
    // A ring around a robot must not hide its path.
    let fill = if radius > Mark::REACH { "0" } else { "0.5" };
    let circle = |colour: Colour, width: &str| {
        disc(at, radius, PAGE)
            .set("fill-opacity", fill)
            .set("stroke", colour.to_string())
            .set("stroke-width", width)
    };
    Group::new().add(circle(PAGE, "5")).add(circle(colour, "2.4"))
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
