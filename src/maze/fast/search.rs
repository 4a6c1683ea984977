//! Components of the planner's search: nodes, costs of straights and turns, and a compact maze.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};

use super::bound::Hop;
use super::limits::Repertoire;
use super::turn::TurnKind;
use crate::maze::{Cell, Direction, Maze, Unknown};

/// The end of a turn: the robot's cell, its heading, and the kind of turn.
///
/// After a turn into a row or column, the cell is the one whose centre the turn ends at, or, out of a
/// diagonal, whose edge. On a diagonal, the robot leaves the cell across the edge of its first heading, and
/// the next cell across that of the second.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Node {
    cell: u32,
    local: u8,
}

/// Turns that end in a row or column; `None` is a turn on the spot.
const ROW_KINDS: [Option<TurnKind>; 7] = [
    None,
    Some(TurnKind::Short90),
    Some(TurnKind::Wide90),
    Some(TurnKind::UTurn),
    Some(TurnKind::Out45),
    Some(TurnKind::Out135),
    Some(TurnKind::TightOut45),
];
/// Turns that end in a diagonal.
const DIAGONAL_KINDS: [TurnKind; 4] =
    [TurnKind::In45, TurnKind::In135, TurnKind::Diagonal90, TurnKind::TightIn45];
/// Number of kinds that end in a row or column.
const ROWS: u8 = ROW_KINDS.len() as u8;
/// Number of kinds that end in a diagonal.
const DIAGONALS: u8 = DIAGONAL_KINDS.len() as u8;
/// Number of kinds of turns, including one on the spot.
pub(super) const ENDS: usize = ROW_KINDS.len() + DIAGONAL_KINDS.len();
/// Index of a cell's first diagonal node; 4 headings come before.
const FIRST_DIAGONAL: u8 = 4 * ROWS;
/// Number of nodes per cell; diagonals have 8 pairs of headings.
const PER_CELL: u32 = FIRST_DIAGONAL as u32 + 8 * DIAGONALS as u32;

/// Index of a kind among those that end alike.
#[inline]
fn place(kind: Option<TurnKind>) -> u8 {
    match kind {
        None | Some(TurnKind::In45) => 0,
        Some(TurnKind::Short90 | TurnKind::In135) => 1,
        Some(TurnKind::Wide90 | TurnKind::Diagonal90) => 2,
        Some(TurnKind::UTurn | TurnKind::TightIn45) => 3,
        Some(TurnKind::Out45) => 4,
        Some(TurnKind::Out135) => 5,
        Some(TurnKind::TightOut45) => 6,
    }
}

impl Node {
    pub(super) fn count(cells: usize) -> usize {
        cells * PER_CELL as usize
    }

    #[inline]
    pub(super) fn row(cell: u32, heading: Direction, kind: Option<TurnKind>) -> Self {
        Self { cell, local: heading as u8 * ROWS + place(kind) }
    }

    #[inline]
    pub(super) fn diagonal(cell: u32, via: Direction, then: Direction, kind: TurnKind) -> Self {
        let right = u8::from(then == via.right());
        Self { cell, local: FIRST_DIAGONAL + (via as u8 * 2 + right) * DIAGONALS + place(Some(kind)) }
    }

    #[inline]
    pub(super) fn id(self) -> u32 {
        self.cell * PER_CELL + u32::from(self.local)
    }

    #[inline]
    pub(super) fn from_id(id: u32) -> Self {
        Self { cell: id / PER_CELL, local: (id % PER_CELL) as u8 }
    }

    #[inline]
    pub(super) fn cell(self) -> u32 {
        self.cell
    }

    #[inline]
    pub(super) fn is_diagonal(self) -> bool {
        self.local >= FIRST_DIAGONAL
    }

    /// The turn that ended here; `None` for one on the spot.
    #[inline]
    pub(super) fn kind(self) -> Option<TurnKind> {
        if self.is_diagonal() {
            Some(DIAGONAL_KINDS[usize::from(self.local - FIRST_DIAGONAL) % DIAGONAL_KINDS.len()])
        } else {
            ROW_KINDS[usize::from(self.local) % ROW_KINDS.len()]
        }
    }

