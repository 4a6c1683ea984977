//! The world itself: floor, hills, walls, objects and marks on the floor.

use svg::node::element::{Group, Pattern};

use super::canvas::{area, disc, line, number, path_data, rectangle, words};
use super::colours::{EDGE, FLOOR, HILL, INK, LETTER, WALL, WATER, mix};
use super::frame::{Frame, Pixel};
use super::relief::relief;
use super::text;
use crate::geometry::{Aabb, Point, Vector, direction};
use crate::world::{Colour, Object, Shape, Terrain, Wall, World};

/// Pixels that nothing is drawn smaller or thinner than.
pub(super) const SMALLEST: f64 = 2.5;

/// Identifier of the pattern that fills hills.
const HATCH: &str = "hills";

/// Floor, water, grid (if to scale), hills, places and marks.
pub(super) fn floor(world: &World, frame: &Frame, to_scale: bool) -> Group {
    let mut group = ground(world, frame);
    if to_scale {
        group = group.add(grid(&world.floor, frame));
    }
    let edge = rectangle(on_page(world.floor, frame), FLOOR).set("fill", "none");
    group = group.add(edge.set("stroke", EDGE.to_string()));
    if let Some(terrain) = world.terrain.as_ref().filter(|terrain| terrain.surface.is_none()) {
        group = group.add(hatch()).add(hills(terrain, world.floor.min, frame));
    }
    for place in &world.places {
        group = group.add(letter(place.letter, frame.at(place.position)));
    }
    for marker in &world.markers {
        let opacity = number(f64::from(marker.alpha) / 255.0);
        group = group.add(disc(frame.at(marker.position), 5.0, marker.colour).set("opacity", opacity));
    }
    group
}

/// The floor alone, with its water and the hills whose surface is known.
pub(super) fn ground(world: &World, frame: &Frame) -> Group {
    let colour = if world.water_level.is_some_and(|level| level > 0.0) { WATER } else { FLOOR };
    let group = Group::new().add(rectangle(on_page(world.floor, frame), colour));
    match world.terrain.as_ref().and_then(|terrain| terrain.surface.as_deref()) {
        Some(surface) => group.add(relief(surface, world.water_level, frame)),
        None => group,
    }
}

/// Objects and walls.
pub(super) fn solids(world: &World, frame: &Frame) -> Group {
    let objects = world.objects.iter().fold(Group::new(), |group, o| group.add(object(o, frame)));
    let walls = walls(&world.walls, frame);
    Group::new().add(objects).add(walls)
}

/// Symbol of a kind of object in the legend.
pub(super) fn object_symbol(shape: &Shape, colour: Colour, at: Pixel) -> Group {
    match shape {
        Shape::Box { .. } => solid_box(at, 11.0, 11.0, 0.0, colour),
        Shape::Cylinder { .. } | Shape::Cone { .. } => solid_disc(at, 6.0, colour),
        Shape::Sphere { .. } => ball(at, 6.0, colour),
    }
}

/// Symbol of hills without a surface in the legend.
pub(super) fn hills_symbol(at: Pixel) -> Group {
    let bounds = Aabb { min: at, max: at }.inflated(6.0);
    Group::new().add(hatched(bounds))
}

fn on_page(bounds: Aabb, frame: &Frame) -> Aabb {
    Aabb::new(frame.at(bounds.min), frame.at(bounds.max))
}

/// Lines at multiples of the grid step, inside the floor.
fn grid(floor: &Aabb, frame: &Frame) -> svg::node::element::Path {
    let step = frame.grid_step();
    let multiples = |from: f64, to: f64| {
        let first = (from / step + 1e-6).floor() + 1.0;
        (0..1000).map(move |i| (first + f64::from(i)) * step).take_while(move |x| *x < to - 1e-6 * step)
    };
    let upright =
        multiples(floor.min.x, floor.max.x).map(|x| [Point::new(x, floor.min.y), Point::new(x, floor.max.y)]);
    let level =
        multiples(floor.min.y, floor.max.y).map(|y| [Point::new(floor.min.x, y), Point::new(floor.max.x, y)]);
    let lines = upright.chain(level).map(|ends| path_data(&ends.map(|p| frame.at(p)), false));
    line(lines.collect(), INK, 1.0).set("stroke-opacity", "0.07")
}

fn hatch() -> Pattern {
    let stroke = path_data(&[Pixel::new(0.0, 9.0), Pixel::new(9.0, 0.0)], false);
    Pattern::new()
        .set("id", HATCH)
        .set("width", "9")
        .set("height", "9")
        .set("patternUnits", "userSpaceOnUse")
        .add(line(stroke, HILL, 1.2).set("stroke-linecap", "square"))
}

