use super::CourseOptions;
use crate::geometry::Point;
use crate::random::Stream;
use crate::world::{Clearance, Raster, World};

/// Attempts to draw a random place in a region.
const TRIES: usize = 60;

/// Radii between which the reachability must not change, and the cell size for this check.
///
/// If two places are connected for a robot, their cells are connected at the lower radius; if cells are
/// connected at the upper radius, the places are connected for a disc as wide as the narrowest corridor. The
/// radii allow for the displacement of a path to the cells' centres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Margins {
    pub(super) resolution: f64,
    pub(super) low: f64,
    pub(super) high: f64,
    /// Distance between obstacles with which cells at the upper radius lead through (m).
    pub(super) room: f64,
    /// Largest distance of the lower radius' region from that of the upper one. It covers corners of rooms
    /// down to 60 degrees, which a small disc can enter farther than a large one.
    rim: f64,
}

impl Margins {
    pub(super) fn new(options: &CourseOptions) -> Self {
        let resolution = options.robot_radius / 6.0;
        let low = options.robot_radius - 0.7072 * resolution;
        let high = 0.5 * options.min_corridor + 0.5 * resolution;
        let room = options.min_corridor + 2.5 * resolution;
        Self { resolution, low, high, room, rim: 2.0 * (high - low) + resolution }
    }
}

/// Connected regions of a world for the lower and upper radius.
#[derive(Debug)]
pub(super) struct Survey {
    margins: Margins,
    clearance: Clearance,
    low: Vec<Option<u32>>,
    high: Vec<Option<u32>>,
}

impl Survey {
    /// Surveys a world; `None` if it is too large.
    pub(super) fn new(world: &World, margins: Margins) -> Option<Self> {
        let limit = margins.high + 4.0 * margins.resolution;
        let clearance = Clearance::new(world, margins.resolution, limit).ok()?;
        let raster = clearance.raster();
        let low = raster.regions(|cell| clearance.at(cell) > margins.low);
        let high = raster.regions(|cell| clearance.at(cell) > margins.high);
        Some(Self { margins, clearance, low, high })
    }

    pub(super) fn raster(&self) -> &Raster {
        self.clearance.raster()
    }

    /// Region of the upper radius at a point.
    pub(super) fn region_at(&self, point: Point) -> Option<u32> {
        self.high[self.raster().cell_at(point)?]
    }

    /// Largest region of the upper radius.
    pub(super) fn largest_region(&self) -> Option<u32> {
        let count = self.high.iter().flatten().max()? + 1;
        let mut sizes = vec![0usize; count as usize];
        self.high.iter().flatten().for_each(|&region| sizes[region as usize] += 1);
        // The last one of equal size, to be deterministic.
        (0..count).max_by_key(|&region| sizes[region as usize])
    }

    /// Whether the robot's reachable places from a cell of `region` are those with room for a disc as wide as
    /// the narrowest corridor, except for a rim along obstacles. Then no narrower passage or niche is
    /// accessible.
    pub(super) fn is_sound(&self, region: u32) -> bool {
        let Some(seed) = self.high.iter().position(|&r| r == Some(region)) else { return false };
        let reached = self.low[seed];
        let inside = |cell: usize| self.low[cell] == reached;
        if (0..self.low.len()).any(|cell| inside(cell) && self.high[cell].is_some_and(|r| r != region)) {
            return false;
        }
        let reach = (self.margins.rim / self.margins.resolution) as usize;
        let heights = self.heights(region, reach);
        let columns = self.raster().columns();
        (0..self.low.len())
            .filter(|&cell| inside(cell) && self.high[cell].is_none())
            .all(|cell| within_reach(&heights, cell, columns, reach))
    }

    /// For every cell, the number of rows to the nearest cell of a region in its column, at most `reach` + 1.
    fn heights(&self, region: u32, reach: usize) -> Vec<usize> {
        let columns = self.raster().columns();
        let mut heights: Vec<usize> =
            self.high.iter().map(|&r| if r == Some(region) { 0 } else { reach + 1 }).collect();
        for cell in columns..heights.len() {
            heights[cell] = heights[cell].min(heights[cell - columns] + 1);
        }
        for cell in (columns..heights.len()).rev() {
            heights[cell - columns] = heights[cell - columns].min(heights[cell] + 1);
        }
        heights
    }

    /// Whether a robot cannot get from one region of the upper radius to another.
    pub(super) fn are_apart(&self, one: u32, other: u32) -> bool {
        let low_of =
            |region| self.high.iter().position(|&r| r == Some(region)).and_then(|cell| self.low[cell]);
        one != other && low_of(one) != low_of(other)
    }

