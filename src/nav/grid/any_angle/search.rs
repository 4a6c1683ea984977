use super::field::{Corner, Field, HalfPoint};
use super::scan::{Scanner, Side};
use super::sight::in_sight;
use crate::geometry::Point;
use crate::nav::grid::components::GridComponents;
use crate::nav::grid::cost::{fixed, limit};
use crate::nav::grid::path::{GridPath, GridPlanner, PlanError, SearchStatistics, check};
use crate::nav::grid::queue::BucketQueue;
use crate::world::{BitGrid, GridCell};

/// The shortest any-angle paths: straight from corner to corner of the blocked cells.
///
/// Paths run from the centre of one cell to the centre of another. They may touch corners and run along
/// walls, but do not pass between two blocked cells that touch at a corner.
///
/// Visibility from a point is found as in Anya, in integers: cones of sight are clipped by the free cells of
/// one row after the other, and only corners that can bend a shortest path count. The corners visible from a
/// corner are computed when a search first gets there, and kept up to 192 MB; [`AnyAngle::prepare`] does so
/// for all of them. The search is A\* over corners, and continues from each only in the directions that bend
/// the path around its blocked cell.
///
/// D. Harabor, A. Grastien, D. Öz, V. Aksakalli, *Optimal Any-Angle Pathfinding in Practice*, Journal of
/// Artificial Intelligence Research 56, 2016; S. Oh, H. W. Leong, *Edge N-Level Sparse Visibility Graphs*,
/// Symposium on Combinatorial Search 2017 (taut paths).
///
/// ```
/// use roverlab::nav::grid::{AnyAngle, GridPlanner};
/// use roverlab::world::{BitGrid, GridCell};
/// let grid = BitGrid::from_text("....\n.##.\n....")?;
/// let path = AnyAngle::new(&grid).plan(GridCell::new(0, 1), GridCell::new(3, 1)).unwrap();
/// // Via the corners (1, 1) and (3, 1).
/// assert!((path.cost - (2.0 + 2.0 * 0.5f64.sqrt())).abs() < 1e-12);
/// # Ok::<(), roverlab::world::BitGridError>(())
/// ```
#[derive(Debug, Clone)]
pub struct AnyAngle {
    grid: BitGrid,
    components: GridComponents,
    field: Field,
    corners: Vec<Corner>,
    views: Vec<View>,
    /// Corners visible from the corners scanned so far.
    seen: Vec<Seen>,
    scanner: Scanner,
    labels: Vec<Label>,
    query: u32,
    queue: BucketQueue,
}

/// Range of a corner's visible corners in the list: first those to the right, or straight ahead where it
/// bends paths from the left; then the rest. A start of [`UNKNOWN`] marks a corner not yet scanned.
#[derive(Debug, Clone, Copy)]
struct View {
    first: u32,
    middle: u32,
    end: u32,
}

/// Start of a view that has not been determined.
const UNKNOWN: u32 = u32::MAX;
const NOT_SCANNED: View = View { first: UNKNOWN, middle: 0, end: 0 };

#[derive(Debug, Clone, Copy)]
struct Seen {
    corner: u32,
    x: i32,
    y: i32,
}

/// Number of visible corners, 12 bytes each, at which preparation ends: on a large lattice they would take
/// gigabytes.
const MOST_PREPARED: usize = 8_000_000;
/// Number of visible corners at which all are forgotten.
const MOST_SEEN: usize = 2 * MOST_PREPARED;
/// Number of cones of sight at which preparation ends.
const MOST_CONES: u64 = 16_000_000;

/// Search state of a corner.
#[derive(Debug, Clone, Copy, Default)]
struct Label {
    cost: f64,
    parent: u32,
    query: u32,
    /// The last query for which the goal was in sight.
    sees_goal: u32,
}

/// The parent of corners in sight of the start.
const START: u32 = u32::MAX;

/// State of one query.
struct Query {
    start: HalfPoint,
    goal: HalfPoint,
    best: f64,
    last: u32,
    statistics: SearchStatistics,
}