fn hatched(bounds: Aabb) -> svg::node::element::Rectangle {
    rectangle(bounds, HILL)
        .set("fill", format!("url(#{HATCH})"))
        .set("stroke", HILL.to_string())
        .set("opacity", "0.6")
}

fn hills(terrain: &Terrain, corner: Point, frame: &Frame) -> svg::node::element::Rectangle {
    let far = corner + Vector::new(terrain.width, terrain.height);
    hatched(on_page(Aabb::new(corner, far), frame))
}

fn letter(letter: char, at: Pixel) -> svg::node::element::Text {
    let name = letter.to_string();
    let left = at + Vector::new(-0.5 * text::width(&name, 15.0), 5.4);
    words(&name, left, 15.0, LETTER)
}

/// All walls: adjacent list entries of equal style form one path, and those that meet are joined.
fn walls(walls: &[Wall], frame: &Frame) -> Group {
    let mut group = Group::new();
    for alike in walls.chunk_by(|a, b| a.colour == b.colour && a.thickness == b.thickness) {
        let width = frame.length(alike[0].thickness).max(SMALLEST);
        let chains = alike.chunk_by(|a, b| a.line.b == b.line.a);
        let data = chains.map(|chain| chain_data(chain, frame)).collect();
        let mut path = line(data, wall_colour(alike[0].colour), width);
        if width > 5.0 {
            // Thin walls look best with round caps; the square ends of thick walls are part of their shape.
            path = path.set("stroke-linecap", "butt").set("stroke-linejoin", "miter");
        }
        group = group.add(path);
    }
    group
}

/// Path along a chain of walls, each of which starts where the previous one ends.
fn chain_data(chain: &[Wall], frame: &Frame) -> String {
    let (first, last) = (chain[0].line.a, chain[chain.len() - 1].line.b);
    let mut points: Vec<Pixel> = chain.iter().map(|wall| frame.at(wall.line.a)).collect();
    let closed = chain.len() > 2 && first == last;
    if !closed {
        points.push(frame.at(last));
    }
    path_data(&points, closed)
}

/// White walls, the default, would vanish on a light floor and are drawn dark; others keep their colour,
/// slightly darkened.
fn wall_colour(colour: Colour) -> Colour {
    if colour == Wall::DEFAULT_COLOUR { WALL } else { mix(colour, INK, 0.25) }
}

fn object(object: &Object, frame: &Frame) -> Group {
    let (at, colour) = (frame.at(object.pose.position()), object.kind.colour);
    let pixels = |metres: f64| frame.length(metres).max(SMALLEST);
    match object.kind.shape {
        Shape::Cylinder { radius, .. } | Shape::Cone { radius, .. } => solid_disc(at, pixels(radius), colour),
        Shape::Sphere { radius } => ball(at, pixels(radius), colour),
        Shape::Box { length, width, .. } => {
            solid_box(at, pixels(length), pixels(width), object.pose.heading, colour)
        }
    }
}

/// Colour for the outline of an area filled with `colour`.
fn edge_of(colour: Colour) -> Colour {
    mix(colour, INK, 0.55)
}

/// Strong colours softened to match the picture.
fn soft(colour: Colour) -> Colour {
    mix(colour, FLOOR, 0.22)
}

fn solid_disc(at: Pixel, radius: f64, colour: Colour) -> Group {
    let rim = disc(at, radius, soft(colour)).set("stroke", edge_of(colour).to_string());
    let lid = disc(at, 0.66 * radius, soft(colour)).set("stroke", edge_of(colour).to_string());
    Group::new().add(rim.set("stroke-width", "1.2")).add(lid.set("stroke-width", "0.7"))
}

fn ball(at: Pixel, radius: f64, colour: Colour) -> Group {
    let body = disc(at, radius, soft(colour)).set("stroke", edge_of(colour).to_string());
    let shine = at + Vector::new(-0.32 * radius, -0.36 * radius);
    let light = mix(colour, Colour::WHITE, 0.65);
    Group::new().add(body.set("stroke-width", "1.2")).add(disc(shine, 0.26 * radius, light))
}

fn solid_box(at: Pixel, length: f64, width: f64, heading: f64, colour: Colour) -> Group {
    let corners = [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)]
        .map(|(x, y)| at + turned(Vector::new(x * length, y * width), heading));
    let outline = area(path_data(&corners, true), soft(colour))
        .set("stroke", edge_of(colour).to_string())
        .set("stroke-width", "1.2")
        .set("stroke-linejoin", "round");
    Group::new().add(outline)
}

/// A vector of something turned by `heading` (x forward, y left) on the page (y down).
pub(super) fn turned(local: Vector, heading: f64) -> Vector {
    let forward = direction(heading);
    let x = forward.x * local.x - forward.y * local.y;
    let y = forward.y * local.x + forward.x * local.y;
    Vector::new(x, -y)
}
