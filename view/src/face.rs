use std::sync::Arc;

use image::RgbImage;
use roverlab::geometry::{Point, Pose};
use roverlab::io::sim::Onlooking;

use crate::{Displayed, Shown};

/// A display outside of the world.
#[derive(Debug, Clone)]
pub struct Face {
    /// Number of changes so far, from 1.
    pub drawings: u64,
    /// Its pixels.
    pub image: Arc<RgbImage>,
    /// The labels of the soft keys, with line feeds between.
    pub menu: String,
}

/// A world with displays of its own, or those of devices.
#[derive(Debug)]
pub struct Look<'a, 'e> {
    /// The world.
    pub world: &'a Onlooking<'e>,
    /// Robot by robot, the displays of devices, if there are any.
    pub faces: Option<&'a [Option<Face>]>,
}

impl Shown for Look<'_, '_> {
    fn time(&self) -> f64 {
        self.world.time()
    }

    fn pose(&self, robot: usize) -> Option<Pose> {
        self.world.pose(robot)
    }

    fn odometry(&self, robot: usize) -> Option<Pose> {
        self.world.odometry(robot)
    }

    fn contacts(&self, robot: usize) -> Option<(u32, &[Point])> {
        self.world.contacts(robot)
    }

    fn display(&self, robot: usize) -> Option<Displayed<'_>> {
        let Some(faces) = self.faces else { return Shown::display(self.world, robot) };
        let Face { drawings, image, menu } = faces.get(robot)?.as_ref()?;
        Some(Displayed { drawings: *drawings, image, menu: menu.clone() })
    }

    fn object(&self, object: usize) -> Option<Pose> {
        self.world.object(object)
    }

    fn has_fallen(&self, object: usize) -> bool {
        self.world.has_fallen(object)
    }
}