    /// Index of the turn among all kinds: first those into rows and columns, then those into diagonals.
    #[inline]
    pub(super) fn end(self) -> usize {
        if self.is_diagonal() {
            usize::from(ROWS + (self.local - FIRST_DIAGONAL) % DIAGONALS)
        } else {
            usize::from(self.local % ROWS)
        }
    }

    /// The heading of the row or column, twice, or the two headings that a diagonal alternates between.
    #[inline]
    pub(super) fn heading(self) -> (Direction, Direction) {
        if self.is_diagonal() {
            let pair = usize::from(self.local - FIRST_DIAGONAL) / DIAGONAL_KINDS.len();
            let via = Direction::ALL[pair / 2];
            (via, if pair % 2 == 1 { via.right() } else { via.left() })
        } else {
            let heading = Direction::ALL[usize::from(self.local) / ROW_KINDS.len()];
            (heading, heading)
        }
    }

    /// Heading in eighths of a full turn, clockwise from north.
    pub(super) fn eighths(self) -> usize {
        let (via, then) = self.heading();
        match via.quarters_to(then) {
            0 => 2 * via as usize,
            1 => 2 * via as usize + 1,
            _ => (2 * via as usize + 7) % 8,
        }
    }
}

/// Open sides of every cell, one byte each.
#[derive(Debug, Clone, Default)]
pub(super) struct Grid {
    width: u32,
    openings: Vec<u8>,
}

impl Grid {
    pub(super) fn read(&mut self, maze: &Maze, unknown: Unknown) {
        self.width = maze.width() as u32;
        self.openings.clear();
        self.openings.extend(maze.cells().map(|cell| {
            let open = |side: &Direction| maze.passage(cell, *side, unknown).is_some();
            Direction::ALL.into_iter().filter(open).fold(0, |bits, side| bits | 1 << side as u8)
        }));
    }

    #[inline]
    pub(super) fn is_open(&self, index: u32, direction: Direction) -> bool {
        self.openings[index as usize] >> direction as u8 & 1 != 0
    }

    /// The neighbour in a direction, if it is accessible.
    #[inline]
    pub(super) fn next(&self, index: u32, direction: Direction) -> Option<u32> {
        if !self.is_open(index, direction) {
            return None;
        }
        Some(match direction {
            Direction::North => index + self.width,
            Direction::East => index + 1,
            Direction::South => index - self.width,
            Direction::West => index - 1,
        })
    }

    #[inline]
    pub(super) fn index(&self, cell: Cell) -> u32 {
        u32::from(cell.y) * self.width + u32::from(cell.x)
    }

    #[inline]
    pub(super) fn cell(&self, index: u32) -> Cell {
        Cell::new((index % self.width) as u16, (index / self.width) as u16)
    }
}

/// Times (µs) from the end of a turn along a row or column and through the next turn; `u32::MAX` if the turn
/// does not fit.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowTimes {
    pub(super) stop: u32,
    pub(super) pivot: u32,
    pub(super) short: u32,
    pub(super) wide: u32,
    pub(super) u_turn: u32,
    pub(super) in_45: u32,
    pub(super) tight_in_45: u32,
    pub(super) in_135: u32,
}

/// The same along a diagonal.
#[derive(Debug, Clone, Copy)]
pub(super) struct DiagonalTimes {
    pub(super) out_45: u32,
    pub(super) tight_out_45: u32,
    pub(super) quarter: u32,
    pub(super) out_135: u32,
}

/// Times of all straights with the turns after them, by the number of cells or edges passed.
#[derive(Debug, Clone)]
pub(super) struct Tables {
    rows: [Vec<RowTimes>; ROW_KINDS.len()],
    diagonals: [Vec<DiagonalTimes>; DIAGONAL_KINDS.len()],
    /// Times of turns on the spot, by quarter turns (µs).
    pub(super) pivots: [u32; 4],
    /// Time of the shortest turn (µs).
    pub(super) shortest: u32,
    /// Time per cell of a row or column, and per edge of a diagonal, at top speed, rounded down (µs).
    top_speed: [u32; 2],
}

