use std::collections::{BTreeSet, VecDeque};
use std::io::{Seek, Write};
use std::path::Path;

use image::RgbImage;
use mcap::McapError;
use roverlab::geometry::{Pose as PlanarPose, Twist as PlanarTwist};
use roverlab::io::LidarScan;
use roverlab::io::log::{Log, Sight};
use roverlab::world::{Clearance, World, formats};
use serde_json::json;

use super::bag::Bag;
use super::messages::{
    Bytes, Clock, Header, Image, LaserScan, MapMetaData, OccupancyGrid, Odometry, Pose, PoseWithCovariance,
    TfMessage, Time, Transform, TransformStamped, Twist, TwistWithCovariance, Vector,
};
use crate::common::Failure;
use crate::replay::{Found, created, unwritable};

/// The fixed frame.
const MAP: &str = "map";
/// Size of a map's cells (m), doubled until there are few enough.
const CELL: f64 = 0.05;
/// Number of a map's cells, at most.
const CELLS: f64 = 4e6;

/// Writes a recording as a bag of ROS 2.
pub(in crate::replay) fn export(log: &Log, (out, force): (&Path, bool)) -> Result<Found, Failure> {
    let name = format!("--ros2 {}", out.display());
    let failed = |error: McapError| match error {
        McapError::Io(reason) => unwritable(&name, &reason),
        other => unwritable(&name, &other),
    };
    let world = log.header().attachment("scene.wld").map(|file| {
        let parsed = formats::wld::parse(&String::from_utf8_lossy(&file.data), "scene.wld");
        parsed.map(|parsed| parsed.value).map_err(Failure::run)
    });
    let map = world.transpose()?.map(|world| map(&world)).transpose()?;
    let file = created(&name, (out, force))?;
    let mut bag = Bag::new(file).map_err(failed)?;
    write_all(log, map.as_ref(), &mut bag).map_err(failed)?;
    let (sink, topics) = bag.finish().map_err(failed)?;
    sink.complete().map_err(|error| unwritable(&name, &error))?;
    let messages: u32 = topics.values().sum();
    Ok(Found {
        text: format!("exported {messages} messages on {} topics to {}", topics.len(), out.display()),
        fields: json!({
            "example": "replay", "command": "export", "outcome": "exported", "messages": messages,
            "topics": topics, "ros2": out,
        }),
        good: true,
        warning: None,
    })
}

/// Writes all messages in the order of the recording.
fn write_all<W: Write + Seek>(
    log: &Log,
    map: Option<&OccupancyGrid>,
    bag: &mut Bag<W>,
) -> Result<(), McapError> {
    let mut robots: Vec<Robot> = (0..log.robots()).map(|robot| Robot::new(log, robot)).collect();
    let mut told = BTreeSet::new();
    bag.write(0, "/clock", &Clock { clock: Time::of(0) })?;
    told.insert(0);
    bag.latch(0, "/tf_static", &TfMessage { transforms: robots.iter().flat_map(Robot::fixed).collect() })?;
    if let Some(map) = map {
        bag.latch(0, "/map", map)?;
    }
    for message in log.messages() {
        if told.insert(message.time) {
            bag.write(message.time, "/clock", &Clock { clock: Time::of(message.time) })?;
        }
        for seen in message.seen() {
            let Some(robot) = robots.get_mut(seen.robot) else { continue };
            robot.commands_until(message.time, bag)?;
            robot.write(message.time, &seen.sight, bag)?;
        }
    }
    robots.iter_mut().try_for_each(|robot| robot.commands_until(u64::MAX, bag))
}

/// What there is of a robot besides the messages for viewers, and the names of its topics and frames.
struct Robot {
    /// `robot2/` for the second one; the first has no prefix.
    prefix: String,
    start: Option<PlanarPose>,
    /// Range and mount of each scan.
    heads: VecDeque<[f64; 6]>,
    /// Commanded velocities, with their times (ns).
    commands: VecDeque<(u64, PlanarTwist)>,
}

impl Robot {
    fn new(log: &Log, index: usize) -> Self {
        let prefix = if index == 0 { String::new() } else { format!("robot{}/", index + 1) };
        let (mut heads, mut commands) = (VecDeque::new(), VecDeque::new());
        for entry in log.entries(index).filter(|entry| !entry.truth && entry.result.is_ok()) {
            match entry.method.as_str() {
                "scan_into" => heads.extend(<[f64; 6]>::try_from(entry.numbers)),
                "set_speed" => {
                    let numbers = entry.arguments.split(", ").map(str::parse::<f64>);
                    if let [Ok(linear), Ok(angular)] = numbers.collect::<Vec<_>>()[..] {
                        commands.push_back((
                            (1e9 * entry.time).round() as u64,
                            PlanarTwist::new(linear, angular),
                        ));
                    }
                }
                _ => {}
            }
        }
        Self { prefix, start: log.start(index), heads, commands }
    }

