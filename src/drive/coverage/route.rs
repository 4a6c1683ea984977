use std::collections::BinaryHeap;

use super::CoverageMap;
use crate::geometry::Point;

/// Shortest paths of a robot's centre over the free cells, from one cell to others.
#[derive(Debug, Clone)]
pub(super) struct Routes {
    /// Predecessor of each cell on the path from the start.
    before: Vec<u32>,
    /// Path length to each cell (cells); infinite if unknown.
    lengths: Vec<f32>,
    /// Cells reached by the last search.
    touched: Vec<u32>,
    start: usize,
}

#[derive(PartialEq)]
struct Open(f32, u32);

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    /// Reversed for a min-heap.
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        other.0.total_cmp(&self.0).then(other.1.cmp(&self.1))
    }
}

impl Routes {
    /// No paths yet over a map.
    pub(super) fn new(map: &CoverageMap) -> Self {
        let cells = map.places.len();
        let (before, lengths) = (vec![u32::MAX; cells], vec![f32::INFINITY; cells]);
        Self { before, lengths, touched: Vec::new(), start: 0 }
    }

    /// Searches from a cell and returns the nearest cell accepted by `is_goal`.
    pub(super) fn search(
        &mut self,
        map: &CoverageMap,
        start: usize,
        mut is_goal: impl FnMut(usize) -> bool,
    ) -> Option<usize> {
        let columns = map.raster().columns() as i64;
        let cells = map.places.len();
        for cell in self.touched.drain(..) {
            self.before[cell as usize] = u32::MAX;
            self.lengths[cell as usize] = f32::INFINITY;
        }
        self.start = start;
        self.lengths[start] = 0.0;
        self.touched.push(start as u32);
        let mut open = BinaryHeap::from([Open(0.0, start as u32)]);
        while let Some(Open(length, cell)) = open.pop() {
            let here = cell as usize;
            if length > self.lengths[here] {
                continue;
            }
            if is_goal(here) {
                return Some(here);
            }
            for (x, y, step) in STEPS {
                let next = here as i64 + y * columns + x;
                // Free cells keep away from the raster's edge, so no step leaves it.
                let Some(next) = usize::try_from(next).ok().filter(|&next| next < cells && map.places[next])
                else {
                    continue;
                };
                if length + step < self.lengths[next] {
                    if self.lengths[next].is_infinite() {
                        self.touched.push(next as u32);
                    }
                    self.lengths[next] = length + step;
                    self.before[next] = cell;
                    open.push(Open(length + step, next as u32));
                }
            }
        }
        None
    }

    /// The path to a cell as few straight lines, both ends included.
    pub(super) fn to(&self, map: &CoverageMap, goal: usize) -> Vec<Point> {
        let mut cells = vec![goal];
        let mut cell = goal;
        while cell != self.start && self.before[cell] != u32::MAX {
            cell = self.before[cell] as usize;
            cells.push(cell);
        }
        cells.reverse();
        let points: Vec<Point> = cells.into_iter().map(|cell| map.raster().centre(cell)).collect();
        straightened(map, &points)
    }
}

/// Length of a diagonal step (cells).
const DIAGONAL: f32 = std::f32::consts::SQRT_2;
/// Steps to a cell's neighbours, as columns and rows, and their lengths (cells).
const STEPS: [(i64, i64, f32); 8] = [
    (1, 0, 1.0),
    (-1, 0, 1.0),
    (0, 1, 1.0),
    (0, -1, 1.0),
    (1, 1, DIAGONAL),
    (-1, 1, DIAGONAL),
    (1, -1, DIAGONAL),
    (-1, -1, DIAGONAL),
];

/// Whether the robot's centre may be anywhere along a line.
pub(super) fn is_free(map: &CoverageMap, from: Point, to: Point) -> bool {
    let steps = (2.0 * (to - from).norm() / map.raster().resolution()).ceil().max(1.0) as usize;
    (0..=steps).all(|step| map.is_place(from + (to - from) * (step as f64 / steps as f64)))
}

/// Removes the points of a path that straight lines can skip.
fn straightened(map: &CoverageMap, points: &[Point]) -> Vec<Point> {
    let Some(&first) = points.first() else { return Vec::new() };
    let mut line = vec![first];
    let mut from = 0;
    while from + 1 < points.len() {
        // Finds the farthest visible point by doubling steps.
        let (mut seen, mut step) = (from + 1, 1);
        while step > 0 {
            let next = (seen + step).min(points.len() - 1);
            if next > seen && is_free(map, points[from], points[next]) {
                seen = next;
                step *= 2;
            } else {
                step /= 2;
            }
        }
        line.push(points[seen]);
        from = seen;
    }
    line
}
