use crate::geometry::{Point, Pose, Vector, cross, math};
use crate::world::Wall;

/// A line of walls through some points.
#[derive(Debug, Clone)]
pub(super) struct Outline {
    pub(super) points: Vec<Point>,
    /// Whether the last point is joined to the first, which closes the line.
    pub(super) closed: bool,
}

impl Outline {
    pub(super) fn closed(points: Vec<Point>) -> Self {
        Self { points, closed: true }
    }

    pub(super) fn open(points: Vec<Point>) -> Self {
        Self { points, closed: false }
    }

    /// Straight pieces, with flags for sharp turns at their ends.
    fn pieces(&self) -> impl Iterator<Item = (Point, Point, bool, bool)> {
        let n = self.points.len();
        let count = if self.closed { n } else { n - 1 };
        (0..count).map(move |i| {
            let j = (i + 1) % n;
            (self.points[i], self.points[j], self.is_sharp(i), self.is_sharp(j))
        })
    }

    /// Whether the line turns by more than about 30 degrees at a point, or ends there.
    fn is_sharp(&self, i: usize) -> bool {
        let n = self.points.len();
        if !self.closed && (i == 0 || i == n - 1) {
            return true;
        }
        let into = self.points[i] - self.points[(i + n - 1) % n];
        let out = self.points[(i + 1) % n] - self.points[i];
        into.dot(&out) < 0.87 * math::hypot(into.x, into.y) * math::hypot(out.x, out.y)
    }

    /// Walls along the line. At sharp corners they are extended by half their thickness, which makes corners
    /// square without notches.
    pub(super) fn walls(&self, thickness: f64) -> impl Iterator<Item = Wall> {
        self.pieces().map(move |(a, b, sharp_a, sharp_b)| {
            let along = b - a;
            let half = along * (0.5 * thickness / math::hypot(along.x, along.y));
            let start = if sharp_a { a - half } else { a };
            let end = if sharp_b { b + half } else { b };
            Wall { thickness, ..Wall::new(start, end) }
        })
    }

    /// Whether a point is inside a closed line.
    pub(super) fn holds(&self, point: Point) -> bool {
        let crossings = self.pieces().filter(|(a, b, ..)| {
            (a.y > point.y) != (b.y > point.y)
                && (point.x - a.x) < (b.x - a.x) * (point.y - a.y) / (b.y - a.y)
        });
        self.closed && crossings.count() % 2 == 1
    }
}

/// An obstacle: lines of walls, and difficult places within it.
#[derive(Debug, Clone, Default)]
pub(super) struct Figure {
    pub(super) outlines: Vec<Outline>,
    /// Places in coves, rooms and corridors, with room for the robot.
    pub(super) pockets: Vec<Point>,
    /// Places inside closed lines, with room for the robot.
    pub(super) chambers: Vec<Point>,
}

impl Figure {
    pub(super) fn of(outlines: Vec<Outline>) -> Self {
        Self { outlines, ..Self::default() }
    }

    pub(super) fn with_pockets(mut self, pockets: Vec<Point>) -> Self {
        self.pockets = pockets;
        self
    }

    pub(super) fn with_chambers(mut self, chambers: Vec<Point>) -> Self {
        self.chambers = chambers;
        self
    }

    /// The figure at another pose, optionally mirrored at its x axis.
    pub(super) fn placed(mut self, pose: Pose, mirrored: bool) -> Self {
        let side = if mirrored { -1.0 } else { 1.0 };
        let (sin, cos) = math::sin_cos(pose.heading);
        let place = |p: &mut Point| {
            let (x, y) = (p.x, side * p.y);
            *p = Point::new(pose.x + cos * x - sin * y, pose.y + sin * x + cos * y);
        };
        self.outlines.iter_mut().flat_map(|o| &mut o.points).for_each(place);
        self.pockets.iter_mut().chain(&mut self.chambers).for_each(place);
        self
    }

    /// The figure with the centre of its bounding box at the origin.
    pub(super) fn centred(self) -> Self {
        let points = self.outlines.iter().flat_map(|o| o.points.iter().copied());
        match crate::geometry::Aabb::around(points) {
            Some(bounds) => {
                let middle = nalgebra::center(&bounds.min, &bounds.max);
                self.placed(Pose::new(-middle.x, -middle.y, 0.0), false)
            }
            None => self,
        }
    }
}

