use proptest::prelude::*;

use super::field::{Field, HalfPoint};
use super::sight::in_sight;
use super::{AnyAngle, LazyThetaStar};
use crate::nav::grid::{GridPlanner, GridSearch, PlanError};
use crate::random::Stream;
use crate::world::{BitGrid, GridCell};

fn random_grid(width: usize, height: usize, share: f64, seed: u64) -> BitGrid {
    let mut stream = Stream::new(seed);
    BitGrid::from_fn(width, height, |_, _| stream.chance(share)).unwrap()
}

fn free(grid: &BitGrid, x: i32, y: i32) -> bool {
    x >= 0 && y >= 0 && grid.is_free(GridCell::new(x as usize, y as usize))
}

/// Whether the four cells around a point are blocked and free crosswise.
fn is_diagonal(grid: &BitGrid, x: i32, y: i32) -> bool {
    let (nw, ne, sw, se) =
        (free(grid, x - 1, y - 1), free(grid, x, y - 1), free(grid, x - 1, y), free(grid, x, y));
    nw == se && ne == sw && nw != ne
}

/// Whether a segment meets the interior of a blocked cell: part of it lies strictly between all four sides.
/// Coordinates in half cells; parameters along the segment as fractions.
fn enters(a: HalfPoint, b: HalfPoint, x: i32, y: i32) -> bool {
    let (mut from, mut to) = ((0i64, 1i64), (1i64, 1i64));
    for (start, end, low) in [(a.x, b.x, 2 * x), (a.y, b.y, 2 * y)] {
        let (start, d, low, high) =
            (i64::from(start), i64::from(end - start), i64::from(low), i64::from(low + 2));
        if d == 0 {
            if start <= low || start >= high {
                return false;
            }
            continue;
        }
        let (mut t0, mut t1) = ((low - start, d), (high - start, d));
        if d < 0 {
            (t0, t1) = ((start - high, -d), (start - low, -d));
        }
        if t0.0 * from.1 > from.0 * t0.1 {
            from = t0;
        }
        if t1.0 * to.1 < to.0 * t1.1 {
            to = t1;
        }
    }
    from.0 * to.1 < to.0 * from.1
}

/// Lines of sight by definition, cell by cell and point by point.
fn sees(grid: &BitGrid, a: HalfPoint, b: HalfPoint) -> bool {
    let (w, h) = (grid.width() as i32, grid.height() as i32);
    let blocked = (-1..=h).any(|y| (-1..=w).any(|x| !free(grid, x, y) && enters(a, b, x, y)));
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let squeezed = (0..=h).any(|y| {
        (0..=w).any(|x| {
            let (px, py) = (2 * x - a.x, 2 * y - a.y);
            let along = px * dx + py * dy;
            is_diagonal(grid, x, y) && px * dy == py * dx && along > 0 && along < dx * dx + dy * dy
        })
    });
    let walled_in = |first: i32, last: i32, sides: &dyn Fn(i32) -> bool| {
        (first.div_euclid(2)..(last + 1).div_euclid(2)).any(|cell| !sides(cell))
    };
    let between_walls = if dx == 0 && a.x % 2 == 0 {
        walled_in(a.y.min(b.y), a.y.max(b.y), &|y| free(grid, a.x / 2, y) || free(grid, a.x / 2 - 1, y))
    } else if dy == 0 && a.y % 2 == 0 {
        walled_in(a.x.min(b.x), a.x.max(b.x), &|x| free(grid, x, a.y / 2) || free(grid, x, a.y / 2 - 1))
    } else {
        false
    };
    !blocked && !squeezed && !between_walls
}

/// The shortest path over all grid points and the two ends, by lines of sight between all pairs.
fn truth(grid: &BitGrid, start: GridCell, goal: GridCell) -> f64 {
    let (w, h) = (grid.width() as i32, grid.height() as i32);
    let mut points = vec![HalfPoint::centre(start), HalfPoint::centre(goal)];
    let all = (0..=h).flat_map(|y| (0..=w).map(move |x| (x, y)));
    points.extend(all.filter(|&(x, y)| !is_diagonal(grid, x, y)).map(|(x, y)| HalfPoint::corner(x, y)));
    let mut costs = vec![f64::INFINITY; points.len()];
    let mut done = vec![false; points.len()];
    costs[0] = 0.0;
    while let Some(node) = (0..points.len())
        .filter(|&i| !done[i] && costs[i].is_finite())
        .min_by(|&a, &b| costs[a].total_cmp(&costs[b]))
    {
        done[node] = true;
        for next in 0..points.len() {
            let (a, b) = (points[node], points[next]);
            let step = 0.5 * f64::from((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y)).sqrt();
            if costs[node] + step < costs[next] && sees(grid, a, b) {
                costs[next] = costs[node] + step;
            }
        }
    }
    costs[1]
}

