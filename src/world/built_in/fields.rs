use image::{Rgba, RgbaImage};

use super::road::Road;
use crate::geometry::{Point, Segment, math};
use crate::world::formats::maz;
use crate::world::{Colour, Texture, Wall, World};

/// Colour of the lines of a playing field.
const WHITE: Colour = Colour::from_hex(0xf0_f0_f0);
/// Colour of a playing field.
const GRASS: Colour = Colour::from_hex(0x2a_7d_3c);
/// Colour of one team's goal.
const BLUE: Colour = Colour::from_hex(0x28_50_b4);
/// Colour of the other team's goal.
const YELLOW: Colour = Colour::from_hex(0xe6_c8_28);

/// A maze without inner walls. Mazes have the sizes and letters of the book's scripts; the walls are our own.
const RECTANGLE: &str = " _ _ _ _ _\n|. . . . .|\n|. . . . .|\n|_ _ _ _ _|\n600\n";
/// A maze with a path from the start.
const SMALL: &str = " _ _ _ _\n|_  |   |\n|  _| | |\n| |   |_|\n|S|_|_ _|\n360\n";
/// A field with a letter in each of sixteen cells, all the same.
const BOTS16: &str = " _ _ _ _\n|a a a a|\n|a a a a|\n|a a a a|\n|A A A A|\n500\n";
/// The same with four different letters.
const BOTS4X4: &str = " _ _ _ _\n|a b c d|\n|b c d a|\n|c d a b|\n|D A B C|\n500\n";

impl World {
    /// Worlds that every script knows by their EyeSim file names: Soccer1998, Field, Field2, Chess, Carolo,
    /// obstacles, rectangle, small, bots16, bots4x4.
    pub const PREDEFINED: [&'static str; 10] = [
        "Soccer1998",
        "Field",
        "Field2",
        "Chess",
        "Carolo",
        "obstacles",
        "rectangle",
        "small",
        "bots16",
        "bots4x4",
    ];

    /// A world of [`PREDEFINED`](Self::PREDEFINED), case-insensitive.
    pub fn predefined(name: &str) -> Option<Self> {
        let name = Self::PREDEFINED.into_iter().find(|known| known.eq_ignore_ascii_case(name))?;
        Some(match name {
            "Soccer1998" => soccer(),
            "Field" => field(),
            "Field2" => Self::empty(8.0, 12.0),
            "Chess" => chess(),
            "Carolo" => carolo(),
            "obstacles" => obstacles(),
            "rectangle" => maze(RECTANGLE),
            "small" => maze(SMALL),
            "bots16" => maze(BOTS16),
            _ => maze(BOTS4X4),
        })
    }
}

fn maze(text: &str) -> World {
    // The texts above are valid, which tests verify.
    maz::parse(text, "built-in.maz").map_or_else(|_| World::walled(2.0, 2.0), |parsed| parsed.value)
}

/// A floor image of a size in metres with pixels of 5 mm. `colour` is a function of the distances from the
/// near left corner (m).
fn painted(name: &str, (width, height): (f64, f64), colour: impl Fn(f64, f64) -> Colour) -> Texture {
    /// Pixel size of a field's texture (m).
    const PIXEL: f64 = 0.005;
    let pixels = |metres: f64| (metres / PIXEL).round() as u32;
    let (columns, rows) = (pixels(width), pixels(height));
    let image = RgbaImage::from_fn(columns, rows, |column, row| {
        let (x, y) = (f64::from(column) + 0.5, f64::from(rows - 1 - row) + 0.5);
        let Colour { red, green, blue } = colour(PIXEL * x, PIXEL * y);
        Rgba([red, green, blue, 255])
    });
    Texture::new(name, image)
}

fn wall(a: [f64; 2], b: [f64; 2], colour: Colour) -> Wall {
    Wall { colour, ..Wall::new(Point::new(a[0], a[1]), Point::new(b[0], b[1])) }
}

