//! Seeded random streams with the same numbers on every platform and in every release.
//!
//! The generator is xoshiro256++. The distributions are implemented here, because those of common crates
//! change between releases and use the platform's logarithm.

use std::convert::Infallible;

use rand::SeedableRng;
use rand::rand_core::{Rng as _, TryRng};
use rand::rngs::Xoshiro256PlusPlus;

use crate::geometry::math;

/// A stream of random numbers.
///
/// Each robot and each sensor has its own, derived from a parent by a label, so that one more draw in one
/// place changes nothing elsewhere:
///
/// ```
/// use roverlab::random::Stream;
/// let world = Stream::new(1);
/// let mut lidar = world.child("lidar", 0);
/// let mut again = Stream::new(1).child("lidar", 0);
/// assert_eq!(lidar.normal().to_bits(), again.normal().to_bits());
/// ```
///
/// It implements the generator traits of `rand` 0.10, so the distributions of `rand_distr` can draw from it.
/// Their results may change with their releases.
#[derive(Debug, Clone)]
pub struct Stream {
    seed: u64,
    generator: Xoshiro256PlusPlus,
}

impl Stream {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self { seed, generator: Xoshiro256PlusPlus::seed_from_u64(seed) }
    }

    /// An independent stream for a named purpose. It depends only on seed, label and index, not on earlier
    /// draws from `self`.
    #[must_use]
    pub fn child(&self, label: &str, index: u64) -> Self {
        // FNV-1a over label, index and seed: a fixed, documented hash.
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        let mut mix = |byte: u8| hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        label.bytes().for_each(&mut mix);
        index.to_le_bytes().into_iter().for_each(&mut mix);
        self.seed.to_le_bytes().into_iter().for_each(&mut mix);
        Self::new(hash)
    }

    /// 64 random bits.
    #[inline]
    pub fn bits(&mut self) -> u64 {
        self.generator.next_u64()
    }

    /// Uniform in `0.0..1.0`, with 53 random bits.
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform between two numbers.
    #[inline]
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Uniform integer below `n`; 0 if `n` is 0. The bias for `n` below 2^32 is less than 2^-32.
    #[inline]
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.bits()) * n as u128) >> 64) as usize
    }

    /// True with the given probability.
    #[inline]
    pub fn chance(&mut self, probability: f64) -> bool {
        self.uniform() < probability
    }

    /// A standard normal sample, from one uniform number by the quantile function (M. J. Wichura, Algorithm
    /// AS 241, Applied Statistics 37, 1988; relative error about 1e-16).
    #[inline]
    pub fn normal(&mut self) -> f64 {
        inverse_normal(self.inner_uniform())
    }

    /// Fills a slice with the samples that as many calls of [`normal`](Self::normal) return, faster.
    ///
    /// ```
    /// use roverlab::random::Stream;
    /// let (mut at_once, mut one_by_one) = (Stream::new(1), Stream::new(1));
    /// let mut samples = [0.0; 100];
    /// at_once.fill_normal(&mut samples);
    /// assert!(samples.iter().all(|&sample| sample == one_by_one.normal()));
    /// ```
    pub fn fill_normal(&mut self, samples: &mut [f64]) {
        for part in samples.chunks_mut(TOGETHER * LANES) {
            let mut blocks = [[0.5; LANES]; TOGETHER];
            let count = part.len();
            blocks.as_flattened_mut()[..count].fill_with(|| self.inner_uniform());
            inverse_normals(&mut blocks[..count.div_ceil(LANES)]);
            part.copy_from_slice(&blocks.as_flattened()[..count]);
        }
    }

    /// Uniform between 0 and 1; the half step keeps it off both, where the normal quantile is infinite.
    #[inline]
    fn inner_uniform(&mut self) -> f64 {
        ((self.bits() >> 12) as f64 + 0.5) * (1.0 / (1u64 << 52) as f64)
    }

    /// Shuffles a slice.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }
}

impl TryRng for Stream {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        self.generator.try_next_u32()
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        self.generator.try_next_u64()
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        self.generator.try_fill_bytes(bytes)
    }
}

/// Quantile function of the standard normal distribution, for `p` strictly between 0 and 1.
#[inline]
fn inverse_normal(p: f64) -> f64 {
    let q = p - 0.5;
    if is_central(q) { inverse_normal_centre(q) } else { inverse_normal_tail(p, q) }
}

/// Number of probabilities that a register of a processor holds, at most.
const LANES: usize = 8;
/// Maximum number of probabilities whose quantiles are computed together (registers).
const TOGETHER: usize = 8;

