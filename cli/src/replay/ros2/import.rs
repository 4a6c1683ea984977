use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

use image::RgbImage;
use roverlab::geometry::{Pose as PlanarPose, Twist as PlanarTwist};
use roverlab::io::log::{Header, LogFile, LogWriter, McapChannel, Recorder, visit_messages};
use roverlab::io::{self, Camera, Clock, Drive, Lidar, LidarScan, LidarSettings, Odometry as _, Resolution};
use serde::de::DeserializeOwned;
use serde_json::json;

use super::cdr::decoded;
use super::messages::{Image, LaserScan, Message, Odometry, TfMessage, Twist, TwistStamped};
use super::tree::FrameTree;
use crate::common::{Failure, millimetres, rounded};
use crate::replay::{Found, created};

/// What messages are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Scan,
    Odometry,
    Image,
    Command,
}

impl Kind {
    const ALL: [Self; 4] = [Self::Scan, Self::Odometry, Self::Image, Self::Command];

    /// The kind of a message type.
    fn of(schema: &str) -> Option<Self> {
        match schema {
            LaserScan::NAME => Some(Self::Scan),
            Odometry::NAME => Some(Self::Odometry),
            Image::NAME => Some(Self::Image),
            Twist::NAME | TwistStamped::NAME => Some(Self::Command),
            _ => None,
        }
    }

    /// The option that chooses a topic, and the topic that most robots have.
    fn option_and_topic(self) -> (&'static str, &'static str) {
        match self {
            Self::Scan => ("--scan", "/scan"),
            Self::Odometry => ("--odometry", "/odom"),
            Self::Image => ("--camera", "/camera/image_raw"),
            Self::Command => ("--commands", "/cmd_vel"),
        }
    }
}

/// Topics chosen by options.
#[derive(Debug, Clone, Copy)]
pub(in crate::replay) struct Wanted<'a> {
    pub(in crate::replay) scan: Option<&'a str>,
    pub(in crate::replay) odometry: Option<&'a str>,
    pub(in crate::replay) camera: Option<&'a str>,
    pub(in crate::replay) commands: Option<&'a str>,
}

impl<'a> Wanted<'a> {
    fn topic(&self, kind: Kind) -> Option<&'a str> {
        match kind {
            Kind::Scan => self.scan,
            Kind::Odometry => self.odometry,
            Kind::Image => self.camera,
            Kind::Command => self.commands,
        }
    }
}

/// Makes a recording of a bag of ROS 2.
pub(in crate::replay) fn import(
    bag: (&Path, &[u8]),
    (out, force): (&Path, bool),
    wanted: &Wanted<'_>,
) -> Result<Found, Failure> {
    let in_bag = |failure: Failure| Failure::input(format!("--ros2 {}: {failure}", bag.0.display()));
    let contents = Contents::read(bag.1).map_err(in_bag)?;
    let topics = contents.choose(wanted).map_err(in_bag)?;
    let mount = contents.mount(&topics).map_err(in_bag)?;
    let cannot = |error| {
        Failure::run(format!("--out {}: {error}; expected a file that can be written", out.display()))
    };
    let file = created(format_args!("--out {}", out.display()), (out, force))?;
    let writer = LogWriter::new(file, &Header::new("ros2_bag", [""; 0])).map_err(cannot)?;
    let robot = Rc::new(RefCell::new(Recorded::default()));
    let mut import = Import {
        recorder: writer.recorder(Player(Rc::clone(&robot)), 0),
        robot,
        start: contents.start,
        mount: mount.unwrap_or_default(),
        counts: BTreeMap::new(),
        late: 0,
    };
    let visited = visit_messages(bag.1, |channel, time, data| match topics.get(channel.topic.as_str()) {
        Some(kind) => import.add(*kind, channel, time, data),
        None => Ok(()),
    });
    let Import { recorder, counts, late, .. } = import;
    drop(recorder);
    let written = writer.finish();
    visited.map_err(in_bag)?;
    written.and_then(LogFile::complete).map_err(cannot)?;
    let count = |kind| counts.get(&kind).copied().unwrap_or(0);
    let [scans, poses, images, commands] = Kind::ALL.map(count);
    let duration = rounded((contents.end - contents.start) as f64 / 1e9);
    Ok(Found {
        text: format!(
            "imported {scans} scans, {poses} poses, {images} images and {commands} commands of {duration:.1} s",
        ),
        fields: json!({
            "example": "replay", "command": "import", "outcome": "imported", "scans": scans, "poses": poses,
            "images": images, "commands": commands, "late": late, "duration_s": duration,
            "topics": topics.keys().collect::<Vec<_>>(),
            "mount": mount.map(|mount| json!({
                "x_mm": millimetres(mount.x), "y_mm": millimetres(mount.y),
                "heading_deg": rounded(roverlab::geometry::units::to_deg(mount.heading)),
            })),
            "out": out,
        }),
        good: true,
        warning: contents.warning(),
    })
}

