use std::path::PathBuf;
use std::sync::Arc;

use roverlab::random::Stream;

/// A type with samples: the first is ordinary, the others are at the edges of what the type can hold, or
/// beyond what a caller should pass.
pub trait Sample: Sized {
    /// Number of samples.
    fn count() -> usize;

    /// A sample; `None` if the library refuses to make it, which is what it should do with most of them.
    fn nth(index: usize) -> Option<Self>;

    /// Several ordinary ones, for lists.
    fn ordinary_list() -> Option<Vec<Self>> {
        (0..3).map(|_| Self::nth(0)).collect()
    }
}

/// Chooses the sample of each argument of a call.
#[derive(Debug)]
pub struct Picker {
    choice: Choice,
    /// Number of samples of each argument so far.
    pub counts: Vec<usize>,
}

#[derive(Debug)]
enum Choice {
    /// One argument has this sample, all others the first.
    One { argument: usize, sample: usize },
    /// All have this sample, or the last.
    All(usize),
    /// Drawn.
    Drawn(Stream),
}

impl Picker {
    /// The first sample of each argument but one.
    pub fn one(argument: usize, sample: usize) -> Self {
        Self { choice: Choice::One { argument, sample }, counts: Vec::new() }
    }

    /// The same sample of all arguments.
    pub fn all(sample: usize) -> Self {
        Self { choice: Choice::All(sample), counts: Vec::new() }
    }

    /// Random samples.
    pub fn drawn(seed: u64) -> Self {
        Self { choice: Choice::Drawn(Stream::new(seed)), counts: Vec::new() }
    }

    /// For the samples of a type that is made of parts: which of them is another than the first.
    pub fn nth(index: usize, counts: &[usize]) -> Self {
        let mut sample = index;
        for (argument, count) in counts.iter().enumerate() {
            if sample < *count {
                return Self::one(argument, sample);
            }
            sample -= count - 1;
        }
        Self::one(0, 0)
    }

    /// Number of samples of a type that is made of parts.
    pub fn total(counts: &[usize]) -> usize {
        1 + counts.iter().map(|count| count - 1).sum::<usize>()
    }

    /// The next argument.
    pub fn pick<T: Sample>(&mut self) -> Option<T> {
        let (here, count) = (self.counts.len(), T::count());
        self.counts.push(count);
        T::nth(match &mut self.choice {
            Choice::One { argument, sample } if *argument == here => *sample,
            Choice::One { .. } => 0,
            Choice::All(sample) => (*sample).min(count - 1),
            Choice::Drawn(random) => random.below(count),
        })
    }
}

/// Implements [`Sample`] by lists of values; a value is an expression that may return from a closure by `?`.
macro_rules! samples {
    ($($type:ty => [$($value:expr),+ $(,)?] $(, list $list:expr)?;)+) => {$(
        impl $crate::Sample for $type {
            fn count() -> usize {
                [$(stringify!($value)),+].len()
            }

            #[allow(unused_assignments, clippy::redundant_closure_call)]
            fn nth(index: usize) -> Option<Self> {
                let mut at = 0;
                $(
                    if at == index {
                        return (|| -> Option<Self> { Some($value) })();
                    }
                    at += 1;
                )+
                None
            }
            $(
                fn ordinary_list() -> Option<Vec<Self>> {
                    Some($list)
                }
            )?
        }
    )+};
}
pub(crate) use samples;

/// A type whose samples are some values, and those with one field changed.
pub(crate) trait Varied: Sized {
    /// Number of these values.
    const COUNT: usize;

    /// One of them.
    fn base(index: usize) -> Self;
}

/// Implements [`Varied`] by lists of values, for types whose fields are all public and whose first samples
/// the library would refuse together.
macro_rules! varied {
    ($($type:ty => varied [$($value:expr),+ $(,)?];)+) => {$(
        impl $crate::sample::Varied for $type {
            const COUNT: usize = [$(stringify!($value)),+].len();

            fn base(index: usize) -> Self {
                let makers: [fn() -> Self; Self::COUNT] = [$(|| $value),+];
                makers[index]()
            }
        }
    )+};
}
pub(crate) use varied;

