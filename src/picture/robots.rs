//! Robots seen from above.

use svg::node::element::Group;

use super::canvas::{area, disc, line, number, path_data};
use super::colours::PAGE;
use super::film::Film;
use super::frame::{Frame, Pixel};
use super::scenery::turned;
use super::{Mark, Style};
use crate::geometry::{Aabb, Pose, Vector};
use crate::world::{Colour, Footprint};

/// A robot, standing or driving.
pub(super) fn robot(
    poses: &[(f64, Pose)],
    footprint: &Footprint,
    style: &Style,
    frame: &Frame,
    film: Option<&Film>,
) -> Group {
    let poses: Vec<_> = poses
        .iter()
        .filter(|(_, pose)| pose.is_finite())
        .map(|(time, pose)| (*time, frame.at(pose.position()), pose.heading))
        .collect();
    match (film, poses.as_slice()) {
        (_, []) => Group::new(),
        (Some(film), poses @ [_, _, ..]) => {
            film.drive(outline(Pixel::origin(), 0.0, footprint, style, frame.scale), poses)
        }
        (_, [.., (_, at, heading)]) => outline(*at, *heading, footprint, style, frame.scale),
    }
}

/// A robot's outline with an arrowhead inside that shows its heading; the arrowhead alone where the outline
/// would be smaller than a mark. `scale` is the pixels in a metre.
pub(super) fn outline(at: Pixel, heading: f64, footprint: &Footprint, style: &Style, scale: f64) -> Group {
    let colour = style.colour;
    let radius = scale * footprint.bounding_radius();
    let group = Group::new().set("opacity", number(style.opacity));
    if radius < Mark::REACH {
        return group.add(arrowhead(at, heading, 9.0, colour).set("stroke", PAGE.to_string()));
    }
    match footprint {
        Footprint::Disc { .. } => {
            group.add(disc_body(at, radius, colour)).add(arrowhead(at, heading, 0.72 * radius, colour))
        }
        Footprint::Rectangle(bounds) => {
            let middle = at + turned(nalgebra::center(&bounds.min, &bounds.max).coords * scale, heading);
            let reach = 0.5 * scale * bounds.size().min();
            let body = box_body(at, heading, bounds, scale, colour);
            group.add(body).add(arrowhead(middle, heading, 0.72 * reach, colour))
        }
    }
}

/// Bounding box of the outline on the page, which names avoid; `None` for a pose that is not finite.
pub(super) fn extent(pose: &Pose, footprint: &Footprint, frame: &Frame) -> Option<Aabb> {
    let at = frame.at(pose.position());
    let radius = frame.length(footprint.bounding_radius()).max(Mark::REACH);
    pose.is_finite().then(|| Aabb { min: at, max: at }.inflated(0.85 * radius))
}

fn disc_body(at: Pixel, radius: f64, colour: Colour) -> svg::node::element::Circle {
    disc(at, radius, PAGE)
        .set("fill-opacity", "0.88")
        .set("stroke", colour.to_string())
        .set("stroke-width", "2.2")
}

fn box_body(at: Pixel, heading: f64, bounds: &Aabb, scale: f64, colour: Colour) -> svg::node::element::Path {
    let (min, max) = (bounds.min, bounds.max);
    let corners = [min, nalgebra::Point2::new(max.x, min.y), max, nalgebra::Point2::new(min.x, max.y)];
    let pixels = corners.map(|corner| at + turned(corner.coords * scale, heading));
    line(path_data(&pixels, true), colour, 2.2).set("fill", PAGE.to_string()).set("fill-opacity", "0.88")
}

/// An arrowhead with `reach` pixels from its centre to its tip.
fn arrowhead(at: Pixel, heading: f64, reach: f64, colour: Colour) -> svg::node::element::Path {
    let corners = [(1.0, 0.0), (-0.7, 0.62), (-0.36, 0.0), (-0.7, -0.62)]
        .map(|(x, y)| at + turned(Vector::new(x, y) * reach, heading));
    area(path_data(&corners, true), colour).set("stroke-width", "1.4").set("stroke-linejoin", "round")
}
