use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use image::RgbImage;
use roverlab::io::sim::{Onlooking, Watcher};
use roverlab::io::{LidarScan, Psd};
use roverlab::picture::Picture;
use roverlab::world::{Scene, Wall};
use roverlab_cli::{Onlooker, run_words};
use roverlab_view::{Frames, overlay_json, scene_json};
use serde_json::json;

use crate::{Digest, Job, Message, Thing, Wish};

/// Runs a job and reports its progress in messages.
pub fn run(job: Job, tell: impl FnMut(Message, &[u8]) + Send + 'static) {
    let Job { words, files, wishes, walls, from } = job;
    let mouth =
        Mouth(Arc::new(Mutex::new(Telling { tell: Box::new(tell), digest: Digest::default(), time: 0.0 })));
    let page = Page { mouth: mouth.clone(), files, wishes, walls, from };
    let ended = run_words(words.into_iter().map(OsString::from), Some(Box::new(page)));
    let digest = mouth.with(|telling| {
        telling.digest.add(ended.output.as_bytes());
        telling.digest.to_string()
    });
    let ended =
        json!({ "status": ended.status, "output": ended.output, "errors": ended.errors, "digest": digest });
    mouth.say(Message::Ended, ended.to_string().as_bytes());
}

/// Sends messages, for the observer of a command and the watcher of its world.
#[derive(Clone)]
struct Mouth(Arc<Mutex<Telling>>);

/// Receives a message and its bytes.
type Tell = dyn FnMut(Message, &[u8]) + Send;

struct Telling {
    tell: Box<Tell>,
    digest: Digest,
    /// Simulated time (s).
    time: f64,
}

impl fmt::Debug for Mouth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Mouth").finish_non_exhaustive()
    }
}

impl Mouth {
    fn with<T>(&self, ask: impl FnOnce(&mut Telling) -> T) -> T {
        ask(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn say(&self, message: Message, bytes: &[u8]) {
        self.with(|telling| {
            telling.digest.add(bytes);
            (telling.tell)(message, bytes);
        });
    }
}

/// The page as observer of a command.
#[derive(Debug)]
struct Page {
    mouth: Mouth,
    files: BTreeMap<String, Vec<u8>>,
    wishes: Vec<Wish>,
    walls: Vec<[roverlab::geometry::Point; 2]>,
    from: f64,
}

impl Onlooker for Page {
    fn told(&mut self, line: &str) {
        let time = self.mouth.with(|telling| telling.time);
        if time >= self.from {
            self.mouth.say(Message::Told, &[&time.to_le_bytes(), line.as_bytes()].concat());
        }
    }

    /// Files are opened without their folders, so the last part of a name must suffice.
    fn file(&mut self, name: &str) -> Option<Vec<u8>> {
        let last = |name: &str| name.rsplit(['/', '\\']).next().unwrap_or_default().to_lowercase();
        let found = self.files.get(name);
        found
            .or_else(|| self.files.iter().find(|(other, _)| last(other) == last(name)).map(|(_, file)| file))
            .cloned()
    }

    fn scene(&mut self, scene: &mut Scene) -> Box<dyn Watcher> {
        scene.world.walls.extend(self.walls.iter().map(|&[a, b]| Wall::new(a, b)));
        self.mouth.say(Message::Scene, scene_json(scene).to_string().as_bytes());
        Box::new(Camera {
            mouth: self.mouth.clone(),
            frames: Frames::new(scene),
            wishes: self.wishes.clone(),
            fulfilled: 0,
            from: self.from,
            ticks: 0,
        })
    }

    fn picture(&mut self, picture: &Picture) {
        if picture.is_to_scale() {
            self.mouth.say(Message::Overlay, overlay_json(picture).to_string().as_bytes());
        }
        self.mouth.say(Message::Picture, picture.to_svg().as_bytes());
    }
}

/// Takes frames of a world and applies the user's actions.
#[derive(Debug)]
struct Camera {
    mouth: Mouth,
    frames: Frames,
    wishes: Vec<Wish>,
    /// Number of actions applied.
    fulfilled: usize,
    from: f64,
    ticks: u64,
}

/// Ticks between frames.
const TICKS: u64 = 4;

impl Watcher for Camera {
    fn tick(&mut self, world: &mut Onlooking<'_>) {
        let time = world.time();
        self.mouth.with(|telling| telling.time = time);
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
                self.mouth.say(Message::Frame, self.frames.frame(world));
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
