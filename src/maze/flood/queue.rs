//! Flood fill of large mazes: a queue, filled without branches.
//!
//! Whether a neighbour is new is as good as random to a processor, so that a branch on it costs more than to write every
//! neighbour behind the end of the queue and to move the end by 0 or 1. Each entry says where it came from, so that the way
//! back is not tried; few cells have more than two other openings. Cells have numbers of 16 bits, with which no index into
//! the arrays can be out of range.

use super::UNREACHED;
use super::passages::LARGEST;
use crate::maze::Cell;

/// The memory of a flood fill.
#[derive(Debug, Clone, Default)]
pub(super) struct Queue {
    /// Cells in the lower 16 bits, the direction back above. No cell enters twice, so that the end comes round to the
    /// beginning only when that has long been read.
    entries: Vec<u32>,
    steps: Vec<u16>,
}

/// What is not reached, and the only cell that can be so far away: the last of a way through all cells of the largest maze.
const FAR: u16 = u16::MAX;
/// Where the direction back is.
const BACK: u32 = 16;

impl Queue {
    /// Fills a maze of some width, `steps` of it in number.
    pub(super) fn fill(
        &mut self,
        openings: &[u8],
        sources: impl Iterator<Item = Cell>,
        width: usize,
        steps: &mut [u32],
    ) {
        self.entries.resize(LARGEST, 0);
        self.steps.resize(LARGEST, FAR);
        self.steps[..steps.len()].fill(FAR);
        let arrays = (openings.first_chunk(), self.entries.first_chunk_mut(), self.steps.first_chunk_mut());
        let (Some(openings), Some(entries), Some(found)) = arrays else { return };
        let mut end = 0;
        for source in sources {
            let index = usize::from(source.y) * width + usize::from(source.x);
            if found[index] != 0 {
                found[index] = 0;
                entries[end] = index as u32;
                end += 1;
            }
        }
        let reached = spread(openings, entries, found, end, &ways(width));
        let unreached = if reached == LARGEST { 0 } else { UNREACHED };
        for (steps, &found) in steps.iter_mut().zip(found.iter()) {
            *steps = if found == FAR { unreached.max(FAR.into()) } else { found.into() };
        }
    }
}

/// For each set of openings what to add to a cell for those behind them, with the directions back; 0 for none.
type Ways = [[u32; 4]; 16];

fn ways(width: usize) -> Ways {
    // North, east, south, west.
    let offsets = [width as u16, 1, (width as u16).wrapping_neg(), 1u16.wrapping_neg()];
    std::array::from_fn(|openings| {
        let mut list = [0; 4];
        let open = (0..4).filter(|side| openings >> side & 1 != 0);
        for (way, side) in list.iter_mut().zip(open) {
            *way = u32::from(offsets[side]) | 1 << (BACK as usize + (side + 2) % 4);
        }
        list
    })
}

/// Goes on from the first `end` cells of the queue. Returns how many cells were reached.
fn spread(
    openings: &[u8; LARGEST],
    entries: &mut [u32; LARGEST],
    found: &mut [u16; LARGEST],
    mut end: usize,
    ways: &Ways,
) -> usize {
    let mut next = 0;
    // Once all cells are reached nothing is left to be found.
    while next < end && end < LARGEST {
        let entry = entries[usize::from(next as u16)];
        next += 1;
        let here = entry as u16;
        let distance = found[usize::from(here)].wrapping_add(1);
        let onward = openings[usize::from(here)] & !((entry >> BACK) as u8) & 0xf;
        let ways = &ways[usize::from(onward)];
        let mut visit = |way: u32| {
            // Without a way one comes back to where one is, which has been met.
            let there = here.wrapping_add(way as u16);
            let known = found[usize::from(there)];
            found[usize::from(there)] = known.min(distance);
            entries[usize::from(end as u16)] = u32::from(there) | way & 0xf << BACK;
            end += usize::from(known == FAR);
        };
        visit(ways[0]);
        visit(ways[1]);
        if ways[2] != 0 {
            visit(ways[2]);
            visit(ways[3]);
        }
    }
    end
}
