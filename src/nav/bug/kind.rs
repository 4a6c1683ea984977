use std::fmt;
use std::str::FromStr;

use super::{
    Alg1, Alg2, Bug, Bug1, Bug2, BugParameters, Class1, DistBug, LeaveBug, OneBug, Rev1, Rev2, TangentBug,
};
use crate::geometry::Point;
use crate::io::Result;
use crate::parameter::debug_as_sentence;

/// The bugs of this library, selectable by name.
///
/// ```
/// use roverlab::geometry::Point;
/// use roverlab::nav::{BugKind, BugParameters};
/// let kind: BugKind = "bug2".parse()?;
/// let bug = kind.with(Point::new(3.0, 1.0), BugParameters::default())?;
/// assert_eq!((bug.name(), bug.guarantee().complete), ("Bug2", true));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum BugKind {
    /// [`Bug1`].
    Bug1,
    /// [`Bug2`].
    Bug2,
    /// [`Alg1`].
    Alg1,
    /// [`Alg2`].
    Alg2,
    /// [`DistBug`].
    DistBug,
    /// [`TangentBug`].
    TangentBug,
    /// [`OneBug`].
    OneBug,
    /// [`LeaveBug`].
    LeaveBug,
    /// [`Rev1`].
    Rev1,
    /// [`Rev2`].
    Rev2,
    /// [`Class1`].
    Class1,
}

/// Unknown name of a bug.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown bug `{found}`; expected one of {}", BugKind::names())]
pub struct UnknownBug {
    found: String,
}

debug_as_sentence!(UnknownBug);

impl BugKind {
    /// All bugs.
    pub const ALL: [Self; 11] = [
        Self::Bug1,
        Self::Bug2,
        Self::Alg1,
        Self::Alg2,
        Self::DistBug,
        Self::TangentBug,
        Self::OneBug,
        Self::LeaveBug,
        Self::Rev1,
        Self::Rev2,
        Self::Class1,
    ];

    /// Name of the algorithm.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bug1 => "Bug1",
            Self::Bug2 => "Bug2",
            Self::Alg1 => "Alg1",
            Self::Alg2 => "Alg2",
            Self::DistBug => "DistBug",
            Self::TangentBug => "TangentBug",
            Self::OneBug => "OneBug",
            Self::LeaveBug => "LeaveBug",
            Self::Rev1 => "Rev1",
            Self::Rev2 => "Rev2",
            Self::Class1 => "Class1",
        }
    }

    /// Creates a run to a goal relative to the robot's start: metres ahead and to the left. Fails for
    /// parameters out of range and a goal that is not finite.
    pub fn with(self, goal: Point, parameters: BugParameters) -> Result<Box<dyn Bug + Send>> {
        Ok(match self {
            Self::Bug1 => Box::new(Bug1::new(goal, parameters)?),
            Self::Bug2 => Box::new(Bug2::new(goal, parameters)?),
            Self::Alg1 => Box::new(Alg1::new(goal, parameters)?),
            Self::Alg2 => Box::new(Alg2::new(goal, parameters)?),
            Self::TangentBug => Box::new(TangentBug::new(goal, parameters)?),
            Self::Rev1 => Box::new(Rev1::new(goal, parameters)?),
            Self::Rev2 => Box::new(Rev2::new(goal, parameters)?),
            Self::DistBug => Box::new(DistBug::new(goal, parameters)?),
            Self::OneBug => Box::new(OneBug::new(goal, parameters)?),
            Self::LeaveBug => Box::new(LeaveBug::new(goal, parameters)?),
            Self::Class1 => Box::new(Class1::new(goal, parameters)?),
        })
    }

    fn names() -> String {
        Self::ALL.map(Self::name).join(", ")
    }
}

impl fmt::Display for BugKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for BugKind {
    type Err = UnknownBug;

    /// Parses a name, ignoring case.
    fn from_str(text: &str) -> std::result::Result<Self, UnknownBug> {
        let named = |kind: &Self| kind.name().eq_ignore_ascii_case(text.trim());
        Self::ALL.into_iter().find(named).ok_or_else(|| UnknownBug { found: text.to_owned() })
    }
}
