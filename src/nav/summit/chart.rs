use super::parameters::{CAUTION, SummitParameters};
use super::sight_map::{NOISE, SightMap};
use super::sweep::DROP;
use crate::geometry::{Aabb, Point, math};
use crate::nav::elevation::ElevationMap;
use crate::nav::grid::{DistanceField, GridComponents};
use crate::world::{BitGrid, GridCell, HeightField};

/// A sight map as the robot plans on it.
#[derive(Debug)]
pub(super) struct Chart {
    pub(super) elevation: ElevationMap,
    /// Where the robot can drive for all that it knows.
    pub(super) safe: BitGrid,
    /// Where it could drive at best.
    pub(super) perhaps: BitGrid,
    /// The elevation of each cell, or the most that it can be where the robot can drive.
    potential: Vec<f64>,
}

/// Area of a patch that is worth a look (m²), unless it is seen to be higher by more than a step's error.
const PATCH: f64 = 0.02;

impl Chart {
    /// Where a robot can drive, and where it perhaps can. It does not know its place better than a distance
    /// (m).
    pub(super) fn of(map: &SightMap, parameters: &SummitParameters, doubt: f64) -> Self {
        let ground = Ground::of(map, parameters);
        let clear = ground.clear();
        let is_fenced = |index: usize| parameters.holds(map.place(map.cell(index)), doubt);
        let is_safe = |index: usize| {
            let is_trodden = map.trodden[index] && !map.shunned[index];
            is_fenced(index) && clear[index] && (is_trodden || ground.covered[index] && ground.is_open(index))
        };
        let is_perhaps_safe = |index: usize| {
            let is_hopeless = map.shunned[index] || map.given_up[index];
            let may_be_open = !ground.covered[index] || ground.is_open(index);
            is_safe(index) || is_fenced(index) && ground.holds(index) && may_be_open && !is_hopeless
        };
        let grid = |is_free: &dyn Fn(usize) -> bool| {
            BitGrid::from_fn(map.side, map.side, |x, y| is_free(y * map.side + x)).expect("a map's cells")
        };
        let (safe, perhaps) = (grid(&is_safe), grid(&is_perhaps_safe));
        let potential = (0..map.cells()).map(|index| ground.potential(index)).collect();
        Self { safe, perhaps, potential, elevation: ground.elevation }
    }

    /// The cells that may be higher than a level and may be reached from a cell, in patches that are worth
    /// a look.
    pub(super) fn higher(&self, map: &SightMap, from: GridCell, level: f64) -> Vec<Vec<GridCell>> {
        let perhaps = GridComponents::new(&self.perhaps);
        let safe = GridComponents::new(&self.safe);
        let is_higher = |index: usize| {
            let cell = map.cell(index);
            self.potential[index] > level && perhaps.connected(from, cell) && !safe.connected(from, cell)
        };
        let side = map.side;
        let cells = BitGrid::from_fn(side, side, |x, y| is_higher(y * side + x)).expect("a map's cells");
        let patches = GridComponents::new(&cells);
        let least = (PATCH / (map.resolution * map.resolution)) as usize;
        let stands_out = |cell: GridCell| map.smoothed(cell).is_some_and(|height| height > level + NOISE);
        let mut list = vec![Vec::new(); patches.count()];
        for cell in cells.free_cells() {
            if let Some(patch) = patches.region(cell) {
                list[patch].push(cell);
            }
        }
        list.retain(|patch| patch.len() >= least || patch.iter().any(|&cell| stands_out(cell)));
        list
    }
}

/// The ground of a map, with all cells filled.
struct Ground<'m> {
    map: &'m SightMap,
    parameters: &'m SummitParameters,
    elevation: ElevationMap,
    filled: Filled,
    /// Cells around which all ground under the robot is known.
    covered: Vec<bool>,
    /// Cells by which the robot reaches to each side.
    reach: usize,
    /// Rise from a cell to the next on the steepest ground that the robot drives on (m).
    steepest: f64,
}

