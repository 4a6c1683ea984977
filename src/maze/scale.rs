use super::{Cell, Direction, Maze, WallState};
use crate::geometry::{Point, Pose, Segment};
use crate::world::{self, World};

/// Dimensions of a physical maze.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Cell size (m).
    pub cell: f64,
    /// Thickness of the walls, and width of the posts (m).
    pub wall: f64,
    /// Height of the walls (m).
    pub height: f64,
}

impl Scale {
    /// Competition standard (book, section 9.1): cells of 18 cm, walls 12 mm thick and 5 cm high.
    pub const MICROMOUSE: Self = Self { cell: 0.180, wall: 0.012, height: 0.050 };

    /// The book's maze for larger robots, twice as large; the walls are high enough for their sensors.
    pub const DOUBLED: Self = Self { cell: 0.360, wall: 0.024, height: 0.100 };

    /// Centre of a cell (m); the origin is the lower left corner of the maze.
    pub fn centre(&self, cell: Cell) -> Point {
        Point::new((f64::from(cell.x) + 0.5) * self.cell, (f64::from(cell.y) + 0.5) * self.cell)
    }

    /// Centre of a cell with a heading.
    pub fn pose(&self, cell: Cell, heading: Direction) -> Pose {
        let centre = self.centre(cell);
        Pose::new(centre.x, centre.y, heading.heading())
    }

    /// Cell of a point; `None` outside the maze.
    pub fn cell_of(&self, maze: &Maze, point: Point) -> Option<Cell> {
        let index = |coordinate: f64| (coordinate / self.cell).floor();
        let (x, y) = (index(point.x), index(point.y));
        let inside = x >= 0.0 && y >= 0.0 && x < maze.width() as f64 && y < maze.height() as f64;
        inside.then(|| Cell::new(x as u16, y as u16))
    }

    /// The world of a maze: one wall per straight stretch, and a post at every corner. Unknown walls count as
    /// present.
    pub fn world(&self, maze: &Maze) -> World {
        let (width, height) = (maze.width(), maze.height());
        let mut world = World::empty(width as f64 * self.cell, height as f64 * self.cell);
        let (right, top) = (width as u16 - 1, height as u16 - 1);
        for y in 0..=height {
            let (row, side) = if y < height { (y as u16, Direction::South) } else { (top, Direction::North) };
            let stands = |x: usize| maze.wall(Cell::new(x as u16, row), side) != WallState::Absent;
            for (a, b) in stretches(width, stands) {
                world.walls.push(self.stretch(self.corner(a, y), self.corner(b, y)));
            }
        }
        for x in 0..=width {
            let (column, side) =
                if x < width { (x as u16, Direction::West) } else { (right, Direction::East) };
            let stands = |y: usize| maze.wall(Cell::new(column, y as u16), side) != WallState::Absent;
            for (a, b) in stretches(height, stands) {
                world.walls.push(self.stretch(self.corner(x, a), self.corner(x, b)));
            }
        }
        for (x, y) in bare_posts(maze) {
            let post = self.corner(x, y);
            world.walls.push(self.stretch(post, post));
        }
        let start = self.pose(maze.start(), maze.heading());
        world.start = Some(start);
        world
    }

    fn corner(&self, x: usize, y: usize) -> Point {
        Point::new(x as f64 * self.cell, y as f64 * self.cell)
    }

    /// A wall from post to post, both included.
    fn stretch(&self, a: Point, b: Point) -> world::Wall {
        let along = if a.x == b.x && a.y != b.y { Point::new(0.0, 1.0) } else { Point::new(1.0, 0.0) };
        let half = along.coords * (0.5 * self.wall);
        world::Wall {
            line: Segment::new(a - half, b + half),
            thickness: self.wall,
            height: self.height,
            colour: world::Wall::DEFAULT_COLOUR,
        }
    }
}

/// Maximal ranges `a..b` of `0..count` in which a condition holds.
fn stretches(count: usize, holds: impl Fn(usize) -> bool) -> Vec<(usize, usize)> {
    let mut list = Vec::new();
    let mut first = None;
    for i in 0..=count {
        match (first, i < count && holds(i)) {
            (None, true) => first = Some(i),
            (Some(a), false) => {
                list.push((a, i));
                first = None;
            }
            _ => {}
        }
    }
    list
}

/// Corners without walls.
fn bare_posts(maze: &Maze) -> impl Iterator<Item = (usize, usize)> + '_ {
    let corners = (0..=maze.height()).flat_map(|y| (0..=maze.width()).map(move |x| (x, y)));
    corners.filter(|&(x, y)| {
        let cells = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| {
            let (x, y) = (x.checked_sub(dx)?, y.checked_sub(dy)?);
            Some(Cell::new(x as u16, y as u16)).filter(|&cell| maze.contains(cell))
        });
        let sides = [
            [Direction::West, Direction::South],
            [Direction::East, Direction::South],
            [Direction::West, Direction::North],
            [Direction::East, Direction::North],
        ];
        let stands = |cell: Cell, side| maze.wall(cell, side) != WallState::Absent;
        let walls = cells.iter().zip(sides).filter_map(|(cell, sides)| Some(((*cell)?, sides)));
        !walls.into_iter().any(|(cell, sides)| sides.into_iter().any(|side| stands(cell, side)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_in_line_are_one_and_bare_posts_stand() {
        let world = Scale::MICROMOUSE.world(&Maze::open(2, 2).unwrap());
        assert_eq!(world.walls.len(), 5);
        let post = world.walls[4];
        assert!((post.line.length() - 0.012).abs() < 1e-12);
        assert!((post.line.a.x - 0.174).abs() < 1e-12 && (post.line.a.y - 0.18).abs() < 1e-12);
        assert!((world.walls[0].line.length() - 0.372).abs() < 1e-12);
    }

    #[test]
    fn a_cell_is_found_from_its_centre() {
        let maze = Maze::open(7, 5).unwrap();
        for cell in maze.cells() {
            assert_eq!(Scale::DOUBLED.cell_of(&maze, Scale::DOUBLED.centre(cell)), Some(cell));
        }
        assert_eq!(Scale::DOUBLED.cell_of(&maze, Point::new(-0.1, 0.1)), None);
        assert_eq!(Scale::DOUBLED.cell_of(&maze, Point::new(0.1, 5.0 * 0.36 + 0.01)), None);
    }
}
