//! Flood fill of large mazes, from a queue with few branches.
//!
//! Whether a neighbour is new is unpredictable to the processor, so a branch on it costs more than always
//! writing the neighbour behind the end of the queue and advancing the end by 0 or 1. Each entry holds the
//! passages from its cell except the one back; most cells have one. Cells have 16-bit numbers, so no index is
//! out of range.

use super::UNREACHED;
use super::passages::LARGEST;
use crate::maze::Cell;

/// Buffers of a flood fill.
#[derive(Debug, Clone, Default)]
pub(super) struct Queue {
    /// Cells in the lower 16 bits, open directions above. No cell enters twice, so the end wraps around to
    /// the start only after that has been read.
    entries: Vec<u32>,
    /// Open directions of cells that are not yet queued; [`SEEN`] for the others.
    unseen: Vec<u8>,
}

/// Mark of a queued cell: more than any set of directions.
const SEEN: u8 = 1 << 7;
/// Bit offset of the open directions in an entry.
const OPEN: u32 = 16;

impl Queue {
    /// Fills a maze of a width with `steps.len()` cells.
    pub(super) fn fill(
        &mut self,
        openings: &[u8],
        sources: impl Iterator<Item = Cell>,
        width: usize,
        steps: &mut [u32],
    ) {
        steps.fill(UNREACHED);
        self.entries.resize(LARGEST, 0);
        self.unseen.resize(LARGEST, SEEN);
        self.unseen[..steps.len()].copy_from_slice(&openings[..steps.len()]);
        let arrays = (self.entries.first_chunk_mut(), self.unseen.first_chunk_mut());
        let (Some(entries), Some(unseen)) = arrays else { return };
        let mut run = Run { entries, unseen, ways: ways(width), end: 0 };
        for source in sources {
            run.enter(usize::from(source.y) * width + usize::from(source.x));
        }
        run.spread(steps);
    }
}

/// For each set of open sides, the offsets to the neighbours, each with the direction back; 0 for none.
type Ways = [[u32; 4]; 16];

fn ways(width: usize) -> Ways {
    // North, east, south, west.
    let offsets = [width as u16, 1, (width as u16).wrapping_neg(), 1u16.wrapping_neg()];
    std::array::from_fn(|openings| {
        let mut list = [0; 4];
        let open = (0..4).filter(|side| openings >> side & 1 != 0);
        for (way, side) in list.iter_mut().zip(open) {
            *way = u32::from(offsets[side]) | 1 << (OPEN as usize + (side + 2) % 4);
        }
        list
    })
}

struct Run<'a> {
    entries: &'a mut [u32; LARGEST],
    unseen: &'a mut [u8; LARGEST],
    ways: Ways,
    /// Number of queued cells.
    end: usize,
}

impl Run<'_> {
    fn enter(&mut self, source: usize) {
        let open = std::mem::replace(&mut self.unseen[source], SEEN);
        if open != SEEN {
            self.entries[self.end] = source as u32 | u32::from(open) << OPEN;
            self.end += 1;
        }
    }

    /// Spreads from the sources to all cells.
    fn spread(&mut self, steps: &mut [u32]) {
        let (mut next, mut distance) = (0, 0);
        while next < self.end {
            // All entries so far have the same distance.
            let level = self.end;
            while next < level {
                let entry = self.entries[usize::from(next as u16)];
                next += 1;
                let (here, open) = (entry as u16, entry >> OPEN & 0xf);
                steps[usize::from(here)] = distance;
                let ways = self.ways[open as usize];
                self.visit(here, ways[0]);
                // Few cells have more than one further passage, and only sources have four.
                if ways[1] != 0 {
                    self.visit(here, ways[1]);
                    self.visit(here, ways[2]);
                    if distance == 0 {
                        self.visit(here, ways[3]);
                    }
                }
            }
            distance += 1;
        }
    }

    /// Queues a neighbour if it is new. Without a passage, the offset 0 leads back to the cell itself, which
    /// is not new.
    #[inline]
    fn visit(&mut self, here: u16, way: u32) {
        let there = here.wrapping_add(way as u16);
        let open = std::mem::replace(&mut self.unseen[usize::from(there)], SEEN);
        let ahead = u32::from(open) << OPEN & !(way & 0xf << OPEN);
        self.entries[usize::from(self.end as u16)] = u32::from(there) | ahead;
        self.end += usize::from(open != SEEN);
    }
}
