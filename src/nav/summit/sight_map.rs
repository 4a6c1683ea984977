use super::parameters::SummitParameters;
use super::sweep::{Beam, DROP};
use crate::geometry::{Point, Point3, Vector};
use crate::nav::elevation::Climber;
use crate::world::GridCell;

/// What has been seen of the ground: the elevation of cells that beams met, and of all cells the most that
/// it can be, as beams passed over them.
#[derive(Debug, Clone)]
pub(super) struct SightMap {
    pub(super) side: usize,
    pub(super) resolution: f64,
    pub(super) extent: f64,
    /// What the robot can drive over, as the map shows it: ground that is just gentle enough may seem
    /// steeper than it is.
    pub(super) climber: Climber,
    /// Two beams above each other that meet the ground less than this many metres apart show what is between.
    gap: f64,
    seen: Vec<Seen>,
    pub(super) ceilings: Vec<f64>,
    /// The weight of what was measured on faces that are steeper and higher than the robot climbs.
    faces: Vec<f64>,
    /// Cells on which the robot has found that it cannot stand.
    pub(super) shunned: Vec<bool>,
    /// Cells on which the robot has stood, and those beside them: it can go back the way that it came,
    /// however steep the ground seems to be.
    pub(super) trodden: Vec<bool>,
    /// Cells that the robot did not see well enough from beside them: it does not go there to look again.
    pub(super) given_up: Vec<bool>,
}

/// What was measured of a cell.
#[derive(Debug, Clone, Copy)]
struct Seen {
    weight: f64,
    /// The mean of it.
    at: Point3,
    /// How well the robot knew its place when it measured, in the mean (m).
    doubt: f64,
}

impl Seen {
    const NOTHING: Self = Self { weight: 0.0, at: Point3::new(0.0, 0.0, 0.0), doubt: 0.0 };
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
/// Largest error of a slope of the map (rad).
const MEASURED: f64 = 0.06;
/// Largest error of a step of the map (m).
pub(super) const NOISE: f64 = 0.01;
/// The part of what was measured of a cell that lies on a face, from which the cell does.
const FACE: f64 = 0.5;

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
            seen: vec![Seen::NOTHING; side * side],
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

    pub(super) fn cells(&self) -> usize {
        self.seen.len()
    }

    pub(super) fn cell(&self, index: usize) -> GridCell {
        GridCell::new(index % self.side, index / self.side)
    }

    pub(super) fn index_of(&self, cell: GridCell) -> usize {
        cell.row * self.side + cell.column
    }

    /// The elevation of a cell, if it has been seen.
    pub(super) fn height(&self, index: usize) -> Option<f64> {
        let Seen { weight, at, .. } = self.seen[index];
        (weight > 0.0).then_some(at.z)
    }

    /// The mean elevation of a cell and of those around it that have been seen, if it has: the highest of
    /// many readings is one that errs upwards.
    pub(super) fn smoothed(&self, cell: GridCell) -> Option<f64> {
        let own = self.height(self.index_of(cell))?;
        let around = self.neighbours(self.index_of(cell)).filter_map(|near| self.height(near));
        let (sum, count) = around.fold((own, 1.0), |(sum, count), height| (sum + height, count + 1.0));
        Some(sum / count)
    }

    /// What was measured of a cell that is known well enough to compare with, in the mean.
    pub(super) fn known(&self, index: usize) -> Option<Point3> {
        let Seen { weight, at, .. } = self.seen[index];
        (weight >= KNOWN && !self.is_face(index)).then_some(at)
    }

    /// How well the robot knew its place when it measured a cell (m).
    pub(super) fn doubt(&self, index: usize) -> f64 {
        self.seen[index].doubt
    }

    /// Forgets all that was seen.
    pub(super) fn clear(&mut self) {
        for flags in [&mut self.shunned, &mut self.trodden, &mut self.given_up] {
            flags.fill(false);
        }
        self.seen.fill(Seen::NOTHING);
        self.ceilings.fill(f64::INFINITY);
        self.faces.fill(0.0);
    }

