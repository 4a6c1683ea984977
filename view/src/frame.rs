//! A snapshot of the world in bytes, which the page stores 25 times a second.
//!
//! All numbers are little-endian; lengths are metres and angles radians unless said otherwise. A frame is
//!
//! ```text
//! f64 seconds; u16 robots; u16 objects that are not where the scene has them; u16 news; u16 0
//! of each robot    f32 x, y, heading; f32 x, y, heading by odometry; u32 contacts so far
//! of each object   u16 index; u16 whether it has fallen; f32 x, y, heading
//! of each news     u16 kind; u16 robot; u32 bytes that follow:
//!   1 distances    of each sensor u32 its number, f32 the distance
//!   2 scan         f32 first angle, angle between beams, mount's x, y, heading; u16 millimetres, 65535 without a return
//!   3 image        PNG
//!   4 display      PNG
//!   5 menu         the labels of the soft keys, with line feeds between
//!   6 contacts     of each new one f32 x, y
//! ```

use std::collections::BTreeMap;
use std::fmt;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, RgbImage};
use roverlab::geometry::{Point, Pose};
use roverlab::io::sim::Onlooking;
use roverlab::io::{LidarScan, Psd};
use roverlab::world::Scene;

/// The world that a frame shows. Robots and objects are identified by their indices in the scene.
pub trait Shown {
    /// Time since the start (s).
    fn time(&self) -> f64;

    /// A robot's pose.
    fn pose(&self, robot: usize) -> Option<Pose>;

    /// A robot's pose by odometry, relative to its start.
    fn odometry(&self, robot: usize) -> Option<Pose>;

    /// A robot's number of contacts, and the places of the first ones.
    fn contacts(&self, robot: usize) -> Option<(u32, &[Point])>;

    /// A robot's display, after the first drawing.
    fn display(&self, robot: usize) -> Option<Displayed<'_>>;

    /// An object's pose.
    fn object(&self, object: usize) -> Option<Pose>;

    /// Whether an object has been knocked over.
    fn has_fallen(&self, object: usize) -> bool;
}

/// A robot's display.
#[derive(Debug, Clone)]
pub struct Displayed<'a> {
    /// Number of drawings so far, from 1; the display is unchanged while this number is.
    pub drawings: u64,
    /// Its pixels.
    pub image: &'a RgbImage,
    /// The labels of the soft keys, with line feeds between.
    pub menu: String,
}

impl Shown for Onlooking<'_> {
    fn time(&self) -> f64 {
        Onlooking::time(self)
    }

    fn pose(&self, robot: usize) -> Option<Pose> {
        Onlooking::pose(self, robot)
    }

    fn odometry(&self, robot: usize) -> Option<Pose> {
        Onlooking::odometry(self, robot)
    }

    fn contacts(&self, robot: usize) -> Option<(u32, &[Point])> {
        Onlooking::contacts(self, robot)
    }

    fn display(&self, robot: usize) -> Option<Displayed<'_>> {
        let (drawings, lcd) = Onlooking::display(self, robot)?;
        Some(Displayed { drawings, image: lcd.frame(), menu: lcd.menu().join("\n") })
    }

    fn object(&self, object: usize) -> Option<Pose> {
        Onlooking::object(self, object)
    }

    fn has_fallen(&self, object: usize) -> bool {
        Onlooking::has_fallen(self, object)
    }
}

/// Writes frames.
pub struct Frames {
    starts: Vec<Pose>,
    objects: Vec<Pose>,
    robots: Vec<News>,
    bytes: Vec<u8>,
}

/// Changes of a robot since the last frame.
#[derive(Default)]
struct News {
    distances: BTreeMap<u8, f32>,
    scan: Option<Vec<u8>>,
    image: Option<RgbImage>,
    /// Times of the last image and of the last display in a frame (s).
    image_time: Option<f64>,
    display_time: Option<f64>,
    /// Number of display calls already shown.
    drawings: u64,
    menu: String,
    contacts: usize,
}

/// Interval between images, and between displays, of a robot (s).
pub const IMAGE_INTERVAL: f64 = 0.2;

impl fmt::Debug for Frames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Frames").field("robots", &self.robots.len()).finish_non_exhaustive()
    }
}

impl Frames {
    /// Frames of a scene's run.
    pub fn new(scene: &Scene) -> Self {
        Self {
            starts: scene.robots.iter().map(|robot| robot.pose).collect(),
            objects: scene.world.objects.iter().map(|object| object.pose).collect(),
            robots: scene.robots.iter().map(|_| News::default()).collect(),
            bytes: Vec::new(),
        }
    }

    /// Starts again, for a viewer without any frame of the run.
    pub fn restart(&mut self) {
        self.robots.fill_with(News::default);
    }

    /// A distance reading (m), for the next frame.
    pub fn distance(&mut self, robot: usize, sensor: Psd, range: f64) {
        self.robots[robot].distances.insert(sensor.0, range as f32);
    }

