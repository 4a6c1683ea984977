/// What the simulator counts.
///
/// A run begins when the mouse leaves the start, and ends in the goal or back at the start.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Score {
    /// Cells driven in all.
    pub total_distance: u32,
    /// Quarter turns in all.
    pub total_turns: u32,
    /// The same with long straights counted by half.
    pub total_effective: f64,
    /// Of the run that is under way, or of the last one.
    pub current: MmsRun,
    /// The run with the lowest sum of turns and effective distance, once there is one.
    pub best: Option<MmsRun>,
    /// Whether a run has come to the goal.
    pub solved: bool,
    running: bool,
    penalty: f64,
}

/// One run from the start.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MmsRun {
    /// Cells driven.
    pub distance: u32,
    /// Quarter turns.
    pub turns: u32,
    /// Cells, with straights of more than two in one command counted by half.
    pub effective: f64,
}

impl MmsRun {
    fn sum(&self) -> f64 {
        f64::from(self.turns) + self.effective
    }
}

impl Score {
    /// The score of a maze that is not solved.
    const UNSOLVED: f64 = 2000.0;
    /// What a reset costs.
    const RESET: f64 = 15.0;

    /// The score, the lower the better: the best run's, and a tenth of all that was driven.
    pub fn value(&self) -> f64 {
        match self.best {
            Some(best) => best.sum() + 0.1 * (f64::from(self.total_turns) + self.total_effective),
            None => Self::UNSOLVED,
        }
    }

    /// What is called by a name of the protocol; -1 where there is nothing yet.
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
