//! The shared edges of free leaves.

use super::tree::{Leaf, Quadtree};
use crate::nav::grid::any_angle::HalfPoint;
use crate::world::{BitGrid, GridCell};

/// The part of an edge shared by two leaves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Portal {
    /// The leaf on the left or above, and the one on the right or below.
    pub(super) leaves: [u32; 2],
    /// Its ends, in cells, from lower to higher coordinates.
    pub(super) ends: [(i32, i32); 2],
}

/// A point of a portal; node of the search.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub(super) at: HalfPoint,
    pub(super) portal: u32,
    /// Leaves of the portal.
    pub(super) leaves: [u32; 2],
}

/// Number of cells above which a portal has nodes at its ends as well as in its middle.
const LONG: i32 = 8;

/// The free leaves of a quadtree and the portals between them.
#[derive(Debug, Clone, Default)]
pub(super) struct Portals {
    pub(super) leaves: Vec<Leaf>,
    pub(super) all: Vec<Portal>,
    pub(super) nodes: Vec<Node>,
    /// Index of the first node around each leaf in the list after it, and the end.
    first: Vec<u32>,
    of_leaf: Vec<u32>,
    /// First cells of leaves, row by row, and the number of them before each word; used to find a leaf's
    /// number.
    corners: Option<BitGrid>,
    before: Vec<u32>,
    /// Numbers of the leaves in the order of their first cells.
    order: Vec<u32>,
}

impl Portals {
    pub(super) fn new(tree: &Quadtree) -> Self {
        let mut this = Self { leaves: tree.free_leaves(), ..Self::default() };
        this.number(tree);
        for leaf in 0..this.leaves.len() as u32 {
            this.connect(tree, leaf);
        }
        this.lay_nodes();
        this
    }

    /// Lists the nodes of all portals, and those around each leaf.
    fn lay_nodes(&mut self) {
        for (portal, &Portal { leaves, ends: [a, b] }) in self.all.iter().enumerate() {
            let mut add = |at| self.nodes.push(Node { at, portal: portal as u32, leaves });
            add(HalfPoint { x: a.0 + b.0, y: a.1 + b.1 });
            if (b.0 - a.0) + (b.1 - a.1) > LONG {
                add(HalfPoint::corner(a.0, a.1));
                add(HalfPoint::corner(b.0, b.1));
            }
        }
        let mut counts = vec![0; self.leaves.len() + 1];
        for node in &self.nodes {
            node.leaves.iter().for_each(|&leaf| counts[leaf as usize + 1] += 1);
        }
        for leaf in 0..self.leaves.len() {
            counts[leaf + 1] += counts[leaf];
        }
        self.first.clone_from(&counts);
        self.of_leaf = vec![0; 2 * self.nodes.len()];
        for (number, node) in self.nodes.iter().enumerate() {
            for &leaf in &node.leaves {
                self.of_leaf[counts[leaf as usize] as usize] = number as u32;
                counts[leaf as usize] += 1;
            }
        }
    }

    fn number(&mut self, tree: &Quadtree) {
        let Ok(mut corners) = BitGrid::blocked(tree.width(), tree.height()) else { return };
        for leaf in &self.leaves {
            corners.set_free(GridCell::new(leaf.column, leaf.row), true);
        }
        let mut count = 0;
        for row in 0..corners.height() {
            for word in corners.row(row) {
                self.before.push(count);
                count += word.count_ones();
            }
        }
        self.order = vec![0; self.leaves.len()];
        self.corners = Some(corners);
        for number in 0..self.leaves.len() {
            let rank = self.rank(self.leaves[number]);
            self.order[rank] = number as u32;
        }
    }

    /// Position of a leaf in the order of first cells.
    fn rank(&self, leaf: Leaf) -> usize {
        let Some(corners) = &self.corners else { return 0 };
        let words = corners.row(leaf.row);
        let below = words[leaf.column / 64] & ((1 << (leaf.column % 64)) - 1);
        (self.before[leaf.row * words.len() + leaf.column / 64] + below.count_ones()) as usize
    }

    /// Number of a free leaf.
    pub(super) fn number_of(&self, leaf: Leaf) -> u32 {
        self.order[self.rank(leaf)]
    }

    /// Nodes around a leaf.
    pub(super) fn around(&self, leaf: u32) -> &[u32] {
        &self.of_leaf[self.first[leaf as usize] as usize..self.first[leaf as usize + 1] as usize]
    }

    /// Adds the portals on the right of a leaf and below it.
    fn connect(&mut self, tree: &Quadtree, number: u32) {
        let leaf = self.leaves[number as usize];
        let (end_column, end_row) = (leaf.column + leaf.size, leaf.row + leaf.size);
        let mut row = leaf.row;
        while row < end_row {
            let Some(next) = tree.leaf_at(GridCell::new(end_column, row)) else {
                row += 1;
                continue;
            };
            let end = end_row.min(next.row + next.size);
            let x = end_column as i32;
            self.add(number, next, [(x, row as i32), (x, end as i32)]);
            row = end;
        }
        let mut column = leaf.column;
        while column < end_column {
            let Some(next) = tree.leaf_at(GridCell::new(column, end_row)) else {
                column += 1;
                continue;
            };
            let end = end_column.min(next.column + next.size);
            let y = end_row as i32;
            self.add(number, next, [(column as i32, y), (end as i32, y)]);
            column = end;
        }
    }

    fn add(&mut self, leaf: u32, next: Leaf, ends: [(i32, i32); 2]) {
        let leaves = [leaf, self.number_of(next)];
        self.all.push(Portal { leaves, ends });
    }
}
