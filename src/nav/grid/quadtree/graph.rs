use super::boxes::Edges;
use super::tree::{Leaf, Quadtree};
use crate::nav::grid::any_angle::{Field, HalfPoint, in_sight};

/// A graph over the middles of a quadtree's free leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct LeafGraph {
    /// The nodes, in the order of [`Quadtree::free_leaves`].
    pub leaves: Vec<Leaf>,
    /// The edges, each once, by their first and then their second leaf.
    pub links: Vec<LeafLink>,
}

/// A straight way between the middles of two leaves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeafLink {
    /// The number of the one leaf.
    pub from: usize,
    /// The number of the other one, which is larger.
    pub to: usize,
    /// The distance of the two middles, in cells.
    pub length: f64,
}

impl Quadtree {
    /// The book's graph (sections 10.4 and 10.5): every two free leaves between whose middles a straight line meets no
    /// blocked leaf.
    ///
    /// With open edges lines may touch blocked leaves, but do not pass between two of them that touch at a corner. With
    /// closed edges they do not even touch any.
    ///
    /// Looks at every pair: for n leaves that is n²/2 lines, which suits some thousand leaves. For more there is
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

    /// The graph that grows with the number of leaves alone: the leaves that share a part of an edge. The line between their
    /// middles may leave the two of them; a way through the shared part does not, and a planner pulls it straight.
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