    /// Takes in the beams of one azimuth, from the lowest tilt up, from a robot that stands at a place which
    /// it knows to within a doubt (m).
    pub(super) fn add_fan(&mut self, place: Point3, fan: &[Beam], doubt: f64) {
        let mut before = Some(place);
        for beam in fan {
            let end = beam.end();
            self.lower_ceilings(beam);
            if let Some(end) = end {
                let away = (end - beam.origin).norm();
                let weight = 1.0 / (1.0 + (away / FAR) * (away / FAR));
                self.measure(end, weight, doubt);
                if let Some(before) = before {
                    self.bridge(before, beam, doubt);
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
    pub(super) fn is_face(&self, index: usize) -> bool {
        self.faces[index] > FACE * self.seen[index].weight
    }

    fn measure(&mut self, at: Point3, weight: f64, doubt: f64) {
        if let Some(index) = self.index(at.xy()) {
            let seen = &mut self.seen[index];
            seen.weight += weight;
            let share = weight / seen.weight;
            seen.at += (at - seen.at) * share;
            seen.doubt += (doubt - seen.doubt) * share;
        }
    }

    /// What lies between an end and that of the next beam is as high as the line between them, as long as
    /// nothing better is known, or it is a face.
    fn bridge(&mut self, from: Point3, beam: &Beam, doubt: f64) {
        let Some(end) = beam.end() else { return };
        let way = end - from;
        let run = way.xy().norm();
        if run > self.gap {
            return;
        }
        let parts = (run / self.resolution).ceil();
        for part in 1..parts as usize {
            let at = from + way * (part as f64 / parts);
            let Some(index) = self.index(at.xy()) else { continue };
            if beam.is_past_drop {
                self.faces[index] += BETWEEN;
            } else if self.seen[index].weight < BETWEEN {
                self.measure(at, BETWEEN, doubt);
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
                self.seen[index] = Seen::NOTHING;
                self.faces[index] = 0.0;
            }
        }
    }

    /// The ground under a robot that stands at a place which it knows to within a doubt (m).
    pub(super) fn stand(&mut self, place: Point3, doubt: f64) {
        self.measure(place, 1.0, doubt);
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
        let is_near = |index: &usize| (self.place(self.cell(*index)) - place).norm() <= radius;
        (0..self.seen.len()).filter(is_near).collect()
    }

    pub(super) fn neighbours(&self, index: usize) -> impl Iterator<Item = usize> + use<> {
        let (side, column, row) = (self.side, index % self.side, index / self.side);
        let rows = row.saturating_sub(1)..(row + 2).min(side);
        rows.flat_map(move |y| (column.saturating_sub(1)..(column + 2).min(side)).map(move |x| y * side + x))
            .filter(move |&near| near != index)
    }
}

#[cfg(test)]
mod tests {
    use super::super::chart::Chart;
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
                map.stand(Point3::new(0.05 * f64::from(x), 0.05 * f64::from(y), 0.0), 0.0);
            }
        };
        see(&mut map, -18, 8);
        let chart = Chart::of(&map, &parameters, 0.0);
        assert!(chart.perhaps.is_free(cell) && !chart.safe.is_free(cell));
        map.give_up(place, 0.15);
        assert!(!Chart::of(&map, &parameters, 0.0).perhaps.is_free(cell));
        see(&mut map, 8, 19);
        let chart = Chart::of(&map, &parameters, 0.0);
        assert!(chart.perhaps.is_free(cell) && chart.safe.is_free(cell));
        map.shun(place, 0.15);
        assert!(!Chart::of(&map, &parameters, 0.0).safe.is_free(cell));
    }

    /// Sees ground of an elevation all around the start.
    fn ground(parameters: &SummitParameters, height: impl Fn(f64) -> f64) -> SightMap {
        let mut map = SightMap::new(parameters, 0.35);
        for (x, y) in (-18..=18).flat_map(|x| (-18..=18).map(move |y| (x, y))) {
            let at = [x, y].map(|cell| 0.05 * f64::from(cell));
            map.stand(Point3::new(at[0], at[1], height(at[0])), 0.0);
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
        let is_safe = |map: &SightMap, at: Point| {
            Chart::of(map, &parameters, 0.0).safe.is_free(map.cell_at(at).unwrap())
        };
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
            is_past_drop: false,
        };
        let known = |map: &SightMap| {
            let cell = |column| GridCell::new(column, map.cell_at(Point::origin()).unwrap().row);
            (21..39).filter(|&column| map.height(map.index_of(cell(column))).is_some()).count()
        };
        let before = known(&map);
        map.add_fan(origin, &[beam(-0.3, 0.5)], 0.0);
        assert_eq!(known(&map), before);
        map.add_fan(origin, &[beam(-0.3, f64::INFINITY)], 0.0);
        // From 0.64 m on it is more than 4 cm below the ground, over whole cells.
        assert!((5..8).contains(&(before - known(&map))), "{before} {}", known(&map));
    }
}
