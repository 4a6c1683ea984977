use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::drive::outline::Outline;
use crate::geometry::{Aabb, Point, Pose, math, normalize_angle};

/// A car that manoeuvres, in the frame of the middle of its rear axle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Car {
    /// Ends of the body along x, and half of its width (m).
    pub(super) body: (f64, f64),
    pub(super) half_width: f64,
    /// Distance between the axles, and half of that between the wheels of each (m).
    pub(super) wheels: (f64, f64),
    /// Greatest curvature of its path (1/m).
    pub(super) curvature: f64,
}

/// Where a car may go, and where it has to arrive, in the plane of the lane.
#[derive(Debug, Clone)]
pub(super) struct Room {
    /// What it must not touch.
    pub(super) obstacles: Vec<Outline>,
    /// Area in which it stays with its whole body.
    pub(super) free: Aabb,
    /// Area in which it arrives with all wheels, in a direction within a tolerance (rad).
    pub(super) goal: Aabb,
    pub(super) direction: f64,
    pub(super) tolerance: f64,
}

/// A part of a path: length, negative in reverse (m), and curvature (1/m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stretch {
    pub(super) length: f64,
    pub(super) curvature: f64,
}

/// Length of a step of the search (m).
const STEP: f64 = 0.04;
/// Size of a cell of the search (m).
const CELL: f64 = 0.025;
/// Number of directions of the search in a full turn.
const DIRECTIONS: usize = 96;
/// Cost of a change between forward and reverse, in metres: gears and brakes take time.
const CHANGE: f64 = 0.25;
/// Cost of a step beside a straight line, relative to its length: the car's path is less certain in bends.
const BEND: f64 = 1.1;
/// Largest number of steps examined.
const MOST: usize = 300_000;

/// A step of the search.
#[derive(Debug, Clone, Copy)]
struct Node {
    pose: Pose,
    stretch: Stretch,
    before: usize,
    cost: f64,
}

/// Entry of the queue, cheapest first; equal costs in the order of the nodes.
#[derive(Debug, PartialEq)]
struct Entry(f64, usize);

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        other.0.total_cmp(&self.0).then(other.1.cmp(&self.1))
    }
}

/// Pose at the end of a stretch.
pub(super) fn driven(pose: &Pose, stretch: Stretch) -> Pose {
    let Stretch { length, curvature } = stretch;
    let turn = length * curvature;
    let chord = if turn.abs() > 1e-9 { 2.0 * math::sin(0.5 * turn) / curvature } else { length };
    let (sin, cos) = math::sin_cos(pose.heading + 0.5 * turn);
    Pose::new(pose.x + chord * cos, pose.y + chord * sin, normalize_angle(pose.heading + turn))
}

/// Shortest path by full locks and straights, forward and in reverse, from a pose to the room's goal: a
/// search in cells of position and direction (hybrid A*; D. Dolgov et al., "Path planning for autonomous
/// vehicles in unknown semi-structured environments", 2010). `None` if there is none.
pub(super) fn search(car: &Car, room: &Room, start: Pose) -> Option<Vec<Stretch>> {
    let mut cells = Cells::new(&room.free);
    let still = Stretch { length: 0.0, curvature: 0.0 };
    let mut nodes = vec![Node { pose: start, stretch: still, before: 0, cost: 0.0 }];
    let mut queue = BinaryHeap::from([Entry(0.0, 0)]);
    while let Some(Entry(_, index)) = queue.pop() {
        let node = nodes[index];
        if !cells.visit(&node) {
            continue;
        }
        if room.is_parked(car, &node.pose) {
            return Some(path(&nodes, index));
        }
        if nodes.len() > MOST {
            break;
        }
        for length in [STEP, -STEP] {
            for side in [0.0, 1.0, -1.0] {
                let stretch = Stretch { length, curvature: side * car.curvature };
                let pose = driven(&node.pose, stretch);
                let changes = node.stretch.length * length < 0.0;
                let cost = node.cost
                    + STEP * if side == 0.0 { 1.0 } else { BEND }
                    + if changes { CHANGE } else { 0.0 };
                let next = Node { pose, stretch, before: index, cost };
                if !cells.is_visited(&next) && room.is_free(car, &pose) {
                    queue.push(Entry(cost + room.left(car, &pose), nodes.len()));
                    nodes.push(next);
                }
            }
        }
    }
    None
}

/// Stretches from the first node to another one, equal neighbours joined.
fn path(nodes: &[Node], mut index: usize) -> Vec<Stretch> {
    let mut path: Vec<Stretch> = Vec::new();
    while index != 0 {
        let Stretch { length, curvature } = nodes[index].stretch;
        match path.last_mut() {
            Some(next) if next.curvature == curvature && next.length * length > 0.0 => next.length += length,
            _ => path.push(Stretch { length, curvature }),
        }
        index = nodes[index].before;
    }
    path.reverse();
    path
}