/// Time in whole microseconds.
fn micros(seconds: Option<f64>) -> u32 {
    seconds.map_or(u32::MAX, |seconds| (seconds * 1e6).round().min(4e9) as u32)
}

impl Tables {
    pub(super) fn new(repertoire: &Repertoire) -> Self {
        let counts = 0..2 * Maze::MAX_SIDE as u16;
        let rows =
            ROW_KINDS.map(|from| counts.clone().map(|count| row_times(repertoire, from, count)).collect());
        let diagonals = DIAGONAL_KINDS
            .map(|from| counts.clone().map(|count| diagonal_times(repertoire, from, count)).collect());
        let pivots = [0.0, FRAC_PI_2, PI, FRAC_PI_2].map(|angle| micros(Some(repertoire.pivot_time(angle))));
        let turns = TurnKind::ALL.map(|kind| micros(Some(repertoire.turn(kind).time)));
        let shortest = turns.into_iter().chain([pivots[1]]).min().unwrap_or(1).max(1);
        let top_speed = [(1.0, false), (FRAC_1_SQRT_2, true)].map(|(cells, diagonal)| {
            let seconds = cells * repertoire.cell / repertoire.top_speed(diagonal);
            micros(Some(seconds)).saturating_sub(1)
        });
        Self { rows, diagonals, pivots, shortest, top_speed }
    }

    /// All straights of up to `most` cells or edges after one kind of turn, with the possible turns after
    /// each.
    pub(super) fn hops(&self, end: usize, most: usize) -> Vec<Hop> {
        let mut hops = Vec::new();
        let mut add = |count, list: &[(u32, usize, Option<usize>)]| {
            hops.extend(list.iter().map(|&(time, more, to)| Hop { count, steps: count + more, time, to }));
        };
        let row = |kind| Some(usize::from(place(kind)));
        let diagonal = |kind| Some(ROW_KINDS.len() + usize::from(place(Some(kind))));
        match end.checked_sub(ROW_KINDS.len()) {
            None => {
                for (count, time) in self.rows[end].iter().enumerate().take(most + 1) {
                    add(
                        count,
                        &[
                            (time.stop, 0, None),
                            (time.pivot, 0, row(None)),
                            (time.short, 0, row(Some(TurnKind::Short90))),
                            (time.wide, 0, row(Some(TurnKind::Wide90))),
                            (time.u_turn, 1, row(Some(TurnKind::UTurn))),
                            (time.in_45, 1, diagonal(TurnKind::In45)),
                            (time.tight_in_45, 1, diagonal(TurnKind::TightIn45)),
                            (time.in_135, 0, diagonal(TurnKind::In135)),
                        ],
                    );
                }
            }
            Some(end) => {
                for (count, time) in self.diagonals[end].iter().enumerate().take(most + 1).skip(1) {
                    add(
                        count,
                        &[
                            (time.out_45, 0, row(Some(TurnKind::Out45))),
                            (time.tight_out_45, 0, row(Some(TurnKind::TightOut45))),
                            (time.quarter, 0, diagonal(TurnKind::Diagonal90)),
                            (time.out_135, 0, row(Some(TurnKind::Out135))),
                        ],
                    );
                }
            }
        }
        hops
    }

    /// For each kind of turn, the minimum time per step on the straight after it and on the one before it.
    pub(super) fn least_per_step(&self) -> ([u32; ENDS], [u32; ENDS]) {
        let [row, diagonal] = self.top_speed;
        let behind = |end: usize| if end < ROW_KINDS.len() { row } else { diagonal };
        let before = |end: usize| match ROW_KINDS.get(end) {
            Some(Some(TurnKind::Out45 | TurnKind::TightOut45 | TurnKind::Out135)) => diagonal,
            None if DIAGONAL_KINDS[end - ROW_KINDS.len()] == TurnKind::Diagonal90 => diagonal,
            _ => row,
        };
        (std::array::from_fn(behind), std::array::from_fn(before))
    }

    /// One more than the maximum number of cells or edges of a straight.
    pub(super) fn reach(&self) -> usize {
        self.rows[0].len()
    }

    #[inline]
    pub(super) fn row(&self, from: Option<TurnKind>) -> &[RowTimes] {
        &self.rows[usize::from(place(from))]
    }

