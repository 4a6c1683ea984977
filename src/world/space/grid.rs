use super::lattice::{Cells, Lattice};
use super::shape::Block;
use crate::geometry::{Aabb, Point};

/// Number of cells above which a solid is tested by every query instead of being listed in each cell.
const MOST_CELLS_OF_A_SOLID: usize = 64;

/// What is in a cell. Half a cache line.
#[derive(Debug, Clone, Default)]
struct Cell {
    /// Start and end of its walls in the list of all cells' walls.
    walls: [u32; 2],
    /// The first `count` are its first solids.
    few: [u32; 3],
    count: u32,
    /// All others.
    #[allow(clippy::box_collection, reason = "Nearly all cells have none, and it shall be small")]
    more: Option<Box<Vec<u32>>>,
}

impl Cell {
    #[inline]
    fn solids(&self) -> impl Iterator<Item = &u32> {
        self.few[..self.count as usize].iter().chain(self.more.iter().flat_map(|more| more.iter()))
    }

    fn insert(&mut self, solid: u32) {
        match self.few.get_mut(self.count as usize) {
            Some(place) => {
                *place = solid;
                self.count += 1;
            }
            None => self.more.get_or_insert_default().push(solid),
        }
    }

    fn remove(&mut self, solid: u32) {
        let few = &mut self.few[..self.count as usize];
        let Some(at) = few.iter().position(|&other| other == solid) else {
            return self.more.iter_mut().for_each(|more| take(more, solid));
        };
        let last = few[few.len() - 1];
        few[at] = self.more.as_mut().and_then(|more| more.pop()).unwrap_or_else(|| {
            self.count -= 1;
            last
        });
    }
}

/// Cells with lists of the walls and solids in them.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    pub(super) lattice: Lattice,
    cells: Vec<Cell>,
    /// The walls of all cells, one after the other: those of a cell are together in memory.
    wall_list: Vec<Block>,
    /// Things tested by every query, because they are not completely on cells.
    loose_walls: Vec<u32>,
    loose_solids: Vec<u32>,
}

impl Grid {
    /// A grid over walls and the bounds of solids that are not listed yet.
    pub(super) fn new(walls: &[Block], solids: &[Aabb]) -> Self {
        let all = walls.iter().map(Block::bounds).chain(solids.iter().copied());
        let bounds = all.reduce(|a, b| a.union(&b)).unwrap_or(Aabb::new(Point::origin(), Point::origin()));
        let mut cells = walls.len() + solids.len() + 16;
        let most_entries = 8 * walls.len() + 64;
        loop {
            let lattice = Lattice::covering(bounds, cells);
            if let Some(grid) = Self::with_lattice(lattice, walls, most_entries.max(cells)) {
                return grid;
            }
            // Many walls cross most of the world; fewer, larger cells keep the lists proportional to the
            // number of walls.
            cells /= 4;
        }
    }

    /// Lists the walls; `None` if that takes too many entries.
    fn with_lattice(lattice: Lattice, walls: &[Block], most_entries: usize) -> Option<Self> {
        let mut counts = vec![0_u32; lattice.count() + 1];
        let mut loose_walls = Vec::new();
        let mut left = most_entries;
        let may_fail = lattice.count() > 1;
        for (number, wall) in walls.iter().enumerate() {
            if !lattice.under(&wall.bounds()).is_some_and(|(_, whole)| whole) {
                loose_walls.push(number as u32);
                continue;
            }
            let fits = lattice.for_each_under(&wall.shape, |cell| {
                counts[cell + 1] += 1;
                left = left.saturating_sub(1);
                left > 0 || !may_fail
            });
            if !fits {
                return None;
            }
        }
        for cell in 1..counts.len() {
            counts[cell] += counts[cell - 1];
        }
        let listed = counts[lattice.count()] as usize;
        let mut wall_list: Vec<Block> = walls.iter().copied().cycle().take(listed).collect();
        let mut cells: Vec<Cell> = counts[..lattice.count()]
            .iter()
            .map(|&start| Cell { walls: [start; 2], ..Cell::default() })
            .collect();
        let mut loose = loose_walls.iter().copied().peekable();
        for (number, wall) in walls.iter().enumerate() {
            if loose.next_if_eq(&(number as u32)).is_some() {
                continue;
            }
            lattice.for_each_under(&wall.shape, |cell| {
                let end = &mut cells[cell].walls[1];
                wall_list[*end as usize] = *wall;
                *end += 1;
                true
            });
        }
        Some(Self { lattice, cells, wall_list, loose_walls, loose_solids: Vec::new() })
    }