/// Replaces probabilities by their quantiles: first as if all of them were central, then those that are not,
/// as if none were in the outermost tails. Several at once are quick.
#[cfg_attr(
    feature = "io",
    multiversion::multiversion(targets(
        "x86_64+avx512f+avx512bw+avx512dq+avx512vl",
        "x86_64+avx2+bmi1+bmi2"
    ))
)]
fn inverse_normals(probabilities: &mut [[f64; LANES]]) {
    let (mut places, mut tails, mut count) = ([0; TOGETHER * LANES], [[0.25; LANES]; TOGETHER], 0);
    for (i, p) in probabilities.as_flattened().iter().enumerate() {
        (places[count], tails.as_flattened_mut()[count]) = (i, *p);
        count += usize::from(!is_central(*p - 0.5));
    }
    for p in probabilities.as_flattened_mut() {
        *p = inverse_normal_centre(*p - 0.5);
    }
    let quantiles = probabilities.as_flattened_mut();
    for (places, tails) in places[..count].chunks(LANES).zip(tails) {
        let mut shoulders = [0.0; LANES];
        for (z, p) in shoulders.iter_mut().zip(tails) {
            *z = inverse_normal_shoulder(p);
        }
        for ((&i, p), z) in places.iter().zip(tails).zip(shoulders) {
            quantiles[i] = if z.abs() > OUTERMOST { inverse_normal_tail(p, p - 0.5) } else { z };
        }
    }
}

#[inline]
fn is_central(q: f64) -> bool {
    q.abs() <= 0.425
}

/// Quantile of `q + 0.5`.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a loop compiled for several processors")]
fn inverse_normal_centre(q: f64) -> f64 {
    q * ratio(&CENTRE, 0.180_625 - q * q)
}

#[cold]
fn inverse_normal_tail(p: f64, q: f64) -> f64 {
    let r = (-math::ln(if q < 0.0 { p } else { 1.0 - p })).sqrt();
    let value = if r <= 5.0 { ratio(&SHOULDER, r - 1.6) } else { ratio(&TAIL, r - 5.0) };
    if q < 0.0 { -value } else { value }
}

/// Quantile above which one of a shoulder may belong to the tail beyond it: that begins where the probability
/// is exp(-25), at 6.65.
const OUTERMOST: f64 = 6.6;

/// Quantile of a probability that is neither central nor in the outermost tails, with the same bits as
/// [`inverse_normal_tail`].
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a loop compiled for several processors")]
fn inverse_normal_shoulder(p: f64) -> f64 {
    let q = p - 0.5;
    let r = (-ln_of_normal(if q < 0.0 { p } else { 1.0 - p })).sqrt();
    let value = ratio(&SHOULDER, r - 1.6);
    if q < 0.0 { -value } else { value }
}

/// Natural logarithm of a positive normal number other than 1 and infinity, with the same bits as `math::ln`,
/// in operations that a loop does for several numbers at once: the number is split into a power of 2 and a
/// factor around 1 whose logarithm is a polynomial (FreeBSD's `e_log.c`).
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a loop compiled for several processors")]
fn ln_of_normal(x: f64) -> f64 {
    /// The logarithm of 2 in two parts, the first of which has trailing zeros.
    const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
    /// The coefficients of even and of odd powers.
    const EVEN: [f64; 3] = [3.999_999_999_940_942e-1, 2.222_219_843_214_978_4e-1, 1.531_383_769_920_937_3e-1];
    const ODD: [f64; 4] = [
        6.666_666_666_666_735e-1,
        2.857_142_874_366_239e-1,
        1.818_357_216_161_805e-1,
        1.479_819_860_511_658_6e-1,
    ];
    /// The upper halves of the bits of 1 and of the root of 1/2.
    const ONE: u64 = 0x3ff0_0000;
    const HALF_ROOT: u64 = 0x3fe6_a09e;
    let bits = x.to_bits();
    let upper = (bits >> 32) + (ONE - HALF_ROOT);
    let power = ((upper >> 20) as i64 - 0x3ff) as f64;
    let factor = f64::from_bits((((upper & 0xf_ffff) + HALF_ROOT) << 32) | (bits & 0xffff_ffff));
    let f = factor - 1.0;
    let half_square = 0.5 * f * f;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let even = w * (EVEN[0] + w * (EVEN[1] + w * EVEN[2]));
    let odd = z * (ODD[0] + w * (ODD[1] + w * (ODD[2] + w * ODD[3])));
    s * (half_square + (odd + even)) + power * LN_2[1] - half_square + f + power * LN_2[0]
}

