use super::shape::Block;
use crate::geometry::{Aabb, Point};

/// Walls per cluster.
pub(super) const CLUSTER: usize = 4;
/// Clusters per district.
const DISTRICT: usize = 16;

/// Bounding boxes of groups of adjacent walls, and of groups of adjacent clusters.
#[derive(Debug, Clone)]
pub(super) struct Clusters {
    pub(super) clusters: Vec<Cluster>,
    districts: Vec<Cluster>,
}

/// An interval of walls or clusters with its bounding box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cluster {
    pub(super) bounds: Aabb,
    first: u32,
    end: u32,
}

impl Cluster {
    /// Indices of its members.
    #[inline]
    pub(super) fn members(&self) -> std::ops::Range<usize> {
        self.first as usize..self.end as usize
    }

    /// Squared distance to a point (m²).
    #[inline]
    pub(super) fn squared_distance(&self, point: Point) -> f64 {
        let x = (self.bounds.min.x - point.x).max(point.x - self.bounds.max.x).max(0.0);
        let y = (self.bounds.min.y - point.y).max(point.y - self.bounds.max.y).max(0.0);
        x * x + y * y
    }
}

impl Clusters {
    /// Sorts walls so that neighbours of similar size are adjacent, and groups them.
    pub(super) fn of(walls: &[Block]) -> (Vec<Block>, Self) {
        let boxes: Vec<Aabb> = walls.iter().map(Block::bounds).collect();
        let all = boxes.iter().copied().reduce(|a, b| a.union(&b));
        let all = all.unwrap_or(Aabb::new(Point::origin(), Point::origin()));
        let mut order: Vec<(u16, u64, usize)> =
            boxes.iter().enumerate().map(|(i, b)| (size_class(b), place_along_curve(b, &all), i)).collect();
        order.sort_unstable();
        let mut clusters: Vec<Cluster> = Vec::new();
        let mut class = None;
        for (position, &(size, _, wall)) in order.iter().enumerate() {
            let position = position as u32;
            match clusters.last_mut() {
                Some(last) if class == Some(size) && last.members().len() < CLUSTER => {
                    last.bounds = last.bounds.union(&boxes[wall]);
                    last.end = position + 1;
                }
                _ => clusters.push(Cluster { bounds: boxes[wall], first: position, end: position + 1 }),
            }
            class = Some(size);
        }
        let districts = (0..clusters.len()).step_by(DISTRICT).map(|first| {
            let end = (first + DISTRICT).min(clusters.len());
            let bounds =
                clusters[first + 1..end].iter().fold(clusters[first].bounds, |b, c| b.union(&c.bounds));
            Cluster { bounds, first: first as u32, end: end as u32 }
        });
        let districts = districts.collect();
        (order.iter().map(|&(_, _, wall)| walls[wall]).collect(), Self { clusters, districts })
    }

    /// Visits the clusters within reach of a point, with their squared distances.
    #[inline]
    pub(super) fn for_each_near(&self, point: Point, reach: f64, mut visit: impl FnMut(usize, f64)) {
        let limit = reach * reach * (1.0 + 1e-9);
        for district in self.districts.iter().filter(|d| d.squared_distance(point) <= limit) {
            for number in district.members() {
                let distance = self.clusters[number].squared_distance(point);
                if distance <= limit {
                    visit(number, distance);
                }
            }
        }
    }
}

/// Class of a size; sizes that differ by less than a factor of four usually share a class.
fn size_class(bounds: &Aabb) -> u16 {
    let size = bounds.size().amax();
    (size.to_bits() >> 53) as u16
}

/// Position of a box's centre along a Z-order curve over `all`.
fn place_along_curve(bounds: &Aabb, all: &Aabb) -> u64 {
    let size = all.size();
    let middle = (bounds.min.coords + bounds.max.coords) * 0.5 - all.min.coords;
    let step = |along: f64, extent: f64| if extent > 0.0 { (along / extent * 65_535.0) as u16 } else { 0 };
    spread(step(middle.x, size.x)) | spread(step(middle.y, size.y)) << 1
}

/// Inserts a zero between the bits of a number.
fn spread(bits: u16) -> u64 {
    (0..16).fold(0, |all, bit| all | (u64::from(bits >> bit & 1) << (2 * bit)))
}