/// What a bag holds, apart from the messages that become a recording.
#[derive(Debug, Default)]
struct Contents {
    /// Topics of each kind.
    topics: BTreeMap<Kind, Vec<String>>,
    /// Types of the other topics.
    others: Vec<String>,
    fixed: FrameTree,
    /// Frames of the scanners and of the robots with odometry, by topic.
    frames: BTreeMap<String, String>,
    /// Encodings of the topics whose images no recording has, such as depth.
    foreign: BTreeMap<String, String>,
    /// Times of the first and the last message (ns).
    start: u64,
    end: u64,
}

impl Contents {
    fn read(bytes: &[u8]) -> Result<Self, Failure> {
        let mut new = Self { start: u64::MAX, ..Self::default() };
        visit_messages(bytes, |channel, time, data| {
            (new.start, new.end) = (new.start.min(time), new.end.max(time));
            new.add(channel, data)
        })?;
        new.start = new.start.min(new.end);
        Ok(new)
    }

    fn add(&mut self, channel: &McapChannel, data: &[u8]) -> Result<(), Failure> {
        if channel.schema == TfMessage::NAME && channel.topic.ends_with("tf_static") {
            self.fixed.add(message(channel, data)?);
            return Ok(());
        }
        let Some(kind) = Kind::of(&channel.schema) else {
            if !self.others.contains(&channel.schema) {
                self.others.push(channel.schema.clone());
            }
            return Ok(());
        };
        let topics = self.topics.entry(kind).or_default();
        if topics.contains(&channel.topic) || self.foreign.contains_key(&channel.topic) {
            return Ok(());
        }
        let topic = channel.topic.clone();
        match kind {
            Kind::Scan => {
                let frame = message::<LaserScan>(channel, data)?.header.frame_id;
                self.frames.insert(topic.clone(), frame);
            }
            Kind::Odometry => {
                let frame = message::<Odometry>(channel, data)?.child_frame_id;
                self.frames.insert(topic.clone(), frame);
            }
            Kind::Image => {
                let encoding = message::<Image>(channel, data)?.encoding;
                if channels(&encoding).is_none() {
                    self.foreign.insert(topic, encoding);
                    return Ok(());
                }
            }
            Kind::Command => {}
        }
        topics.push(topic);
        Ok(())
    }

    /// The topics to take: the given ones, those that are alone, or those that most robots have.
    fn choose(&self, wanted: &Wanted<'_>) -> Result<BTreeMap<&str, Kind>, Failure> {
        let mut chosen = BTreeMap::new();
        for kind in Kind::ALL {
            let topics = self.topics.get(&kind).map_or(&[][..], Vec::as_slice);
            let (option, usual) = kind.option_and_topic();
            let find = |name: &str| topics.iter().find(|topic| topic.as_str() == name);
            let topic = match (wanted.topic(kind), topics) {
                (Some(name), _) if kind == Kind::Image && self.foreign.contains_key(name) => {
                    return Err(Failure::input(format!("{name}: {}", refusal(&self.foreign[name]))));
                }
                (Some(name), _) => Some(find(name).ok_or_else(|| {
                    Failure::input(format!("found no topic {name} for {option}; expected {}", list(topics)))
                })?),
                (None, []) => None,
                (None, [only]) => Some(only),
                (None, _) => Some(find(usual).ok_or_else(|| {
                    Failure::input(format!("found {}; expected {option} with one of them", list(topics)))
                })?),
            };
            chosen.extend(topic.map(|topic| (topic.as_str(), kind)));
        }
        if chosen.values().any(|kind| matches!(kind, Kind::Scan | Kind::Odometry)) {
            return Ok(chosen);
        }
        Err(Failure::input(format!(
            "found {}; expected messages of {} or {}",
            list(&self.others),
            LaserScan::NAME,
            Odometry::NAME
        )))
    }

