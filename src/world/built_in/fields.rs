use image::{Rgba, RgbaImage};

use super::road::Road;
use crate::geometry::{Aabb, Point, Segment, math};
use crate::world::formats::maz;
use crate::world::{Colour, HeightField, Terrain, Texture, Wall, World};

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
    /// obstacles, rectangle, small, bots16, bots4x4, pool, crater, levels-steel.
    pub const PREDEFINED: [&'static str; 13] = [
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
        "pool",
        "crater",
        "levels-steel",
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
            "bots4x4" => maze(BOTS4X4),
            "pool" => pool(),
            "crater" => crater(),
            _ => levels(),
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

/// Hills from the height at each point, with samples every `pitch` metres.
fn hills(name: &str, (width, length): (f64, f64), pitch: f64, height: impl FnMut(Point) -> f64) -> World {
    let samples = |side: f64| (side / pitch).round() as usize + 1;
    let area = Aabb::new(Point::origin(), Point::new(width, length));
    let surface = HeightField::from_fn(samples(width), samples(length), area, height).ok();
    World { terrain: surface.map(|surface| Terrain::new(name, surface)), ..World::empty(width, length) }
}

/// The swimming pool of chapter 8, 25 m by 50 m, inside a rim. It is 1.5 m deep at its near end, and 1.9 m
/// from the middle on.
fn pool() -> World {
    let (width, length, water) = (25.0, 50.0, 1.9);
    let height = |at: Point| {
        let inside = at.x.min(width - at.x).min(at.y).min(length - at.y);
        if inside > 0.5 { 0.4 * (1.0 - 2.0 * at.y / length).max(0.0) } else { water + 0.1 }
    };
    World { water_level: Some(water), ..hills("pool.png", (width, length), 0.25, height) }
}

/// A ring around a lake (section 7.3). The land around it is above the water, and its outer flank the gentler
/// one.
fn crater() -> World {
    let height = |at: Point| {
        let off = math::hypot(at.x - 2.5, at.y - 2.5) - 1.3;
        let (land, width) = if off > 0.0 { (0.15, 0.7) } else { (0.0, 0.55) };
        land + (0.5 - land) * math::exp(-0.5 * (off / width) * (off / width))
    };
    World { water_level: Some(0.14), ..hills("crater.png", (5.0, 5.0), 0.02, height) }
}

/// A ramp up, a bank and a ramp back down beside it, inside a rim (section 7.3).
fn levels() -> World {
    let (side, top) = (4.0, 0.2);
    let height = |at: Point| {
        let inside = at.x.min(side - at.x).min(at.y).min(side - at.y);
        let on_ramp = (0.7..=1.3).contains(&at.y) || (2.0..=2.6).contains(&at.y);
        if inside < 0.12 || ((2.4..=3.1).contains(&at.x) && (0.7..=2.6).contains(&at.y)) {
            top
        } else if on_ramp && (1.6..2.4).contains(&at.x) {
            top * (at.x - 1.6) / 0.8
        } else {
            0.0
        }
    };
    hills("levels-steel.png", (side, side), 0.02, height)
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
    fn worlds_with_hills_are_as_the_books_scripts_need_them() {
        let ground = |world: &World, x, y| {
            let surface = world.terrain.as_ref().and_then(|terrain| terrain.surface.clone());
            surface.unwrap().height(Point::new(x, y)).unwrap()
        };
        let pool = World::predefined("pool").unwrap();
        let depth = |x, y| pool.water_level.unwrap() - ground(&pool, x, y);
        assert!((depth(12.5, 40.0) - 1.9).abs() < 1e-6 && (1.4..1.6).contains(&depth(12.5, 2.0)));
        assert!(depth(0.1, 25.0) < 0.0, "its rim is above the water");
        let crater = World::predefined("crater").unwrap();
        let above = |x, y| ground(&crater, x, y) - crater.water_level.unwrap();
        assert!(above(2.5, 2.5) < -0.05 && above(2.5, 3.8) > 0.3);
        assert!(above(0.4, 0.4) > 0.0 && above(5.0, 0.0) > 0.0, "only the hollow is under water");
        let levels = World::predefined("levels-steel").unwrap();
        assert!(ground(&levels, 1.0, 1.0) < 1e-6 && (ground(&levels, 2.7, 1.0) - 0.2).abs() < 1e-6);
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
