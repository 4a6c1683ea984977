/// Statistics of the simulator.
///
/// A run begins when the mouse leaves the start, and ends at the goal or back at the start.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Score {
    /// Total number of cells driven.
    pub total_distance: u32,
    /// Total number of quarter turns.
    pub total_turns: u32,
    /// Total distance with long straights counted by half (cells).
    pub total_effective: f64,
    /// The present run, or the last one.
    pub current: MmsRun,
    /// The run with the smallest sum of turns and effective distance.
    pub best: Option<MmsRun>,
    /// Whether a run has reached the goal.
    pub solved: bool,
    running: bool,
    penalty: f64,
}

/// A run from the start.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MmsRun {
    /// Number of cells driven.
    pub distance: u32,
    /// Number of quarter turns.
    pub turns: u32,
    /// Effective distance: straights of more than two cells in one command count by half (cells).
    pub effective: f64,
}

impl MmsRun {
    fn sum(&self) -> f64 {
        f64::from(self.turns) + self.effective
    }
}

impl Score {
    /// Score of an unsolved maze.
    const UNSOLVED: f64 = 2000.0;
    /// Penalty of a reset.
    const RESET: f64 = 15.0;

    /// The score, lower is better: the best run plus a tenth of everything driven.
    pub fn value(&self) -> f64 {
        match self.best {
            Some(best) => best.sum() + 0.1 * (f64::from(self.total_turns) + self.total_effective),
            None => Self::UNSOLVED,
        }
    }

    /// The statistic of a protocol name; -1 if it does not exist yet.
    pub(super) fn named(&self, name: &str) -> Option<f64> {
        let best = |value: fn(&MmsRun) -> f64| self.best.as_ref().map_or(-1.0, value);
        Some(match name {
            "total-distance" => self.total_distance.into(),
            "total-turns" => self.total_turns.into(),
            "total-effective-distance" => self.total_effective,
            "current-run-distance" => self.current.distance.into(),
            "current-run-turns" => self.current.turns.into(),
            "current-run-effective-distance" => self.current.effective,
            "best-run-distance" => best(|run| run.distance.into()),
            "best-run-turns" => best(|run| run.turns.into()),
            "best-run-effective-distance" => best(|run| run.effective),
            "score" => self.value(),
            _ => return None,
        })
    }

    pub(super) fn leave_start(&mut self) {
        self.current = MmsRun { effective: self.penalty, ..MmsRun::default() };
        self.total_effective += self.penalty;
        self.penalty = 0.0;
        self.running = true;
    }

    pub(super) fn drive(&mut self, cells: u32) {
        let effective = if cells > 2 { 0.5 * f64::from(cells) + 1.0 } else { f64::from(cells) };
        self.total_distance += cells;
        self.total_effective += effective;
        if self.running {
            self.current.distance += cells;
            self.current.effective += effective;
        }
    }

    pub(super) fn turn(&mut self) {
        self.total_turns += 1;
        if self.running {
            self.current.turns += 1;
        }
    }

    pub(super) fn reach_goal(&mut self) {
        if self.running {
            self.running = false;
            self.solved = true;
            if self.best.is_none_or(|best| self.current.sum() < best.sum()) {
                self.best = Some(self.current);
            }
        }
    }

    pub(super) fn return_to_start(&mut self) {
        self.running = false;
    }

    pub(super) fn reset(&mut self) {
        self.running = false;
        self.penalty = Self::RESET;
    }
}
