//! Robots as seen from above.

use svg::node::element::Group;

use super::canvas::{area, disc, line, number, path_data};
use super::colours::PAGE;
use super::frame::{Frame, Pixel};
use super::items::Robot;
use super::scenery::turned;
use crate::geometry::{Aabb, Pose, Vector};
use crate::world::{Colour, Footprint};

/// Robots that reach less far than this many pixels from their origin are drawn as an arrowhead.
const SMALLEST: f64 = 6.0;

/// A robot's outline with an arrowhead inside that shows its heading; the arrowhead alone where the outline would be
/// too small to see.
pub(super) fn outline(robot: &Robot, frame: &Frame) -> Group {
    if !robot.pose.is_finite() {
        return Group::new();
    }
    let (pose, colour) = (&robot.pose, robot.style.colour);
    let at = frame.at(pose.position());
    let radius = frame.length(robot.footprint.bounding_radius());
    let group = Group::new().set("opacity", number(robot.style.opacity));
    if radius < SMALLEST {
        return group.add(arrowhead(at, pose, 9.0, colour).set("stroke", PAGE.to_string()));
    }
    match &robot.footprint {
        Footprint::Disc { .. } => {
            group.add(disc_body(at, radius, colour)).add(arrowhead(at, pose, 0.72 * radius, colour))
        }
        Footprint::Rectangle(bounds) => {
            let half_width = 0.5 * frame.length(bounds.size().y);
            let middle = frame.at(pose.to_world(nalgebra::center(&bounds.min, &bounds.max)));
            let reach = (0.5 * frame.length(bounds.size().x)).min(half_width);
            group.add(box_body(pose, bounds, frame, colour)).add(arrowhead(
                middle,
                pose,
                0.72 * reach,
                colour,
            ))
        }
    }
}

/// The outline's box on the page, for names that keep off it; `None` for a robot that is nowhere.
pub(super) fn extent(robot: &Robot, frame: &Frame) -> Option<Aabb> {
    let at = frame.at(robot.pose.position());
    let radius = frame.length(robot.footprint.bounding_radius()).max(SMALLEST);
    robot.pose.is_finite().then(|| Aabb { min: at, max: at }.inflated(0.85 * radius))
}

fn disc_body(at: Pixel, radius: f64, colour: Colour) -> svg::node::element::Circle {
    disc(at, radius, PAGE)
        .set("fill-opacity", "0.88")
        .set("stroke", colour.to_string())
        .set("stroke-width", "2.2")
}

fn box_body(pose: &Pose, bounds: &Aabb, frame: &Frame, colour: Colour) -> svg::node::element::Path {
    let (min, max) = (bounds.min, bounds.max);
    let corners = [min, nalgebra::Point2::new(max.x, min.y), max, nalgebra::Point2::new(min.x, max.y)];
    let pixels = corners.map(|corner| frame.at(pose.to_world(corner)));
    line(path_data(&pixels, true), colour, 2.2).set("fill", PAGE.to_string()).set("fill-opacity", "0.88")
}

/// An arrowhead of a length from its middle to its tip.
fn arrowhead(at: Pixel, pose: &Pose, reach: f64, colour: Colour) -> svg::node::element::Path {
    let corners = [(1.0, 0.0), (-0.7, 0.62), (-0.36, 0.0), (-0.7, -0.62)]
        .map(|(x, y)| at + turned(Vector::new(x, y) * reach, pose.heading));
    area(path_data(&corners, true), colour).set("stroke-width", "1.4").set("stroke-linejoin", "round")
}
