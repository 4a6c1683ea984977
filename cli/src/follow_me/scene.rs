use std::sync::Arc;

use roverlab::geometry::{Point, Pose, units};
use roverlab::random::Stream;
use roverlab::world::{
    LidarSpec, Mount, Object, ObjectKind, PsdSpec, RobotPlacement, RobotSpec, Scene, World,
};

/// How the followers locate the leader.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Mode {
    /// A level lidar sees the leader among everything else.
    Lidar,
    /// A raised lidar sees only the leader, which is taller than the followers; eight distance sensors see
    /// the rest.
    Raised,
    /// Each follows the one before it by a level lidar.
    Chain,
    /// The leader sends its pose.
    Radio,
}

impl Mode {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Lidar => "lidar",
            Self::Raised => "raised",
            Self::Chain => "chain",
            Self::Radio => "radio",
        }
    }

    /// The followers' robot.
    pub(crate) fn spec(self) -> Arc<RobotSpec> {
        Arc::new(if self == Self::Raised { lidarbot() } else { RobotSpec::s4() })
    }

    /// Suitable mode for a number of followers.
    pub(crate) fn for_followers(followers: usize) -> Self {
        match followers {
            0 | 1 => Self::Lidar,
            2..=5 => Self::Raised,
            _ => Self::Chain,
        }
    }
}

/// How the leader drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Pattern {
    /// Round the hall.
    Round,
    /// An eight.
    Eight,
    /// To and fro across the hall, with sharp turns.
    Zigzag,
    /// Round the hall, with a stop of 3 s every 8 s.
    StopAndGo,
}

impl Pattern {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Round => "round",
            Self::Eight => "eight",
            Self::Zigzag => "zigzag",
            Self::StopAndGo => "stop-and-go",
        }
    }

    /// Whether the leader stands at a time (s).
    pub(crate) fn stands(self, time: f64) -> bool {
        const PAUSE: [f64; 2] = [5.0, 8.0];
        self == Self::StopAndGo && time % PAUSE[1] >= PAUSE[0]
    }

    /// The leader's route in a hall, different for each seed.
    fn waypoints(self, stream: &mut Stream, width: f64, depth: f64) -> Vec<Point> {
        let (left, right, middle) = (1.3, width - 1.3, 0.5 * width);
        let (near, far) = (1.3, depth - 1.3);
        let places: &[(f64, f64)] = match self {
            Self::Round | Self::StopAndGo => {
                &[(right, near), (right, far), (middle, depth - 1.6), (left, far), (left, 1.5), (middle, 1.6)]
            }
            Self::Eight => &[(right, far), (right, near), (left, far), (left, near)],
            Self::Zigzag => &[
                (right, near),
                (right, far),
                (0.7 * right + 0.3 * left, near),
                (0.4 * right + 0.6 * left, far),
                (left, near),
            ],
        };
        let mut about = |&(x, y): &(f64, f64)| {
            Point::new(x + stream.between(-0.25, 0.25), y + stream.between(-0.25, 0.25))
        };
        places.iter().map(&mut about).collect()
    }
}

/// The book's `LidarBot`: an S4 with a lidar above the other followers and four more distance sensors
/// (programs 5.8 and 5.9).
pub(crate) fn lidarbot() -> RobotSpec {
    let s4 = RobotSpec::s4();
    let ray = |id: u8, name: &str, y: f64, yaw: f64| PsdSpec {
        id,
        name: name.into(),
        mount: Mount { x: 0.045, y, z: 0.030, yaw: units::from_deg(yaw), ..Mount::default() },
        max_range: PsdSpec::DEFAULT_MAX_RANGE,
    };
    let more = [
        ray(5, "PSD_FL", 0.03, 45.0),
        ray(6, "PSD_FR", -0.03, -45.0),
        ray(7, "PSD_FFL", 0.015, 25.0),
        ray(8, "PSD_FFR", -0.015, -25.0),
    ];
    RobotSpec {
        name: "LidarBot".into(),
        lidar: Some(LidarSpec {
            mount: Mount { z: 0.100, ..Mount::default() },
            field_of_view: std::f64::consts::PI,
            points: 180,
            ..LidarSpec::default()
        }),
        psds: s4.psds.iter().cloned().chain(more).collect(),
        ..s4
    }
}

/// A hall with a leading LabBot, followers behind it, and optional obstacles in the leader's path; also
/// returns the leader's waypoints.
pub(crate) fn hall(
    (mode, pattern): (Mode, Pattern),
    followers: usize,
    obstacles: usize,
    seed: u64,
) -> (Scene, Vec<Point>) {
    let length = match mode {
        Mode::Chain => 6.0 + 0.36 * followers as f64,
        _ => 7.0 + rows_behind(followers),
    };
    let (width, depth) = (length.max(7.0), 5.5);
    let mut stream = Stream::new(seed).child("hall", 0);
    let mut world = World::walled(width, depth);
    let waypoints = pattern.waypoints(&mut stream, width, depth);
    let start =
        Pose::new(if mode == Mode::Chain { width - 3.0 } else { 2.4 + rows_behind(followers) }, 1.2, 0.0);
    add_obstacles(&mut world, &mut stream, obstacles, &waypoints, start.position());
    let mut scene = Scene::new(world);
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::labbot()), start));
    let (spec, places) = (mode.spec(), behind(start, mode, followers, &mut stream));
    scene.robots.extend(places.into_iter().map(|pose| RobotPlacement::new(Arc::clone(&spec), pose)));
    (scene, waypoints)
}

/// Start poses of followers, with small random turns.
pub(crate) fn behind(start: Pose, mode: Mode, followers: usize, stream: &mut Stream) -> Vec<Pose> {
    let pose = |follower| {
        let place = start.to_world(place(mode, follower));
        Pose::new(place.x, place.y, start.heading + stream.between(-0.2, 0.2))
    };
    (1..=followers).map(pose).collect()
}

/// Start of a follower in the leader's frame: in a file, or in rows of three and two as in the book.
fn place(mode: Mode, follower: usize) -> Point {
    match mode {
        Mode::Lidar => Point::new(-0.5 * follower as f64, 0.0),
        Mode::Chain => Point::new(-0.36 * follower as f64 - 0.05, 0.0),
        Mode::Raised | Mode::Radio => {
            let seat = (follower - 1) % ROW;
            let (back, aside) = [(0.6, 0.0), (0.6, 0.35), (0.6, -0.35), (1.05, 0.2), (1.05, -0.2)][seat];
            Point::new(-back - rows_behind(follower), aside)
        }
    }
}

/// Number of followers in a row of three and one of two.
const ROW: usize = 5;

/// Distance of a follower's row behind the first one (m).
fn rows_behind(follower: usize) -> f64 {
    0.9 * (follower.saturating_sub(1) / ROW) as f64
}

/// Cans on the leader's way, not too near to its start.
fn add_obstacles(world: &mut World, stream: &mut Stream, count: usize, waypoints: &[Point], start: Point) {
    let Some(can) = ObjectKind::predefined("can") else { return };
    let can = Arc::new(ObjectKind { fixed: true, ..can });
    for k in 0..count {
        let leg = k % waypoints.len();
        let (a, b) = (waypoints[leg], waypoints[(leg + 1) % waypoints.len()]);
        let place = a + (b - a) * stream.between(0.35, 0.65);
        if (place - start).norm() > 1.2 {
            world.objects.push(Object::new(Arc::clone(&can), Pose::new(place.x, place.y, 0.0)));
        }
    }
}
