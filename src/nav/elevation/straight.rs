use super::costs::GroundCosts;
use crate::geometry::Point;
use crate::nav::grid::StepCosts;
use crate::world::{BitGrid, GridCell};

/// A way of straight lines between some of the cells of a way that goes from cell to cell, and its cost: no more than that of
/// the given one, and lower where a straight line is.
pub(super) fn straightened(costs: &GroundCosts, open: &BitGrid, cells: &[GridCell]) -> (Vec<GridCell>, f64) {
    // From each cell back over 1, 2, 4, 8, ... others; then between any two of those that are left.
    let halves =
        |to: usize| std::iter::successors(Some(1), |back| Some(2 * back)).take_while(move |&b| b <= to);
    let few = shortest(costs, open, cells, |to| halves(to).map(|back| to - back).collect()).0;
    shortest(costs, open, &few, |to| (0..to).collect())
}

/// The cheapest chain of straight lines from the first of some cells to the last one, forwards through the list.
fn shortest(
    costs: &GroundCosts,
    open: &BitGrid,
    cells: &[GridCell],
    before: impl Fn(usize) -> Vec<usize>,
) -> (Vec<GridCell>, f64) {
    let at = |index: usize| Point::new(cells[index].column as f64, cells[index].row as f64);
    let mut best = vec![(0.0, 0)];
    for to in 1..cells.len() {
        let chains = before(to).into_iter().filter_map(|from| {
            let cost = if is_step(cells[from], cells[to]) {
                costs.cost(cells[from], cells[to]) * costs.unit
            } else {
                costs.straight(at(from), at(to), |cell| open.is_free(cell))?
            };
            Some((best[from].0 + cost, from))
        });
        // The way from cell to cell is one of them.
        best.push(chains.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, to - 1)));
    }
    let last = cells.len() - 1;
    let back = std::iter::successors(Some(last), |&index| (index > 0).then(|| best[index].1));
    let mut chain: Vec<GridCell> = back.map(|index| cells[index]).collect();
    chain.reverse();
    (chain, best[last].0)
}

fn is_step(a: GridCell, b: GridCell) -> bool {
    a.column.abs_diff(b.column).max(a.row.abs_diff(b.row)) == 1
}
