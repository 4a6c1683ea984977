//! Descriptions of worlds and robots, and their file formats.
//!
//! A [`Scene`] is a [`World`] with robots. The types are plain data in SI units; readers and writers of the
//! EyeSim and ROS formats are in [`formats`].

mod bit_grid;
mod body;
mod built_in;
mod clearance;
mod colour;
pub mod formats;
pub mod generate;
mod grid;
mod mesh;
mod misplacement;
mod object;
pub mod road;
mod robot;
mod scene;
mod sensors;
mod site;
pub mod space;
mod terrain;
mod texture;
mod wall;
mod water;
#[cfg(feature = "parry2d")]
mod with_parry;

pub use bit_grid::{BitGrid, BitGridError, GridCell};
pub use body::{Axis, Body, Collider, Place3};
pub use clearance::{Clearance, Raster};
pub use colour::Colour;
pub use grid::{Occupancy, OccupancyGrid};
pub use mesh::{Face, Material, Mesh};
pub use misplacement::Misplacement;
pub use object::{Billboard, Marker, Object, ObjectKind, Shape};
pub use robot::{CarDynamics, DriveSpec, Footprint, Mast, MotorSpec, RobotSpec};
pub use scene::{Place, RobotPlacement, Scene, Settings, World};
pub use sensors::{CameraSpec, DepthSensorSpec, InertialSpec, LidarSpec, Mount, PsdSpec};
pub use terrain::{HeightField, Terrain};
pub use texture::Texture;
pub use wall::Wall;
pub use water::{Water, Waves};
#[cfg(feature = "parry2d")]
pub use with_parry::ParryError;
