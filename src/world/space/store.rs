use super::cluster::Clusters;
use super::grid::Grid;
use super::lattice::Cells;
use super::shape::{Block, Shape};
use super::solid::{Solid, SolidId, Span};
use crate::geometry::{Aabb, Pose};
use crate::world::Wall;

/// An index of static walls and moving solids.
///
/// Walls are rectangles of the wall's thickness about its line, from the floor to the wall's height; a wall
/// of thickness 0 is a line. Memory and construction time are proportional to the number of walls and solids.
/// Coordinates must be numbers; up to some thousand kilometres they give results accurate to 1 µm.
#[derive(Debug, Clone)]
pub struct Space {
    /// In the order of the clusters.
    pub(super) walls: Vec<Block>,
    pub(super) clusters: Clusters,
    pub(super) solids: Vec<Placed>,
    /// The solids as their users described them, apart from what queries look at.
    described: Vec<Solid>,
    pub(super) grid: Grid,
    /// The grid is rebuilt at this number of solids ...
    full_at: usize,
    /// ... or when too many solids have left its cells.
    strays: usize,
    strays_allowed: usize,
}

/// A solid with its index data.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    pub(super) shape: Shape,
    pub(super) span: Span,
    pub(super) taper: f64,
    pub(super) mast: Option<Box<Block>>,
    /// Elevation of the ground on hills; its heights are relative to that (m).
    pub(super) level: f64,
    /// Cells that list it; `None`: every query tests it.
    pub(super) cells: Option<Cells>,
    /// Whether it is not completely on cells.
    stray: bool,
}

impl Placed {
    /// Radius of a disc at a height, for rays.
    #[inline]
    pub(super) fn radius_at(&self, z: f64) -> f64 {
        match self.shape {
            Shape::Disc { radius, .. } if self.taper == 0.0 => radius,
            Shape::Disc { radius, .. } => radius - self.taper * (z - self.span.bottom),
            Shape::Box(_) => 0.0,
        }
    }
}

impl Space {
    /// A space with these walls and no solids.
    pub fn new(walls: &[Wall]) -> Self {
        let (walls, clusters) = Clusters::of(&walls.iter().map(Block::of_wall).collect::<Vec<_>>());
        let grid = Grid::new(&walls, &[]);
        let (solids, described) = (Vec::new(), Vec::new());
        Self { walls, clusters, solids, described, grid, full_at: 16, strays: 0, strays_allowed: 16 }
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
        let (taper, mast) = (solid.taper, solid.placed_mast().map(Box::new));
        self.described.push(solid);
        self.solids.push(Placed { shape, span, taper, mast, level: 0.0, cells: None, stray: false });
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
        let (placed, described) = (&mut self.solids[id.index()], &mut self.described[id.index()]);
        described.pose = pose;
        match &mut placed.shape {
            Shape::Disc { centre, .. } => *centre = pose.position(),
            shape @ Shape::Box(_) => *shape = described.outline.at(&pose),
        }
        if placed.mast.is_some() {
            placed.mast = described.placed_mast().map(Box::new);
        }
        let bounds = placed.shape.bounds();
        let cells = self.grid.place_for(&bounds);
        if cells.is_some() && cells == placed.cells {
            return;
        }
        self.relist(id.0, &bounds);
    }

    /// Changes the height of a solid's top. A solid of zero height has no contacts.
    ///
    /// # Panics
    ///
    /// If the solid is of another space that holds more solids.
    pub fn set_top(&mut self, id: SolidId, top: f64) {
        self.described[id.index()].top = top;
        self.solids[id.index()].span.top = top;
    }

