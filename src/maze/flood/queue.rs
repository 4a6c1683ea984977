//! Flood fill of large mazes: a queue, filled without branches.
//!
//! Whether a neighbour is new is as good as random to a processor, so that a branch on it costs more than to write every
//! neighbour behind the end of the queue and to move the end by 0 or 1.

use super::UNREACHED;
use crate::maze::Cell;

/// The memory of a flood fill.
#[derive(Debug, Clone, Default)]
pub(super) struct Queue {
    cells: Vec<u32>,
    /// The open directions of each cell, and whether it has been met.
    state: Vec<u8>,
}

/// Set in the state of a cell that has been met.
const MET: u32 = 7;

impl Queue {
    pub(super) fn fill(
        &mut self,
        openings: &[u8],
        sources: impl Iterator<Item = Cell>,
        width: usize,
        steps: &mut [u32],
    ) {
        let count = openings.len();
        self.state.clear();
        self.state.extend_from_slice(openings);
        self.cells.resize(count + 4, 0);
        steps.fill(UNREACHED);
        let mut end = 0;
        for source in sources {
            let index = usize::from(source.y) * width + usize::from(source.x);
            if self.state[index] >> MET == 0 {
                self.state[index] |= 1 << MET;
                self.cells[end] = index as u32;
                end += 1;
            }
        }
        spread(&mut self.cells, &mut self.state[..count], end, width, steps);
    }
}

/// Goes on from the first `end` cells of the queue.
fn spread(queue: &mut [u32], state: &mut [u8], mut end: usize, width: usize, steps: &mut [u32]) {
    // North, east, south, west.
    let offsets = [width, 1, width.wrapping_neg(), 1usize.wrapping_neg()];
    let (mut next, mut distance) = (0, 0);
    while next < end {
        let level = next..end;
        next = end;
        for place in level {
            let here = queue[place] as usize;
            steps[here] = distance;
            let open = state[here];
            for (bit, offset) in offsets.into_iter().enumerate() {
                // Through a wall one comes back to where one is, which has been met.
                let through = usize::from(open >> bit & 1).wrapping_neg();
                let there = here.wrapping_add(offset & through);
                let new = !state[there] >> MET;
                state[there] |= new << MET;
                queue[end] = there as u32;
                end += usize::from(new);
            }
        }
        distance += 1;
    }
}
