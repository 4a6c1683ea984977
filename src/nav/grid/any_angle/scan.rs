//! Visibility from a point: cones of sight, clipped by the free cells of one row after the other, in
//! integers.

use super::field::{Field, HalfPoint};

/// A direction within a half plane: x per distance from the point's row, in half cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Ray {
    x: i64,
    away: i64,
}

impl Ray {
    /// Whether it lies to the left of another ray.
    fn is_left_of(self, other: Self) -> bool {
        self.x * other.away < other.x * self.away
    }
}

/// Side of a point along x.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
    Both,
}

/// The rays that have reached a line through the free cells of one stretch of a row.
#[derive(Debug, Clone, Copy)]
struct Cone {
    left: Ray,
    right: Ray,
    /// Distance from the point to the line (half cells).
    away: i64,
    /// The row behind the line.
    row: i32,
    /// First and last grid line along y of the previous stretch.
    stretch: (i32, i32),
}

/// Scans for visible corners; reuses its memory.
#[derive(Debug, Clone, Default)]
pub(super) struct Scanner {
    cones: Vec<Cone>,
    /// Number of cones so far, which take the time.
    pub(super) passed: u64,
}

impl Scanner {
    /// Calls `found` with the corners that are visible from a point and bend a path from there, among those
    /// in later rows (`down`) or earlier ones.
    pub(super) fn half(
        &mut self,
        field: &Field,
        from: HalfPoint,
        down: bool,
        side: Side,
        mut found: impl FnMut(i32, i32),
    ) {
        self.cones.clear();
        let sight = Sight { field, from, down };
        if let Some(cone) = sight.first(side) {
            sight.report(&cone, &mut found);
            self.cones.push(cone);
        }
        while let Some(cone) = self.cones.pop() {
            self.passed += 1;
            sight.pass(&cone, |next| {
                sight.report(&next, &mut found);
                self.cones.push(next);
            });
        }
    }
}

struct Sight<'a> {
    field: &'a Field,
    from: HalfPoint,
    down: bool,
}

impl Sight<'_> {
    /// The cone through the row next to the point, or through half of the point's own row if it lies in the
    /// middle.
    fn first(&self, side: Side) -> Option<Cone> {
        let HalfPoint { x, y } = self.from;
        let row = if self.down || y % 2 != 0 { y.div_euclid(2) } else { y / 2 - 1 };
        // Of the two cells beside a corner, the one on the relevant side.
        let column = if x % 2 == 0 && side == Side::Left { x / 2 - 1 } else { x.div_euclid(2) };
        if !self.field.is_free(column, row) {
            return None;
        }
        let stretch = (self.field.last_blocked(row, column) + 1, self.field.next_blocked(row, column));
        let away = if y % 2 == 0 { 2 } else { 1 };
        let ray = |line: i32| Ray { x: i64::from(2 * line - x), away };
        let ahead = Ray { x: 0, away };
        let left = if side == Side::Right { ahead } else { ray(stretch.0) };
        let right = if side == Side::Left { ahead } else { ray(stretch.1) };
        Some(Cone { left, right, away, row: self.behind(row), stretch })
    }

    fn behind(&self, row: i32) -> i32 {
        if self.down { row + 1 } else { row - 1 }
    }

    /// Calls `next` with the remainder of a cone in each stretch of free cells of the row it meets.
    #[inline]
    fn pass(&self, cone: &Cone, mut next: impl FnMut(Cone)) {
        if cone.row < 0 || cone.row as usize >= self.field.height() {
            return;
        }
        let (first, last) = self.span(cone);
        // Cells that touch the cone and share an edge with its previous stretch.
        let mut column = (first - 1).max(cone.stretch.0);
        let end = last.min(cone.stretch.1 - 1);
        let away = cone.away + 2;
        while column <= end {
            column = self.field.next_free(cone.row, column);
            if column > end {
                break;
            }
            let stretch =
                (self.field.last_blocked(cone.row, column) + 1, self.field.next_blocked(cone.row, column));
            // A ray must be within the stretch on both of its lines.
            let (to_left, to_right) = (self.along(stretch.0), self.along(stretch.1));
            let left_edge = Ray { x: to_left, away: if to_left > 0 { cone.away } else { away } };
            let right_edge = Ray { x: to_right, away: if to_right < 0 { cone.away } else { away } };
            let left = if cone.left.is_left_of(left_edge) { left_edge } else { cone.left };
            let right = if right_edge.is_left_of(cone.right) { right_edge } else { cone.right };
            if !right.is_left_of(left) {
                next(Cone { left, right, away, row: self.behind(cone.row), stretch });
            }
            column = stretch.1 + 1;
        }
    }

    /// The corners on the line that a cone has reached.
    #[inline]
    fn report(&self, cone: &Cone, found: &mut impl FnMut(i32, i32)) {
        let (first, last) = self.span(cone);
        let y = if self.down { cone.row } else { cone.row + 1 };
        // Corners of one kind bend rising paths, the others falling paths.
        let (left, right) = (last.min(self.from.x.div_euclid(2)), first.max((self.from.x + 1).div_euclid(2)));
        self.field.corners(y, first, left, self.down, |x| found(x, y));
        self.field.corners(y, right, last, !self.down, |x| found(x, y));
    }

    /// The first and the last grid point within a cone on the line that it has reached.
    #[inline]
    fn span(&self, cone: &Cone) -> (i32, i32) {
        let at = |ray: Ray| (i64::from(self.from.x) * ray.away + ray.x * cone.away, 2 * ray.away);
        let ((left, by), (right, of)) = (at(cone.left), at(cone.right));
        (-(-left).div_euclid(by) as i32, right.div_euclid(of) as i32)
    }

    fn along(&self, line: i32) -> i64 {
        i64::from(2 * line - self.from.x)
    }
}
