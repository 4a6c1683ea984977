use std::collections::BTreeSet;

use super::CoverageMap;
use super::lanes::{Block, blocks};
use super::route::{Routes, is_free};
use crate::geometry::{Point, way_length};
use crate::io::Result;

/// A path over the whole floor in parallel lanes, like a lawn mower's (book, sections 3.1 and 6.3), with
/// visits to the places left out.
///
/// ```
/// use roverlab::drive::{CoverageMap, CoverageMapParameters, CoveragePlan};
/// use roverlab::geometry::Point;
/// use roverlab::world::World;
/// let world = World::walled(1.5, 1.0);
/// let mut map = CoverageMap::new(&world, Point::new(0.2, 0.2), CoverageMapParameters::default())?;
/// let plan = CoveragePlan::new(&map, Point::new(0.2, 0.2))?;
/// plan.points().windows(2).for_each(|two| map.cover_line(two[0], two[1], 0.0));
/// assert!(map.share() > 0.98 && plan.length() < 1.5 * map.area() / 0.12);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CoveragePlan {
    points: Vec<Point>,
    share: f64,
}

/// Path error that leaves no gap unknown to the plan (m).
const ERROR: f64 = 0.004;
/// Minimum fraction of the cells under the robot that a visit must gain, and the covered fraction of the
/// floor at which such visits end: small gains matter where the floor is small or has many corners.
const WORTH: [(f64, f64); 3] = [(0.12, 0.995), (0.05, 0.92), (0.02, 0.9)];
/// Covered fraction of the floor below which a plan is worse than another, however short it is.
const ENOUGH: f64 = 0.98;
/// Maximum number of visits beside the lanes.
const VISITS: usize = 2000;

impl CoveragePlan {
    /// Plans for a robot at a start, with lanes along either side of the floor, whichever is shorter. Ignores
    /// what the map marks as covered. Time is proportional to the number of cells times, at worst, the number
    /// of blocks and extra visits.
    pub fn new(map: &CoverageMap, start: Point) -> Result<Self> {
        let [one, other] = [true, false].map(|along_x| Self::in_lanes(map, start, along_x));
        // A plan that leaves out more floor is no better for being shorter.
        let is_better = match (one.share < ENOUGH, other.share < ENOUGH) {
            (false, true) => true,
            (true, false) => false,
            _ => one.length() <= other.length(),
        };
        Ok(if is_better { one } else { other })
    }

    fn in_lanes(map: &CoverageMap, start: Point, along_x: bool) -> Self {
        let mut planned = CoverageMap::clone(map).uncovered();
        let mut points = vec![start];
        let mut blocks = blocks(map, along_x);
        let mut routes = Routes::new(map);
        while let Some(lanes) = take_nearest(map, &mut routes, &mut blocks, points[points.len() - 1]) {
            for place in lanes.into_iter().flatten() {
                connect(map, &mut routes, &mut points, place);
            }
        }
        for two in points.windows(2) {
            planned.cover_line(two[0], two[1], ERROR);
        }
        visit_the_rest(map, &mut routes, &mut planned, &mut points);
        Self { points, share: planned.share() }
    }

    /// Corners of the path, including the start.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Length of the path (m).
    pub fn length(&self) -> f64 {
        way_length(&self.points)
    }

    /// Fraction of the floor covered if the path is driven to within a few millimetres.
    pub fn share(&self) -> f64 {
        self.share
    }
}

/// Takes the block with the nearest entry: its lanes in the order and directions to be driven.
fn take_nearest(
    map: &CoverageMap,
    routes: &mut Routes,
    blocks: &mut Vec<Block>,
    here: Point,
) -> Option<Vec<[Point; 2]>> {
    let from = map.raster().cell_at(here)?;
    let ends: BTreeSet<usize> = blocks
        .iter()
        .flat_map(|block| [block.lanes.first(), block.lanes.last()])
        .flatten()
        .flatten()
        .filter_map(|&end| map.raster().cell_at(end))
        .collect();
    let nearest = routes.search(map, from, |cell| ends.contains(&cell))?;
    let is_there = |end: &Point| map.raster().cell_at(*end) == Some(nearest);
    let begins = |lane: Option<&[Point; 2]>| lane.is_some_and(|lane| lane.iter().any(is_there));
    let index = blocks.iter().position(|block| begins(block.lanes.first()) || begins(block.lanes.last()))?;
    let mut lanes = blocks.swap_remove(index).lanes;
    if !begins(lanes.first()) {
        lanes.reverse();
    }
    let flipped = !is_there(&lanes[0][0]);
    for (number, lane) in lanes.iter_mut().enumerate() {
        if (number % 2 == 1) != flipped {
            lane.reverse();
        }
    }
    Some(lanes)
}

