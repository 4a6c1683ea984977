use super::canvas::Canvas;
use super::film::Darkroom;
use super::scenery::Scenery;
use crate::world::Scene;
use crate::world::space::SolidId;

/// Shared by all cameras of a simulation: the visible scene, and buffers for one picture.
#[derive(Debug)]
pub(in crate::io::sim) struct Studio {
    pub(super) scenery: Scenery,
    pub(super) canvas: Canvas,
    /// One side of a fisheye's cube.
    pub(super) side: Canvas,
    pub(super) darkroom: Darkroom,
}

impl Studio {
    /// The studio of a scene; `objects` and `robots` are its solids.
    pub(in crate::io::sim) fn new(scene: &Scene, objects: &[SolidId], robots: &[SolidId]) -> Self {
        Self {
            scenery: Scenery::new(scene, objects, robots),
            canvas: Canvas::default(),
            side: Canvas::default(),
            darkroom: Darkroom::default(),
        }
    }
}