    /// Number of cells and of entries in their lists.
    #[cfg(test)]
    pub(super) fn size(&self) -> usize {
        let solids: usize = self.cells.iter().map(|cell| cell.solids().count()).sum();
        self.lattice.count()
            + self.wall_list.len()
            + self.loose_walls.len()
            + solids
            + self.loose_solids.len()
    }

    /// Walls listed in a cell.
    #[inline]
    pub(super) fn walls_in(&self, cell: usize) -> &[Block] {
        let [start, end] = self.cells[cell].walls;
        &self.wall_list[start as usize..end as usize]
    }

    /// Solids listed in a cell.
    #[inline]
    pub(super) fn solids_in(&self, cell: usize) -> impl Iterator<Item = &u32> {
        self.cells[cell].solids()
    }

    /// Solids in some cells; a solid occurs once per cell that lists it.
    #[inline]
    pub(super) fn solids_of(&self, cells: Cells) -> impl Iterator<Item = &u32> {
        let row = move |y| (cells.x0..=cells.x1).flat_map(move |x| self.solids_in(self.lattice.index(x, y)));
        (cells.y0..=cells.y1).flat_map(row)
    }

    /// Visits the walls in some cells; a wall once per cell that lists it.
    #[inline]
    pub(super) fn for_each_wall_in(&self, cells: Cells, mut visit: impl FnMut(&Block)) {
        for y in cells.y0..=cells.y1 {
            for x in cells.x0..=cells.x1 {
                self.walls_in(self.lattice.index(x, y)).iter().for_each(&mut visit);
            }
        }
    }

    /// Visits the solids in some cells, with the cell's column and row; a solid once per cell that lists it.
    #[inline]
    pub(super) fn for_each_solid_in(&self, cells: Cells, mut visit: impl FnMut(u32, i32, i32)) {
        for y in cells.y0..=cells.y1 {
            for x in cells.x0..=cells.x1 {
                self.solids_in(self.lattice.index(x, y)).for_each(|&number| visit(number, x, y));
            }
        }
    }

    #[inline]
    pub(super) fn loose_walls(&self) -> &[u32] {
        &self.loose_walls
    }

    #[inline]
    pub(super) fn loose_solids(&self) -> &[u32] {
        &self.loose_solids
    }

    /// Cells in which a solid with these bounds is listed; `None` if it is to be loose.
    #[inline]
    pub(super) fn place_for(&self, bounds: &Aabb) -> Option<Cells> {
        let (cells, whole) = self.lattice.under(bounds)?;
        (whole && cells.count() <= MOST_CELLS_OF_A_SOLID).then_some(cells)
    }

    pub(super) fn insert(&mut self, solid: u32, place: Option<Cells>) {
        let Some(cells) = place else {
            self.loose_solids.push(solid);
            return;
        };
        for y in cells.y0..=cells.y1 {
            for x in cells.x0..=cells.x1 {
                self.cells[self.lattice.index(x, y)].insert(solid);
            }
        }
    }

    pub(super) fn remove(&mut self, solid: u32, place: Option<Cells>) {
        let Some(cells) = place else {
            take(&mut self.loose_solids, solid);
            return;
        };
        for y in cells.y0..=cells.y1 {
            for x in cells.x0..=cells.x1 {
                self.cells[self.lattice.index(x, y)].remove(solid);
            }
        }
    }
}

/// Removes one entry from an unordered list.
fn take(list: &mut Vec<u32>, solid: u32) {
    if let Some(at) = list.iter().position(|&other| other == solid) {
        list.swap_remove(at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn a_cell_lists_what_was_inserted_and_not_removed(
            changes in prop::collection::vec((0..12_u32, any::<bool>()), 0..60),
        ) {
            let (mut cell, mut expected) = (Cell::default(), Vec::new());
            for (solid, comes) in changes {
                let listed = expected.contains(&solid);
                if comes && !listed {
                    cell.insert(solid);
                    expected.push(solid);
                } else if !comes {
                    cell.remove(solid);
                    expected.retain(|&other| other != solid);
                }
                let mut found: Vec<u32> = cell.solids().copied().collect();
                found.sort_unstable();
                expected.sort_unstable();
                prop_assert_eq!(&found, &expected);
            }
        }
    }
}