impl<'m> Ground<'m> {
    fn of(map: &'m SightMap, parameters: &'m SummitParameters) -> Self {
        let filled = Filled::of(map);
        let corner = Point::new(map.extent, map.extent);
        let area = Aabb::new(-corner, corner);
        let field = HeightField::new(map.side, map.side, area, filled.heights.clone());
        let field = field.expect("a map of finite heights");
        let lowest = parameters.lowest.unwrap_or(f64::NEG_INFINITY);
        let elevation = ElevationMap::new(&field, &map.climber).and_then(|map| map.above(lowest));
        let mut ground = Self {
            map,
            parameters,
            elevation: elevation.expect("parameters that have been checked"),
            filled,
            covered: Vec::new(),
            reach: (map.climber.radius / map.resolution).round() as usize,
            steepest: math::tan(map.climber.slope) * map.resolution,
        };
        let is_known = |index: usize| ground.filled.known[index] || ground.is_beyond(index);
        let known: Vec<bool> = (0..map.cells()).map(is_known).collect();
        ground.covered = eroded(&known, map.side, ground.reach + 1);
        ground
    }

    /// Whether a cell is beyond the fence, which has a margin of its own.
    fn is_beyond(&self, index: usize) -> bool {
        let place = self.map.place(self.map.cell(index));
        self.parameters.fence.is_some_and(|fence| !fence.holds(place))
    }

    /// Elevation of a cell; where it is not known, that of the nearest cells.
    fn height(&self, index: usize) -> f64 {
        f64::from(self.filled.heights[index])
    }

    fn is_open(&self, index: usize) -> bool {
        self.elevation.open().is_free(self.map.cell(index)) && !self.map.shunned[index]
    }

    /// Whether a cell lies lower than a slope could lead to that the robot can drive.
    fn drops(&self, index: usize) -> bool {
        let least = self.height(index) - self.steepest * f64::from(self.filled.away[index]) - DROP;
        !self.filled.known[index] && self.map.ceilings[index] < least
    }

    /// Whether a cell is no drop and no face.
    fn holds(&self, index: usize) -> bool {
        self.is_beyond(index) || !self.drops(index) && !self.map.is_face(index)
    }

    /// Cells from which the robot does not reach a drop or a face.
    fn clear(&self) -> Vec<bool> {
        let holds: Vec<bool> = (0..self.map.cells()).map(|index| self.holds(index)).collect();
        let caution = (CAUTION / self.map.resolution).round() as usize;
        eroded(&holds, self.map.side, self.reach + caution)
    }

    /// The elevation of a cell, or the most that it can be where the robot can drive.
    fn potential(&self, index: usize) -> f64 {
        let slope = self.height(index) + self.steepest * f64::from(self.filled.away[index]) + DROP;
        self.map.height(index).unwrap_or_else(|| self.map.ceilings[index].min(slope))
    }
}

/// Elevations of all cells, which of them are known, and how many cells the others are away from such.
struct Filled {
    heights: Vec<f32>,
    known: Vec<bool>,
    away: Vec<u16>,
}

impl Filled {
    /// Elevations of all cells, and which of them have been seen or lie in small gaps between such. Where
    /// nothing is known, the ground goes on as it is at the nearest known place.
    fn of(map: &SightMap) -> Self {
        let mut known: Vec<bool> = (0..map.cells()).map(|index| map.height(index).is_some()).collect();
        let mut heights: Vec<f32> =
            (0..map.cells()).map(|index| map.height(index).unwrap_or(0.0) as f32).collect();
        let mut filled = known.clone();
        let mut edge: Vec<usize> = (0..filled.len()).filter(|&index| filled[index]).collect();
        let mut away = vec![0; filled.len()];
        for round in 1.. {
            let mut next: Vec<usize> = edge
                .iter()
                .flat_map(|&index| map.neighbours(index))
                .filter(|&index| !filled[index])
                .collect();
            next.sort_unstable();
            next.dedup();
            if next.is_empty() {
                break;
            }
            let values: Vec<(usize, f32, usize)> = next
                .iter()
                .map(|&index| {
                    let around: Vec<usize> = map.neighbours(index).filter(|&near| filled[near]).collect();
                    let sum: f32 = around.iter().map(|&near| heights[near]).sum();
                    (index, sum / around.len() as f32, around.len())
                })
                .collect();
            for &(index, height, around) in &values {
                (heights[index], filled[index], away[index]) = (height, true, round);
                // A gap of a cell or two is no gap.
                known[index] |= round <= 2 && around >= 5;
            }
            edge = next;
        }
        Self { heights, known, away }
    }
}

/// Which cells have only flagged ones, and no edge of the map, within a reach of cells.
fn eroded(flags: &[bool], side: usize, reach: usize) -> Vec<bool> {
    let grid = BitGrid::from_fn(side, side, |x, y| flags[y * side + x]).expect("a map's cells");
    let field = DistanceField::new(&grid);
    (0..flags.len()).map(|index| field.at(GridCell::new(index % side, index / side)) > reach as f64).collect()
}
