use std::fmt;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use image::RgbImage;
use roverlab::io::log::{RobotMessages, RobotTopic, Topic, scene_message};
use roverlab::io::sim::{Onlooking, Watcher};
use roverlab::io::{Key, LidarScan, Psd};
use roverlab::picture::Picture;
use roverlab::world::Scene;
use serde_json::json;

use super::hub::{Channel, Hub, Keep};
use super::server::{Opening, Server};
use crate::{Face, Frames, IMAGE_INTERVAL, Look, Message, Shown, overlay_json, scene_json};

/// The page beside a run, and other viewers. On drop, viewers receive the rest, and their connections end.
pub struct Beside {
    server: Server,
    page: Channel,
    /// Simulated time (s), as its bits.
    time: Arc<AtomicU64>,
}

impl fmt::Debug for Beside {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Beside").field("address", &self.address()).finish_non_exhaustive()
    }
}

/// Devices outside a simulated world: displays and keys of the programs that drive its robots.
pub trait Devices: fmt::Debug + Send {
    /// A robot's display, after the first drawing.
    fn face(&self, robot: usize) -> Option<Face>;

    /// Presses a soft key of a robot.
    fn press(&self, robot: usize, key: Key);
}

/// Number of a run's last lines that a later page receives.
const LINES: usize = 1000;

impl Beside {
    /// Listens for the page. Fails if the port is taken.
    pub fn open(opening: &Opening) -> io::Result<Self> {
        let server = Server::open(opening)?;
        let (page, command) = (server.hub.page(), &opening.command);
        let beside = Self { server, page, time: Arc::default() };
        beside.say(Message::Beside, json!({ "command": command }).to_string().as_bytes(), 1);
        Ok(beside)
    }

    /// Address of the page; that of the protocol begins with `ws:`.
    pub fn address(&self) -> &str {
        self.server.address()
    }

    /// Waits until the page, or another viewer, has subscribed to something.
    pub fn wait(&self) {
        self.server.hub.wait_for_subscription();
    }

    /// A line of output.
    pub fn told(&self, line: &str) {
        let time = self.time.load(Ordering::Relaxed).to_le_bytes();
        self.say(Message::Told, &[&time, line.as_bytes()].concat(), LINES);
    }

    /// The scene before robots drive in it. Returns the watcher that must observe it.
    pub fn scene(&self, scene: &Scene) -> Box<dyn Watcher> {
        self.scene_with(scene, None)
    }

    /// The same, with devices outside the world.
    pub fn scene_with(&self, scene: &Scene, devices: Option<Box<dyn Devices>>) -> Box<dyn Watcher> {
        let hub = &self.server.hub;
        self.say(Message::Scene, scene_json(scene).to_string().as_bytes(), 1);
        let channel = hub.advertise(Topic::scene());
        hub.publish(&channel, 0, &scene_message(scene), Keep::Last(0, 1));
        let robots = scene.robots.iter().enumerate().map(|(index, robot)| {
            let channels = RobotTopic::ALL.map(|topic| hub.advertise(topic.of(index)));
            let messages = RobotMessages::new(index);
            let [.., transforms] = &channels;
            hub.publish(transforms, 0, &messages.start(&robot.pose), Keep::Last(0, 1));
            Robot { channels, messages, drawings: 0, shown: None }
        });
        Box::new(Camera {
            faces: Vec::new(),
            devices,
            robots: robots.collect(),
            hub: Arc::clone(hub),
            page: self.page.clone(),
            time: Arc::clone(&self.time),
            frames: Frames::new(scene),
            pages: 0,
            ticks: 0,
        })
    }

    /// The picture of the run.
    pub fn picture(&self, picture: &Picture) {
        if let Some(plan) = picture.plan() {
            self.say(Message::Overlay, overlay_json(plan).to_string().as_bytes(), 1);
        }
        self.say(Message::Picture, picture.to_svg().as_bytes(), 1);
    }

    /// The end of the run: exit status, output and errors.
    pub fn ended(&self, status: u8, output: &str, errors: &str) {
        let text = json!({ "status": status, "output": output, "errors": errors }).to_string();
        self.say(Message::Ended, text.as_bytes(), 1);
    }

    /// Sends a message to pages. Later pages receive the last messages of each kind.
    fn say(&self, message: Message, bytes: &[u8], most: usize) {
        let time = nanoseconds(f64::from_bits(self.time.load(Ordering::Relaxed)));
        let keep = Keep::Last(message as u8, most);
        self.server.hub.publish(&self.page, time, &[&[message as u8], bytes].concat(), keep);
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        self.server.finish();
    }
}

