use super::cluster::Clusters;
use super::grid::{Cells, Grid};
use super::shape::{Block, Shape};
use super::solid::{Solid, SolidId, Span};
use crate::geometry::{Aabb, Pose};
use crate::world::Wall;

/// Walls that stay and solids that move, indexed.
///
/// Walls are rectangles of the wall's thickness about its line, from the floor to the wall's height; a wall of
/// thickness 0 is a bare line. Memory and building time are in proportion to the number of walls and solids.
/// Coordinates have to be numbers; up to some thousand kilometres they are exact enough for a result to 1 µm.
#[derive(Debug, Clone)]
pub struct Space {
    /// In the order of the clusters.
    pub(super) walls: Vec<Block>,
    pub(super) clusters: Clusters,
    pub(super) solids: Vec<Placed>,
    pub(super) grid: Grid,
    /// The grid is made anew for this many solids, ...
    full_at: usize,
    /// ... or when so many solids have left its cells.
    strays: usize,
    strays_allowed: usize,
}

/// A solid, and what the index knows about it.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    solid: Solid,
    pub(super) shape: Shape,
    pub(super) span: Span,
    /// The cells that list it; `None`: every question tests it.
    pub(super) cells: Option<Cells>,
    /// It is not, or not wholly, on cells.
    stray: bool,
}

impl Space {
    /// A space with these walls and no solids.
    pub fn new(walls: &[Wall]) -> Self {
        let (walls, clusters) = Clusters::of(walls.iter().map(Block::of_wall).collect());
        let grid = Grid::new(&walls, &[]);
        Self { walls, clusters, solids: Vec::new(), grid, full_at: 16, strays: 0, strays_allowed: 16 }
    }

    /// Adds a solid.
    ///
    /// # Panics
    ///
    /// With 2³² solids in the space.
    pub fn add(&mut self, solid: Solid) -> SolidId {
        let id = SolidId(u32::try_from(self.solids.len()).expect("fewer than 2^32 solids"));
        let shape = solid.outline.at(&solid.pose);
        let span = solid.span();
        self.solids.push(Placed { solid, shape, span, cells: None, stray: false });
        self.list(id.0, &shape.bounds());
        if self.solids.len() >= self.full_at || self.strays > self.strays_allowed {
            self.rebuild();
        }
        id
    }

    /// Moves a solid.
    ///
    /// # Panics
    ///
    /// If the solid is of another space that holds more solids.
    pub fn set_pose(&mut self, id: SolidId, pose: Pose) {
        let placed = &mut self.solids[id.index()];
        placed.solid.pose = pose;
        placed.shape = placed.solid.outline.at(&pose);
        let bounds = placed.shape.bounds();
        let cells = self.grid.place_for(&bounds);
        if cells.is_some() && cells == placed.cells {
            return;
        }
        self.relist(id.0, &bounds);
    }

    /// A solid, with its present pose.
    ///
    /// # Panics
    ///
    /// If the solid is of another space that holds more solids.
    pub fn solid(&self, id: SolidId) -> &Solid {
        &self.solids[id.index()].solid
    }

    /// The number of solids.
    pub fn solids(&self) -> usize {
        self.solids.len()
    }

    #[cold]
    fn relist(&mut self, number: u32, bounds: &Aabb) {
        let placed = &self.solids[number as usize];
        self.grid.remove(number, placed.cells);
        self.strays -= usize::from(placed.stray);
        self.list(number, bounds);
        if self.strays > self.strays_allowed {
            self.rebuild();
        }
    }

    fn list(&mut self, number: u32, bounds: &Aabb) {
        let cells = self.grid.place_for(bounds);
        let stray = cells.is_none() && !self.grid.lattice.under(bounds).is_some_and(|(_, whole)| whole);
        self.grid.insert(number, cells);
        self.strays += usize::from(stray);
        let placed = &mut self.solids[number as usize];
        (placed.cells, placed.stray) = (cells, stray);
    }

    /// Makes a grid that suits the present number and places of solids. Answers stay what they are.
    fn rebuild(&mut self) {
        let bounds: Vec<Aabb> = self.solids.iter().map(|placed| placed.shape.bounds()).collect();
        self.grid = Grid::new(&self.walls, &bounds);
        self.strays = 0;
        for (number, bounds) in bounds.iter().enumerate() {
            self.list(number as u32, bounds);
        }
        self.full_at = 2 * self.solids.len().max(8);
        // Solids beyond the farthest cell stay strays; the next grid has to be worth its making.
        self.strays_allowed = 2 * self.strays + 16 + self.solids.len() / 4;
    }
}
