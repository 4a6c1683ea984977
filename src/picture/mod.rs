//! Pictures of worlds and of robots' runs, as SVG or PNG files.
//!
//! A [`Picture`] shows a world from above: floor, walls and objects to scale, and additions such as robots,
//! paths, marked points and point clouds. Title, scale bar and legend stand outside the floor. Equal calls
//! produce equal bytes.
//!
//! ```
//! use roverlab::geometry::{Point, Pose};
//! use roverlab::picture::{Mark, Picture};
//! use roverlab::world::{RobotSpec, World};
//!
//! let world = World::walled(2.0, 1.0);
//! let mut picture = Picture::new(&world);
//! picture
//!     .title("A short trip")
//!     .true_path([Point::new(0.3, 0.5), Point::new(1.2, 0.6)])
//!     .mark(Mark::Goal, Point::new(1.7, 0.5))
//!     .robot(Pose::new(1.2, 0.6, 0.1), &RobotSpec::s4().footprint);
//! assert!(picture.to_svg().starts_with("<svg"));
//! ```
//!
//! Coordinates that are not finite are omitted: a lidar beam without a return draws nothing, and a path has a
//! gap. Content far outside the world is clipped at the frame.

mod canvas;
mod colours;
mod decorations;
mod film;
mod frame;
mod items;
mod labels;
mod legend;
mod lines;
mod marks;
mod names;
mod panels;
#[cfg(feature = "png")]
mod raster;
mod relief;
mod render;
mod robots;
mod save;
mod scenery;
mod style;
mod text;

pub use colours::{SERIES, ramp};
pub use items::{Figure, Item, Picture};
pub use marks::Mark;
pub use save::{FileType, SaveError};
pub use style::Style;