    /// A scan, for the next frame.
    pub fn scan(&mut self, robot: usize, scan: &LidarScan) {
        let mut out = self.robots[robot].scan.take().unwrap_or_default();
        out.clear();
        let LidarScan { angle_min, angle_increment, mount, .. } = scan;
        for number in [angle_min, angle_increment, &mount.x, &mount.y, &mount.heading] {
            put_f32(&mut out, *number);
        }
        for range in &scan.ranges {
            put_u16(&mut out, millimetres(*range));
        }
        self.robots[robot].scan = Some(out);
    }

    /// A camera image, for the next frame.
    pub fn image(&mut self, robot: usize, image: &RgbImage) {
        self.robots[robot].image = Some(image.clone());
    }

    /// Skips the contacts so far, which the page has already.
    pub fn skip(&mut self, world: &impl Shown) {
        for (index, news) in self.robots.iter_mut().enumerate() {
            news.contacts = world.contacts(index).map_or(0, |(_, places)| places.len());
        }
    }

    /// The current frame.
    pub fn frame(&mut self, world: &impl Shown) -> &[u8] {
        let time = world.time();
        let mut out = std::mem::take(&mut self.bytes);
        out.clear();
        out.extend_from_slice(&time.to_le_bytes());
        put_u16(&mut out, self.robots.len());
        // The numbers of objects and changes are filled in later.
        out.extend_from_slice(&[0; 6]);
        for (index, start) in self.starts.iter().enumerate() {
            let pose = world.pose(index).unwrap_or_default();
            let odometry = start.compose(&world.odometry(index).unwrap_or_default());
            for number in [pose.x, pose.y, pose.heading, odometry.x, odometry.y, odometry.heading] {
                put_f32(&mut out, number);
            }
            let contacts = world.contacts(index).map_or(0, |(contacts, _)| contacts);
            out.extend_from_slice(&contacts.to_le_bytes());
        }
        let mut moved = 0_u16;
        for (index, before) in self.objects.iter().enumerate() {
            let (pose, fallen) = (world.object(index).unwrap_or(*before), world.has_fallen(index));
            if pose != *before || fallen {
                moved += 1;
                put_u16(&mut out, index);
                put_u16(&mut out, usize::from(fallen));
                for number in [pose.x, pose.y, pose.heading] {
                    put_f32(&mut out, number);
                }
            }
        }
        let mut count = 0_u16;
        for (index, news) in self.robots.iter_mut().enumerate() {
            news.write(index, world, &mut |kind, payload| {
                count += 1;
                put_u16(&mut out, kind);
                put_u16(&mut out, index);
                out.extend_from_slice(&(payload.len() as u32).to_le_bytes());
                out.extend_from_slice(payload);
            });
        }
        out[10..12].copy_from_slice(&moved.to_le_bytes());
        out[12..14].copy_from_slice(&count.to_le_bytes());
        self.bytes = out;
        &self.bytes
    }
}

impl News {
    fn write(&mut self, robot: usize, world: &impl Shown, put: &mut dyn FnMut(usize, &[u8])) {
        let time = world.time();
        if !self.distances.is_empty() {
            let mut out = Vec::new();
            for (&sensor, range) in &self.distances {
                out.extend_from_slice(&u32::from(sensor).to_le_bytes());
                out.extend_from_slice(&range.to_le_bytes());
            }
            self.distances.clear();
            put(1, &out);
        }
        if let Some(scan) = self.scan.take() {
            put(2, &scan);
        }
        let is_due = |last: Option<f64>| last.is_none_or(|last| time >= last + IMAGE_INTERVAL);
        if is_due(self.image_time)
            && let Some(image) = self.image.take()
        {
            self.image_time = Some(time);
            put(3, &png(&image));
        }
        if is_due(self.display_time)
            && let Some(Displayed { drawings, image, menu }) = world.display(robot)
            && drawings != self.drawings
        {
            (self.drawings, self.display_time) = (drawings, Some(time));
            put(4, &png(image));
            if menu != self.menu {
                put(5, menu.as_bytes());
                self.menu = menu;
            }
        }
        let places = world.contacts(robot).map_or(&[][..], |(_, places)| places);
        if let Some(new) = places.get(self.contacts..).filter(|new| !new.is_empty()) {
            let mut out = Vec::new();
            new.iter().flat_map(|place| [place.x, place.y]).for_each(|number| put_f32(&mut out, number));
            self.contacts = places.len();
            put(6, &out);
        }
    }
}

fn put_f32(out: &mut Vec<u8>, number: f64) {
    out.extend_from_slice(&(number as f32).to_le_bytes());
}

fn put_u16(out: &mut Vec<u8>, number: usize) {
    out.extend_from_slice(&u16::try_from(number).unwrap_or(u16::MAX).to_le_bytes());
}

/// Whole millimetres; the maximum for ranges that are too large.
fn millimetres(range: f64) -> usize {
    let millimetres = (1000.0 * range).round();
    if millimetres < 65_535.0 { millimetres as usize } else { 65_535 }
}

fn png(image: &RgbImage) -> Vec<u8> {
    let mut out = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut out, CompressionType::Fast, FilterType::Up);
    // Writing to a vector cannot fail.
    let _ = encoder.write_image(image.as_raw(), image.width(), image.height(), ExtendedColorType::Rgb8);
    out
}