    /// A place in a region, at the centre of a cell: one of the given ones, one beside an obstacle, or any.
    pub(super) fn draw_place(&self, stream: &mut Stream, region: u32, hard: &[Point]) -> Option<Point> {
        let kind = stream.uniform();
        (0..TRIES).find_map(|attempt| {
            let point = if kind < 0.6 && !hard.is_empty() && attempt < TRIES / 2 {
                hard[stream.below(hard.len())]
            } else {
                self.raster().centre(stream.below(self.high.len()))
            };
            let cell = self.raster().cell_at(point)?;
            let beside = kind > 0.8 && attempt < TRIES / 2;
            let good = self.high[cell] == Some(region)
                && !(beside && self.clearance.at(cell) >= self.clearance.limit());
            good.then(|| self.raster().centre(cell))
        })
    }

    /// For every cell in the upper radius' regions, the edge steps from a point; `None` without a path.
    pub(super) fn steps_from(&self, point: Point) -> Vec<Option<u32>> {
        let mut steps = vec![None; self.high.len()];
        let Some(seed) = self.raster().cell_at(point) else { return steps };
        steps[seed] = Some(0);
        let mut wave = vec![seed];
        let mut count = 0;
        while !wave.is_empty() {
            count += 1;
            let mut next_wave = Vec::new();
            for cell in wave {
                for next in self.raster().edge_neighbours(cell).into_iter().flatten() {
                    if steps[next].is_none() && self.high[next].is_some() {
                        steps[next] = Some(count);
                        next_wave.push(next);
                    }
                }
            }
            wave = next_wave;
        }
        steps
    }
}

/// Whether a cell of a region is within `reach` cells, given the distances in columns.
fn within_reach(heights: &[usize], cell: usize, columns: usize, reach: usize) -> bool {
    let column = cell % columns;
    let row_start = cell - column;
    let (first, last) = (column.saturating_sub(reach), (column + reach).min(columns - 1));
    (first..=last).any(|other| {
        let (across, along) = (other.abs_diff(column), heights[row_start + other]);
        across * across + along * along <= reach * reach
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Wall;

    fn survey(world: &World) -> Survey {
        Survey::new(world, Margins::new(&CourseOptions::default())).unwrap()
    }

    /// A field with a transverse wall that has an opening of some width.
    fn gate(width: f64) -> World {
        let mut world = World::walled(3.0, 2.0);
        let wall =
            |low, high| Wall { thickness: 0.0, ..Wall::new(Point::new(1.5, low), Point::new(1.5, high)) };
        world.walls.push(wall(0.0, 1.0));
        world.walls.push(wall(1.0 + width, 2.0));
        world
    }

    /// A field with two parallel walls on the border.
    fn niche(width: f64) -> World {
        let mut world = World::walled(3.0, 2.0);
        for x in [1.0, 1.0 + width] {
            world.walls.push(Wall { thickness: 0.0, ..Wall::new(Point::new(x, 0.0), Point::new(x, 0.6)) });
        }
        world
    }

    #[test]
    fn narrow_gates_are_unsound_and_wide_or_shut_ones_are_not() {
        for (width, sound) in [(0.08, true), (0.13, false), (0.16, false), (0.21, true)] {
            let survey = survey(&gate(width));
            let region = survey.region_at(Point::new(0.5, 0.5)).unwrap();
            assert_eq!(survey.is_sound(region), sound, "{width}");
            let other = survey.region_at(Point::new(2.5, 0.5)).unwrap();
            assert_eq!(survey.are_apart(region, other), width < 0.1, "{width}");
        }
    }

    #[test]
    fn narrow_niches_are_unsound_and_wide_or_shut_ones_are_not() {
        for (width, sound) in [(0.08, true), (0.14, false), (0.16, false), (0.22, true)] {
            let survey = survey(&niche(width));
            assert_eq!(survey.is_sound(survey.largest_region().unwrap()), sound, "{width}");
        }
    }

    #[test]
    fn steps_count_the_way_around() {
        let survey = survey(&gate(0.3));
        let steps = survey.steps_from(Point::new(1.3, 0.3));
        let there = steps[survey.raster().cell_at(Point::new(1.7, 0.3)).unwrap()].unwrap();
        // To the opening and back.
        let metres = f64::from(there) * 0.01;
        assert!((1.8..2.2).contains(&metres), "{metres}");
        assert_eq!(steps[survey.raster().cell_at(Point::new(1.5, 0.3)).unwrap()], None);
    }
}
