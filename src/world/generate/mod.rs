//! Random worlds with known answers.
//!
//! [`obstacle_course`] draws a walled field of varied obstacles, many of them concave or curved, with a start
//! and a goal, which is reachable or unreachable. Reachability does not depend on tiny gaps: every passage
//! and niche is either closed or at least as wide as [`CourseOptions::min_corridor`], which is checked on the
//! finished world. Equal streams give the same world on every platform.
//!
//! Sensor-based algorithms for finding a goal (chapter 10) are evaluated on such courses.
//!
//! [`room`] draws a room with corners of many angles, curved walls and doors, whose wall can be followed all
//! the way round (chapter 6). [`relief`] draws hills, craters, ramps and steps (chapter 7), [`pool`] pools with water (chapter 8).

mod bent;
mod border;
mod brush;
mod contour;
mod course;
mod decor;
mod enclosure;
mod family;
mod figure;
mod layout;
mod options;
mod pool;
mod relief;
mod repertoire;
mod room;
mod round;
mod straight;
mod survey;

pub use course::{Course, obstacle_course};
pub use family::{CourseFamily, UnknownFamily};
pub use options::CourseOptions;
pub use pool::{Pool, PoolKind, pool};
pub use relief::{Relief, ReliefKind, ReliefOptions, relief};
pub use repertoire::ObstacleKind;
pub use room::{Room, RoomFeature, RoomOptions, room};
