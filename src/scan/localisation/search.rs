use std::f64::consts::{PI, SQRT_2};

use super::LocaliserParameters;
use super::map::LocalisationMap;
use super::surfaces::{STEP, Surfaces};
use crate::geometry::{Aabb, Point, Pose, Vector, math, normalize_angle};
use crate::io::LidarScan;
use crate::kinematics::OUTLIER;

/// Search for all poses at which a scan's points lie on surfaces.
///
/// A block of poses is a square of positions and an interval of headings. Within a block, a point moves from
/// its position at the block's centre by at most the block's size; if the nearest surface is farther, the
/// whole block misses that point. Blocks that miss too many points are discarded, others are divided into
/// eight: branch and bound (E. Olson, *Real-Time Correlative Scan Matching*, 2009; W. Hess et al., *Real-Time
/// Loop Closure in 2D LIDAR SLAM*, 2016), with a distance map instead of a pyramid of maps.
struct Search<'a> {
    surfaces: &'a Surfaces,
    /// Points in the robot frame (m).
    points: Vec<Point>,
    levels: Vec<Level>,
    /// Maximum number of points that may miss all surfaces.
    misses: usize,
    found: Vec<Pose>,
}

/// Blocks of one size.
struct Level {
    /// Half the edge (m), and half the heading interval (rad).
    half: (f64, f64),
    /// Maximum distance of each point from a surface (steps).
    reach: Vec<u8>,
}

/// Centre of a block.
#[derive(Clone, Copy)]
struct Middle {
    place: Point,
    heading: f64,
}

/// Edge of the smallest blocks (m).
const LEAF: f64 = 0.05;
/// Minimum lever arm for headings (m). In a small round room built of straight pieces, a scan rotated by one
/// piece fits nearly as well, but is another pose.
const NEAREST: f64 = 3.0;
/// Number of divisions of the largest blocks.
const LEVELS: usize = 6;
/// Level at which one pose per block is kept.
const KEPT: usize = 2;
/// Number of scan points that are compared.
const COMPARED: usize = 72;
/// Maximum number of blocks that may be found.
const MOST_BLOCKS: usize = 2000;

/// One pose for each small block of some bounds in which a fraction `share` of the scan's points may lie on
/// surfaces; `None` if there are too many such blocks, because the scan is too ambiguous.
pub(super) fn search(
    map: &LocalisationMap,
    bounds: &Aabb,
    scan: &LidarScan,
    parameters: &LocaliserParameters,
    share: f64,
) -> Option<Vec<Pose>> {
    let points = compared(scan);
    if points.is_empty() {
        return None;
    }
    let misses = ((1.0 - share) * points.len() as f64) as usize;
    let noise = OUTLIER * parameters.lidar_error();
    let levels = levels(&points, noise);
    let mut search = Search { surfaces: map.surfaces(), points, levels, misses, found: Vec::new() };
    search.blocks(bounds).then_some(search.found)
}

/// Points from all directions, ordered such that neighbours are far apart and a miss shows early.
fn compared(scan: &LidarScan) -> Vec<Point> {
    let all: Vec<Point> = scan.points().collect();
    let every = all.len().div_ceil(COMPARED).max(1);
    let chosen: Vec<Point> = all.into_iter().step_by(every).collect();
    let count = chosen.len();
    // Multiples of the golden ratio fill a circle evenly.
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| {
        let turn = |i: usize| (i as f64 * 0.618_033_988_749_895).fract();
        turn(a).total_cmp(&turn(b))
    });
    order.into_iter().map(|i| chosen[i]).collect()
}

/// Block sizes in which rotation moves the farthest point as much as translation, smallest first.
fn levels(points: &[Point], noise: f64) -> Vec<Level> {
    let arms: Vec<f64> = points.iter().map(|point| point.coords.norm()).collect();
    let far = arms.iter().copied().fold(NEAREST, f64::max);
    let largest = 0.5 * LEAF * f64::from(1_u32 << LEVELS);
    // The largest intervals cover the full circle.
    let largest_turn = PI / (PI * far / (SQRT_2 * largest)).ceil().max(1.0);
    (0..=LEVELS)
        .map(|level| {
            let part = 1.0 / f64::from(1_u32 << (LEVELS - level));
            let half = (largest * part, largest_turn * part);
            let reach = arms.iter().map(|arm| (noise + SQRT_2 * half.0 + arm * half.1) / STEP);
            Level { half, reach: reach.map(|steps| steps.min(f64::from(u8::MAX)) as u8).collect() }
        })
        .collect()
}

