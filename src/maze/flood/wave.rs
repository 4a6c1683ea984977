//! Flood fill of small mazes by a bit-parallel wave: the cells of one distance are the bits of a few words,
//! and one step moves them all.
//!
//! Distances are stored as bit planes: when the wave reaches new cells, they enter the planes of the bits set
//! in their distance. The three lowest planes change with each step, the others every eight steps.

use super::UNREACHED;
use super::passages::Boards;
use crate::maze::Cell;

/// State of a wave: the cells of the wavefront, the cells not yet reached, and the distances, one plane per
/// bit.
pub(super) struct Wave<const N: usize, const P: usize> {
    pub(super) front: [u64; N],
    pub(super) unseen: [u64; N],
    pub(super) planes: [[u64; N]; P],
}

impl<const N: usize, const P: usize> Wave<N, P> {
    /// Runs a wave to its end.
    #[inline(always)]
    pub(super) fn spread(boards: &Boards<N>, sources: [u64; N]) -> Self {
        let mut wave = Self { front: sources, unseen: [!0; N], planes: [[0; N]; P] };
        let mut eighth = 0_usize;
        while wave.front.iter().fold(0, |any, word| any | word) != 0 {
            wave.go_eight_steps(boards, eighth);
            eighth += 1;
        }
        wave
    }

    /// Eight steps, whose distances differ in the three lowest bits only. Written out, because a loop is not
    /// unrolled and half as fast.
    #[inline(always)]
    fn go_eight_steps(&mut self, boards: &Boards<N>, eighth: usize) {
        let before = self.unseen;
        self.go::<0>(boards);
        self.go::<1>(boards);
        self.go::<2>(boards);
        self.go::<3>(boards);
        self.go::<4>(boards);
        self.go::<5>(boards);
        self.go::<6>(boards);
        self.go::<7>(boards);
        for (bit, plane) in self.planes.iter_mut().skip(3).enumerate() {
            let all = (eighth >> bit & 1).wrapping_neg() as u64;
            add(plane, &std::array::from_fn(|i| before[i] & !self.unseen[i] & all));
        }
    }

    /// Records the wavefront and moves it on. `LOW` are the three lowest bits of its distance.
    #[inline(always)]
    fn go<const LOW: usize>(&mut self, boards: &Boards<N>) {
        for (bit, plane) in self.planes.iter_mut().take(3).enumerate() {
            if LOW >> bit & 1 != 0 {
                add(plane, &self.front);
            }
        }
        for (unseen, front) in self.unseen.iter_mut().zip(&self.front) {
            *unseen &= !front;
        }
        self.front = step(boards, &self.front, &self.unseen);
    }
}

#[inline(always)]
fn add<const N: usize>(plane: &mut [u64; N], cells: &[u64; N]) {
    for (plane, cells) in plane.iter_mut().zip(cells) {
        *plane |= cells;
    }
}

/// Cells that the wave reaches from `front`. The row above is in the next word at the same place; only
/// between the last and the first word do bits move.
#[inline(always)]
fn step<const N: usize>(boards: &Boards<N>, front: &[u64; N], unseen: &[u64; N]) -> [u64; N] {
    let row = Boards::<N>::ROW;
    let north: [u64; N] = std::array::from_fn(|i| front[i] & boards.north[i]);
    let from_below: [u64; N] =
        std::array::from_fn(|i| if i == 0 { north[N - 1] << row } else { north[i - 1] });
    let from_above: [u64; N] =
        std::array::from_fn(|i| if i + 1 == N { front[0] >> row } else { front[i + 1] });
    std::array::from_fn(|i| {
        let eastward = (front[i] & boards.east[i]) << 1;
        let westward = front[i] >> 1 & boards.east[i];
        (eastward | westward | from_below[i] | from_above[i] & boards.north[i]) & unseen[i]
    })
}

/// Writes the distances of a maze up to one row of bits wide.
#[inline(always)]
pub(super) fn write<const N: usize, const P: usize>(wave: &Wave<N, P>, width: usize, steps: &mut [u32]) {
    for (y, line) in steps.chunks_exact_mut(width).enumerate() {
        let (word, shift) = Boards::<N>::place(y);
        // Bits above the row belong to no cell.
        let bits = |plane: &[u64; N]| (plane[word] >> shift) as u32;
        let rows: [u32; P] = std::array::from_fn(|p| bits(&wave.planes[p]));
        let unseen = bits(&wave.unseen);
        for (x, steps) in line.iter_mut().enumerate() {
            let cell = 1 << x;
            let bit = |p: usize| if rows[p] & cell != 0 { 1 << p } else { 0 };
            let distance = (0..P).fold(0, |distance, p| distance | bit(p));
            *steps = if unseen & cell != 0 { UNREACHED } else { distance };
        }
    }
}

fn board<const N: usize>(sources: impl Iterator<Item = Cell>) -> [u64; N] {
    let mut board = [0; N];
    for cell in sources {
        let (word, shift) = Boards::<N>::place(cell.y.into());
        board[word] |= 1 << (shift + usize::from(cell.x));
    }
    board
}

/// Fills a maze of up to 16 x 16 cells.
pub(super) fn fill_small(
    boards: &Boards<4>,
    sources: impl Iterator<Item = Cell>,
    width: usize,
    steps: &mut [u32],
) {
    small(boards, board(sources), width, steps);
}

/// Fills a maze of up to 32 x 32 cells.
pub(super) fn fill_medium(
    boards: &Boards<16>,
    sources: impl Iterator<Item = Cell>,
    width: usize,
    steps: &mut [u32],
) {
    medium(boards, board(sources), width, steps);
}

#[multiversion::multiversion(targets(
    "x86_64+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx2+bmi1+bmi2",
    "x86_64+ssse3+sse4.1",
))]
fn small(boards: &Boards<4>, sources: [u64; 4], width: usize, steps: &mut [u32]) {
    let wave = multiversion::target::match_target! {
        "x86_64+avx512f+avx512bw+avx512dq+avx512vl" | "x86_64+avx2+bmi1+bmi2" => super::register::spread(boards, sources),
        _ => Wave::<4, 8>::spread(boards, sources),
    };
    // The usual width as a constant, so that a row is written at once.
    if width == 16 {
        write(&wave, 16, steps);
    } else {
        write(&wave, width, steps);
    }
}

#[multiversion::multiversion(targets(
    "x86_64+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx2+bmi1+bmi2",
    "x86_64+ssse3+sse4.1",
))]
fn medium(boards: &Boards<16>, sources: [u64; 16], width: usize, steps: &mut [u32]) {
    write(&Wave::<16, 10>::spread(boards, sources), width, steps);
}
