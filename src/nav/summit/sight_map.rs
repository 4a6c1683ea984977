use super::parameters::{CAUTION, SummitParameters};
use super::sweep::Beam;
use crate::geometry::{Aabb, Point, Point3, Vector, math};
use crate::nav::elevation::{Climber, ElevationMap};
use crate::nav::grid::GridComponents;
use crate::world::{BitGrid, GridCell, HeightField};

/// What has been seen of the ground: the elevation of cells that beams met, and of all cells the most that
/// it can be, as beams passed over them.
#[derive(Debug, Clone)]
pub(super) struct SightMap {
    side: usize,
    resolution: f64,
    extent: f64,
    /// What the robot can drive over, as the map shows it: ground that is just gentle enough may seem
    /// steeper than it is.
    pub(super) climber: Climber,
    /// Two beams above each other that meet the ground less than this many metres apart show what is between.
    gap: f64,
    /// The weight of what was measured, and its mean.
    seen: Vec<(f64, f64)>,
    ceilings: Vec<f64>,
    /// The weight of what was measured on faces that are steeper and higher than the robot climbs.
    faces: Vec<f64>,
    /// Cells on which the robot has found that it cannot stand.
    shunned: Vec<bool>,
    /// Cells on which the robot has stood, and those beside them: it can go back the way that it came,
    /// however steep the ground seems to be.
    trodden: Vec<bool>,
    /// Cells that the robot did not see well enough from beside them: it does not go there to look again.
    given_up: Vec<bool>,
}

/// Cosine of the largest tilt of a robot that stands: 60 degrees.
pub(super) const MIN_UPRIGHT: f64 = 0.5;
/// The weight of what is between.
const BETWEEN: f64 = 0.05;
/// Metres at which a measurement weighs half.
const FAR: f64 = 1.0;
/// Metres beyond the last return that a beam shows to be no ground.
const REACH: f64 = 9.5;
/// The weight from which a cell is known well enough to compare with: what is between counts, as a single
/// look shows little else of ground farther away, which tells most about where the robot is.
const KNOWN: f64 = 0.04;

/// The map as the robot plans on it.
#[derive(Debug)]
pub(super) struct Chart {
    pub(super) elevation: ElevationMap,
    /// Where the robot can drive for all that it knows.
    pub(super) safe: BitGrid,
    /// Where it could drive at best.
    pub(super) perhaps: BitGrid,
    /// The elevation of each cell, or the most that it can be where the robot can drive.
    pub(super) potential: Vec<f64>,
}

/// Elevations of all cells, which of them are known, and how many cells the others are away from such.
struct Filled {
    heights: Vec<f32>,
    known: Vec<bool>,
    away: Vec<u16>,
}

/// Largest error of a slope of the map (rad).
const MEASURED: f64 = 0.06;
/// Largest error of a step of the map (m).
const NOISE: f64 = 0.01;
/// Area of a patch that is worth a look (m²), unless it is seen to be higher by more than a step's error.
const PATCH: f64 = 0.02;
/// The part of what was measured of a cell that lies on a face if the cell does: ground before it counts too.
const FACE: f64 = 0.5;
/// Depth below what a slope could lead to from which ground is a drop (m).
const DROP: f64 = 0.04;

impl SightMap {
    pub(super) fn new(parameters: &SummitParameters, gap: f64) -> Self {
        let SummitParameters { resolution, extent, climber, .. } = *parameters;
        let side = (2.0 * extent / resolution).round() as usize + 1;
        let climber = Climber { slope: climber.slope + MEASURED, step: climber.step + NOISE, ..climber };
        Self {
            side,
            resolution,
            extent,
            climber,
            gap,
            seen: vec![(0.0, 0.0); side * side],
            ceilings: vec![f64::INFINITY; side * side],
            faces: vec![0.0; side * side],
            shunned: vec![false; side * side],
            trodden: vec![false; side * side],
            given_up: vec![false; side * side],
        }
    }

    pub(super) fn cell_at(&self, place: Point) -> Option<GridCell> {
        let at = (place + Vector::new(self.extent, self.extent)).coords / self.resolution;
        let last = (self.side - 1) as f64 + 0.5;
        let inside = at.x >= -0.5 && at.y >= -0.5 && at.x < last && at.y < last;
        inside.then(|| GridCell::new(at.x.round() as usize, at.y.round() as usize))
    }