/// The parallel of a line at a distance to its left, with mitred corners.
pub(super) fn beside(line: &[Point], distance: f64) -> Vec<Point> {
    let normal = |i: usize| {
        let along = line[i + 1] - line[i];
        Vector::new(-along.y, along.x) / math::hypot(along.x, along.y)
    };
    let last = line.len() - 1;
    (0..=last)
        .map(|i| {
            let before = normal(i.max(1) - 1);
            let after = normal(i.min(last - 1));
            // The mitre is longer than the distance by a factor of one over the cosine of half the turn.
            let sum = before + after;
            line[i] + sum * (2.0 * distance / sum.norm_squared().max(0.2))
        })
        .collect()
}

/// Outline of a stroke of a width along a line.
pub(super) fn stroke(line: &[Point], width: f64) -> Outline {
    let mut points = beside(line, -0.5 * width);
    points.extend(beside(line, 0.5 * width).into_iter().rev());
    Outline::closed(points)
}

/// Points that divide a line into pieces of at most a length, including its corners.
pub(super) fn divided(line: &[Point], length: f64) -> Vec<Point> {
    let mut points = vec![line[0]];
    for pair in line.windows(2) {
        let along = pair[1] - pair[0];
        let pieces = (math::hypot(along.x, along.y) / length).ceil().max(1.0);
        points.extend((1..=pieces as usize).map(|k| pair[0] + along * (k as f64 / pieces)));
    }
    points
}

/// Smallest distance between two line segments; 0 if they cross.
pub(super) fn distance_between(a: (Point, Point), b: (Point, Point)) -> f64 {
    let side = |line: (Point, Point), p: Point| cross(line.1 - line.0, p - line.0);
    if side(a, b.0) * side(a, b.1) < 0.0 && side(b, a.0) * side(b, a.1) < 0.0 {
        return 0.0;
    }
    let reach = |line: (Point, Point), p: Point| crate::geometry::Segment::new(line.0, line.1).distance_to(p);
    reach(a, b.0).min(reach(a, b.1)).min(reach(b, a.0)).min(reach(b, a.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Point> {
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Point::new(x, y)).to_vec()
    }

    #[test]
    fn a_closed_line_holds_its_inside_only() {
        let closed = Outline::closed(square());
        assert!(closed.holds(Point::new(0.5, 0.2)) && !closed.holds(Point::new(1.5, 0.2)));
        assert!(!Outline::open(square()).holds(Point::new(0.5, 0.2)));
        assert_eq!((closed.walls(0.01).count(), Outline::open(square()).walls(0.01).count()), (4, 3));
    }

    #[test]
    fn walls_meet_in_square_corners() {
        let walls: Vec<Wall> = Outline::closed(square()).walls(0.1).collect();
        assert!((walls[0].line.b - Point::new(1.05, 0.0)).norm() < 1e-12);
        assert!((walls[1].line.a - Point::new(1.0, -0.05)).norm() < 1e-12);
    }

    #[test]
    fn a_line_beside_a_corner_keeps_its_distance() {
        let line = [Point::new(0.0, 0.0), Point::new(1.0, 0.0), Point::new(1.0, 1.0)];
        let left = beside(&line, 0.2);
        let expected = [(0.0, 0.2), (0.8, 0.2), (0.8, 1.0)];
        assert!(left.iter().zip(expected).all(|(p, (x, y))| (p - Point::new(x, y)).norm() < 1e-12));
        assert_eq!(stroke(&line, 0.1).points.len(), 6);
    }

    #[test]
    fn distances_between_lines() {
        let line = |ax, ay, bx, by| (Point::new(ax, ay), Point::new(bx, by));
        assert_eq!(distance_between(line(0.0, 0.0, 1.0, 1.0), line(0.0, 1.0, 1.0, 0.0)), 0.0);
        assert_eq!(distance_between(line(0.0, 0.0, 1.0, 0.0), line(0.0, 0.5, 1.0, 0.7)), 0.5);
        assert_eq!(distance_between(line(0.0, 0.0, 1.0, 0.0), line(2.0, 0.0, 3.0, 0.0)), 1.0);
    }
}
