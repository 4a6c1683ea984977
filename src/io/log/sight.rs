use std::collections::BTreeMap;
use std::sync::Arc;

use image::RgbImage;

use super::call::Call;
use super::stamp::seconds;
use super::truth::true_poses;
use super::wire::{self, Field, Reading};
use super::{Log, Topic};
use crate::geometry::{Pose, math};
use crate::io::{LidarScan, Psd};

/// A message of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct LogMessage {
    /// Time (ns).
    pub time: u64,
    /// Its topic.
    pub topic: Arc<Topic>,
    /// Content, in the topic's schema.
    pub data: Vec<u8>,
}

/// Something about a robot that viewers show.
#[derive(Debug, Clone, PartialEq)]
pub enum Sight {
    /// A scan; its maximum range is unknown, and infinite here.
    Scan(LidarScan),
    /// A camera image.
    Image(RgbImage),
    /// The display.
    Display(RgbImage),
    /// Pose by odometry, relative to the start.
    Odometry(Pose),
    /// True pose, as far as the run queried it.
    Truth(Pose),
    /// Reading of a distance sensor (m).
    Distance(Psd, f64),
}

/// Content of a message of a recording, with its time.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    /// Time (s).
    pub time: f64,
    /// The robot, by its index.
    pub robot: usize,
    /// Content.
    pub sight: Sight,
}

impl Log {
    /// All messages, in the order of the file.
    pub fn messages(&self) -> impl Iterator<Item = LogMessage> + '_ {
        let mut topics: BTreeMap<u16, Arc<Topic>> = BTreeMap::new();
        // The file has been verified.
        mcap::MessageStream::new(self.bytes()).into_iter().flatten().map_while(Result::ok).map(
            move |message| {
                let channel = &message.channel;
                let topic = topics.entry(channel.id).or_insert_with(|| {
                    let schema = channel.schema.as_deref();
                    Arc::new(Topic {
                        name: channel.topic.clone(),
                        schema: schema.map_or_else(String::new, |schema| schema.name.clone()),
                        descriptor: schema.map_or_else(Vec::new, |schema| schema.data.to_vec()),
                    })
                });
                LogMessage {
                    time: message.log_time,
                    topic: Arc::clone(topic),
                    data: message.data.into_owned(),
                }
            },
        )
    }
}

impl LogMessage {
    /// What the message shows of a robot. An answer about the true path shows it at earlier times.
    pub fn seen(&self) -> Vec<Seen> {
        let topic = self.topic.name.strip_prefix("/robot").and_then(|name| name.split_once('/'));
        let robot = |name: &str| name.parse::<usize>().ok()?.checked_sub(1);
        let Some((robot, name)) = topic.and_then(|(number, name)| Some((robot(number)?, name))) else {
            return Vec::new();
        };
        let time = seconds(self.time);
        let sight = match name {
            "lidar" => scan(&self.data).map(Sight::Scan),
            "camera" => image(&self.data).map(Sight::Image),
            "lcd" => image(&self.data).map(Sight::Display),
            "odometry" => wire::bytes_of(&self.data, 3).and_then(pose).map(Sight::Odometry),
            "calls" => distance(&self.data),
            "truth" => return truth(&self.data, time),
            _ => None,
        };
        sight.map(|sight| Seen { time, robot, sight }).into_iter().collect()
    }
}

/// A double of a message; 0 if it is absent.
fn double(message: &[u8], number: u32) -> f64 {
    let found = Reading::new(message).find_map(|(found, field)| match field {
        Field::Fixed64(bits) if found == number => Some(f64::from_bits(bits)),
        _ => None,
    });
    found.unwrap_or(0.0)
}

fn fixed32(message: &[u8], number: u32) -> Option<u32> {
    Reading::new(message).find_map(|(found, field)| match field {
        Field::Fixed32(value) if found == number => Some(value),
        _ => None,
    })
}

/// A `foxglove.Pose`.
fn pose(message: &[u8]) -> Option<Pose> {
    let (position, turned) = (wire::bytes_of(message, 1)?, wire::bytes_of(message, 2)?);
    let heading = 2.0 * math::atan2(double(turned, 3), double(turned, 4));
    Some(Pose::new(double(position, 1), double(position, 2), heading))
}

/// A `foxglove.LaserScan`.
fn scan(message: &[u8]) -> Option<LidarScan> {
    let ranges: Vec<f64> = wire::doubles(wire::bytes_of(message, 6).unwrap_or_default())?.collect();
    let (first, last) = (double(message, 4), double(message, 5));
    let gaps = ranges.len().saturating_sub(1).max(1) as f64;
    Some(LidarScan {
        angle_min: first,
        angle_increment: (last - first) / gaps,
        range_max: f64::INFINITY,
        mount: pose(wire::bytes_of(message, 3)?)?,
        ranges,
    })
}

/// A `foxglove.RawImage`.
fn image(message: &[u8]) -> Option<RgbImage> {
    let pixels = wire::bytes_of(message, 6)?;
    let (width, height) = (fixed32(message, 2)?, fixed32(message, 3)?);
    let expected = 3 * u64::from(width) * u64::from(height);
    (pixels.len() as u64 == expected).then(|| RgbImage::from_raw(width, height, pixels.to_vec())).flatten()
}

/// The reading of a distance sensor.
fn distance(message: &[u8]) -> Option<Sight> {
    let call = Call::read(message).filter(|call| call.method == "distance")?;
    let sensor = u8::try_from(*call.arguments.integers.first()?).ok()?;
    Some(Sight::Distance(Psd(sensor), *call.result.ok()?.numbers.first()?))
}

/// A robot's true poses.
fn truth(message: &[u8], now: f64) -> Vec<Seen> {
    let told = Call::read(message).as_ref().and_then(true_poses);
    told.map_or_else(Vec::new, |(robot, poses)| {
        let seen = |(time, pose): (Option<f64>, Pose)| Seen {
            time: time.unwrap_or(now),
            robot,
            sight: Sight::Truth(pose),
        };
        poses.into_iter().map(seen).collect()
    })
}