    pub(super) fn place(&self, cell: GridCell) -> Point {
        let at = |index: usize| index as f64 * self.resolution - self.extent;
        Point::new(at(cell.column), at(cell.row))
    }

    fn index(&self, place: Point) -> Option<usize> {
        self.cell_at(place).map(|cell| self.index_of(cell))
    }

    pub(super) fn index_of(&self, cell: GridCell) -> usize {
        cell.row * self.side + cell.column
    }

    /// The elevation of a cell, if it has been seen.
    pub(super) fn height(&self, index: usize) -> Option<f64> {
        let (weight, height) = self.seen[index];
        (weight > 0.0).then_some(height)
    }

    /// The mean elevation of a cell and of those around it that have been seen, if it has: the highest of
    /// many readings is one that errs upwards.
    pub(super) fn smoothed(&self, cell: GridCell) -> Option<f64> {
        let own = self.height(self.index_of(cell))?;
        let around = self.neighbours(self.index_of(cell)).filter_map(|near| self.height(near));
        let (sum, count) = around.fold((own, 1.0), |(sum, count), height| (sum + height, count + 1.0));
        Some(sum / count)
    }

    /// Elevation and gradient at a place all around which the ground has been seen, and is no face.
    pub(super) fn surface(&self, place: Point) -> Option<(f64, Vector)> {
        let cell = self.cell_at(place)?;
        let inside = |at: usize| at > 0 && at + 1 < self.side;
        if !inside(cell.column) || !inside(cell.row) {
            return None;
        }
        let index = self.index_of(cell);
        let known =
            |index: usize| (self.seen[index].0 >= KNOWN && !self.is_face(index)).then(|| self.seen[index].1);
        let (middle, width) = (known(index)?, 2.0 * self.resolution);
        let rise = Vector::new(
            (known(index + 1)? - known(index - 1)?) / width,
            (known(index + self.side)? - known(index - self.side)?) / width,
        );
        Some((middle + rise.dot(&(place - self.place(cell))), rise))
    }

    /// Forgets all that was seen.
    pub(super) fn clear(&mut self) {
        for flags in [&mut self.shunned, &mut self.trodden, &mut self.given_up] {
            flags.fill(false);
        }
        self.seen.fill((0.0, 0.0));
        self.ceilings.fill(f64::INFINITY);
        self.faces.fill(0.0);
    }

    /// Takes in the beams of one azimuth, from the lowest tilt up, from a robot that stands at a place.
    pub(super) fn add_fan(&mut self, place: Point3, fan: &[Beam]) {
        let mut before = Some(place);
        for beam in fan {
            let end = beam.end();
            self.lower_ceilings(beam);
            if let Some(end) = end {
                let away = (end - beam.origin).norm();
                let weight = 1.0 / (1.0 + (away / FAR) * (away / FAR));
                self.measure(end.xy(), end.z, weight);
                if let Some(before) = before {
                    self.bridge(before, end);
                }
                if beam.is_on_face
                    && let Some(index) = self.index(end.xy())
                {
                    self.faces[index] += weight;
                }
            }
            before = end;
        }
    }

    /// Whether a good part of what was measured of a cell lies on a face.
    fn is_face(&self, index: usize) -> bool {
        self.faces[index] > FACE * self.seen[index].0
    }

    fn measure(&mut self, place: Point, height: f64, weight: f64) {
        if let Some(index) = self.index(place) {
            let (known, mean) = self.seen[index];
            let sum = known + weight;
            self.seen[index] = (sum, mean + (height - mean) * weight / sum);
        }
    }

    /// What lies between two ends is as high as the line between them, as long as nothing better is known.
    fn bridge(&mut self, from: Point3, to: Point3) {
        let way = to - from;
        let run = way.xy().norm();
        if run > self.gap {
            return;
        }
        let parts = (run / self.resolution).ceil();
        for part in 1..parts as usize {
            let at = from + way * (part as f64 / parts);
            if self.index(at.xy()).is_some_and(|index| self.seen[index].0 < BETWEEN) {
                self.measure(at.xy(), at.z, BETWEEN);
            }
        }
    }

