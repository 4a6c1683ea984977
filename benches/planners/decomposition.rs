//! How long it takes to decompose maps into quadtrees.

use std::time::Instant;

use roverlab::nav::grid::Quadtree;
use roverlab::world::BitGrid;
use roverlab_bench::maps;

/// Decomposes the maps of a size that are made here.
pub(crate) fn show(size: usize) {
    println!("\ndecomposition of {size} x {size} cells, and all leaves listed (fastest of 9):");
    for map in maps::own(size, 1) {
        let (time, listed, leaves) = decompose(&map.grid);
        println!("  {:<32}{time:>10.1} us, {listed:.1} us for {leaves} leaves", map.name);
    }
    println!();
}

/// Microseconds at best for the decomposition and for a list of the leaves, and how many these are.
#[allow(clippy::disallowed_methods, reason = "a benchmark measures time")]
fn decompose(grid: &BitGrid) -> (f64, f64, usize) {
    let (mut fastest, mut listed, mut leaves) = (f64::INFINITY, f64::INFINITY, 0);
    for _ in 0..9 {
        let start = Instant::now();
        let tree = std::hint::black_box(Quadtree::new(grid));
        fastest = fastest.min(1e6 * start.elapsed().as_secs_f64());
        let start = Instant::now();
        let (mut count, mut area) = (0, 0);
        tree.visit(|leaf, is_free| {
            count += 1;
            area += if is_free { leaf.size * leaf.size } else { 0 };
        });
        listed = listed.min(1e6 * start.elapsed().as_secs_f64());
        assert_eq!(area, grid.count_free(), "free leaves cover the free cells");
        leaves = count;
    }
    (fastest, listed, leaves)
}