impl AnyAngle {
    /// Creates a planner for a grid.
    pub fn new(grid: &BitGrid) -> Self {
        let field = Field::new(grid);
        let corners = field.all_corners();
        Self {
            grid: grid.clone(),
            components: GridComponents::new(grid),
            views: vec![NOT_SCANNED; corners.len()],
            labels: vec![Label::default(); corners.len()],
            field,
            corners,
            seen: Vec::new(),
            scanner: Scanner::default(),
            query: 0,
            queue: BucketQueue::default(),
        }
    }

    /// Computes the visibility of every corner, which makes first queries as fast as later ones. Stops at 96
    /// MB and after about two seconds, as large open floors with many single obstacles need far more. Returns
    /// whether all corners are prepared; the others follow when a search first gets there.
    pub fn prepare(&mut self) -> bool {
        let last = self.scanner.passed + MOST_CONES;
        for corner in 0..self.corners.len() as u32 {
            if self.seen.len() > MOST_PREPARED || self.scanner.passed > last {
                return false;
            }
            self.look(corner);
        }
        true
    }

    /// Number of corners of the map.
    pub fn corners(&self) -> usize {
        self.corners.len()
    }

    /// Whether the centres of two cells are in sight of each other.
    pub fn in_sight(&self, a: GridCell, b: GridCell) -> bool {
        self.grid.is_free(a)
            && self.grid.is_free(b)
            && in_sight(&self.field, HalfPoint::centre(a), HalfPoint::centre(b))
    }

    /// Whether two points, in units of cells, are in sight of each other. Both must be centres or corners of
    /// cells, as in the planners' paths; otherwise the answer is `false`.
    pub fn points_in_sight(&self, a: Point, b: Point) -> bool {
        match (self.half_point(a), self.half_point(b)) {
            (Some(a), Some(b)) => in_sight(&self.field, a, b),
            _ => false,
        }
    }

    fn half_point(&self, point: Point) -> Option<HalfPoint> {
        let (x, y) = (2.0 * point.x, 2.0 * point.y);
        let is_within = |v: f64, cells: usize| v.fract() == 0.0 && v >= 0.0 && v <= 2.0 * cells as f64;
        let is_point = is_within(x, self.grid.width()) && is_within(y, self.grid.height());
        (is_point && (x - y) % 2.0 == 0.0).then_some(HalfPoint { x: x as i32, y: y as i32 })
    }

    /// The corners visible from a corner.
    fn look(&mut self, number: u32) -> View {
        let view = self.views[number as usize];
        if view.first != UNKNOWN {
            return view;
        }
        if self.seen.len() > MOST_SEEN {
            self.seen.clear();
            self.views.fill(NOT_SCANNED);
        }
        let Self { field, scanner, seen, corners, .. } = self;
        let corner = corners[number as usize];
        let (from, falling) = (HalfPoint::corner(corner.x, corner.y), corner.is_falling());
        let first = seen.len() as u32;
        let mut add = |x, y| seen.push(Seen { corner: field.number(x, y), x, y });
        scanner.half(field, from, !falling, Side::Right, &mut add);
        field.along_right(corner.x, corner.y).into_iter().for_each(|x| add(x, corner.y));
        let middle = seen.len() as u32;
        let mut add = |x, y| seen.push(Seen { corner: field.number(x, y), x, y });
        scanner.half(field, from, falling, Side::Left, &mut add);
        field.along_left(corner.x, corner.y).into_iter().for_each(|x| add(x, corner.y));
        let view = View { first, middle, end: seen.len() as u32 };
        self.views[number as usize] = view;
        view
    }

    fn begin(&mut self) {
        if self.query == u32::MAX {
            self.labels.fill(Label::default());
            self.query = 0;
        }
        self.query += 1;
    }

