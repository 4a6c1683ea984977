use super::score::Score;
use crate::maze::{Cell, Direction, Maze, Unknown};

/// The simulator's side of the protocol: a maze with a mouse that answers commands.
///
/// It implements the commands with whole cells and quarter turns: `mazeWidth`, `mazeHeight`, `wallFront`,
/// `wallRight`, `wallLeft` and `wallBack` (with an odd number of half steps), `moveForward` (with a number of
/// cells), `turnRight`, `turnLeft`, `wasReset`, `ackReset`, `getStat`, and the drawing commands. As in mms,
/// other lines get no answer.
#[derive(Debug, Clone)]
pub struct MmsReferee {
    maze: Maze,
    at: (Cell, Direction),
    score: Score,
    reset: bool,
    commands: u64,
    ignored: u64,
    first_ignored: Option<String>,
}

impl MmsReferee {
    /// A mouse at the start of a maze. Unknown walls count as present.
    pub fn new(maze: Maze) -> Self {
        let at = (maze.start(), maze.heading());
        Self { maze, at, score: Score::default(), reset: false, commands: 0, ignored: 0, first_ignored: None }
    }

    /// Cell and heading of the mouse.
    pub fn at(&self) -> (Cell, Direction) {
        self.at
    }

    /// The score so far.
    pub fn score(&self) -> &Score {
        &self.score
    }

    /// Number of valid commands.
    pub fn commands(&self) -> u64 {
        self.commands
    }

    /// Number of invalid lines, and the first of them.
    pub fn ignored(&self) -> (u64, Option<&str>) {
        (self.ignored, self.first_ignored.as_deref())
    }

    /// Presses the reset button; the mouse learns of it when it asks.
    pub fn press_reset(&mut self) {
        self.reset = true;
    }

    /// Answer to a line, without the line end; `None` if there is none.
    pub fn answer(&mut self, line: &str) -> Option<String> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let Some(answer) = self.obey(&words) else {
            self.ignored += 1;
            self.first_ignored.get_or_insert_with(|| line.chars().take(60).collect());
            return None;
        };
        self.commands += 1;
        (!answer.is_empty()).then_some(answer)
    }

    /// The answer, empty for a command without one; `None` if the line is not a command.
    fn obey(&mut self, words: &[&str]) -> Option<String> {
        let (cell, heading) = self.at;
        Some(match *words {
            ["mazeWidth"] => self.maze.width().to_string(),
            ["mazeHeight"] => self.maze.height().to_string(),
            ["wallFront", ref rest @ ..] => self.wall(heading, rest)?.to_string(),
            ["wallRight", ref rest @ ..] => self.wall(heading.right(), rest)?.to_string(),
            ["wallBack", ref rest @ ..] => self.wall(heading.opposite(), rest)?.to_string(),
            ["wallLeft", ref rest @ ..] => self.wall(heading.left(), rest)?.to_string(),
            ["moveForward", ref rest @ ..] => self.drive(number(rest)?).into(),
            ["turnRight"] => self.turn(cell, heading.right()),
            ["turnLeft"] => self.turn(cell, heading.left()),
            ["wasReset"] => self.reset.to_string(),
            ["ackReset"] => {
                self.at = (self.maze.start(), self.maze.heading());
                self.score.reset();
                self.reset = false;
                "ack".into()
            }
            ["getStat", name] => self.score.named(name)?.to_string(),
            ["setWall" | "clearWall", x, y, side] => {
                self.cell(x, y)?;
                matches!(side, "n" | "e" | "s" | "w").then(String::new)?
            }
            ["setColor", x, y, _] | ["clearColor" | "clearText", x, y] | ["setText", x, y, ..] => {
                self.cell(x, y).map(|_| String::new())?
            }
            ["clearAllColor" | "clearAllText"] => String::new(),
            _ => return None,
        })
    }

    fn cell(&self, x: &str, y: &str) -> Option<Cell> {
        let cell = Cell::new(x.parse().ok()?, y.parse().ok()?);
        self.maze.contains(cell).then_some(cell)
    }

    /// Whether a wall is a number of half steps away.
    fn wall(&self, side: Direction, rest: &[&str]) -> Option<bool> {
        let half_steps = number(rest)?;
        let mut cell = self.at.0;
        // Walls lie at odd numbers of half steps.
        if half_steps.is_multiple_of(2) {
            return None;
        }
        for _ in 0..half_steps / 2 {
            match self.maze.neighbour(cell, side) {
                Some(next) => cell = next,
                None => return Some(true),
            }
        }
        Some(self.maze.passage(cell, side, Unknown::Closed).is_none())
    }

    fn turn(&mut self, cell: Cell, heading: Direction) -> String {
        self.at = (cell, heading);
        self.score.turn();
        "ack".into()
    }

    /// Drives up to a number of cells, as far as no wall blocks the way.
    fn drive(&mut self, cells: u32) -> &'static str {
        let (from, heading) = self.at;
        let mut passed = Vec::new();
        let mut cell = from;
        while (passed.len() as u32) < cells
            && let Some(next) = self.maze.passage(cell, heading, Unknown::Closed)
        {
            passed.push(next);
            cell = next;
        }
        if passed.is_empty() {
            return "crash";
        }
        if from == self.maze.start() {
            self.score.leave_start();
        }
        self.at = (cell, heading);
        self.score.drive(passed.len() as u32);
        if self.maze.is_goal(cell) {
            self.score.reach_goal();
        } else if cell == self.maze.start() {
            self.score.return_to_start();
        }
        if passed.len() as u32 == cells { "ack" } else { "crash" }
    }
}

/// The optional number after a command, from 1; 1 by default.
fn number(rest: &[&str]) -> Option<u32> {
    match rest {
        [] => Some(1),
        [number] => number.parse().ok().filter(|&number| number > 0),
        _ => None,
    }
}