    /// Where the chosen scanner is on the robot, if the bag says so.
    fn mount(&self, topics: &BTreeMap<&str, Kind>) -> Result<Option<PlanarPose>, Failure> {
        let frame = |wanted| {
            let (topic, _) = topics.iter().find(|(_, kind)| **kind == wanted)?;
            self.frames.get(*topic).map(String::as_str)
        };
        let mount = frame(Kind::Scan).map(|scanner| self.fixed.mount(scanner, frame(Kind::Odometry)));
        Ok(mount.transpose().map_err(Failure::input)?.flatten())
    }

    /// Sentences on topics that are left out.
    fn warning(&self) -> Option<String> {
        let left_out =
            |(topic, encoding): (&String, &String)| format!("{topic} is left out: {}", refusal(encoding));
        let sentences: Vec<_> = self.foreign.iter().map(left_out).collect();
        (!sentences.is_empty()).then(|| sentences.join("\n"))
    }
}

/// Names in an error.
const LISTED: usize = 10;

fn list(names: &[String]) -> String {
    match names {
        [] => "none".into(),
        names => names.iter().take(LISTED).map(String::as_str).collect::<Vec<_>>().join(", "),
    }
}

/// A message of a channel.
fn message<T: DeserializeOwned>(channel: &McapChannel, data: &[u8]) -> Result<T, Failure> {
    let refused = |what: String| Failure::input(format!("a message on {}: {what}", channel.topic));
    if channel.encoding != "cdr" {
        return Err(refused(format!("found the encoding {:?}; expected \"cdr\"", channel.encoding)));
    }
    decoded(data).map_err(refused)
}

/// A recording that is being made of a bag.
struct Import {
    robot: Rc<RefCell<Recorded>>,
    recorder: Recorder<Player, LogFile>,
    /// Time of the bag's first message (ns).
    start: u64,
    mount: PlanarPose,
    counts: BTreeMap<Kind, u64>,
    /// Number of messages with an earlier time than the one before.
    late: u64,
}

impl Import {
    fn add(&mut self, kind: Kind, channel: &McapChannel, time: u64, data: &[u8]) -> Result<(), Failure> {
        let count = self.counts.entry(kind).or_default();
        *count += 1;
        let number = *count;
        let seconds = (time - self.start) as f64 / 1e9;
        let mut robot = self.robot.borrow_mut();
        self.late += u64::from(seconds < robot.time);
        robot.time = robot.time.max(seconds);
        drop(robot);
        let refused = |what: String| Failure::input(format!("message {number} on {}: {what}", channel.topic));
        match kind {
            Kind::Scan => {
                let scan = scan(message(channel, data)?, self.mount).map_err(refused)?;
                self.robot.borrow_mut().scan = scan;
                self.recorder.scan()?;
            }
            Kind::Odometry => {
                let (pose, speed) = odometry(&message(channel, data)?).map_err(refused)?;
                (self.robot.borrow_mut().pose, self.robot.borrow_mut().speed) = (pose, speed);
                self.recorder.pose()?;
                self.recorder.speed()?;
            }
            Kind::Image => {
                let image = image(&message(channel, data)?).map_err(refused)?;
                self.robot.borrow_mut().image = image;
                self.recorder.image()?;
            }
            Kind::Command => {
                let stamped = channel.schema == TwistStamped::NAME;
                let command = if stamped {
                    message::<TwistStamped>(channel, data)?.twist
                } else {
                    message(channel, data)?
                };
                self.recorder.set_speed(twist(&command).map_err(refused)?)?;
            }
        }
        Ok(())
    }
}

fn twist(twist: &Twist) -> Result<PlanarTwist, String> {
    let (linear, angular) = (twist.linear.x, twist.angular.z);
    if linear.is_finite() && angular.is_finite() {
        Ok(PlanarTwist::new(linear, angular))
    } else {
        Err(format!("found the velocities {linear} and {angular}; expected finite numbers"))
    }
}

fn odometry(odometry: &Odometry) -> Result<(PlanarPose, PlanarTwist), String> {
    let pose = odometry.pose.pose.planar();
    Ok((pose.ok_or("found a pose that is none; expected finite numbers")?, twist(&odometry.twist.twist)?))
}

