//! Roads for model cars (book, chapter 13): closed two-lane courses by the rules of the CAuDri-Challenge, the
//! successor of the Carolo-Cup.
//!
//! The centre line of a road is an [`Alignment`] of straights, arcs and clothoids. A [`RoadCourse`] adds the
//! markings, locates a car in its lane, and is drawn as the floor of a [`World`](super::World). Courses come
//! from [`generate`], or from files in a plain format of our own: see
//! [`formats::course`](super::formats::course) and `docs/courses.md`.
//!
//! ```
//! use roverlab::world::road::{Appearance, RoadCourseOptions, generate};
//!
//! let course = generate(1, &RoadCourseOptions::default())?;
//! let world = course.world(&Appearance::default())?;
//! let start = course.start();
//! assert!(world.floor.contains(start.position()));
//! assert!(course.locate(&start, None).offset.abs() < 1e-6, "the middle of its lane");
//! # Ok::<(), roverlab::world::road::CourseError>(())
//! ```
//!
//! Your own course is a chain of elements:
//!
//! ```
//! use std::f64::consts::PI;
//! use roverlab::geometry::Pose;
//! use roverlab::world::road::{Alignment, RoadCourse, CourseError, Element};
//!
//! let half = [Element::straight(3.0), Element::arc(1.5, PI)];
//! let oval = RoadCourse::new(Alignment::new(Pose::default(), [half, half].concat()))?;
//! assert!((oval.line.length() - 15.42).abs() < 0.01);
//! let open = RoadCourse::new(Alignment::new(Pose::default(), [half, half, half].concat()));
//! assert!(matches!(open, Err(CourseError::Open { .. })));
//! # Ok::<(), CourseError>(())
//! ```

mod alignment;
mod check;
mod course;
mod crossings;
mod generate;
mod paint;
mod raster;
#[cfg(test)]
mod tests;

pub use alignment::{Alignment, AlignmentStation, Element};
pub use course::{
    Centre, CourseError, Crossing, LanePose, Line, RightOfWay, RoadCourse, RoadMark, RoadMarkKind, RoadSide,
    Traffic,
};
pub use generate::{RoadCourseOptions, generate};
pub use raster::Appearance;
