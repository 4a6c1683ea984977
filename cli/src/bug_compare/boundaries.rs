use roverlab::ParameterError;
use roverlab::geometry::{Point, Segment, cross};
use roverlab::world::{Clearance, World};

/// The closed contour lines of the clearance, along which a robot's centre follows obstacles.
///
/// They are traced between the centres of cells by marching squares (W. E. Lorensen and H. E. Cline, SIGGRAPH
/// 1987, in the plane), with interpolated clearances; their lengths are accurate to a few thousandths.
#[derive(Debug, Clone)]
pub(crate) struct Boundaries {
    pub(crate) all: Vec<Boundary>,
}

/// A closed contour line.
#[derive(Debug, Clone)]
pub(crate) struct Boundary {
    points: Vec<Point>,
    /// Length (m).
    pub(crate) perimeter: f64,
}

/// Cell size (m): fine enough to separate contours with half a centimetre more room between them.
const RESOLUTION: f64 = 0.006;

/// Number of path points compared.
const VOTES: usize = 100;

/// No crossing, or no neighbour.
const NONE: usize = usize::MAX;

impl Boundaries {
    /// The contour lines of a clearance (m).
    pub(crate) fn new(world: &World, clearance: f64) -> Result<Self, ParameterError> {
        let field = Clearance::new(world, RESOLUTION, clearance + 2.0 * RESOLUTION)?;
        let mut tracer = Tracer::new(&field, clearance);
        tracer.join_all();
        Ok(Self { all: tracer.lines() })
    }

    /// The contour nearest to most points of a path: the one it follows, though another may be as near at its
    /// start.
    pub(crate) fn followed(&self, path: &[Point]) -> Option<usize> {
        let mut counts = vec![0; self.all.len()];
        let looked_at = path.iter().step_by(path.len() / VOTES + 1);
        looked_at.filter_map(|&point| self.nearest(point)).for_each(|line| counts[line] += 1);
        (0..counts.len()).max_by_key(|&line| counts[line]).filter(|_| !path.is_empty())
    }

    /// The contour nearest to a point.
    pub(crate) fn nearest(&self, point: Point) -> Option<usize> {
        let distance = |line: &Boundary| {
            line.points.iter().map(|p| (p - point).norm_squared()).fold(f64::INFINITY, f64::min)
        };
        (0..self.all.len()).min_by(|&a, &b| distance(&self.all[a]).total_cmp(&distance(&self.all[b])))
    }
}

impl Boundary {
    fn new(points: Vec<Point>) -> Self {
        let mut line = Self { points, perimeter: 0.0 };
        line.perimeter = line.pieces().map(|(a, b)| (b - a).norm()).sum();
        line
    }

    fn pieces(&self) -> impl Iterator<Item = (Point, Point)> + '_ {
        let next = self.points.iter().cycle().skip(1);
        self.points.iter().copied().zip(next.copied())
    }

    /// Number of times that a straight line crosses it.
    pub(crate) fn crossings(&self, line: Segment) -> usize {
        let side = |from: Point, to: Point, point: Point| cross(to - from, point - from) > 0.0;
        self.pieces()
            .filter(|&(a, b)| {
                side(line.a, line.b, a) != side(line.a, line.b, b) && side(a, b, line.a) != side(a, b, line.b)
            })
            .count()
    }
}

/// Joins the points where contours cross the connections between neighbouring cells.
struct Tracer<'a> {
    field: &'a Clearance,
    level: f64,
    /// For each connection, two per cell (along x and along y), the two others joined to it.
    joined: Vec<[usize; 2]>,
}

impl<'a> Tracer<'a> {
    fn new(field: &'a Clearance, level: f64) -> Self {
        Self { field, level, joined: vec![[NONE; 2]; 2 * field.raster().cells()] }
    }

    fn is_free(&self, cell: usize) -> bool {
        self.field.at(cell) > self.level
    }

    /// Joins the crossings around every square of four cells.
    fn join_all(&mut self) {
        let (columns, rows) = (self.field.raster().columns(), self.field.raster().rows());
        for row in 0..rows.saturating_sub(1) {
            for column in 0..columns.saturating_sub(1) {
                self.join_square(row * columns + column, columns);
            }
        }
    }

    fn join_square(&mut self, cell: usize, columns: usize) {
        let corners = [cell, cell + 1, cell + columns + 1, cell + columns];
        let free = corners.map(|corner| self.is_free(corner));
        // The connections below, to the right, above and to the left.
        let sides = [2 * cell, 2 * (cell + 1) + 1, 2 * (cell + columns), 2 * cell + 1];
        let crossed: Vec<usize> =
            (0..4).filter(|&k| free[k] != free[(k + 1) % 4]).map(|k| sides[k]).collect();
        match crossed[..] {
            [a, b] => self.join(a, b),
            // Two opposite corners are free: the free area stays connected.
            [below, right, above, left] if free[0] => {
                self.join(below, right);
                self.join(above, left);
            }
            [below, right, above, left] => {
                self.join(below, left);
                self.join(above, right);
            }
            _ => {}
        }
    }

    fn join(&mut self, a: usize, b: usize) {
        for (from, to) in [(a, b), (b, a)] {
            let [first, second] = &mut self.joined[from];
            *(if *first == NONE { first } else { second }) = to;
        }
    }

    /// The point where a contour crosses a connection.
    fn place(&self, connection: usize) -> Point {
        let raster = self.field.raster();
        let cell = connection / 2;
        let other = if connection.is_multiple_of(2) { cell + 1 } else { cell + raster.columns() };
        let (here, there) = (self.field.at(cell), self.field.at(other));
        let (a, b) = (raster.centre(cell), raster.centre(other));
        a + (b - a) * ((self.level - here) / (there - here)).clamp(0.0, 1.0)
    }

    fn lines(mut self) -> Vec<Boundary> {
        (0..self.joined.len()).filter_map(|start| self.line_from(start)).collect()
    }

    /// The contour through a connection, whose crossings are consumed.
    fn line_from(&mut self, start: usize) -> Option<Boundary> {
        let mut points = Vec::new();
        let mut at = start;
        while self.joined[at] != [NONE; 2] {
            points.push(self.place(at));
            let [first, second] = std::mem::replace(&mut self.joined[at], [NONE; 2]);
            let unused = |next: usize| next != NONE && self.joined[next] != [NONE; 2];
            let Some(next) = [first, second].into_iter().find(|&next| unused(next)) else { break };
            at = next;
        }
        (points.len() > 2).then(|| Boundary::new(points))
    }
}