impl Room {
    fn is_free(&self, car: &Car, pose: &Pose) -> bool {
        let outline = Outline::new(pose, car.body, car.half_width);
        outline.corners.iter().all(|corner| self.free.contains(*corner))
            && self.obstacles.iter().all(|obstacle| !outline.touches(obstacle))
    }

    /// Lower bound of the distance to the goal: the straight way of the wheels' middle, or the arc to turn
    /// (m).
    fn left(&self, car: &Car, pose: &Pose) -> f64 {
        let middle = pose.to_world(Point::new(0.5 * car.wheels.0, 0.0));
        let goal = nalgebra::center(&self.goal.min, &self.goal.max);
        let room = 0.5 * (self.goal.max - self.goal.min).norm();
        let turn = normalize_angle(pose.heading - self.direction).abs() - self.tolerance;
        f64::max((goal - middle).norm() - room, turn / car.curvature).max(0.0)
    }

    /// Whether a car at a pose is where it has to be.
    pub(super) fn is_parked(&self, car: &Car, pose: &Pose) -> bool {
        let off = normalize_angle(pose.heading - self.direction).abs();
        let wheels = Outline::new(pose, (0.0, car.wheels.0), car.wheels.1);
        off <= self.tolerance && wheels.corners.iter().all(|wheel| self.goal.contains(*wheel))
    }
}

/// The cells that have been visited, once in each gear.
struct Cells {
    corner: Point,
    columns: usize,
    rows: usize,
    visited: Vec<bool>,
}

impl Cells {
    fn new(free: &Aabb) -> Self {
        let size = free.size();
        let (columns, rows) = ((size.x / CELL) as usize + 1, (size.y / CELL) as usize + 1);
        Self { corner: free.min, columns, rows, visited: vec![false; 2 * columns * rows * DIRECTIONS] }
    }

    /// Marks a node's cell. Returns whether it is new.
    fn visit(&mut self, node: &Node) -> bool {
        let cell = self.cell(node);
        !std::mem::replace(&mut self.visited[cell], true)
    }

    fn is_visited(&self, node: &Node) -> bool {
        self.visited[self.cell(node)]
    }

    fn cell(&self, node: &Node) -> usize {
        let place = (node.pose.position() - self.corner) / CELL;
        let (column, row) = (place.x.max(0.0) as usize, place.y.max(0.0) as usize);
        let turn = node.pose.heading.rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU;
        let direction = (turn * DIRECTIONS as f64) as usize % DIRECTIONS;
        let gear = usize::from(node.stretch.length < 0.0);
        let row = (gear * DIRECTIONS + direction) * self.rows + row.min(self.rows - 1);
        row * self.columns + column.min(self.columns - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAR: Car = Car { body: (-0.08, 0.35), half_width: 0.095, wheels: (0.26, 0.0825), curvature: 1.8 };

    fn wall(from: (f64, f64), to: (f64, f64)) -> Outline {
        let middle = Pose::new(0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1), 0.0);
        let half = 0.5 * (to.0 - from.0);
        Outline::new(&middle, (-half, half), 0.5 * (to.1 - from.1))
    }

    /// A gap of 1.4 lengths of the car between two boxes to the right of its lane.
    fn gap(long: f64) -> Room {
        Room {
            obstacles: vec![wall((-0.4, -0.5), (0.0, -0.25)), wall((long, -0.5), (long + 0.4, -0.25))],
            free: Aabb::new(Point::new(-1.0, -0.51), Point::new(1.8, 0.5)),
            goal: Aabb::new(Point::new(0.0, -0.51), Point::new(long, -0.22)),
            direction: 0.0,
            tolerance: 0.1,
        }
    }

    #[test]
    fn a_short_gap_is_entered_in_reverse_and_without_contact() {
        let room = gap(0.602);
        let mut pose = Pose::new(0.7, 0.0, 0.0);
        let path = search(&CAR, &room, pose).unwrap();
        assert!(path[..2].iter().any(|stretch| stretch.length < 0.0), "{path:?}");
        for stretch in &path {
            for part in 1..=20 {
                let length = stretch.length * f64::from(part) / 20.0;
                assert!(room.is_free(&CAR, &driven(&pose, Stretch { length, ..*stretch })));
            }
            pose = driven(&pose, *stretch);
        }
        assert!(room.is_parked(&CAR, &pose), "{pose:?}");
    }

    #[test]
    fn no_path_leads_into_a_gap_that_is_too_short() {
        assert_eq!(search(&CAR, &gap(0.40), Pose::new(0.7, 0.0, 0.0)), None);
    }
}
