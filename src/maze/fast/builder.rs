use super::limits::Repertoire;
use super::plan::{FastPlan, Piece};
use super::search::{Node, Tables};
use super::turn::TurnKind;
use crate::geometry::normalize_angle;
use crate::maze::{Cell, Direction, Route, Scale};

/// Assembles a plan from the hops of a search.
pub(super) struct Builder<'a> {
    repertoire: &'a Repertoire,
    scale: Scale,
    start: (Cell, Direction),
    /// End of the moves so far.
    cell: Cell,
    pieces: Vec<Piece>,
    moves: Vec<Direction>,
    time: f64,
    /// Turn at the end of the last hop.
    last: Option<TurnKind>,
}

impl<'a> Builder<'a> {
    pub(super) fn new(repertoire: &'a Repertoire, scale: Scale, start: (Cell, Direction)) -> Self {
        let (pieces, moves) = (Vec::new(), Vec::new());
        Self { repertoire, scale, start, cell: start.0, pieces, moves, time: 0.0, last: None }
    }

    /// Turns on the spot at the start.
    pub(super) fn face(&mut self, direction: Direction) {
        self.pivot(self.start.1, direction);
    }

    fn pivot(&mut self, from: Direction, to: Direction) {
        let angle = normalize_angle(to.heading() - from.heading());
        if from != to {
            self.time += self.repertoire.pivot_time(angle);
            self.pieces.push(Piece::Pivot { angle });
        }
    }

    fn step(&mut self, direction: Direction) {
        let (dx, dy) = direction.step();
        self.cell = Cell::new((i32::from(self.cell.x) + dx) as u16, (i32::from(self.cell.y) + dy) as u16);
        self.moves.push(direction);
    }

    /// Adds a straight from one node and the turn at its end into the next, which lies in a cell; `None` at
    /// the goal.
    pub(super) fn hop(&mut self, from: Node, count: u16, to: Option<(Node, Cell)>) {
        let (via, then) = from.heading();
        let kind = to.and_then(|(node, _)| node.kind());
        let distance = if from.is_diagonal() {
            Tables::diagonal_distance(count, kind)
        } else {
            Tables::row_distance(from.kind(), count, kind)
        };
        for i in 0..count {
            self.step(if i % 2 == 0 { via } else { then });
        }
        self.straight(distance * self.repertoire.cell, kind, from.is_diagonal());
        let Some((to, cell)) = to else { return };
        let Some(kind) = kind else { return self.pivot(via, to.heading().0) };
        let left = match kind {
            TurnKind::UTurn => {
                let (dx, dy) = via.left().step();
                (i32::from(self.cell.x) + dx, i32::from(self.cell.y) + dy) == (cell.x.into(), cell.y.into())
            }
            _ => (to.eighths() + 8 - from.eighths()) % 8 > 4,
        };
        match kind {
            TurnKind::In45 | TurnKind::TightIn45 => self.step(via),
            TurnKind::UTurn => self.step(if left { via.left() } else { via.right() }),
            _ => {}
        }
        self.time += self.repertoire.turn(kind).time;
        self.pieces.push(Piece::Turn { kind, left });
    }

    fn straight(&mut self, distance: f64, kind: Option<TurnKind>, diagonal: bool) {
        let r = self.repertoire;
        let length = (distance - r.tangent(self.last) - r.tangent(kind)).max(0.0);
        let (entry, exit) = (r.speed(self.last), r.speed(kind));
        self.time += r.straight_time(self.last, kind, distance, diagonal).unwrap_or(0.0);
        if length > 1e-9 {
            self.pieces.push(Piece::Straight { length, entry, exit, diagonal });
        }
        self.last = kind;
    }

    pub(super) fn finish(self) -> FastPlan {
        let (cell, heading) = self.start;
        FastPlan {
            time: self.time,
            route: Route::new(cell, heading, self.moves),
            start: self.scale.pose(cell, heading),
            pieces: self.pieces,
        }
    }
}
