//! Flood fill of small mazes: all cells of one distance are the bits of a few words, and one step moves them all.
//!
//! The distance of a cell is written as bits too: whenever a wave comes to new cells, they enter the planes of those bits
//! that are set in its number. The three lowest planes take part in each step; the others are the same for eight steps.

use super::UNREACHED;
use super::passages::Boards;
use crate::maze::Cell;

/// Every cell's distance, a plane for each of its bits, and which cells were reached.
struct Planes<const N: usize, const P: usize> {
    bits: [[u64; N]; P],
    reached: [u64; N],
}

/// Cells that the wave comes to from `front`.
#[inline(always)]
fn step<const N: usize>(boards: &Boards<N>, front: &[u64; N], unseen: &[u64; N]) -> [u64; N] {
    let row = Boards::<N>::ROW as u32;
    let north: [u64; N] = std::array::from_fn(|i| front[i] & boards.north[i]);
    std::array::from_fn(|i| {
        let eastward = (front[i] & boards.east[i]) << 1;
        let westward = front[i] >> 1 & boards.east[i];
        let from_below = if i == 0 { 0 } else { north[i - 1] >> (64 - row) };
        let northward = north[i] << row | from_below;
        let from_above = if i + 1 == N { 0 } else { front[i + 1] << (64 - row) };
        let southward = (front[i] >> row | from_above) & boards.north[i];
        (eastward | westward | northward | southward) & unseen[i]
    })
}

#[inline(always)]
fn spread<const N: usize, const P: usize>(boards: &Boards<N>, sources: [u64; N]) -> Planes<N, P> {
    let mut bits = [[0; N]; P];
    let (mut front, mut unseen) = (sources, sources.map(|word| !word));
    let mut eighth = 0_usize;
    loop {
        // The cells that this group of eight steps comes to.
        let before = unseen;
        for low in 0..8 {
            // Distance 0 is that of the sources.
            if low > 0 || eighth > 0 {
                front = step(boards, &front, &unseen);
            }
            for i in 0..N {
                unseen[i] &= !front[i];
                for (bit, plane) in bits.iter_mut().take(3).enumerate() {
                    if low >> bit & 1 != 0 {
                        plane[i] |= front[i];
                    }
                }
            }
        }
        for (bit, plane) in bits.iter_mut().skip(3).enumerate() {
            let all = (eighth >> bit & 1).wrapping_neg() as u64;
            for i in 0..N {
                plane[i] |= before[i] & !unseen[i] & all;
            }
        }
        if front.iter().fold(0, |any, word| any | word) == 0 {
            return Planes { bits, reached: unseen.map(|word| !word) };
        }
        eighth += 1;
    }
}

/// Writes the distances of a maze of any width up to that of a row.
#[inline(always)]
fn write<const N: usize, const P: usize>(planes: &Planes<N, P>, width: usize, steps: &mut [u32]) {
    let row = Boards::<N>::ROW;
    let mask = (1u64 << row) - 1;
    for (y, line) in steps.chunks_exact_mut(width).enumerate() {
        let (word, shift) = (y * row / 64, y * row % 64);
        let bits = |plane: &[u64; N]| (plane[word] >> shift & mask) as u32;
        let reached = bits(&planes.reached);
        let rows: [u32; P] = std::array::from_fn(|p| bits(&planes.bits[p]));
        let distance = |x: u32| {
            let found = (0..P).fold(0, |distance, p| distance | (rows[p] >> x & 1) << p);
            if reached >> x & 1 == 0 { UNREACHED } else { found }
        };
        for (x, steps) in (0..).zip(line) {
            *steps = distance(x);
        }
    }
}

fn board<const N: usize>(sources: impl Iterator<Item = Cell>) -> [u64; N] {
    let mut board = [0; N];
    for cell in sources {
        let bit = usize::from(cell.y) * Boards::<N>::ROW + usize::from(cell.x);
        board[bit / 64] |= 1 << (bit % 64);
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
    write(&spread::<4, 8>(boards, sources), width, steps);
}

#[multiversion::multiversion(targets(
    "x86_64+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx2+bmi1+bmi2",
    "x86_64+ssse3+sse4.1",
))]
fn medium(boards: &Boards<16>, sources: [u64; 16], width: usize, steps: &mut [u32]) {
    write(&spread::<16, 10>(boards, sources), width, steps);
}