/// A scan: counter-clockwise, and infinite where nothing is within the scanner's range.
fn scan(scan: LaserScan, mount: PlanarPose) -> Result<LidarScan, String> {
    let [first, step, nearest, farthest] =
        [scan.angle_min, scan.angle_increment, scan.range_min, scan.range_max].map(f64::from);
    let beams = scan.ranges.len();
    if !(first.is_finite() && step.is_finite() && step != 0.0 && farthest > 0.0) {
        return Err(format!(
            "found a scan from {first} rad in steps of {step} rad, up to {farthest} m; expected numbers other than 0"
        ));
    }
    if beams > LidarSettings::MAX_POINTS {
        return Err(format!("found {beams} beams; expected at most {}", LidarSettings::MAX_POINTS));
    }
    let mut ranges: Vec<f64> = scan
        .ranges
        .into_iter()
        .map(f64::from)
        .map(|range| if range >= nearest && range <= farthest { range } else { f64::INFINITY })
        .collect();
    let clockwise = step < 0.0;
    if clockwise {
        ranges.reverse();
    }
    let angle_min = if clockwise { first + step * beams.saturating_sub(1) as f64 } else { first };
    Ok(LidarScan { angle_min, angle_increment: step.abs(), range_max: farthest, mount, ranges })
}

/// Number of channels of an encoding, and the places of red, green and blue among them.
fn channels(encoding: &str) -> Option<(usize, [usize; 3])> {
    match encoding {
        "rgb8" => Some((3, [0, 1, 2])),
        "bgr8" => Some((3, [2, 1, 0])),
        "rgba8" => Some((4, [0, 1, 2])),
        "bgra8" => Some((4, [2, 1, 0])),
        "mono8" | "8UC1" => Some((1, [0; 3])),
        _ => None,
    }
}

fn refusal(encoding: &str) -> String {
    format!("found the encoding {encoding:?}; expected rgb8, bgr8, rgba8, bgra8 or mono8")
}

/// An image of 8 bits per channel.
fn image(image: &Image) -> Result<RgbImage, String> {
    let (channels, order) = channels(&image.encoding).ok_or_else(|| refusal(&image.encoding))?;
    let (width, height, step) = (image.width as usize, image.height as usize, image.step as usize);
    let row = width.checked_mul(channels);
    let fits = row.is_some_and(|row| row <= step) && step.checked_mul(height) == Some(image.data.0.len());
    if !fits || image.data.0.is_empty() {
        return Err(format!(
            "found {} bytes; expected {height} rows of {step} bytes, for {width} pixels each",
            image.data.0.len()
        ));
    }
    let rows = image.data.0.chunks_exact(step).flat_map(|row| row[..width * channels].chunks_exact(channels));
    let pixels = rows.flat_map(|pixel| order.map(|channel| pixel[channel])).collect();
    RgbImage::from_raw(image.width, image.height, pixels)
        .ok_or_else(|| "found an image of another size".into())
}

/// What a robot answers at a time.
#[derive(Debug, Default)]
struct Recorded {
    time: f64,
    pose: PlanarPose,
    speed: PlanarTwist,
    scan: LidarScan,
    image: RgbImage,
}

/// A robot that answers from a bag.
struct Player(Rc<RefCell<Recorded>>);

impl Clock for Player {
    fn now(&mut self) -> io::Result<f64> {
        Ok(self.0.borrow().time)
    }

    fn wait(&mut self, _: f64) -> io::Result<()> {
        Err(io::Error::unsupported("waiting"))
    }
}

impl Drive for Player {
    fn set_speed(&mut self, _: PlanarTwist) -> io::Result<()> {
        Ok(())
    }
}

impl io::Odometry for Player {
    fn speed(&mut self) -> io::Result<PlanarTwist> {
        Ok(self.0.borrow().speed)
    }

    fn pose(&mut self) -> io::Result<PlanarPose> {
        Ok(self.0.borrow().pose)
    }

    fn set_pose(&mut self, _: PlanarPose) -> io::Result<()> {
        Err(io::Error::unsupported("setting the pose"))
    }
}

impl Lidar for Player {
    fn scan_into(&mut self, scan: &mut LidarScan) -> io::Result<()> {
        scan.clone_from(&self.0.borrow().scan);
        Ok(())
    }

    fn configure_lidar(&mut self, _: LidarSettings) -> io::Result<()> {
        Err(io::Error::unsupported("other settings of the lidar"))
    }
}

impl Camera for Player {
    fn set_resolution(&mut self, _: Resolution) -> io::Result<()> {
        Err(io::Error::unsupported("another resolution"))
    }

    fn resolution(&mut self) -> io::Result<Resolution> {
        Resolution::of(self.0.borrow().image.dimensions())
    }

    fn image_into(&mut self, image: &mut RgbImage) -> io::Result<()> {
        image.clone_from(&self.0.borrow().image);
        Ok(())
    }
}