    fn topic(&self, name: &str) -> String {
        format!("/{}{name}", self.prefix)
    }

    fn frame(&self, name: &str) -> String {
        format!("{}{name}", self.prefix)
    }

    /// Transforms that do not change: to the start of odometry, and to the lidar.
    fn fixed(&self) -> Vec<TransformStamped> {
        let start = self.start.map(|start| transform(0, MAP, &self.frame("odom"), &start));
        let mount = self.heads.front().map(|&[_, _, _, x, y, heading]| {
            let mount = PlanarPose::new(x, y, heading);
            transform(0, &self.frame("base_link"), &self.frame("base_scan"), &mount)
        });
        start.into_iter().chain(mount).collect()
    }

    /// Writes the commands up to a time.
    fn commands_until<W: Write + Seek>(&mut self, time: u64, bag: &mut Bag<W>) -> Result<(), McapError> {
        while let Some(&(at, command)) = self.commands.front().filter(|(at, _)| *at <= time) {
            self.commands.pop_front();
            bag.write(at, &self.topic("cmd_vel"), &twist(command))?;
        }
        Ok(())
    }

    /// Writes what a message shows.
    fn write<W: Write + Seek>(
        &mut self,
        time: u64,
        sight: &Sight,
        bag: &mut Bag<W>,
    ) -> Result<(), McapError> {
        match sight {
            Sight::Scan(scan) => {
                let range_max = self.heads.pop_front().map_or(f64::INFINITY, |head| head[2]);
                let header = Header::new(time, &self.frame("base_scan"));
                bag.write(time, &self.topic("scan"), &laser_scan(header, scan, range_max))
            }
            Sight::Image(image) => {
                let header = Header::new(time, &self.frame("camera"));
                bag.write(time, &self.topic("camera/image_raw"), &raw_image(header, image))
            }
            Sight::Odometry(pose) => {
                let [odom, base] = ["odom", "base_link"].map(|name| self.frame(name));
                let transforms = vec![transform(time, &odom, &base, pose)];
                bag.write(time, "/tf", &TfMessage { transforms })?;
                let pose = PoseWithCovariance { pose: Pose::of(pose), ..PoseWithCovariance::default() };
                let odometry = Odometry {
                    header: Header::new(time, &odom),
                    child_frame_id: base,
                    pose,
                    twist: TwistWithCovariance::default(),
                };
                bag.write(time, &self.topic("odom"), &odometry)
            }
            Sight::Display(_) | Sight::Truth(_) | Sight::Distance(..) => Ok(()),
        }
    }
}

fn transform(time: u64, parent: &str, child: &str, pose: &PlanarPose) -> TransformStamped {
    TransformStamped {
        header: Header::new(time, parent),
        child_frame_id: child.into(),
        transform: Transform::of(pose),
    }
}

fn twist(command: PlanarTwist) -> Twist {
    Twist {
        linear: Vector { x: command.linear, ..Vector::default() },
        angular: Vector { z: command.angular, ..Vector::default() },
    }
}

fn laser_scan(header: Header, scan: &LidarScan, range_max: f64) -> LaserScan {
    let gaps = scan.ranges.len().saturating_sub(1) as f64;
    LaserScan {
        header,
        angle_min: scan.angle_min as f32,
        angle_max: (scan.angle_min + scan.angle_increment * gaps) as f32,
        angle_increment: scan.angle_increment as f32,
        range_max: range_max as f32,
        ranges: scan.ranges.iter().map(|range| *range as f32).collect(),
        ..LaserScan::default()
    }
}

fn raw_image(header: Header, image: &RgbImage) -> Image {
    Image {
        header,
        height: image.height(),
        width: image.width(),
        encoding: "rgb8".into(),
        is_bigendian: 0,
        step: 3 * image.width(),
        data: Bytes(image.as_raw().clone()),
    }
}

/// A map of a world: cells with something solid within half a cell of their centre are occupied.
fn map(world: &World) -> Result<OccupancyGrid, Failure> {
    let site = world.site();
    let (width, height) = (site.max.x - site.min.x, site.max.y - site.min.y);
    let mut cell = CELL;
    while (width / cell + 2.0) * (height / cell + 2.0) > CELLS && cell.is_finite() {
        cell *= 2.0;
    }
    let field = Clearance::new(world, cell, cell).map_err(Failure::run)?;
    let raster = field.raster();
    let occupied = |index| if field.at(index) <= 0.5 * cell + 1e-9 { 100 } else { 0 };
    let corner = raster.centre(0);
    let origin = PlanarPose::new(corner.x - 0.5 * cell, corner.y - 0.5 * cell, 0.0);
    Ok(OccupancyGrid {
        header: Header::new(0, MAP),
        info: MapMetaData {
            map_load_time: Time::default(),
            resolution: cell as f32,
            width: raster.columns() as u32,
            height: raster.rows() as u32,
            origin: Pose::of(&origin),
        },
        data: (0..raster.cells()).map(occupied).collect(),
    })
}
