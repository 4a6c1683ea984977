use proptest::prelude::*;

use super::{Edges, Leaf, Quadtree, QuadtreePlanner, segment_meets_box};
use crate::nav::grid::{AnyAngle, GridPlanner, PlanError};
use crate::random::Stream;
use crate::world::{BitGrid, GridCell};

fn random_grid(width: usize, height: usize, share: f64, seed: u64) -> BitGrid {
    let mut stream = Stream::new(seed);
    BitGrid::from_fn(width, height, |_, _| stream.chance(share)).unwrap()
}

/// The book's recursion, which checks every cell of every square.
fn recursion(grid: &BitGrid, x: usize, y: usize, size: usize, minimum: usize, found: &mut Vec<(Leaf, bool)>) {
    if x >= grid.width() || y >= grid.height() {
        return;
    }
    let whole = x + size <= grid.width() && y + size <= grid.height();
    let cells = || (y..y + size).flat_map(|row| (x..x + size).map(move |column| GridCell::new(column, row)));
    let leaf = Leaf { column: x, row: y, size };
    let all_free = whole && cells().all(|cell| grid.is_free(cell));
    if all_free || (whole && (size <= minimum || cells().all(|cell| !grid.is_free(cell)))) {
        found.push((leaf, all_free));
        return;
    }
    let half = size / 2;
    for (dx, dy) in [(0, 0), (half, 0), (0, half), (half, half)] {
        recursion(grid, x + dx, y + dy, half, minimum, found);
    }
}

proptest! {
    #![proptest_config(crate::testing::cases(200))]

    #[test]
    fn leaves_are_those_of_the_recursion(
        width in 1..150usize, height in 1..40usize, share in 0.0..1.0f64, power in 0..4u32, seed in any::<u64>()
    ) {
        let grid = random_grid(width, height, share * share * share * share, seed);
        let minimum = 1 << power;
        let tree = Quadtree::with_minimum_leaf(&grid, minimum).unwrap();
        let (mut found, mut expected) = (Vec::new(), Vec::new());
        tree.visit(|leaf, free| found.push((leaf, free)));
        recursion(&grid, 0, 0, width.max(height).next_power_of_two(), minimum, &mut expected);
        prop_assert_eq!(&found, &expected);
        for (leaf, free) in found {
            let cell = GridCell::new(leaf.column + leaf.size - 1, leaf.row + leaf.size / 2);
            prop_assert_eq!(tree.leaf_at(cell), free.then_some(leaf));
            prop_assert_eq!(tree.blocked_leaf_at(cell), (!free).then_some(leaf));
        }
        prop_assert_eq!(tree.leaf_at(GridCell::new(width, 0)), None);
    }

    #[test]
    fn changing_cells_gives_the_tree_of_the_changed_map(width in 1..40usize, height in 1..40usize, seed in any::<u64>()) {
        let mut grid = random_grid(width, height, 0.9, seed);
        let mut tree = Quadtree::new(&grid);
        let mut stream = Stream::new(seed);
        for _ in 0..60 {
            let (cell, free) = (GridCell::new(stream.below(width + 2), stream.below(height + 2)), stream.chance(0.7));
            grid.set_free(cell, free);
            tree.set_free(cell, free);
        }
        prop_assert_eq!(tree.free_leaves(), Quadtree::new(&grid).free_leaves());
        prop_assert_eq!(tree.blocked_leaves(), Quadtree::new(&grid).blocked_leaves());
    }

    /// Leaves are neighbours if and only if two of their cells share an edge, and the relation is symmetric.
    #[test]
    fn neighbours_share_an_edge(width in 1..40usize, height in 1..40usize, share in 0.7..1.0f64, seed in any::<u64>()) {
        let tree = Quadtree::new(&random_grid(width, height, share, seed));
        let graph = tree.neighbour_graph();
        let mut expected = Vec::new();
        for (from, a) in graph.leaves.iter().enumerate() {
            for (to, b) in graph.leaves.iter().enumerate().skip(from + 1) {
                let overlap = |p: usize, m: usize, q: usize, n: usize| (p + m).min(q + n) as isize - p.max(q) as isize;
                let x = overlap(a.column, a.size, b.column, b.size);
                let y = overlap(a.row, a.size, b.row, b.size);
                if (x == 0 && y > 0) || (y == 0 && x > 0) {
                    expected.push((from, to));
                }
            }
        }
        let found: Vec<_> = graph.links.iter().map(|link| (link.from, link.to)).collect();
        prop_assert_eq!(found, expected);
    }

    /// Lines that meet no closed leaf meet no open one; the open graph's lines meet none, and there are more
    /// of them.
    #[test]
    fn all_pairs_meet_no_blocked_leaf(size in 1..14usize, share in 0.6..1.0f64, seed in any::<u64>()) {
        let tree = Quadtree::new(&random_grid(size, size, share, seed));
        let blocked = tree.blocked_leaves();
        let graphs = [Edges::Closed, Edges::Open].map(|edges| (edges, tree.all_pairs_graph(edges)));
        for (edges, graph) in &graphs {
            let mut links = graph.links.iter().map(|link| (link.from, link.to)).peekable();
            for from in 0..graph.leaves.len() {
                for to in from + 1..graph.leaves.len() {
                    let (a, b) = (graph.leaves[from].half_centre(), graph.leaves[to].half_centre());
                    let met = blocked.iter().any(|leaf| {
                        let (lower, upper) = leaf.half_cells();
                        segment_meets_box(a, b, lower, upper, *edges)
                    });
                    let linked = links.next_if_eq(&(from, to)).is_some();
                    // A line may pass between open boxes that touch at a corner, but a path may not.
                    let right = if *edges == Edges::Closed { linked != met } else { !linked || !met };
                    prop_assert!(right);
                }
            }
        }
        prop_assert!(graphs[0].1.links.len() <= graphs[1].1.links.len());
    }

    #[test]
    fn boxes_are_met_where_a_point_of_the_segment_is_inside(
        a in (-6..6i64, -6..6i64), b in (-6..6i64, -6..6i64), lower in (-4..4i64, -4..4i64), size in (1..5i64, 1..5i64)
    ) {
        let upper = (lower.0 + size.0, lower.1 + size.1);
        // Crossings with the box's sides have denominators up to 12: these points lie in between them.
        let (mut inside, mut touching) = (false, false);
        let steps = 27720;
        for i in 0..=steps {
            let (x, y) = (a.0 * (steps - i) + b.0 * i, a.1 * (steps - i) + b.1 * i);
            let (low, high) = ((lower.0 * steps, lower.1 * steps), (upper.0 * steps, upper.1 * steps));
            inside |= x > low.0 && x < high.0 && y > low.1 && y < high.1;
            touching |= x >= low.0 && x <= high.0 && y >= low.1 && y <= high.1;
        }
        prop_assert_eq!(segment_meets_box(a, b, lower, upper, Edges::Open), inside);
        prop_assert_eq!(segment_meets_box(a, b, lower, upper, Edges::Closed), touching);
    }

    #[test]
    fn paths_are_short(width in 1..60usize, height in 1..60usize, share in 0.6..1.0f64, seed in any::<u64>()) {
        ten_paths(width, height, share, seed)?;
    }
}

