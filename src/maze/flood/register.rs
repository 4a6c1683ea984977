//! The wave of small mazes in 256-bit registers, one per board. Left to itself, the compiler spreads the four
//! words of a board over smaller registers and gathers them in each step.

use std::arch::x86_64::{
    __m256i, _mm256_and_si256, _mm256_andnot_si256, _mm256_extract_epi64, _mm256_or_si256,
    _mm256_permute4x64_epi64, _mm256_set1_epi64x, _mm256_setr_epi64x, _mm256_setzero_si256,
    _mm256_slli_epi64, _mm256_sllv_epi64, _mm256_srli_epi64, _mm256_srlv_epi64, _mm256_testz_si256,
};

use super::passages::Boards;
use super::wave::Wave;

/// Open sides of all cells.
struct Open {
    east: __m256i,
    north: __m256i,
    south: __m256i,
}

struct RegisterWave {
    front: __m256i,
    unseen: __m256i,
    planes: [__m256i; 8],
}

/// The same as [`Wave::spread`].
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn spread(boards: &Boards<4>, sources: [u64; 4]) -> Wave<4, 8> {
    let north = load(boards.north);
    let open = Open { east: load(boards.east), north, south: row_above(north) };
    let mut wave = RegisterWave {
        front: load(sources),
        unseen: _mm256_set1_epi64x(-1),
        planes: [_mm256_setzero_si256(); 8],
    };
    let mut eighth = 0;
    while _mm256_testz_si256(wave.front, wave.front) == 0 {
        wave.go_eight_steps(&open, eighth);
        eighth += 1;
    }
    Wave {
        front: words(wave.front),
        unseen: words(wave.unseen),
        planes: wave.planes.map(|plane| words(plane)),
    }
}

impl RegisterWave {
    #[target_feature(enable = "avx2")]
    #[inline]
    fn go_eight_steps(&mut self, open: &Open, eighth: i64) {
        let before = self.unseen;
        self.go::<0>(open);
        self.go::<1>(open);
        self.go::<2>(open);
        self.go::<3>(open);
        self.go::<4>(open);
        self.go::<5>(open);
        self.go::<6>(open);
        self.go::<7>(open);
        let new = _mm256_andnot_si256(self.unseen, before);
        for (bit, plane) in self.planes.iter_mut().skip(3).enumerate() {
            let all = _mm256_set1_epi64x(-(eighth >> bit & 1));
            *plane = _mm256_or_si256(*plane, _mm256_and_si256(new, all));
        }
    }

    #[target_feature(enable = "avx2")]
    #[inline]
    fn go<const LOW: usize>(&mut self, open: &Open) {
        let front = self.front;
        for (bit, plane) in self.planes.iter_mut().take(3).enumerate() {
            if LOW >> bit & 1 != 0 {
                *plane = _mm256_or_si256(*plane, front);
            }
        }
        self.unseen = _mm256_andnot_si256(front, self.unseen);
        let eastward = _mm256_slli_epi64::<1>(_mm256_and_si256(front, open.east));
        let westward = _mm256_and_si256(_mm256_srli_epi64::<1>(front), open.east);
        let northward = _mm256_and_si256(row_above(front), open.south);
        let southward = _mm256_and_si256(row_below(front), open.north);
        let along = _mm256_or_si256(eastward, westward);
        let across = _mm256_or_si256(northward, southward);
        self.front = _mm256_and_si256(_mm256_or_si256(along, across), self.unseen);
    }
}

/// Moves every bit to the cell to its north: one word on, and after the last word one row up.
#[target_feature(enable = "avx2")]
#[inline]
fn row_above(board: __m256i) -> __m256i {
    _mm256_sllv_epi64(_mm256_permute4x64_epi64::<0b10_01_00_11>(board), _mm256_setr_epi64x(16, 0, 0, 0))
}

/// Moves every bit to the cell to its south.
#[target_feature(enable = "avx2")]
#[inline]
fn row_below(board: __m256i) -> __m256i {
    _mm256_srlv_epi64(_mm256_permute4x64_epi64::<0b00_11_10_01>(board), _mm256_setr_epi64x(0, 0, 0, 16))
}

#[target_feature(enable = "avx2")]
#[inline]
fn load(board: [u64; 4]) -> __m256i {
    let [a, b, c, d] = board.map(u64::cast_signed);
    _mm256_setr_epi64x(a, b, c, d)
}

#[target_feature(enable = "avx2")]
#[inline]
fn words(board: __m256i) -> [u64; 4] {
    let words = [
        _mm256_extract_epi64::<0>(board),
        _mm256_extract_epi64::<1>(board),
        _mm256_extract_epi64::<2>(board),
        _mm256_extract_epi64::<3>(board),
    ];
    words.map(i64::cast_unsigned)
}
