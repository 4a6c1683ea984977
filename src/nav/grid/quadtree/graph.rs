use super::boxes::Edges;
use super::tree::{Leaf, Quadtree};
use crate::nav::grid::any_angle::{Field, HalfPoint, in_sight};

/// A graph over the centres of a quadtree's free leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct LeafGraph {
    /// Nodes, in the order of [`Quadtree::free_leaves`].
    pub leaves: Vec<Leaf>,
    /// Edges, each once, ordered by their first and then their second leaf.
    pub links: Vec<LeafLink>,
}

/// A straight connection of two leaves' centres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeafLink {
    /// Number of the first leaf.
    pub from: usize,
    /// Number of the second leaf, which is larger.
    pub to: usize,
    /// Distance of the two centres (cells).
    pub length: f64,
}

impl Quadtree {
    /// The book's graph (sections 10.4 and 10.5): connects every two free leaves if the straight line between
    /// their centres meets no blocked leaf.
    ///
    /// With open edges, lines may touch blocked leaves but not pass between two of them that touch at a
    /// corner. With closed edges they may not touch any.
    ///
    /// Checks every pair, n²/2 lines for n leaves, which is feasible for a few thousand leaves. For more use
    /// [`Quadtree::neighbour_graph`].
    pub fn all_pairs_graph(&self, edges: Edges) -> LeafGraph {
        let leaves = self.free_leaves();
        let field = Field::new(&self.grid());
        let mut links = Vec::new();
        for (from, a) in leaves.iter().enumerate() {
            for (to, b) in leaves.iter().enumerate().skip(from + 1) {
                let (start, end) = (a.half_centre(), b.half_centre());
                let is_clear = match edges {
                    Edges::Open => in_sight(&field, point(start), point(end)),
                    Edges::Closed => !self.is_met(start, end, edges),
                };
                if is_clear {
                    links.push(LeafLink { from, to, length: (a.centre() - b.centre()).norm() });
                }
            }
        }
        LeafGraph { leaves, links }
    }

    /// The graph of adjacent free leaves, whose size grows linearly with the number of leaves. The line
    /// between two centres may leave both leaves; a path through their shared edge does not, and a planner
    /// pulls it straight.
    pub fn neighbour_graph(&self) -> LeafGraph {
        let leaves = self.free_leaves();
        let numbers: std::collections::BTreeMap<Leaf, usize> =
            leaves.iter().enumerate().map(|(number, &leaf)| (leaf, number)).collect();
        let mut links = Vec::new();
        for (from, leaf) in leaves.iter().enumerate() {
            let mut next: Vec<usize> = self.neighbours(*leaf).iter().map(|next| numbers[next]).collect();
            next.sort_unstable();
            let length = |to: usize| (leaf.centre() - leaves[to].centre()).norm();
            links.extend(next.into_iter().filter(|&to| to > from).map(|to| LeafLink {
                from,
                to,
                length: length(to),
            }));
        }
        LeafGraph { leaves, links }
    }
}

fn point((x, y): (i64, i64)) -> HalfPoint {
    HalfPoint { x: x as i32, y: y as i32 }
}
