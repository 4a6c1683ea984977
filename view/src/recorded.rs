//! Messages to the page that show a recording.

use std::collections::BTreeMap;
use std::sync::Arc;

use image::RgbImage;
use roverlab::geometry::{Aabb, Point, Pose, normalize_angle};
use roverlab::io::log::{Log, Seen, Sight};
use roverlab::world::formats::{MemoryFiles, parse_scene_tolerantly};
use roverlab::world::{RobotPlacement, RobotSpec, Scene, World};
use serde_json::json;

use crate::{Displayed, Frames, Message, Shown, scene_json};

/// Interval between frames (s).
const INTERVAL: f64 = 0.04;
/// Tolerance of the end, as a fraction of an interval.
const ROUNDING: f64 = 1e-6;
/// Longest gap in a true path over which a robot is shown on the line between (s).
const GAP: f64 = 1.0;
/// Distance around paths that a world without a description reaches (m).
const MARGIN: f64 = 1.0;

/// Messages to a page, each with its kind as the first byte.
pub(crate) fn messages(log: &Log, command: &str) -> Vec<Vec<u8>> {
    let mut seen: Vec<Seen> = log.messages().flat_map(|message| message.seen()).collect();
    seen.sort_by(|a, b| a.time.total_cmp(&b.time));
    let mut robots: Vec<Robot> = (0..log.robots()).map(|_| Robot::default()).collect();
    for Seen { time, robot, sight } in &seen {
        let Some(robot) = robots.get_mut(*robot) else { continue };
        match sight {
            Sight::Odometry(pose) => robot.odometry.push((*time, *pose)),
            Sight::Truth(pose) => robot.truth.push((*time, *pose)),
            _ => {}
        }
    }
    let scene = scene(log, &robots);
    let said = |message: Message, bytes: &[u8]| [&[message as u8], bytes].concat();
    let beside = json!({ "command": command, "recording": true }).to_string();
    let ended = json!({ "status": 0, "output": format!("{}: recorded", log.header().program), "errors": "" });
    let mut told = vec![
        said(Message::Beside, beside.as_bytes()),
        said(Message::Scene, scene_json(&scene).to_string().as_bytes()),
    ];
    let starts = scene.robots.iter().map(|robot| robot.pose).collect();
    let mut moment = Moment { time: 0.0, starts, robots, displays: BTreeMap::new() };
    let mut frames = Frames::new(&scene);
    let end = log.span().map_or(0.0, |(_, end)| end);
    let (mut next, count) = (seen.into_iter().peekable(), (end / INTERVAL - ROUNDING).ceil() as u64);
    for number in 0..=count {
        moment.time = INTERVAL * number as f64;
        while let Some(Seen { robot, sight, .. }) = next.next_if(|seen| seen.time <= moment.time) {
            if robot < scene.robots.len() {
                moment.take(robot, sight, &mut frames);
            }
        }
        told.push(said(Message::Frame, frames.frame(&moment)));
    }
    told.push(said(Message::Ended, ended.to_string().as_bytes()));
    told
}

/// The recorded scene; otherwise, or if it cannot be read, an empty one around the paths.
fn scene(log: &Log, robots: &[Robot]) -> Scene {
    let header = log.header();
    let mut files = MemoryFiles::default();
    for file in &header.attachments {
        files.0.insert(file.name.clone(), file.data.clone());
    }
    let recorded = header.attachment("scene.sim").and_then(|file| {
        parse_scene_tolerantly(file.data.clone(), "scene.sim", &mut files).ok().map(|parsed| parsed.value)
    });
    if let Some(scene) = recorded.filter(|scene| scene.robots.len() >= robots.len()) {
        return scene;
    }
    let starts: Vec<Pose> = (0..robots.len()).map(|robot| log.start(robot).unwrap_or_default()).collect();
    let places = robots.iter().zip(&starts).flat_map(|(robot, start)| {
        let told = robot.odometry.iter().map(|(_, pose)| start.compose(pose).position());
        told.chain(robot.truth.iter().map(|(_, pose)| pose.position())).chain([start.position()])
    });
    let mut world = World::empty(1.0, 1.0);
    world.floor = Aabb::around(places).map_or(world.floor, |bounds| bounds.inflated(MARGIN));
    let mut scene = Scene::new(world);
    let spec = Arc::new(RobotSpec::s4());
    scene.robots.extend(starts.into_iter().map(|start| RobotPlacement::new(Arc::clone(&spec), start)));
    scene
}

/// Poses of a robot by time (s).
#[derive(Debug, Default)]
struct Robot {
    odometry: Vec<(f64, Pose)>,
    truth: Vec<(f64, Pose)>,
}

/// A moment of a recording.
#[derive(Debug)]
struct Moment {
    time: f64,
    starts: Vec<Pose>,
    robots: Vec<Robot>,
    /// Number of changes of each robot's display, and its pixels.
    displays: BTreeMap<usize, (u64, RgbImage)>,
}

impl Moment {
    fn take(&mut self, robot: usize, sight: Sight, frames: &mut Frames) {
        match sight {
            Sight::Scan(scan) => frames.scan(robot, &scan),
            Sight::Image(image) => frames.image(robot, &image),
            Sight::Distance(sensor, range) => frames.distance(robot, sensor, range),
            Sight::Display(image) => {
                let drawings = self.displays.get(&robot).map_or(0, |(drawings, _)| *drawings);
                self.displays.insert(robot, (drawings + 1, image));
            }
            Sight::Odometry(_) | Sight::Truth(_) => {}
        }
    }
}

impl Shown for Moment {
    fn time(&self) -> f64 {
        self.time
    }

    fn pose(&self, robot: usize) -> Option<Pose> {
        let truth = self.robots.get(robot).and_then(|robot| at(&robot.truth, self.time, GAP));
        truth.or_else(|| Some(self.starts.get(robot)?.compose(&self.odometry(robot)?)))
    }

    fn odometry(&self, robot: usize) -> Option<Pose> {
        let recorded = self.robots.get(robot).and_then(|robot| at(&robot.odometry, self.time, f64::INFINITY));
        Some(recorded.unwrap_or_default())
    }

    fn contacts(&self, _robot: usize) -> Option<(u32, &[Point])> {
        None
    }

    fn display(&self, robot: usize) -> Option<Displayed<'_>> {
        let (drawings, image) = self.displays.get(&robot)?;
        Some(Displayed { drawings: *drawings, image, menu: String::new() })
    }

    fn object(&self, _object: usize) -> Option<Pose> {
        None
    }

    fn has_fallen(&self, _object: usize) -> bool {
        false
    }
}

/// The pose at a time, between the recorded ones; `None` in a longer gap, and without poses.
fn at(poses: &[(f64, Pose)], time: f64, gap: f64) -> Option<Pose> {
    let after = poses.partition_point(|(other, _)| *other <= time);
    let (before, next) = (after.checked_sub(1).map(|index| poses[index]), poses.get(after).copied());
    match (before, next) {
        (Some((t0, a)), Some((t1, b))) if t1 - t0 <= gap => {
            let share = (time - t0) / (t1 - t0);
            let turn = normalize_angle(b.heading - a.heading);
            Some(Pose::new(a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.heading + share * turn))
        }
        (Some((t0, a)), None) if time - t0 <= gap => Some(a),
        _ => None,
    }
}