/// Numerator and denominator coefficients of a rational function, constant term first.
type Rational = [[f64; 8]; 2];

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a loop compiled for several processors")]
fn ratio([numerator, denominator]: &Rational, x: f64) -> f64 {
    let horner = |c: &[f64; 8]| c.iter().rev().fold(0.0, |sum, c| sum * x + c);
    horner(numerator) / horner(denominator)
}

/// Normal quantile near the median (M. J. Wichura, algorithm AS 241, 1988).
const CENTRE: Rational = [
    [
        3.387_132_872_796_366_5,
        1.331_416_678_917_843_8e2,
        1.971_590_950_306_551_3e3,
        1.373_169_376_550_946e4,
        4.592_195_393_154_987e4,
        6.726_577_092_700_87e4,
        3.343_057_558_358_813e4,
        2.509_080_928_730_122_7e3,
    ],
    [
        1.0,
        4.231_333_070_160_091e1,
        6.871_870_074_920_579e2,
        5.394_196_021_424_751e3,
        2.121_379_430_158_659_7e4,
        3.930_789_580_009_271e4,
        2.872_908_573_572_194_3e4,
        5.226_495_278_852_545e3,
    ],
];
/// Normal quantile farther from the median (same source).
const SHOULDER: Rational = [
    [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        2.417_807_251_774_506e-1,
        2.272_384_498_926_918_4e-2,
        7.745_450_142_783_414e-4,
    ],
    [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        6.897_673_349_851e-1,
        1.481_039_764_274_800_8e-1,
        1.519_866_656_361_645_7e-2,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ],
];
/// Normal quantile in the tails (same source).
const TAIL: Rational = [
    [
        6.657_904_643_501_103,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        2.965_605_718_285_048_7e-1,
        2.653_218_952_657_612_4e-2,
        1.242_660_947_388_078_4e-3,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ],
    [
        1.0,
        5.998_322_065_558_88e-1,
        1.369_298_809_227_358e-1,
        1.487_536_129_085_061_5e-2,
        7.868_691_311_456_133e-4,
        1.846_318_317_510_054_8e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_8e-15,
    ],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_quantiles_have_the_bits_of_single_ones() {
        let mut stream = Stream::new(1);
        for _ in 0..20_000 {
            // Small probabilities of all magnitudes, and those near 1.
            let mut blocks = [[0.0; LANES]; TOGETHER];
            for (i, p) in blocks.as_flattened_mut().iter_mut().enumerate() {
                let uniform = stream.inner_uniform();
                *p = if i % 3 == 0 { math::exp(-36.0 * uniform) } else { uniform };
                assert_eq!(ln_of_normal(*p).to_bits(), math::ln(*p).to_bits(), "{p}");
            }
            let expected = blocks.map(|block| block.map(|p| inverse_normal(p).to_bits()));
            inverse_normals(&mut blocks);
            assert_eq!(blocks.map(|block| block.map(f64::to_bits)), expected);
        }
    }

    #[test]
    fn quantiles_match_tables() {
        for (p, z) in [
            (0.5, 0.0),
            (0.975, 1.959_963_984_540_054),
            (0.001, -3.090_232_306_167_813_5),
            (1e-12, -7.034_483_825_301_132),
        ] {
            assert!((inverse_normal(p) - z).abs() < 1e-13 * z.abs().max(1.0), "{p}: {}", inverse_normal(p));
        }
    }

    #[test]
    fn normal_samples_have_the_right_moments() {
        let mut stream = Stream::new(7);
        let n = 200_000;
        let (mut sum, mut squares, mut fourths) = (0.0, 0.0, 0.0);
        for _ in 0..n {
            let x = stream.normal();
            sum += x;
            squares += x * x;
            fourths += x * x * x * x;
        }
        let n = f64::from(n);
        assert!(
            (sum / n).abs() < 0.01 && (squares / n - 1.0).abs() < 0.015 && (fourths / n - 3.0).abs() < 0.1
        );
    }

    #[test]
    fn children_do_not_depend_on_what_the_parent_drew() {
        let mut parent = Stream::new(3);
        let before = parent.child("a", 1).bits();
        parent.bits();
        assert_eq!(before, parent.child("a", 1).bits());
        assert_ne!(before, parent.child("a", 2).bits());
        assert_ne!(before, parent.child("b", 1).bits());
    }

    #[test]
    fn below_stays_below_and_reaches_all() {
        let mut stream = Stream::new(1);
        let mut seen = [false; 6];
        (0..200).for_each(|_| seen[stream.below(6)] = true);
        assert!(seen.iter().all(|&s| s));
        assert_eq!(stream.below(0), 0);
    }
}