impl Search<'_> {
    /// Searches all blocks of a box; false if too much is found.
    fn blocks(&mut self, bounds: &Aabb) -> bool {
        let (half, half_turn) = self.levels[LEVELS].half;
        let size = bounds.size();
        let count = |length: f64, half: f64| (0.5 * length / half).ceil().max(1.0) as usize;
        let (columns, rows, turns) = (count(size.x, half), count(size.y, half), count(2.0 * PI, half_turn));
        let middle = |index: usize, half: f64| (2 * index + 1) as f64 * half;
        (0..turns).all(|turn| {
            let heading = middle(turn, half_turn) - PI;
            let (sin, cos) = math::sin_cos(heading);
            (0..rows * columns).all(|index| {
                let offset = Vector::new(middle(index % columns, half), middle(index / columns, half));
                let block = Middle { place: bounds.min + offset, heading };
                !self.may_fit(LEVELS, &block, sin, cos) || self.divide(LEVELS, &block)
            })
        })
    }

    /// Divides a block that may contain poses; false if too much is found.
    fn divide(&mut self, level: usize, block: &Middle) -> bool {
        if level == KEPT {
            let best = self.best(level, block);
            self.found.extend(best.map(|(_, pose)| pose));
            return self.found.len() <= MOST_BLOCKS;
        }
        self.parts(level, block).into_iter().flatten().all(|part| self.divide(level - 1, &part))
    }

    /// Best pose in a block, and the sum of its points' distances from surfaces.
    fn best(&self, level: usize, block: &Middle) -> Option<(u32, Pose)> {
        if level == 0 {
            let Middle { place, heading } = *block;
            let pose = Pose::new(place.x, place.y, normalize_angle(heading));
            return Some((self.distance(block), pose));
        }
        let parts = self.parts(level, block).into_iter().flatten();
        parts.filter_map(|part| self.best(level - 1, &part)).min_by_key(|(distance, _)| *distance)
    }

    /// The eight parts of a block, those that may contain poses.
    fn parts(&self, level: usize, block: &Middle) -> [Option<Middle>; 8] {
        let (half, half_turn) = self.levels[level - 1].half;
        let headings = [block.heading - half_turn, block.heading + half_turn];
        let turned = headings.map(math::sin_cos);
        std::array::from_fn(|part| {
            let side = |bit: usize| if part >> bit & 1 == 0 { -half } else { half };
            let place = block.place + Vector::new(side(0), side(1));
            let (sin, cos) = turned[part >> 2];
            let part = Middle { place, heading: headings[part >> 2] };
            self.may_fit(level - 1, &part, sin, cos).then_some(part)
        })
    }

    /// Whether at most `misses` points certainly miss all surfaces.
    fn may_fit(&self, level: usize, block: &Middle, sin: f64, cos: f64) -> bool {
        let mut left = self.misses;
        self.points.iter().zip(&self.levels[level].reach).all(|(point, &reach)| {
            let (x, y) = (cos * point.x - sin * point.y, sin * point.x + cos * point.y);
            if self.surfaces.at(block.place.x + x, block.place.y + y) <= reach {
                return true;
            }
            let spared = left > 0;
            left = left.saturating_sub(1);
            spared
        })
    }

    /// Sum of the points' distances to surfaces, each clipped at a miss (steps).
    fn distance(&self, block: &Middle) -> u32 {
        let (sin, cos) = math::sin_cos(block.heading);
        let points = self.points.iter().zip(&self.levels[0].reach);
        let steps = points.map(|(point, &reach)| {
            let (x, y) = (cos * point.x - sin * point.y, sin * point.x + cos * point.y);
            u32::from(self.surfaces.at(block.place.x + x, block.place.y + y).min(reach))
        });
        steps.sum()
    }
}