/// Every stretch of a path is a line of sight.
fn assert_sound(grid: &BitGrid, points: &[crate::geometry::Point]) {
    for pair in points.windows(2) {
        let [a, b] = [pair[0], pair[1]]
            .map(|p| HalfPoint { x: (2.0 * p.x).round() as i32, y: (2.0 * p.y).round() as i32 });
        assert!(sees(grid, a, b), "{a:?} to {b:?} on {grid:?}");
    }
}

proptest! {
    #![proptest_config(crate::testing::cases(400))]

    #[test]
    fn sight_is_as_defined(
        width in 1..12usize, height in 1..12usize, share in 0.4..0.95f64, seed in any::<u64>()
    ) {
        let grid = random_grid(width, height, share, seed);
        let field = Field::new(&grid);
        let mut stream = Stream::new(seed);
        for _ in 0..60 {
            let mut point = || HalfPoint { x: stream.below(2 * width + 1) as i32, y: stream.below(2 * height + 1) as i32 };
            let (a, b) = (point(), point());
            // Paths run between centres and corners of cells; midpoints of edges do not occur.
            let is_point = |p: HalfPoint| p.x % 2 == p.y % 2;
            if is_point(a) && is_point(b) && a != b {
                prop_assert_eq!(in_sight(&field, a, b), sees(&grid, a, b), "{:?} to {:?} on {:?}", a, b, grid);
            }
        }
    }

    #[test]
    fn paths_are_the_shortest(
        width in 1..9usize, height in 1..9usize, share in 0.5..0.95f64, seed in any::<u64>()
    ) {
        let grid = random_grid(width, height, share, seed);
        let cells: Vec<GridCell> = grid.free_cells().collect();
        prop_assume!(!cells.is_empty());
        let (mut lazily, mut prepared) = (AnyAngle::new(&grid), AnyAngle::new(&grid));
        prepared.prepare();
        let mut theta = LazyThetaStar::new(&grid);
        let mut octile = GridSearch::astar(&grid);
        let mut stream = Stream::new(seed);
        for _ in 0..3 {
            let (start, goal) = (cells[stream.below(cells.len())], cells[stream.below(cells.len())]);
            match lazily.plan(start, goal) {
                Ok(path) => {
                    let expected = truth(&grid, start, goal);
                    prop_assert!((path.cost - expected).abs() < 1e-9, "{} for {}, {} to {} on {:?}", path.cost, expected, start, goal, grid);
                    assert_sound(&grid, &path.points);
                    prop_assert_eq!(prepared.plan(start, goal).unwrap().cost, path.cost);
                    let short = theta.plan(start, goal).unwrap();
                    assert_sound(&grid, &short.points);
                    prop_assert!(short.cost >= path.cost - 1e-9 && short.cost <= 1.3 * octile.plan(start, goal).unwrap().cost);
                    prop_assert!(path.cost <= octile.plan(start, goal).unwrap().cost + 1e-9);
                }
                Err(error) => {
                    prop_assert_eq!(error, PlanError::Unreachable { start, goal });
                    prop_assert!(truth(&grid, start, goal).is_infinite(), "{:?}", grid);
                    prop_assert_eq!(theta.plan(start, goal), Err(error));
                }
            }
        }
    }

    /// Larger maps exercise the word boundaries of the bit scans: paths are sound, symmetric, and shorter
    /// than all others.
    #[test]
    fn long_paths_are_sound(width in 60..200usize, height in 3..30usize, seed in any::<u64>(), share in 0.7..0.99f64) {
        let grid = random_grid(width, height, share, seed);
        let cells: Vec<GridCell> = grid.free_cells().collect();
        let (mut any, mut theta) = (AnyAngle::new(&grid), LazyThetaStar::new(&grid));
        let mut turned = AnyAngle::new(&grid.transposed());
        let mut stream = Stream::new(seed);
        for _ in 0..5 {
            let (start, goal) = (cells[stream.below(cells.len())], cells[stream.below(cells.len())]);
            let Ok(path) = any.plan(start, goal) else { continue };
            assert_sound(&grid, &path.points);
            let swap = |cell: GridCell| GridCell::new(cell.row, cell.column);
            prop_assert!((turned.plan(swap(goal), swap(start)).unwrap().cost - path.cost).abs() < 1e-9);
            let short = theta.plan(start, goal).unwrap();
            assert_sound(&grid, &short.points);
            prop_assert!(short.cost >= path.cost - 1e-9);
        }
    }
}

#[test]
fn there_is_no_way_between_cells_that_touch_at_a_corner() {
    let grid = BitGrid::from_text(".#.\n#..\n...").unwrap();
    let (a, b) = (GridCell::new(0, 0), GridCell::new(2, 2));
    assert_eq!(AnyAngle::new(&grid).plan(a, b), Err(PlanError::Unreachable { start: a, goal: b }));
    let around = BitGrid::from_text("..#\n.#.\n...").unwrap();
    let path = AnyAngle::new(&around).plan(GridCell::new(1, 0), GridCell::new(2, 1)).unwrap();
    assert_eq!(path.points.len(), 5, "{path:?}");
}