    fn lower_ceilings(&mut self, beam: &Beam) {
        let run = beam.direction.xy().norm();
        if run < 1e-6 {
            return;
        }
        let length = if beam.range.is_finite() { beam.range * run - self.resolution } else { REACH * run };
        let (ahead, slope) = (beam.direction.xy() / run, beam.direction.z / run);
        for step in 0..(length / self.resolution).max(0.0) as usize {
            let away = step as f64 * self.resolution;
            let Some(index) = self.index(beam.origin.xy() + ahead * away) else { return };
            // The beam is lowest in the cell at one of its edges.
            let height = beam.origin.z + slope * away + 0.5 * slope.abs() * self.resolution;
            self.ceilings[index] = self.ceilings[index].min(height);
            // What a beam passes below is no ground: the robot was not where it took itself to be. At the
            // edge of a level, a beam comes from above it and leaves the cell below it.
            let highest = beam.origin.z + slope * away + slope.abs() * self.resolution;
            if self.height(index).is_some_and(|ground| ground - DROP > highest) {
                self.seen[index] = (0.0, 0.0);
                self.faces[index] = 0.0;
            }
        }
    }

    /// The ground under a robot that stands.
    pub(super) fn stand(&mut self, place: Point3) {
        self.measure(place.xy(), place.z, 1.0);
    }

    /// Notes that the robot is at a place.
    pub(super) fn tread(&mut self, place: Point) {
        let Some(index) = self.index(place) else { return };
        self.trodden[index] = true;
        for near in self.neighbours(index) {
            self.trodden[near] = true;
        }
    }

    /// Notes that the robot cannot stand around a place.
    pub(super) fn shun(&mut self, place: Point, radius: f64) {
        for index in self.around(place, radius) {
            self.shunned[index] = true;
        }
    }

    /// Forgets where the robot could not stand: it may have come there the wrong way. Whether there was
    /// such a place.
    pub(super) fn forget_shunned(&mut self) -> bool {
        let any = self.shunned.contains(&true);
        self.shunned.fill(false);
        any
    }

    /// Notes that a look from beside a place shows no way on. Ground there that is seen from elsewhere is
    /// as good as any.
    pub(super) fn give_up(&mut self, place: Point, radius: f64) {
        for index in self.around(place, radius) {
            self.given_up[index] = true;
        }
    }

    fn around(&self, place: Point, radius: f64) -> Vec<usize> {
        let is_near = |index: &usize| {
            let cell = GridCell::new(index % self.side, index / self.side);
            (self.place(cell) - place).norm() <= radius
        };
        (0..self.seen.len()).filter(is_near).collect()
    }

    /// Where a robot can drive, and where it perhaps can. It does not know its place better than a distance
    /// (m).
    pub(super) fn chart(&self, parameters: &SummitParameters, doubt: f64) -> Chart {
        let climber = &self.climber;
        let Filled { heights, known, away } = self.filled();
        let corner = Point::new(self.extent, self.extent);
        let area = Aabb::new(-corner, corner);
        let field = HeightField::new(self.side, self.side, area, heights).expect("a map of finite heights");
        let lowest = parameters.lowest.unwrap_or(f64::NEG_INFINITY);
        let elevation = ElevationMap::new(&field, climber).and_then(|map| map.above(lowest));
        let elevation = elevation.expect("parameters that have been checked");
        let reach = (climber.radius / self.resolution).round() as usize;
        // The fence has a margin of its own, whatever is beyond it.
        let is_beyond = |index: usize| {
            let place = self.place(GridCell::new(index % self.side, index / self.side));
            parameters.fence.is_some_and(|fence| !fence.holds(place))
        };
        let covered: Vec<bool> = (0..known.len()).map(|index| known[index] || is_beyond(index)).collect();
        let covered = eroded(&covered, self.side, reach + 1);
        let grid = |is_free: &dyn Fn(usize) -> bool| {
            let side = self.side;
            BitGrid::from_fn(side, side, |x, y| is_free(y * side + x)).expect("a map's cells")
        };
        let open = |index: usize| {
            let cell = GridCell::new(index % self.side, index / self.side);
            elevation.open().is_free(cell) && !self.shunned[index]
        };
        // What lies lower than a slope could lead to that the robot can drive.
        let steepest = math::tan(climber.slope) * self.resolution;
        let drops = |index: usize| {
            let least = f64::from(field_height(&field, index)) - steepest * f64::from(away[index]) - DROP;
            !known[index] && self.ceilings[index] < least
        };
        // In turns belts slide down, and do not come up again from ground that is too steep.
        let is_brink = |index: usize| {
            let is_pit = |near: usize| {
                covered[near] && !open(near) && field_height(&field, near) < field_height(&field, index)
            };
            self.neighbours(index).any(is_pit)
        };
        let fenced = |index: usize| {
            parameters.holds(self.place(GridCell::new(index % self.side, index / self.side)), doubt)
        };
        let is_even = |index: usize| !drops(index) && !self.is_face(index);
        let holds: Vec<bool> = (0..known.len()).map(|index| is_even(index) || is_beyond(index)).collect();
        let clear = eroded(&holds, self.side, reach + (CAUTION / self.resolution).round() as usize);
        let is_safe = |index: usize| {
            let is_even = covered[index] && open(index) && !is_brink(index)
                || self.trodden[index] && !self.shunned[index];
            fenced(index) && clear[index] && is_even
        };
        let safe = grid(&is_safe);
        let perhaps = grid(&|index| {
            let is_hopeless = self.shunned[index] || self.given_up[index];
            let may_be_even = !covered[index] || open(index) && !is_brink(index);
            is_safe(index) || fenced(index) && holds[index] && may_be_even && !is_hopeless
        });
        let potential = (0..known.len()).map(|index| {
            let slope = f64::from(field_height(&field, index)) + steepest * f64::from(away[index]) + DROP;
            self.height(index).unwrap_or_else(|| self.ceilings[index].min(slope))
        });
        Chart { elevation, safe, perhaps, potential: potential.collect() }
    }

