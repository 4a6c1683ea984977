//! Hills: one surface that carries robots, blocks rays and is drawn.

mod height_field;
mod pyramid;
mod ray;

use std::path::PathBuf;
use std::sync::Arc;

pub use height_field::HeightField;

/// The hills of a world, as described in its file.
///
/// ```
/// use roverlab::geometry::{Aabb, Point};
/// use roverlab::world::{HeightField, Terrain};
/// let area = Aabb::new(Point::origin(), Point::new(10.0, 10.0));
/// let slope = HeightField::from_fn(11, 11, area, |place| 0.1 * place.x)?;
/// let terrain = Terrain::new("slope.asc", slope);
/// let surface = terrain.surface.expect("it was given");
/// assert!((surface.height(Point::new(5.5, 2.0)).expect("a place on it") - 0.55).abs() < 1e-6);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Terrain {
    /// Extent along x, from x = 0 (m).
    pub width: f64,
    /// Extent along y, from y = 0 (m).
    pub height: f64,
    /// Height above the floor of a white pixel, or of a grid's highest point (m); black is 0.
    pub max_elevation: f64,
    /// File of the elevations, as named in the world's file.
    pub file: PathBuf,
    /// The surface, once a [`FileSource`](super::formats::FileSource) has found the file; this happens when a
    /// whole scene is read, but not when only the text of a world is read. Beyond the surface there is no
    /// ground.
    pub surface: Option<Arc<HeightField>>,
}

impl Terrain {
    /// Hills made by a program.
    pub fn new(file: impl Into<PathBuf>, surface: HeightField) -> Self {
        let far = surface.area().max;
        let max_elevation = surface.highest();
        Self {
            width: far.x,
            height: far.y,
            max_elevation,
            file: file.into(),
            surface: Some(Arc::new(surface)),
        }
    }
}
