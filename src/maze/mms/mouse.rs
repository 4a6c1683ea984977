use std::collections::VecDeque;

use crate::maze::{
    Cell, Direction, ExplorationOutcome, ExplorationStep, Explorer, Goals, Maze, Preference,
    TwoPhaseExplorer, Unknown, WallState, shortest_route_between,
};
use crate::parameter::debug_as_sentence;

/// Next action of the mouse.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Move {
    /// Writes a line. It expects an answer if [`MmsMouse::awaits`] is true.
    Say(String),
    /// Finished: the exploration is proved and the goal reached, or there is no path.
    Done(ExplorationOutcome),
}

/// An invalid answer of the simulator.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error("found the answer {found:?} to {command}; expected {expected}")]
pub struct MmsError {
    command: String,
    found: String,
    expected: &'static str,
}

debug_as_sentence!(MmsError);

/// A solver for mms: explores until the best route is proved, and then drives it.
///
/// As in mms, it starts in the lower left corner, facing north, and the goal is the centre. Observed walls
/// are shown by `setWall`. After every move it asks whether the reset button was pressed; if so, it starts
/// again with what it knows.
#[derive(Debug, Clone)]
pub struct MmsMouse {
    sides: [usize; 2],
    known: Option<Maze>,
    at: (Cell, Direction),
    explorer: TwoPhaseExplorer,
    verdict: Option<ExplorationOutcome>,
    /// Lines to write, with the purpose of their answers.
    queue: VecDeque<(String, Asked)>,
    asked: Asked,
    line: String,
    /// Whether the walls of the present cell have been queried.
    looked: bool,
    racing: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Asked {
    /// No answer expected.
    Nothing,
    Side(usize),
    WallState(Direction),
    Turn(Direction),
    Forward,
    Reset,
    Acknowledged,
}

impl Default for MmsMouse {
    fn default() -> Self {
        Self::new()
    }
}

impl MmsMouse {
    /// A mouse without any knowledge.
    pub fn new() -> Self {
        let ask = |line: &str, index| (line.to_owned(), Asked::Side(index));
        Self {
            sides: [0; 2],
            known: None,
            at: (Cell::default(), Direction::North),
            explorer: TwoPhaseExplorer::new(Goals::Steps),
            verdict: None,
            queue: VecDeque::from([ask("mazeWidth", 0), ask("mazeHeight", 1)]),
            asked: Asked::Nothing,
            line: String::new(),
            looked: false,
            racing: false,
        }
    }

    /// Known part of the maze, once the size is known.
    pub fn maze(&self) -> Option<&Maze> {
        self.known.as_ref()
    }

    /// Whether the last line expects an answer.
    pub fn awaits(&self) -> bool {
        self.asked != Asked::Nothing
    }

    /// Takes the answer to the last line, if it expects one, and returns the next action.
    ///
    /// # Errors
    ///
    /// If the answer is invalid.
    pub fn step(&mut self, answer: Option<&str>) -> Result<Move, MmsError> {
        if self.awaits() {
            self.learn(answer.unwrap_or("nothing").trim())?;
        }
        loop {
            if let Some((line, asked)) = self.queue.pop_front() {
                self.asked = asked;
                self.line.clone_from(&line);
                return Ok(Move::Say(line));
            }
            self.asked = Asked::Nothing;
            if let Some(verdict) = self.decide() {
                return Ok(Move::Done(verdict));
            }
        }
    }

    fn wrong(&self, found: &str, expected: &'static str) -> MmsError {
        let found = found.chars().take(60).collect();
        MmsError { command: self.line.clone(), found, expected }
    }

    fn learn(&mut self, answer: &str) -> Result<(), MmsError> {
        let (cell, heading) = self.at;
        match self.asked {
            Asked::Nothing => {}
            Asked::Side(index) => self.measure(index, answer)?,
            Asked::WallState(side) => {
                let stands = self.truth(answer)?;
                if let Some(known) = &mut self.known {
                    known.set_wall(cell, side, if stands { WallState::Present } else { WallState::Absent });
                }
                if stands {
                    let line = format!("setWall {} {} {}", cell.x, cell.y, side.letter());
                    self.queue.push_back((line, Asked::Nothing));
                }
            }
            Asked::Turn(to) => {
                self.acknowledged(answer)?;
                self.at = (cell, to);
            }
            Asked::Forward => {
                self.acknowledged(answer)?;
                let next = self.known.as_ref().and_then(|known| known.neighbour(cell, heading));
                self.at = (next.unwrap_or(cell), heading);
                self.looked = false;
            }
            Asked::Reset => {
                if self.truth(answer)? {
                    self.queue.clear();
                    self.queue.push_back(("ackReset".into(), Asked::Acknowledged));
                }
            }
            Asked::Acknowledged => {
                self.acknowledged(answer)?;
                self.at = (Cell::default(), Direction::North);
                self.looked = false;
            }
        }
        Ok(())
    }