    /// Finds a path that is known to exist and to turn.
    fn search(&mut self, query: &mut Query) {
        self.begin();
        let mut near = Vec::new();
        for down in [false, true] {
            let Self { field, scanner, labels, .. } = self;
            scanner.half(field, query.goal, down, Side::Both, |x, y| {
                labels[field.number(x, y) as usize].sees_goal = self.query;
            });
            scanner.half(field, query.start, down, Side::Both, |x, y| {
                near.push(Seen { corner: field.number(x, y), x, y });
            });
        }
        self.queue.start(fixed(distance(query.start, query.goal)));
        for &seen in &near {
            self.reach(query, seen, distance(query.start, HalfPoint::corner(seen.x, seen.y)), START);
        }
        while let Some((corner, bits)) = self.queue.pop_below(limit(query.best)) {
            let label = self.labels[corner as usize];
            let at = self.corners[corner as usize];
            let point = HalfPoint::corner(at.x, at.y);
            if label.cost.to_bits() != bits || label.cost + distance(point, query.goal) >= query.best {
                continue;
            }
            query.statistics.expanded += 1;
            self.expand(query, corner, at, label);
        }
    }

    /// Continues from a corner in the directions that bend the path around its blocked cell.
    fn expand(&mut self, query: &mut Query, number: u32, at: Corner, label: Label) {
        let before = match label.parent {
            START => query.start,
            parent => HalfPoint::corner(self.corners[parent as usize].x, self.corners[parent as usize].y),
        };
        let point = HalfPoint::corner(at.x, at.y);
        let way = (i64::from(point.x - before.x), i64::from(point.y - before.y));
        let inwards = cross(way, (i64::from(at.blocked.0), i64::from(at.blocked.1))).signum();
        let vertical_is_right = (way.1 < 0) == at.is_falling();
        let view = self.look(number);
        let range = if way.0 > 0 || (way.0 == 0 && vertical_is_right) {
            view.first..view.middle
        } else {
            view.middle..view.end
        };
        for index in range {
            let seen = self.seen[index as usize];
            let onward = (i64::from(seen.x - at.x), i64::from(seen.y - at.y));
            if cross(way, onward) * inwards >= 0 {
                let step = distance(point, HalfPoint::corner(seen.x, seen.y));
                self.reach(query, seen, label.cost + step, number);
            }
        }
    }

    fn reach(&mut self, query: &mut Query, seen: Seen, cost: f64, parent: u32) {
        let label = &mut self.labels[seen.corner as usize];
        if label.query == self.query && label.cost <= cost {
            return;
        }
        let sum = cost + distance(HalfPoint::corner(seen.x, seen.y), query.goal);
        if sum >= query.best {
            return;
        }
        (label.cost, label.parent, label.query) = (cost, parent, self.query);
        if label.sees_goal == self.query {
            (query.best, query.last) = (sum, seen.corner);
        } else {
            query.statistics.generated += 1;
            self.queue.push(fixed(sum), seen.corner, cost.to_bits());
        }
    }

    /// The corners on the path, from the last one back.
    fn points(&self, start: GridCell, last: u32, goal: GridCell) -> Vec<Point> {
        let (mut points, mut corner) = (vec![goal.centre()], last);
        while corner != START {
            let at = self.corners[corner as usize];
            points.push(Point::new(f64::from(at.x), f64::from(at.y)));
            corner = self.labels[corner as usize].parent;
        }
        points.push(start.centre());
        points.reverse();
        points
    }
}

impl GridPlanner for AnyAngle {
    fn plan(&mut self, start: GridCell, goal: GridCell) -> Result<GridPath, PlanError> {
        check(&self.grid, &self.components, start, goal)?;
        let statistics = SearchStatistics { expanded: 1, generated: 1 };
        let (from, to) = (HalfPoint::centre(start), HalfPoint::centre(goal));
        let mut query = Query { start: from, goal: to, best: f64::INFINITY, last: START, statistics };
        if !in_sight(&self.field, from, to) {
            self.search(&mut query);
        }
        let points = self.points(start, query.last, goal);
        Ok(GridPath::along(points, query.statistics))
    }
}

/// Distance of two points in cells.
#[inline]
fn distance(a: HalfPoint, b: HalfPoint) -> f64 {
    let (dx, dy) = (f64::from(a.x - b.x), f64::from(a.y - b.y));
    0.5 * (dx * dx + dy * dy).sqrt()
}

#[inline]
fn cross(a: (i64, i64), b: (i64, i64)) -> i64 {
    a.0 * b.1 - a.1 * b.0
}