    #[inline]
    pub(super) fn diagonal(&self, from: TurnKind) -> &[DiagonalTimes] {
        &self.diagonals[usize::from(place(Some(from)))]
    }

    /// Distance between the corners of two turns along a row or column (cells); the straight passes `count`
    /// cell centres after the first.
    pub(super) fn row_distance(from: Option<TurnKind>, count: u16, to: Option<TurnKind>) -> f64 {
        let from_edge = matches!(from, Some(TurnKind::Out45 | TurnKind::TightOut45 | TurnKind::Out135));
        let to_edge = matches!(to, Some(TurnKind::In45 | TurnKind::TightIn45 | TurnKind::In135));
        f64::from(count) + if from_edge { 0.5 } else { 0.0 } + if to_edge { 0.5 } else { 0.0 }
    }

    /// Distance between the corners of two turns along a diagonal (cells); the straight crosses `count`
    /// edges.
    pub(super) fn diagonal_distance(count: u16, to: Option<TurnKind>) -> f64 {
        let edges = count + u16::from(to == Some(TurnKind::Out135));
        f64::from(edges) * FRAC_1_SQRT_2
    }
}

fn row_times(repertoire: &Repertoire, from: Option<TurnKind>, count: u16) -> RowTimes {
    let straight = |to| {
        let distance = Tables::row_distance(from, count, to) * repertoire.cell;
        repertoire.straight_time(from, to, distance, false)
    };
    let turn = |kind| micros(straight(Some(kind)).map(|time| time + repertoire.turn(kind).time));
    RowTimes {
        stop: micros(straight(None)),
        pivot: micros(straight(None).map(|time| time + repertoire.pivot_time(FRAC_PI_2))),
        short: turn(TurnKind::Short90),
        wide: turn(TurnKind::Wide90),
        u_turn: turn(TurnKind::UTurn),
        in_45: turn(TurnKind::In45),
        tight_in_45: turn(TurnKind::TightIn45),
        in_135: turn(TurnKind::In135),
    }
}

fn diagonal_times(repertoire: &Repertoire, from: TurnKind, count: u16) -> DiagonalTimes {
    let turn = |kind| {
        let distance = Tables::diagonal_distance(count, Some(kind)) * repertoire.cell;
        let straight = repertoire.straight_time(Some(from), Some(kind), distance, true);
        micros(straight.map(|time| time + repertoire.turn(kind).time))
    };
    DiagonalTimes {
        out_45: turn(TurnKind::Out45),
        tight_out_45: turn(TurnKind::TightOut45),
        quarter: turn(TurnKind::Diagonal90),
        out_135: turn(TurnKind::Out135),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_have_ids_of_their_own() {
        let mut ids = Vec::new();
        for cell in [0, 5] {
            for via in Direction::ALL {
                for kind in ROW_KINDS {
                    let node = Node::row(cell, via, kind);
                    assert_eq!((node.kind(), node.heading(), node.is_diagonal()), (kind, (via, via), false));
                    ids.push(node.id());
                }
                for then in [via.left(), via.right()] {
                    for kind in DIAGONAL_KINDS {
                        let node = Node::diagonal(cell, via, then, kind);
                        assert_eq!((node.kind(), node.heading()), (Some(kind), (via, then)));
                        assert!(node.is_diagonal() && node.cell() == cell);
                        assert_eq!(node, Node::from_id(node.id()));
                        ids.push(node.id());
                    }
                }
            }
        }
        ids.sort_unstable();
        let expected: Vec<u32> = (0..PER_CELL).chain(5 * PER_CELL..6 * PER_CELL).collect();
        assert_eq!(ids, expected);
    }

    #[test]
    fn headings_count_eighths() {
        let node = |via, then| Node::diagonal(0, via, then, TurnKind::In45).eighths();
        assert_eq!(node(Direction::North, Direction::East), 1);
        assert_eq!(node(Direction::East, Direction::North), 1);
        assert_eq!(node(Direction::North, Direction::West), 7);
        assert_eq!(node(Direction::West, Direction::South), 5);
        assert_eq!(Node::row(0, Direction::West, None).eighths(), 6);
    }
}
