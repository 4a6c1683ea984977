//! Ray casting in the known part of a maze.

use crate::geometry::units::NEGLIGIBLE;
use crate::geometry::{Point, Vector};
use crate::maze::{Cell, Direction, Maze, Scale, WallState};

/// A line of walls crossed by a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossing {
    /// Distance from the origin of the ray to the near face of the walls (m).
    pub(super) distance: f64,
    /// Whether the walls run along y.
    pub(super) upright: bool,
    /// Index of the line, from the left or from below.
    pub(super) line: i64,
    /// Position of the crossing along the walls (m).
    pub(super) along: f64,
    /// State of the wall there.
    pub(super) wall: WallState,
    /// Position of the nearest corner along the walls (m); `beyond` is the wall on its other side.
    pub(super) corner: f64,
    pub(super) beyond: WallState,
}

impl Crossing {
    /// Distance along the walls to the nearest corner (m).
    pub(super) fn corner_distance(&self) -> f64 {
        (self.along - self.corner).abs()
    }
}

/// Lines of walls crossed by a ray, nearest first.
#[derive(Debug, Clone)]
pub(super) struct Crossings<'a> {
    maze: &'a Maze,
    scale: Scale,
    origin: Point,
    direction: Vector,
    /// Next line of walls in x and in y.
    lines: [i64; 2],
}

impl<'a> Crossings<'a> {
    pub(super) fn new(maze: &'a Maze, scale: Scale, origin: Point, direction: Vector) -> Self {
        let half = 0.5 * scale.wall;
        let lines = [0, 1].map(|axis| {
            let place = origin[axis];
            if direction[axis] > 0.0 {
                ((place + half) / scale.cell).floor() as i64 + 1
            } else {
                ((place - half) / scale.cell).ceil() as i64 - 1
            }
        });
        Self { maze, scale, origin, direction, lines }
    }

    /// Distance to the next line in x or y (m).
    fn distance(&self, axis: usize) -> f64 {
        let speed = self.direction[axis];
        if speed.abs() < NEGLIGIBLE {
            return f64::INFINITY;
        }
        let face = self.lines[axis] as f64 * self.scale.cell - 0.5 * self.scale.wall * speed.signum();
        (face - self.origin[axis]) / speed
    }

    /// The wall of a line at a position; `None` outside the maze.
    fn wall(&self, axis: usize, line: i64, place: i64) -> Option<WallState> {
        let sides = [self.maze.width() as i64, self.maze.height() as i64];
        if !(0..=sides[axis]).contains(&line) || !(0..sides[1 - axis]).contains(&place) {
            return None;
        }
        let last = line == sides[axis];
        let row = line - i64::from(last);
        let (cell, side) = if axis == 0 {
            (Cell::new(row as u16, place as u16), if last { Direction::East } else { Direction::West })
        } else {
            (Cell::new(place as u16, row as u16), if last { Direction::North } else { Direction::South })
        };
        Some(self.maze.wall(cell, side))
    }
}

impl Iterator for Crossings<'_> {
    type Item = Crossing;

    fn next(&mut self) -> Option<Crossing> {
        let axis = usize::from(self.distance(1) < self.distance(0));
        let distance = self.distance(axis);
        if !distance.is_finite() {
            return None;
        }
        let line = self.lines[axis];
        self.lines[axis] += if self.direction[axis] > 0.0 { 1 } else { -1 };
        let along = self.origin[1 - axis] + distance * self.direction[1 - axis];
        let place = (along / self.scale.cell).floor();
        let wall = self.wall(axis, line, place as i64)?;
        let upper = along - place * self.scale.cell > 0.5 * self.scale.cell;
        let (corner, other) = if upper { (place + 1.0, place as i64 + 1) } else { (place, place as i64 - 1) };
        Some(Crossing {
            distance,
            upright: axis == 0,
            line,
            along,
            wall,
            corner: corner * self.scale.cell,
            beyond: self.wall(axis, line, other).unwrap_or(WallState::Absent),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::direction;
    use crate::maze::generate::mazes;
    use crate::world::space::Space;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn a_ray_meets_the_wall_that_stands_in_the_world(
            maze in mazes(6), x in 0.1..0.9f64, y in 0.1..0.9f64, angle in -3.1..3.1f64, seed in any::<u64>(),
        ) {
            let scale = Scale::MICROMOUSE;
            let cell = maze.cell_at(seed as usize % maze.cell_count());
            let corner = scale.centre(cell) - Vector::new(0.5, 0.5) * scale.cell;
            let origin = corner + Vector::new(x, y) * scale.cell;
            let toward = direction(angle);
            let space = Space::new(&scale.world(&maze).walls);
            let truth = space.cast_ray(origin, toward, 0.02, 3.0, None);
            let stands = |crossing: &Crossing| crossing.wall == WallState::Present;
            let met = Crossings::new(&maze, scale, origin, toward).find(stands);
            // Close to corners, the ray may hit the end of a wall or a bare post.
            let mut passed = Crossings::new(&maze, scale, origin, toward);
            let grazes = passed.any(|c| c.distance < truth + 0.02 && c.corner_distance() < 0.03);
            if let Some(met) = met.filter(|met| met.distance < 2.9 && !grazes) {
                prop_assert!((met.distance - truth).abs() < 1e-9, "{met:?} {truth}");
            }
        }
    }

    #[test]
    fn corners_and_their_other_side() {
        let mut maze = Maze::open(3, 3).unwrap();
        maze.set_wall(Cell::new(1, 1), Direction::East, WallState::Present);
        let scale = Scale::MICROMOUSE;
        let origin = Point::new(0.27, 0.34);
        let met = Crossings::new(&maze, scale, origin, Vector::new(1.0, 0.0)).next().unwrap();
        assert!((met.distance - (0.36 - 0.006 - 0.27)).abs() < 1e-12 && met.upright);
        assert_eq!((met.wall, met.beyond), (WallState::Present, WallState::Absent));
        assert!((met.corner - 0.36).abs() < 1e-12 && (met.corner_distance() - 0.02).abs() < 1e-12);
    }
}