samples! {
    f64 => [1.0, f64::NAN, f64::NEG_INFINITY, f64::INFINITY, 0.0, -0.0, -1.0, 1e-9, 1e9, 1e160, 1e300, -1e300],
        list vec![0.0, 1.0, 3.0, 2.0, 5.0, 4.0];
    f32 => [1.0, f32::NAN, f32::NEG_INFINITY, f32::INFINITY, 0.0, -1.0, 1e-9, 1e30];
    bool => [true, false];
    u8 => [1, 0, 2, 255];
    u16 => [2, 0, 1, 1000, u16::MAX];
    u32 => [3, 0, 1, 100_000, u32::MAX];
    u64 => [3, 0, 1, 100_000, u64::MAX];
    usize => [3, 0, 1, 2, 1000, 100_000, 1_000_000_000, usize::MAX], list vec![0, 1, 2];
    i8 => [1, 0, -1, i8::MIN, i8::MAX];
    i32 => [1, 0, -1, i32::MIN, i32::MAX];
    i64 => [1, 0, -1, i64::MIN, i64::MAX];
    char => ['a', '\0', '\u{10ffff}'];
    String => [
        "a".into(), String::new(), "0".into(), "nan".into(), "-1e999".into(), "\0".into(), "\u{202e}ß😀".into(),
        "[".repeat(10_000), "1 ".repeat(10_000), "a: &a [*a]\n".into(), "{}".into()
    ];
    PathBuf => [
        "/nonexistent/folder/file".into(), PathBuf::new(), "/dev/null".into(), "/".into(), "/dev/zero".into(),
        "a\0b".into()
    ];
    std::ops::Range<usize> => [0..2, 0..0, reversed(5, 2), 0..usize::MAX, reversed(usize::MAX, 0)];
    std::ops::Range<f64> => [0.0..1.0, 1.0..0.0, f64::NAN..1.0, 0.0..f64::INFINITY];
    std::ops::RangeInclusive<f64> => [0.0..=1.0, 1.0..=0.0, f64::NAN..=1.0, 0.0..=f64::INFINITY];
    Stream => [Stream::new(1)];
    std::time::Duration => [std::time::Duration::from_millis(1), std::time::Duration::ZERO, std::time::Duration::MAX];
}

impl<T: Sample> Sample for Vec<T> {
    fn count() -> usize {
        T::count() + 2
    }

    fn nth(index: usize) -> Option<Self> {
        match index {
            0 => T::ordinary_list(),
            1 => Some(Self::new()),
            2 => Some(vec![T::nth(0)?]),
            _ => {
                let mut list = T::ordinary_list()?;
                list.insert(1, T::nth(index - 2)?);
                Some(list)
            }
        }
    }
}

impl<T: Sample> Sample for Option<T> {
    fn count() -> usize {
        T::count() + 1
    }

    fn nth(index: usize) -> Option<Self> {
        if index == 1 { Some(None) } else { T::nth(index.saturating_sub(1)).map(Some) }
    }
}

impl<T: Sample, const N: usize> Sample for [T; N] {
    fn count() -> usize {
        Picker::total(&[T::count(); N])
    }

    fn nth(index: usize) -> Option<Self> {
        let mut picker = Picker::nth(index, &[T::count(); N]);
        let items: Option<Vec<T>> = (0..N).map(|_| picker.pick()).collect();
        items?.try_into().ok()
    }
}

impl<T: Sample> Sample for Arc<T> {
    fn count() -> usize {
        T::count()
    }

    fn nth(index: usize) -> Option<Self> {
        T::nth(index).map(Arc::new)
    }
}

impl<T: Sample> Sample for Box<T> {
    fn count() -> usize {
        T::count()
    }

    fn nth(index: usize) -> Option<Self> {
        T::nth(index).map(Self::new)
    }
}

macro_rules! tuples {
    ($(($($type:ident),+))+) => {$(
        impl<$($type: Sample),+> Sample for ($($type,)+) {
            fn count() -> usize {
                Picker::total(&[$($type::count()),+])
            }

            fn nth(index: usize) -> Option<Self> {
                let mut picker = Picker::nth(index, &[$($type::count()),+]);
                Some(($(picker.pick::<$type>()?,)+))
            }
        }
    )+};
}

tuples! { (A) (A, B) (A, B, C) (A, B, C, D) }

/// A range whose end comes before its start.
fn reversed(start: usize, end: usize) -> std::ops::Range<usize> {
    std::ops::Range { start, end }
}
