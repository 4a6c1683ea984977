//! The search shared by both forms of jump point search.

use super::planes::{Landing, Planes};
use crate::nav::grid::cost::octile;
use crate::nav::grid::path::SearchStatistics;
use crate::nav::grid::queue::BucketQueue;
use crate::world::GridCell;

/// Source of jumps.
pub(super) trait Jumps {
    /// Number of nodes. The start has the next number.
    fn count(&self) -> usize;

    /// Jumps from the start, in all directions.
    fn leave_start(&self, x: usize, y: usize, land: impl FnMut(Arrival));

    /// Jumps from a jump point, depending on the direction of arrival.
    fn leave_node(&self, node: u32, at: Landing, land: impl FnMut(Arrival));
}

/// The end of a jump.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arrival {
    pub(super) node: u32,
    pub(super) at: Landing,
}

/// Search state of a node.
#[derive(Debug, Clone, Copy)]
struct Label {
    cost: u64,
    x: u32,
    y: u32,
    parent: u32,
    /// The query it belongs to, and the direction of arrival in the lowest three bits.
    query: u32,
}

impl Label {
    fn pack(self) -> Packed {
        let pair = |low: u32, high: u32| u64::from(high) << 32 | u64::from(low);
        [self.cost, pair(self.x, self.y), pair(self.parent, self.query)]
    }

    fn unpack([cost, place, rest]: Packed) -> Self {
        let low = |pair: u64| pair as u32;
        let high = |pair: u64| (pair >> 32) as u32;
        Self { cost, x: low(place), y: high(place), parent: low(rest), query: high(rest) }
    }
}

/// A label as plain integers: zeroed memory for them is allocated only when written, so a search costs what
/// it touches, however large the map is.
type Packed = [u64; 3];

/// Search state kept from one query to the next.
#[derive(Debug, Clone, Default)]
pub(super) struct Search {
    labels: Vec<Packed>,
    query: u32,
    queue: BucketQueue,
}

/// Parent of the start, and of the nodes at which jumps from the start end.
const NO_NODE: u32 = u32::MAX;

impl Search {
    /// Finds the shortest path, which must exist. Returns its turning cells, between which it goes diagonally
    /// first.
    pub(super) fn run(
        &mut self,
        planes: &Planes,
        jumps: &impl Jumps,
        start: GridCell,
        goal: GridCell,
    ) -> (Vec<GridCell>, SearchStatistics) {
        self.begin(jumps.count());
        let mut statistics = SearchStatistics { expanded: 1, generated: 1 };
        let (x, y) = (start.column + 1, start.row + 1);
        let goal = planes.target(goal.column + 1, goal.row + 1);
        if planes.sees(x, y, &goal) {
            return (self.turns(start, NO_NODE, goal.x, goal.y), statistics);
        }
        let (mut best, mut last) = (u64::MAX, NO_NODE);
        let estimate = |x: usize, y: usize| octile(x.abs_diff(goal.x) as u32, y.abs_diff(goal.y) as u32);
        self.queue.start(estimate(x, y));
        jumps.leave_start(x, y, |arrival| {
            self.reach(
                arrival,
                octile_between(x, y, arrival.at),
                NO_NODE,
                u64::MAX,
                &estimate,
                &mut statistics,
            );
        });
        while let Some((node, cost)) = self.queue.pop_below(best) {
            let label = Label::unpack(self.labels[node as usize]);
            let (x, y) = (label.x as usize, label.y as usize);
            if label.cost != cost || cost + estimate(x, y) >= best {
                continue;
            }
            statistics.expanded += 1;
            if planes.sees(x, y, &goal) {
                // Nothing else from here can be shorter.
                (best, last) = (cost + estimate(x, y), node);
                continue;
            }
            let at = Landing { x, y, direction: label.query as usize & 7 };
            jumps.leave_node(node, at, |arrival| {
                let total = cost + octile_between(x, y, arrival.at);
                self.reach(arrival, total, node, best, &estimate, &mut statistics);
            });
        }
        (self.turns(start, last, goal.x, goal.y), statistics)
    }

    /// The cells that the last query reached by jumps, nearest first.
    pub(super) fn landings(&self) -> Vec<GridCell> {
        let labels = self.labels.iter().map(|label| Label::unpack(*label));
        let mut reached: Vec<_> =
            labels.filter(|label| label.query & !7 == self.query && self.query > 0).collect();
        reached.sort_by_key(|label| (label.cost, label.y, label.x));
        reached.iter().map(|label| GridCell::new(label.x as usize - 1, label.y as usize - 1)).collect()
    }

    fn begin(&mut self, count: usize) {
        if self.labels.len() != count || self.query >= u32::MAX - 16 {
            self.labels = vec![[0; 3]; count];
            self.query = 0;
        }
        self.query += 8;
    }

    #[inline]
    fn reach(
        &mut self,
        arrival: Arrival,
        cost: u64,
        parent: u32,
        best: u64,
        estimate: &impl Fn(usize, usize) -> u64,
        statistics: &mut SearchStatistics,
    ) {
        let place = &mut self.labels[arrival.node as usize];
        let label = Label::unpack(*place);
        if label.query & !7 == self.query && label.cost <= cost {
            return;
        }
        let at = arrival.at;
        let sum = cost + estimate(at.x, at.y);
        if sum >= best {
            return;
        }
        let query = self.query | at.direction as u32;
        *place = Label { cost, x: at.x as u32, y: at.y as u32, parent, query }.pack();
        statistics.generated += 1;
        self.queue.push(sum, arrival.node, cost);
    }

    fn turns(&self, start: GridCell, last: u32, goal_x: usize, goal_y: usize) -> Vec<GridCell> {
        let mut turns = vec![GridCell::new(goal_x - 1, goal_y - 1)];
        let mut node = last;
        while node != NO_NODE {
            let label = Label::unpack(self.labels[node as usize]);
            turns.push(GridCell::new(label.x as usize - 1, label.y as usize - 1));
            node = label.parent;
        }
        turns.push(start);
        turns.reverse();
        turns
    }
}

#[inline]
fn octile_between(x: usize, y: usize, at: Landing) -> u64 {
    octile(x.abs_diff(at.x) as u32, y.abs_diff(at.y) as u32)
}