/// Extends a path to a place, straight or round obstacles.
fn connect(map: &CoverageMap, routes: &mut Routes, points: &mut Vec<Point>, place: Point) {
    let here = points[points.len() - 1];
    if is_free(map, here, place) {
        points.push(place);
        return;
    }
    let (Some(from), Some(to)) = (map.raster().cell_at(here), map.raster().cell_at(place)) else { return };
    if routes.search(map, from, |cell| cell == to).is_some() {
        points.extend(routes.to(map, to).into_iter().skip(1));
    }
}

/// Drives to the nearest worthwhile places until the floor is covered.
fn visit_the_rest(
    map: &CoverageMap,
    routes: &mut Routes,
    planned: &mut CoverageMap,
    points: &mut Vec<Point>,
) {
    let robot = planned.robot();
    let mut visits = 0;
    for (share, enough) in WORTH {
        let worth = ((robot.len() as f64 * share) as usize).max(1);
        while planned.share() < enough && visits < VISITS {
            visits += 1;
            let here = points[points.len() - 1];
            let Some(from) = map.raster().cell_at(here) else { return };
            let found = routes.search(map, from, |cell| planned.gain(cell, &robot) >= worth);
            let Some(goal) = found.filter(|&goal| goal != from) else { break };
            for place in routes.to(map, goal).into_iter().skip(1) {
                planned.cover_line(points[points.len() - 1], place, ERROR);
                points.push(place);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::CoverageMapParameters;
    use super::*;
    use crate::geometry::Pose;
    use crate::world::{Object, ObjectKind, Wall, World};
    use proptest::prelude::*;

    const START: Point = Point::new(0.2, 0.2);

    proptest! {
        #![proptest_config(crate::testing::cases(12))]
        #[test]
        fn plans_cover_the_floor_and_stay_on_it(
            width in 1.4..2.4f64, depth in 1.2..2.0f64, wall in 0.3..0.7f64, x in 0.3..0.8f64, y in 0.4..0.8f64, turn in 0.0..1.5f64,
        ) {
            let mut world = World::walled(width, depth);
            let middle = Point::new(0.5 * width, 0.0);
            world.walls.push(Wall::new(middle, Point::new(middle.x, wall * depth)));
            let kind = std::sync::Arc::new(ObjectKind::predefined("crate").unwrap());
            world.objects.push(Object::new(kind, Pose::new(x * width, y * depth, turn)));
            let Ok(mut map) = CoverageMap::new(&world, START, CoverageMapParameters::default()) else { return Ok(()) };
            let plan = CoveragePlan::new(&map, START).unwrap();
            // The plan assumes a cross-track error of a few millimetres.
            prop_assert!(plan.share() >= 0.94, "{}", plan.share());
            prop_assert!(plan.length() < 1.7 * map.area() / 0.12, "{} m for {} m2", plan.length(), map.area());
            for two in plan.points().windows(2) {
                prop_assert!(is_free(&map, two[0], two[1]), "{:?}", two);
                map.cover_line(two[0], two[1], 0.0);
            }
            prop_assert!(map.share() >= 0.98, "{}", map.share());
        }
    }

    #[test]
    fn what_is_covered_is_what_was_passed_over() {
        let mut map =
            CoverageMap::new(&World::walled(1.0, 1.0), START, CoverageMapParameters::default()).unwrap();
        assert_eq!((map.share(), map.cells(true).count()), (0.0, 0));
        map.cover(Point::new(0.5, 0.5));
        let disc = std::f64::consts::PI * 0.06 * 0.06;
        assert!((map.share() * map.area() - disc).abs() < 0.1 * disc);
        map.cover_line(Point::new(0.2, 0.5), Point::new(0.8, 0.5), 0.0);
        // The cells at either edge may or may not count.
        assert!((map.share() * map.area() - disc - 0.6 * 0.12).abs() < 0.6 * 0.02);
        // The clearance of 15 mm and the robot's round corners stay uncovered.
        assert!((map.area() - 0.96 * 0.96).abs() < 0.04, "{}", map.area());
    }

    #[test]
    fn nonsense_is_refused() {
        let good = CoverageMapParameters::default();
        let world = World::walled(1.0, 1.0);
        for bad in [
            CoverageMapParameters { radius: 0.0, ..good },
            CoverageMapParameters { resolution: 0.05, ..good },
            CoverageMapParameters { overlap: 0.1, ..good },
            CoverageMapParameters { margin: f64::NAN, ..good },
        ] {
            assert!(CoverageMap::new(&world, START, bad).is_err());
        }
        assert!(CoverageMap::new(&world, Point::new(0.03, 0.5), good).is_err());
        assert!(CoverageMap::new(&world, Point::new(5.0, 5.0), good).is_err());
    }
}
