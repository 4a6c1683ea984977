//! Lower bounds of the remaining time of a run: the heuristic of the search.

use super::search::{ENDS, Tables};

/// Number of steps beyond which the bound no longer grows.
const STEPS: usize = 256;
/// Length of a straight (cells or edges) beyond which every further one counts as driven at top speed.
const LONG: usize = 16;

/// Minimum time (µs) from the end of each turn to a stop that is a number of steps away, in a maze without
/// walls.
///
/// Walls only lengthen the way, and more steps never take less time. So no run is faster than the bound for
/// the steps counted by flood fill. Along a hop, the bound falls by at most the time of the hop.
#[derive(Debug, Clone)]
pub(super) struct Bounds {
    /// By steps, and by the index of the turn.
    times: Vec<[u32; ENDS]>,
}

/// A straight and the turn after it, or a stop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hop {
    /// Cells or edges passed by the straight.
    pub(super) count: usize,
    /// Steps from the cell of one end to that of the next.
    pub(super) steps: usize,
    pub(super) time: u32,
    /// Index of the turn; `None` for a stop.
    pub(super) to: Option<usize>,
}

impl Bounds {
    pub(super) fn new(tables: &Tables) -> Self {
        let hops: [Vec<Hop>; ENDS] = std::array::from_fn(|end| tables.hops(end, LONG));
        let (per_step, before_turn) = tables.least_per_step();
        let mut times = vec![[u32::MAX; ENDS]; STEPS + 1];
        // The same, with any number of cells or edges at top speed before the turn.
        let mut cruising = times.clone();
        for steps in 0..=STEPS {
            // A hop within a cell leaves the number of remaining steps unchanged.
            loop {
                let before = times[steps];
                for end in 0..ENDS {
                    let onward =
                        hops[end].iter().map(|hop| bound(hop, steps, &times, &cruising, per_step[end]));
                    times[steps][end] = onward.min().unwrap_or(u32::MAX);
                    let further = steps.checked_sub(1).map_or(u32::MAX, |fewer| cruising[fewer][end]);
                    cruising[steps][end] = times[steps][end].min(further.saturating_add(before_turn[end]));
                }
                if times[steps] == before {
                    break;
                }
            }
        }
        Self { times }
    }

    /// Trivial bounds, for a search without heuristic.
    #[cfg(test)]
    pub(super) fn none() -> Self {
        Self { times: vec![[0; ENDS]] }
    }

    /// Bound for a number of steps after a turn.
    #[inline]
    pub(super) fn get(&self, steps: u32, end: usize) -> u32 {
        self.times[(steps as usize).min(self.times.len() - 1)][end]
    }
}

/// Minimum time of a way that begins with this hop; if the hop is a long one, also with longer ones.
fn bound(hop: &Hop, steps: usize, times: &[[u32; ENDS]], cruising: &[[u32; ENDS]], per_step: u32) -> u32 {
    let rest = steps.saturating_sub(hop.steps);
    let onward = match hop.to {
        Some(to) if hop.count == LONG => cruising[rest][to],
        Some(to) => times[rest][to],
        None if hop.count == LONG => per_step.saturating_mul(rest as u32),
        None if rest == 0 => 0,
        None => u32::MAX,
    };
    hop.time.saturating_add(onward)
}

#[cfg(test)]
mod tests {
    use super::super::limits::{Repertoire, RunLimits};
    use super::*;
    use crate::maze::Scale;

    #[test]
    fn bounds_grow_with_the_steps_and_fall_by_no_more_than_a_hop_takes() {
        for (scale, limits) in
            [(Scale::MICROMOUSE, RunLimits::MICROMOUSE), (Scale::DOUBLED, RunLimits::EYEBOT)]
        {
            let tables = Tables::new(&Repertoire::new(scale, limits).unwrap());
            let bounds = Bounds::new(&tables);
            for end in 0..ENDS {
                let hops = tables.hops(end, 40);
                for steps in 0..100 {
                    let bound = bounds.get(steps, end);
                    assert!(bound <= bounds.get(steps + 1, end));
                    for hop in hops.iter().filter(|hop| hop.time != u32::MAX) {
                        let rest = steps.saturating_sub(hop.steps as u32);
                        let onward = hop.to.map(|to| bounds.get(rest, to));
                        if let Some(onward) = onward.or((rest == 0).then_some(0)) {
                            assert!(bound <= hop.time + onward, "{end} {steps} {hop:?}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn bounds_of_the_slowest_robot_are_numbers() {
        let slowest = RunLimits { speed: 0.001, diagonal_speed: 0.001, ..RunLimits::MICROMOUSE };
        let tables = Tables::new(&Repertoire::new(Scale::MICROMOUSE, slowest).unwrap());
        let bounds = Bounds::new(&tables);
        assert!((1..300).all(|steps| bounds.get(steps - 1, 0) <= bounds.get(steps, 0)));
    }

    #[test]
    fn a_straight_from_standstill_meets_the_bound() {
        let tables = Tables::new(&Repertoire::new(Scale::MICROMOUSE, RunLimits::MICROMOUSE).unwrap());
        // For one step, nothing is faster than the straight.
        assert_eq!(Bounds::new(&tables).get(1, 0), tables.row(None)[1].stop);
    }
}