    /// Elevations of all cells, and which of them have been seen or lie in small gaps between such. Where
    /// nothing is known, the ground goes on as it is at the nearest known place.
    fn filled(&self) -> Filled {
        let mut known: Vec<bool> = self.seen.iter().map(|(weight, _)| *weight > 0.0).collect();
        let mut heights: Vec<f32> = self.seen.iter().map(|(_, height)| *height as f32).collect();
        let mut filled = known.clone();
        let mut edge: Vec<usize> = (0..filled.len()).filter(|&index| filled[index]).collect();
        let mut away = vec![0; filled.len()];
        for round in 1.. {
            let mut next: Vec<usize> = edge
                .iter()
                .flat_map(|&index| self.neighbours(index))
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
                    let around: Vec<usize> = self.neighbours(index).filter(|&near| filled[near]).collect();
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
        Filled { heights, known, away }
    }

    fn neighbours(&self, index: usize) -> impl Iterator<Item = usize> + use<> {
        let (side, column, row) = (self.side, index % self.side, index / self.side);
        let rows = row.saturating_sub(1)..(row + 2).min(side);
        rows.flat_map(move |y| (column.saturating_sub(1)..(column + 2).min(side)).map(move |x| y * side + x))
            .filter(move |&near| near != index)
    }

    /// The cells that may be higher than a level and may be reached from a cell, in patches that are worth
    /// a look.
    pub(super) fn higher(&self, chart: &Chart, from: GridCell, level: f64) -> Vec<Vec<GridCell>> {
        let perhaps = GridComponents::new(&chart.perhaps);
        let safe = GridComponents::new(&chart.safe);
        let is_higher = |index: usize| {
            let cell = GridCell::new(index % self.side, index / self.side);
            chart.potential[index] > level && perhaps.connected(from, cell) && !safe.connected(from, cell)
        };
        let side = self.side;
        let cells = BitGrid::from_fn(side, side, |x, y| is_higher(y * side + x)).expect("a map's cells");
        let patches = GridComponents::new(&cells);
        let least = (PATCH / (self.resolution * self.resolution)) as usize;
        let stands_out = |cell: GridCell| self.smoothed(cell).is_some_and(|height| height > level + NOISE);
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

fn field_height(field: &HeightField, index: usize) -> f32 {
    field.sample(index % field.columns(), index / field.columns()) as f32
}

/// Which cells have only flagged ones within a reach along both axes.
fn eroded(flags: &[bool], side: usize, reach: usize) -> Vec<bool> {
    let along = |flags: &[bool], stride: usize, other: usize| {
        let mut kept = vec![false; flags.len()];
        for line in 0..side {
            let mut run = 0;
            for at in 0..side {
                run = if flags[line * other + at * stride] { run + 1 } else { 0 };
                if run > 2 * reach {
                    kept[line * other + (at - reach) * stride] = true;
                }
            }
        }
        kept
    };
    along(&along(flags, 1, side), side, 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector3;
    use crate::world::RobotSpec;

    /// A look that shows no way on gives up ground only until it is seen from elsewhere.
    #[test]
    fn what_was_given_up_is_safe_once_it_is_seen() {
        let mut parameters = SummitParameters::of(&RobotSpec::blizzard()).unwrap();
        parameters.extent = 1.0;
        let mut map = SightMap::new(&parameters, 0.35);
        let place = Point::new(0.5, 0.0);
        let cell = map.cell_at(place).unwrap();
        let see = |map: &mut SightMap, low: i32, high: i32| {
            for (x, y) in (low..high).flat_map(|x| (-18..=18).map(move |y| (x, y))) {
                map.stand(Point3::new(0.05 * f64::from(x), 0.05 * f64::from(y), 0.0));
            }
        };
        see(&mut map, -18, 8);
        let chart = map.chart(&parameters, 0.0);
        assert!(chart.perhaps.is_free(cell) && !chart.safe.is_free(cell));
        map.give_up(place, 0.15);
        assert!(!map.chart(&parameters, 0.0).perhaps.is_free(cell));
        see(&mut map, 8, 19);
        let chart = map.chart(&parameters, 0.0);
        assert!(chart.perhaps.is_free(cell) && chart.safe.is_free(cell));
        map.shun(place, 0.15);
        assert!(!map.chart(&parameters, 0.0).safe.is_free(cell));
    }

    /// Sees ground of an elevation all around the start.
    fn ground(parameters: &SummitParameters, height: impl Fn(f64) -> f64) -> SightMap {
        let mut map = SightMap::new(parameters, 0.35);
        for (x, y) in (-18..=18).flat_map(|x| (-18..=18).map(move |y| (x, y))) {
            let at = [x, y].map(|cell| 0.05 * f64::from(cell));
            map.stand(Point3::new(at[0], at[1], height(at[0])));
        }
        map
    }

    /// The robot can go back the way that it came over ground that seems too steep, unless it slips there.
    #[test]
    fn where_it_came_by_is_safe() {
        let parameters =
            SummitParameters { extent: 1.0, ..SummitParameters::of(&RobotSpec::blizzard()).unwrap() };
        let mut map = ground(&parameters, |x| 0.7 * x);
        let (way, aside) = (Point::new(0.1, 0.0), Point::new(0.1, 0.3));
        let is_safe =
            |map: &SightMap, at: Point| map.chart(&parameters, 0.0).safe.is_free(map.cell_at(at).unwrap());
        assert!(!is_safe(&map, way));
        map.tread(way);
        assert!(is_safe(&map, way) && !is_safe(&map, aside));
        map.shun(way, 0.1);
        assert!(!is_safe(&map, way));
        assert!(map.forget_shunned() && !map.forget_shunned());
        assert!(is_safe(&map, way));
    }

    /// Ground that was mapped in a wrong place goes when a beam passes below it.
    #[test]
    fn what_beams_pass_below_is_no_ground() {
        let parameters =
            SummitParameters { extent: 1.0, ..SummitParameters::of(&RobotSpec::blizzard()).unwrap() };
        let mut map = ground(&parameters, |_| 0.0);
        let origin = Point3::new(0.0, 0.0, 0.15);
        let beam = |slope: f64, range: f64| Beam {
            origin,
            direction: Vector3::new(1.0, 0.0, slope).normalize(),
            range,
            is_on_face: false,
        };
        let known = |map: &SightMap| {
            let cell = |column| GridCell::new(column, map.cell_at(Point::origin()).unwrap().row);
            (21..39).filter(|&column| map.height(map.index_of(cell(column))).is_some()).count()
        };
        let before = known(&map);
        map.add_fan(origin, &[beam(-0.3, 0.5)]);
        assert_eq!(known(&map), before);
        map.add_fan(origin, &[beam(-0.3, f64::INFINITY)]);
        // From 0.64 m on it is more than 4 cm below the ground, over whole cells.
        assert!((5..8).contains(&(before - known(&map))), "{before} {}", known(&map));
    }
}
