use crate::ParameterError;
use crate::parameter::debug_as_sentence;
use std::fmt;
use std::str::FromStr;

use super::course::{Course, draw};
use super::{CourseOptions, ObstacleKind};
use crate::random::Stream;

/// Families of courses with one kind of difficulty each, to compare sensor-based navigation algorithms.
///
/// ```
/// use roverlab::random::Stream;
/// use roverlab::world::generate::{CourseFamily, ObstacleKind};
/// let family: CourseFamily = "local minima".parse()?;
/// let course = family.course(&mut Stream::new(1))?;
/// assert!(course.reachable && course.obstacles.iter().all(|kind| kind.is_concave()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CourseFamily {
    /// A few obstacles with hollows on the way to the goal.
    LocalMinima,
    /// A large field with many obstacles of every kind.
    ComplexTerrain,
    /// Obstacles whose boundaries hardly hold a robot back: convex ones, stars and bows.
    SemiConvex,
    /// Obstacles of every kind, one of which closes off the goal or the start.
    Unreachable,
}

impl CourseFamily {
    /// All families.
    pub const ALL: [Self; 4] = [Self::LocalMinima, Self::ComplexTerrain, Self::SemiConvex, Self::Unreachable];

    /// Name of the family.
    pub fn name(self) -> &'static str {
        match self {
            Self::LocalMinima => "local minima",
            Self::ComplexTerrain => "complex terrain",
            Self::SemiConvex => "semi-convex",
            Self::Unreachable => "unreachable",
        }
    }

    /// Sizes and numbers for its courses.
    pub fn options(self) -> CourseOptions {
        let reachable = CourseOptions { unreachable_share: 0.0, ..CourseOptions::default() };
        match self {
            Self::LocalMinima => CourseOptions { obstacles: (2, 5), objects: 0, ..reachable },
            Self::ComplexTerrain => CourseOptions { size: (6.0, 8.0), obstacles: (10, 14), ..reachable },
            Self::SemiConvex => CourseOptions { obstacles: (4, 9), ..reachable },
            Self::Unreachable => CourseOptions { unreachable_share: 1.0, ..reachable },
        }
    }

    /// Draws a course like [`obstacle_course`](super::obstacle_course).
    ///
    /// # Errors
    ///
    /// None with the present options.
    pub fn course(self, stream: &mut Stream) -> Result<Course, ParameterError> {
        draw(stream, &self.options(), self.kinds())
    }

    fn kinds(self) -> &'static [ObstacleKind] {
        use ObstacleKind as Kind;
        match self {
            Self::LocalMinima => &[
                Kind::Crescent,
                Kind::OpenRing,
                Kind::HookedRing,
                Kind::Trough,
                Kind::Angle,
                Kind::Comb,
                Kind::Room,
                Kind::Alcove,
            ],
            Self::SemiConvex => {
                &[Kind::Polygon, Kind::Disc, Kind::Ellipse, Kind::Star, Kind::Cross, Kind::Bow, Kind::Bump]
            }
            Self::ComplexTerrain | Self::Unreachable => &ObstacleKind::DRAWN,
        }
    }
}

impl fmt::Display for CourseFamily {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// An unknown name of a family of courses.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown family of courses `{found}`; expected one of {}", CourseFamily::ALL.map(CourseFamily::name).join(", "))]
pub struct UnknownFamily {
    found: String,
}

debug_as_sentence!(UnknownFamily);

impl FromStr for CourseFamily {
    type Err = UnknownFamily;

    /// Reads a name, case-insensitive, with spaces, hyphens or underscores.
    fn from_str(text: &str) -> Result<Self, UnknownFamily> {
        let plain = |text: &str| text.trim().to_ascii_lowercase().replace(['_', '-'], " ");
        let named = |family: &Self| plain(family.name()) == plain(text);
        Self::ALL.into_iter().find(named).ok_or_else(|| UnknownFamily { found: text.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nav::Reachability;

    #[test]
    fn courses_hold_what_their_family_promises() {
        for family in CourseFamily::ALL {
            assert!(family.options().validate().is_ok(), "{family}");
            for seed in 0..4 {
                let course = family.course(&mut Stream::new(seed)).unwrap();
                let kinds = family.kinds();
                let allowed = |kind: &ObstacleKind| kinds.contains(kind) || *kind == ObstacleKind::Enclosure;
                assert!(course.obstacles.iter().all(allowed), "{family}: {:?}", course.obstacles);
                let truth = Reachability::new(&course.world, 0.06, 0.01).unwrap();
                let way = truth.connected(course.start.position(), course.goal);
                assert_eq!(way, family != CourseFamily::Unreachable, "{family}, seed {seed}");
            }
        }
    }

    #[test]
    fn names_are_read_and_others_refused() {
        for family in CourseFamily::ALL {
            assert_eq!(family.name().to_uppercase().replace(' ', "_").parse(), Ok(family));
        }
        let error = "swamp".parse::<CourseFamily>().unwrap_err().to_string();
        assert!(
            error.starts_with("unknown family of courses `swamp`; expected one of local minima,"),
            "{error}"
        );
    }
}