/// The field of the robot-soccer small-size league in 1998, as large as a table-tennis table, with its goals.
fn soccer() -> World {
    let (length, width, goal, depth) = (2.74, 1.525, 0.5, 0.18);
    let mut world = World::empty(length, width);
    let (low, high) = (0.5 * (width - goal), 0.5 * (width + goal));
    for (line, behind, colour) in [(0.0, -depth, YELLOW), (length, length + depth, BLUE)] {
        world.walls.extend([
            wall([line, 0.0], [line, low], WHITE),
            wall([line, high], [line, width], WHITE),
            wall([line, low], [behind, low], colour),
            wall([behind, low], [behind, high], colour),
            wall([behind, high], [line, high], colour),
        ]);
    }
    for y in [0.0, width] {
        world.walls.push(wall([0.0, y], [length, y], WHITE));
    }
    let grass = painted("Soccer1998.png", (length, width), |x, y| {
        let from_middle = math::hypot(x - 0.5 * length, y - 0.5 * width);
        let near = |distance: f64| distance.abs() < 0.006;
        let area = {
            let (end, side) = (x.min(length - x), (y - 0.5 * width).abs());
            (near(end - 0.225) && side < 0.5) || (near(side - 0.5) && end < 0.225)
        };
        if near(x - 0.5 * length) || near(from_middle - 0.125) || area { WHITE } else { GRASS }
    });
    world.floor_texture = Some(grass);
    world
}

/// A field for swarms (sections 5.2 and 5.3): open, with a blue wall at its far end.
fn field() -> World {
    let mut world = World::empty(7.0, 3.0);
    world.walls.push(wall([7.0, 0.0], [7.0, 3.0], BLUE));
    world
}

/// A board of eight by eight squares.
fn chess() -> World {
    /// Size of a square of the chequered floor (m).
    const SQUARE: f64 = 0.3;
    let side = 8.0 * SQUARE;
    let mut world = World::walled(side, side);
    let board = painted("Chess.png", (side, side), |x, y| {
        let dark = ((x / SQUARE) as u32 + (y / SQUARE) as u32).is_multiple_of(2);
        if dark { Colour::from_hex(0x40_30_28) } else { Colour::from_hex(0xe8_dc_c0) }
    });
    world.floor_texture = Some(board);
    world
}

/// The model town's loop (section 13.2), for clockwise driving on the left.
fn carolo() -> World {
    /// Length of its side (m).
    const SIDE: f64 = 3.1;
    let corners =
        [(0.33, 0.45), (0.33, 2.60), (2.72, 2.60), (2.72, 1.95), (2.40, 1.55), (2.72, 1.15), (2.72, 0.45)];
    let pixels = 620;
    let road = Road::around(&corners.map(|(x, y)| Point::new(x, y)), pixels, SIDE / pixels as f64);
    let mut world = World::empty(SIDE, SIDE);
    let image = RgbaImage::from_fn(pixels as u32, pixels as u32, |column, row| {
        let Colour { red, green, blue } = road.colour(column as usize, row as usize);
        Rgba([red, green, blue, 255])
    });
    world.floor_texture = Some(Texture::new("Carolo.png", image));
    world
}

/// A room with obstacles between its corners (section 10.2).
fn obstacles() -> World {
    let mut world = World::walled(5.0, 5.0);
    let boxes: [[f64; 4]; 4] =
        [[1.0, 1.2, 2.0, 1.8], [2.6, 2.2, 3.2, 3.6], [0.8, 3.0, 1.6, 3.4], [3.4, 0.8, 4.2, 1.6]];
    for [left, near, right, far] in boxes {
        let corners = [(left, near), (right, near), (right, far), (left, far)];
        world.add_loop(&corners.map(|(x, y)| Point::new(x, y)));
    }
    world
        .walls
        .push(Wall { line: Segment::new(Point::new(3.6, 4.0), Point::new(4.3, 3.3)), ..world.walls[0] });
    world
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_a_world() {
        for name in World::PREDEFINED {
            let world = World::predefined(&name.to_uppercase()).unwrap();
            let size = world.floor.size();
            assert!(size.x > 1.0 && size.y > 1.0, "{name}");
            assert!(world.floor_texture.is_none_or(|texture| texture.image.is_some()), "{name}");
        }
        assert_eq!(World::predefined("Atlantis"), None);
    }

    #[test]
    fn mazes_read_without_warnings_and_have_the_scripts_letters() {
        for (text, letters) in [(RECTANGLE, ""), (SMALL, "s"), (BOTS16, "a"), (BOTS4X4, "abcd")] {
            let parsed = maz::parse(text, "built-in.maz").unwrap();
            assert_eq!(parsed.warnings, []);
            let mut found: Vec<char> =
                parsed.value.places.iter().map(|place| place.letter.to_ascii_lowercase()).collect();
            found.sort_unstable();
            found.dedup();
            assert_eq!(found.into_iter().collect::<String>(), letters);
        }
    }
}