    /// A solid with its present pose.
    ///
    /// # Panics
    ///
    /// If the solid is of another space that holds more solids.
    pub fn solid(&self, id: SolidId) -> &Solid {
        &self.described[id.index()]
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

    /// Builds a grid for the present number and places of solids. Answers do not change.
    fn rebuild(&mut self) {
        let bounds: Vec<Aabb> = self.solids.iter().map(|placed| placed.shape.bounds()).collect();
        self.grid = Grid::new(&self.walls, &bounds);
        self.strays = 0;
        for (number, bounds) in bounds.iter().enumerate() {
            self.list(number as u32, bounds);
        }
        self.full_at = 2 * self.solids.len().max(8);
        // Solids beyond the farthest cell remain strays; the next rebuild must be worth its cost.
        self.strays_allowed = 2 * self.strays + 16 + self.solids.len() / 4;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Vector};
    use crate::world::Footprint;
    use crate::world::World;
    use crate::world::space::Scanner;

    const DISC: Footprint = Footprint::Disc { radius: 0.1 };

    fn disc(x: f64, y: f64) -> Solid {
        Solid::new(DISC, Pose::new(x, y, 0.0), 0.0, 0.2)
    }

    /// Makes every query once, at a place between two things 1 m to its left and right.
    fn answers(space: &Space, x: f64, y: f64) {
        let eye = Point::new(x, y);
        for direction in [Vector::x(), -Vector::x()] {
            let range = space.cast_ray(eye, direction, 0.1, f64::INFINITY, None);
            assert!((range - 1.0).abs() < 1e-5, "{range}");
        }
        let pose = Pose::new(x, y, 0.0);
        let mut ranges = [0.0; 2];
        space.scan(&mut Scanner::new(0.0, std::f64::consts::PI, 2, 0.1, 0.0, 5.0), &pose, None, &mut ranges);
        assert!(ranges.iter().all(|range| (range - 1.0).abs() < 1e-5), "{ranges:?}");
        let span = Span { bottom: 0.0, top: 0.1 };
        assert!((space.clearance(&DISC, &pose, span, 2.0, None) - 0.9).abs() < 1e-5);
        let mut contacts = Vec::new();
        space.contacts(&DISC, &Pose::new(x + 0.95, y, 0.0), span, None, &mut contacts);
        assert_eq!(contacts.len(), 1);
        assert!((contacts[0].normal + Vector::x()).norm() < 1e-5 && (contacts[0].depth - 0.05).abs() < 1e-5);
    }

    fn gate(x: f64, y: f64, half_length: f64) -> [Wall; 2] {
        [-1.005, 1.005].map(|side| {
            Wall::new(Point::new(x + side, y - half_length), Point::new(x + side, y + half_length))
        })
    }

    #[test]
    fn a_world_of_any_extent_has_answers() {
        for (x, y, half_length) in
            [(0.0, 0.0, 1.0), (-300.0, 40.0, 5_000.0), (1e6, -1e6, 10.0), (-1e8, 1e8, 10.0), (0.0, 0.0, 1e12)]
        {
            answers(&Space::new(&gate(x, y, half_length)), x, y);
        }
    }

    #[test]
    fn small_things_in_a_huge_world_have_answers() {
        let mut walls = gate(3.0, 4.0, 1.0).to_vec();
        walls.push(Wall::new(Point::new(-5_000.0, -5_000.0), Point::new(5_000.0, -5_000.0)));
        walls.push(Wall::new(Point::new(1e13, 1e13), Point::new(3e13, -4e13)));
        answers(&Space::new(&walls), 3.0, 4.0);
    }

    #[test]
    fn coordinates_beyond_all_sense_do_no_harm() {
        let huge = [0.0, 1.0, -1e9, 1e155, -1e300, f64::MAX, -f64::MAX];
        let points: Vec<Point> =
            huge.iter().flat_map(|&x| huge.iter().map(move |&y| Point::new(x, y))).collect();
        let walls: Vec<Wall> = points.windows(9).map(|pair| Wall::new(pair[0], pair[8])).collect();
        let mut space = Space::new(&walls);
        let ids: Vec<SolidId> = points.iter().map(|p| space.add(disc(p.y, p.x))).collect();
        let mut scanner = Scanner::new(0.0, 0.1, 63, 0.1, 0.0, f64::INFINITY);
        let mut ranges = [0.0; 63];
        for (point, &id) in points.iter().zip(&ids) {
            let pose = Pose::new(point.x, point.y, 0.0);
            space.set_pose(id, pose);
            space.scan(&mut scanner, &pose, Some(id), &mut ranges);
            let ray = space.cast_ray(*point, Vector::y(), 0.1, f64::MAX, None);
            assert!(ranges.iter().chain([&ray]).all(|&range| range >= 0.0));
        }
    }

    #[test]
    fn walls_without_length_are_hit_and_touched() {
        let points = [-1.0, 1.0].map(|x| {
            let p = Point::new(x, 0.0);
            Wall { thickness: 0.2, ..Wall::new(p, p) }
        });
        answers(&Space::new(&points), 0.0, 0.0);
    }

    #[test]
    fn solids_without_walls_have_answers_wherever_they_go() {
        let mut space = Space::new(&[]);
        let ids: Vec<SolidId> = (0..200).map(|i| space.add(disc(f64::from(i), 7.0))).collect();
        for place in [0.0, -50.0, 2e3, 1e8, -3.0] {
            space.set_pose(ids[0], Pose::new(place - 1.1, 0.0, 0.0));
            space.set_pose(ids[1], Pose::new(place + 1.1, 0.0, 0.0));
            for &id in &ids[2..] {
                space.set_pose(id, Pose::new(place, 1000.0 + id.index() as f64, 0.0));
            }
            answers(&space, place, 0.0);
        }
        assert_eq!(space.solids(), 200);
        assert_eq!(space.solid(ids[1]).pose, Pose::new(-1.9, 0.0, 0.0));
    }

    #[test]
    fn a_space_without_anything_is_empty() {
        let space = Space::new(&[]);
        assert_eq!(space.cast_ray(Point::origin(), Vector::x(), 0.1, 1e9, None), f64::INFINITY);
        let span = Span { bottom: 0.0, top: 1.0 };
        assert_eq!(space.clearance(&DISC, &Pose::default(), span, 3.0, None), 3.0);
    }

    #[test]
    fn memory_is_in_proportion_to_walls_and_solids() {
        // Long crossing walls in a world of 10 km: the worst case for a grid.
        let end = |i: u32| Point::new(f64::from(i * 7919 % 10_000), f64::from(i * 104_729 % 10_000));
        let walls: Vec<Wall> = (0..4_000).map(|i| Wall::new(end(i), end(i + 1))).collect();
        let mut space = Space::new(&walls);
        for i in 0..4_000 {
            let place = end(3 * i + 1);
            space.add(disc(place.x, place.y));
        }
        assert!(space.grid.size() < 40 * 8_000, "{}", space.grid.size());
    }

    #[test]
    fn what_stands_above_or_below_is_not_met() {
        let mut space = Space::new(&World::walled(4.0, 2.0).walls);
        let id = space.add(Solid { bottom: 0.1, top: 0.3, ..disc(2.0, 1.0) });
        let at = |z: f64| space.cast_ray(Point::new(1.0, 1.0), Vector::x(), z, 10.0, None);
        assert!((at(0.05) - 2.995).abs() < 1e-12 && (at(0.2) - 0.9).abs() < 1e-12);
        assert_eq!(at(0.35), f64::INFINITY);
        let touched = |bottom: f64, top: f64| {
            let mut contacts = Vec::new();
            let pose = Pose::new(2.05, 1.0, 0.0);
            space.contacts(&DISC, &pose, Span { bottom, top }, None, &mut contacts);
            contacts.iter().map(|contact| contact.with).collect::<Vec<_>>()
        };
        assert_eq!(touched(0.0, 0.1), []);
        assert_eq!(touched(0.3, 0.5), []);
        assert_eq!(touched(0.0, 0.11), [Some(id)]);
    }

    #[test]
    fn walls_come_first_among_contacts_then_solids_in_their_order() {
        let mut space = Space::new(&World::walled(4.0, 2.0).walls);
        let ids: Vec<SolidId> = (0..3).map(|i| space.add(disc(0.1 + 0.01 * f64::from(i), 0.1))).collect();
        let pose = Pose::new(0.09, 0.1, 0.0);
        let span = Span { bottom: 0.0, top: 0.1 };
        let mut contacts = Vec::new();
        space.contacts(&DISC, &pose, span, Some(ids[1]), &mut contacts);
        let with: Vec<_> = contacts.iter().map(|contact| contact.with).collect();
        assert_eq!(with, [None, None, Some(ids[0]), Some(ids[2])]);
        assert!(
            (contacts[0].depth - 0.015).abs() < 1e-12 && (contacts[0].normal - Vector::x()).norm() < 1e-12
        );
        assert!(
            (contacts[1].depth - 0.005).abs() < 1e-12 && (contacts[1].normal - Vector::y()).norm() < 1e-12
        );
        assert_eq!(space.walls_clearance(&DISC, &pose, span, 1.0), 0.0);
        let away = Pose::new(1.0, 1.0, 0.0);
        assert!((space.walls_clearance(&DISC, &away, span, 5.0) - 0.895).abs() < 1e-12);
        assert_eq!(space.walls_clearance(&DISC, &away, span, 0.5), 0.5);
    }
}