/// Time of a message (ns).
pub(super) fn nanoseconds(seconds: f64) -> u64 {
    (seconds * 1e9).round() as u64
}

/// Takes frames of a world while there are viewers, and presses keys.
struct Camera {
    hub: Arc<Hub>,
    page: Channel,
    robots: Vec<Robot>,
    devices: Option<Box<dyn Devices>>,
    /// The devices' displays at the last frame.
    faces: Vec<Option<Face>>,
    time: Arc<AtomicU64>,
    frames: Frames,
    /// Number of pages at the last frame.
    pages: u64,
    ticks: u64,
}

/// A robot for viewers other than the page.
struct Robot {
    channels: [Channel; 5],
    messages: RobotMessages,
    /// Number of display calls already shown, and when (s).
    drawings: u64,
    shown: Option<f64>,
}

impl fmt::Debug for Camera {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Camera").field("robots", &self.robots.len()).finish_non_exhaustive()
    }
}

/// Ticks between frames.
const TICKS: u64 = 4;

impl Watcher for Camera {
    fn tick(&mut self, world: &mut Onlooking<'_>) {
        let time = world.time();
        self.time.store(time.to_bits(), Ordering::Relaxed);
        for (robot, key) in self.hub.take_keys() {
            match &self.devices {
                Some(devices) => devices.press(robot, key),
                // A missing robot has no keys.
                None => drop(world.press_key(robot, key)),
            }
        }
        if self.ticks.is_multiple_of(TICKS) {
            self.look(world, nanoseconds(time));
        }
        self.ticks += 1;
    }

    fn distance(&mut self, robot: usize, sensor: Psd, range: f64) {
        self.frames.distance(robot, sensor, range);
    }

    fn scan(&mut self, robot: usize, scan: &LidarScan) {
        if self.page.is_wanted() {
            self.frames.scan(robot, scan);
        }
        self.show(robot, RobotTopic::Lidar, |messages, time| messages.scan(time, scan));
    }

    fn image(&mut self, robot: usize, image: &RgbImage) {
        if self.page.is_wanted() {
            self.frames.image(robot, image);
        }
        self.show(robot, RobotTopic::Camera, |messages, time| messages.image(time, image));
    }
}

impl Camera {
    fn look(&mut self, world: &Onlooking<'_>, time: u64) {
        if let Some(devices) = &self.devices {
            self.faces = (0..self.robots.len()).map(|robot| devices.face(robot)).collect();
        }
        let world = &Look { world, faces: self.devices.is_some().then_some(self.faces.as_slice()) };
        if self.page.is_wanted() {
            let pages = self.hub.pages();
            if pages != self.pages {
                self.pages = pages;
                self.frames.restart();
            }
            let frame = [&[Message::Frame as u8], self.frames.frame(world)].concat();
            self.hub.publish(&self.page, time, &frame, Keep::No);
        }
        let mut is_wanted = false;
        for (index, robot) in self.robots.iter_mut().enumerate() {
            if robot.channels.iter().any(Channel::is_wanted) {
                is_wanted = true;
                robot.show(index, world, &self.hub);
            }
        }
        if is_wanted {
            self.hub.tell_time(time);
        }
    }

    fn show(&self, robot: usize, topic: RobotTopic, message: impl FnOnce(&RobotMessages, f64) -> Vec<u8>) {
        let Robot { channels, messages, .. } = &self.robots[robot];
        let channel = &channels[topic as usize];
        if channel.is_wanted() {
            let time = f64::from_bits(self.time.load(Ordering::Relaxed));
            self.hub.publish(channel, nanoseconds(time), &message(messages, time), Keep::No);
        }
    }
}

impl Robot {
    fn show(&mut self, index: usize, world: &impl Shown, hub: &Hub) {
        let [.., lcd, odometry, transforms] = &self.channels;
        let (time, messages) = (world.time(), &self.messages);
        let send = |channel: &Channel, message: &dyn Fn() -> Vec<u8>, keep| {
            if channel.is_wanted() {
                hub.publish(channel, nanoseconds(time), &message(), keep);
            }
        };
        let pose = world.odometry(index).unwrap_or_default();
        send(odometry, &|| messages.odometry(time, &pose), Keep::No);
        send(transforms, &|| messages.transform(time, &pose), Keep::No);
        if let Some(display) = world.display(index)
            && display.drawings != self.drawings
            && self.shown.is_none_or(|shown| time >= shown + IMAGE_INTERVAL)
            && lcd.is_wanted()
        {
            (self.drawings, self.shown) = (display.drawings, Some(time));
            send(lcd, &|| messages.image(time, display.image), Keep::Last(0, 1));
        }
    }
}