/// Paths exist where the grid has some, go through free cells, and are on average not much longer than the
/// shortest. Returns the largest single ratio: a short path may pass an obstacle on the longer side, as
/// midpoints of edges overestimate the shorter side by up to a cell at either end.
fn ten_paths(width: usize, height: usize, share: f64, seed: u64) -> Result<f64, TestCaseError> {
    let grid = random_grid(width, height, share, seed);
    let cells: Vec<GridCell> = grid.free_cells().collect();
    if cells.is_empty() {
        return Err(TestCaseError::reject("no free cell"));
    }
    let mut planner = QuadtreePlanner::new(&Quadtree::new(&grid));
    let mut truth = AnyAngle::new(&grid);
    let mut stream = Stream::new(seed);
    let (mut all, mut all_best, mut worst) = (0.0, 0.0, 1.0_f64);
    for _ in 0..10 {
        let (start, goal) = (cells[stream.below(cells.len())], cells[stream.below(cells.len())]);
        match truth.plan(start, goal) {
            Ok(best) => {
                let path = planner.plan(start, goal).unwrap();
                let most = 1.25 * best.cost + 2.0;
                prop_assert!(
                    (best.cost - 1e-9..=most).contains(&path.cost),
                    "{} for {}",
                    path.cost,
                    best.cost
                );
                for pair in path.points.windows(2) {
                    prop_assert!(truth.points_in_sight(pair[0], pair[1]), "{:?} on {:?}", path, grid);
                }
                (all, all_best) = (all + path.cost, all_best + best.cost);
                worst = worst.max(path.cost / best.cost.max(1e-9));
            }
            Err(error) => prop_assert_eq!(planner.plan(start, goal), Err(error)),
        }
    }
    prop_assert!(all <= 1.25 * all_best + 1e-9, "{all} for {all_best}");
    Ok(worst)
}

#[test]
fn a_short_path_may_be_a_quarter_too_long() {
    let worst = ten_paths(29, 56, 0.865_935_148_921_931_1, 14_712_884_698_213_369_345).unwrap();
    assert!(worst < 1.3, "{worst}");
}

#[test]
fn the_books_first_rows() {
    // 64 x 64 cells with the upper half free, as at the beginning of the list in section 10.5.
    let grid = BitGrid::from_fn(64, 64, |x, y| y < 32 || (x < 8 && y < 36) || (x < 2 && y == 36)).unwrap();
    let free: Vec<_> = Quadtree::new(&grid).free_leaves().iter().map(|l| (l.column, l.row, l.size)).collect();
    assert_eq!(free[..6], [(0, 0, 32), (32, 0, 32), (0, 32, 4), (4, 32, 4), (0, 36, 1), (1, 36, 1)]);
}

#[test]
fn small_and_empty_maps() {
    let empty = Quadtree::new(&BitGrid::blocked(0, 3).unwrap());
    assert!(empty.free_leaves().is_empty() && empty.blocked_leaves().is_empty());
    assert_eq!(
        QuadtreePlanner::new(&empty).plan(GridCell::new(0, 0), GridCell::new(0, 0)),
        Err(PlanError::EmptyMap)
    );
    let one = Quadtree::new(&BitGrid::from_text(".").unwrap());
    assert_eq!(one.free_leaves(), [Leaf { column: 0, row: 0, size: 1 }]);
    assert_eq!(QuadtreePlanner::new(&one).plan(GridCell::new(0, 0), GridCell::new(0, 0)).unwrap().cost, 0.0);
    for wrong in [0, 3, 1 << 21] {
        let error = Quadtree::with_minimum_leaf(&BitGrid::from_text(".").unwrap(), wrong).unwrap_err();
        assert!(error.to_string().contains("power of two"), "{error}");
    }
}