    fn measure(&mut self, index: usize, answer: &str) -> Result<(), MmsError> {
        let side: Option<usize> = answer.parse().ok().filter(|side| (1..=Maze::MAX_SIDE).contains(side));
        self.sides[index] = side.ok_or_else(|| self.wrong(answer, "1 to 256"))?;
        if index == 1 {
            self.known = Maze::unexplored(self.sides[0], self.sides[1]).ok();
        }
        Ok(())
    }

    fn truth(&self, answer: &str) -> Result<bool, MmsError> {
        match answer {
            "true" => Ok(true),
            "false" => Ok(false),
            other => Err(self.wrong(other, "true or false")),
        }
    }

    fn acknowledged(&self, answer: &str) -> Result<(), MmsError> {
        if answer == "ack" { Ok(()) } else { Err(self.wrong(answer, "ack")) }
    }

    /// Queues the next lines, or returns the outcome.
    fn decide(&mut self) -> Option<ExplorationOutcome> {
        let Some(known) = &self.known else { return Some(ExplorationOutcome::Unreachable) };
        let (cell, heading) = self.at;
        if !self.looked && !known.is_known(cell) {
            for (command, side) in
                [("wallFront", heading), ("wallLeft", heading.left()), ("wallRight", heading.right())]
            {
                if known.wall(cell, side) == WallState::Unknown {
                    self.queue.push_back((command.into(), Asked::WallState(side)));
                }
            }
        }
        self.looked = true;
        if !self.queue.is_empty() {
            return None;
        }
        if self.verdict.is_none() {
            let step = self.explorer.next(known, self.at);
            match step {
                // The wall behind has not been seen.
                ExplorationStep::Go(next) if next == cell => self.turn(heading.right()),
                ExplorationStep::Go(next) => self.head_for(next),
                ExplorationStep::Finished(verdict) => self.verdict = Some(verdict),
            }
            return None;
        }
        self.race()
    }

    /// Drives the best route, one cell at a time, once it is known.
    fn race(&mut self) -> Option<ExplorationOutcome> {
        let (known, verdict) = (self.known.as_ref()?, self.verdict?);
        let (cell, _) = self.at;
        if verdict != ExplorationOutcome::Optimal || (known.is_goal(cell) && self.racing) {
            return Some(verdict);
        }
        if !self.racing && cell == known.start() {
            self.racing = true;
            if known.is_goal(cell) {
                return Some(verdict);
            }
        }
        let side = self.first_step(|at| known.is_goal(at));
        match side {
            Some(side) => self.advance(side),
            None => return Some(ExplorationOutcome::Unreachable),
        }
        None
    }

    fn first_step(&self, goal: impl Fn(Cell) -> bool) -> Option<Direction> {
        let known = self.known.as_ref()?;
        let route = shortest_route_between(known, Unknown::Closed, Preference::StepsAndTurns, self.at, goal)?;
        route.moves().first().copied()
    }

    /// First step of the path to a cell.
    fn head_for(&mut self, cell: Cell) {
        match self.first_step(|at| at == cell) {
            Some(side) => self.advance(side),
            None => self.verdict = Some(ExplorationOutcome::Unreachable),
        }
    }

    fn turn(&mut self, to: Direction) {
        let heading = self.at.1;
        let (right, left) = (("turnRight", heading.right()), ("turnLeft", heading.left()));
        match heading.quarters_to(to) {
            0 => {}
            3 => self.queue.push_back((left.0.into(), Asked::Turn(left.1))),
            1 => self.queue.push_back((right.0.into(), Asked::Turn(right.1))),
            _ => self.queue.extend([heading.right(), to].map(|to| ("turnRight".into(), Asked::Turn(to)))),
        }
        self.looked = false;
    }

    /// Turns and drives into the next cell.
    fn advance(&mut self, side: Direction) {
        self.turn(side);
        self.queue.push_back(("moveForward".into(), Asked::Forward));
        self.queue.push_back(("wasReset".into(), Asked::Reset));
    }
}
