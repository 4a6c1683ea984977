use std::sync::{Arc, Mutex, PoisonError};

use image::RgbImage;
use roverlab::geometry::Point;
use roverlab::io::sim::{Onlooking, Watcher};
use roverlab::io::{LidarScan, Psd};
use roverlab::world::{Scene, Wall};
use roverlab_view::{Face, Frames, Look, scene_json};

use crate::mouth::Mouth;
use crate::{Message, Thing, Wish};

/// Takes frames of a world and applies the user's actions.
#[derive(Debug)]
pub(crate) struct Camera {
    mouth: Mouth,
    frames: Frames,
    panel: Option<Panel>,
    wishes: Vec<Wish>,
    /// Number of actions applied.
    fulfilled: usize,
    from: f64,
    ticks: u64,
}

/// Ticks between frames.
const TICKS: u64 = 4;

/// The displays of programs, robot by robot, if their robots have none of their own.
pub(crate) type Panel = Arc<Mutex<Vec<Option<Face>>>>;

impl Camera {
    /// Adds drawn walls to a scene, sends it, and takes frames of its run from a time (s) on.
    pub(crate) fn of(
        scene: &mut Scene,
        (walls, wishes): (&[[Point; 2]], Vec<Wish>),
        from: f64,
        mouth: &Mouth,
    ) -> Self {
        scene.world.walls.extend(walls.iter().map(|&[a, b]| Wall::new(a, b)));
        mouth.say(Message::Scene, scene_json(scene).to_string().as_bytes());
        let frames = Frames::new(scene);
        Self { mouth: mouth.clone(), frames, panel: None, wishes, fulfilled: 0, from, ticks: 0 }
    }

    /// Shows the displays of programs.
    #[cfg(all(target_family = "wasm", feature = "programs"))]
    pub(crate) fn with_panel(self, panel: Panel) -> Self {
        Self { panel: Some(panel), ..self }
    }
}

impl Watcher for Camera {
    fn tick(&mut self, world: &mut Onlooking<'_>) {
        let time = world.time();
        self.mouth.set_time(time);
        while let Some(wish) = self.wishes.get(self.fulfilled).filter(|wish| wish.time <= time) {
            self.fulfilled += 1;
            // Missing robots or objects cannot be moved.
            let _ = match wish.thing {
                Thing::Robot(robot, pose) => world.place_robot(robot, pose),
                Thing::Object(object, pose) => world.place_object(object, pose),
                Thing::Key(robot, key) => world.press_key(robot, key),
            };
        }
        if self.ticks.is_multiple_of(TICKS) {
            if time < self.from {
                self.frames.skip(world);
            } else {
                let faces =
                    self.panel.as_ref().map(|panel| panel.lock().unwrap_or_else(PoisonError::into_inner));
                let look = Look { world, faces: faces.as_deref().map(Vec::as_slice) };
                self.mouth.say(Message::Frame, self.frames.frame(&look));
            }
        }
        self.ticks += 1;
    }

    fn distance(&mut self, robot: usize, sensor: Psd, range: f64) {
        self.frames.distance(robot, sensor, range);
    }

    fn scan(&mut self, robot: usize, scan: &LidarScan) {
        self.frames.scan(robot, scan);
    }

    fn image(&mut self, robot: usize, image: &RgbImage) {
        self.frames.image(robot, image);
    }
}
