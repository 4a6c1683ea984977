//! The systems of a robotics textbook as a library: robots that drive, map, navigate, see and learn, after
//! *Robot Adventures in Python and C* (Thomas Bräunl, 2020).
//!
//! Algorithms are written against small traits for a robot's capabilities ([`io`]); whether the robot is
//! simulated, recorded or real makes no difference to them. The same seed, world and program give the same
//! run, to the last bit, on every platform.
//!
//! # Example
//!
//! A robot with a lidar drives around a wall without touching it:
//!
//! ```
//! use roverlab::geometry::{Point, Pose};
//! use roverlab::io::control::run;
//! use roverlab::io::sim::{SimOptions, Simulation};
//! use roverlab::nav::{DistBug, BugOutcome, BugParameters};
//! use roverlab::world::{RobotSpec, Scene, Wall, World};
//!
//! # fn main() -> roverlab::io::Result<()> {
//! let mut world = World::walled(3.0, 2.0);
//! world.walls.push(Wall::new(Point::new(1.5, 0.5), Point::new(1.5, 1.6)));
//! let start = Pose::new(0.5, 1.0, 0.0);
//! let scene = Scene::with_robot(world, RobotSpec::s4(), start);
//! let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 7))?;
//! let mut robot = simulation.robot(0)?;
//!
//! let goal = Point::new(2.5, 1.0);
//! let mut bug = DistBug::new(start.to_local(goal), BugParameters::default())?;
//! let outcome = run(&mut robot, &mut bug, 120.0, |_, _, _| {})?;
//!
//! let truth = simulation.truth().robot(0)?;
//! assert_eq!((outcome, truth.contacts), (BugOutcome::Reached, 0));
//! assert!(truth.pose.distance_to(goal) < 0.1);
//! # Ok(())
//! # }
//! ```
//!
//! # Chapters and modules
//!
//! The README lists which parts of these chapters are missing, and the command that shows each system.
//!
//! | chapter | topic | module |
//! |---|---|---|
//! | 1 Robots and simulation | simulated worlds and robots; random worlds | [`io::sim`], [`world`], [`world::generate`] |
//! | 1 Robots and simulation | EyeSim's files, ROS maps and others | [`world::formats`] |
//! | 2 Sensors and programs | robot capabilities; the loop of all behaviours; wrappers that add noise or faults; first steps, a ring by radio | [`io`], [`io::control`], [`io::wrappers`], [`io::delegate`], [`drive`] |
//! | 3 Driving | random drive, coverage, point to point, path followers, PID | [`drive`], [`kinematics`] |
//! | 4 Lidar | scans, features, noise filters; localisation in a known world | [`scan`] |
//! | 5 Swarms | any number of robots in one world; followers, chains, formations | [`io::sim`], [`drive`] |
//! | 6 Wall following | walls of any shape, by distance sensors, PID or lidar | [`drive`] |
//! | 7 Alternative drives | cars, Mecanum wheels, tracks: kinematics, control, simulation | [`kinematics`], [`drive`], [`io::sim`] |
//! | 7 Alternative drives | hills: height fields, bodies in space, plans, the search for the summit, ramps | [`world::space`], [`nav::elevation`], [`nav`], [`drive::terrain`] |
//! | 8 Boats and subs | craft in water and their control | [`kinematics::marine`], [`drive::marine`] |
//! | 9 Mazes | models, files and generators, flood fill, exploration, time-optimal runs, a simulator's protocol | [`maze`], [`maze::files`], [`maze::generate`], [`maze::mms`] |
//! | 10 Navigation | bug algorithms, navigation in a known world, reachable goals | [`nav`] |
//! | 10 Navigation | planning on grid maps and graphs: A\*, Dijkstra, jump points, any angle, quadtrees | [`nav::grid`], [`nav::graph`] |
//! | 11 Robot vision | edges, colours, blobs, lines, motion; driving by colour and by motion | [`vision`], [`vision::images`], [`vision::motion`], [`drive::colour`], [`drive::motion_watch`] |
//! | 12 Evolution | genetic algorithms, CMA evolution strategy; a walking robot | [`evolve`], `evolve::checkpoint`, `io::sim::starman` |
//! | 13 Driverless cars | roads and their files, the lane, what is on the road and signs by camera, driving in traffic, the referees of Free Drive and Obstacle Evasion | [`world::road`], [`vision::lane_markings`], [`vision::road_elements`], [`vision::signs`], [`drive::lane_keeping`], [`drive::traffic`], [`drive::parking`] |
//! | 13 Driverless cars | trained networks, driving by one, and training | [`vision::network`], [`drive::end_to_end`], `learn` |
//! | 14 Formula SAE | cone tracks, centre lines, racing lines, racing cars, referee | [`race`] |
//! | 14 Formula SAE | safety: state machine, monitors, stopping distance | [`safety`] |
//!
//! Besides the chapters: [`ParameterError`] is the error of constructors; [`geometry`] has poses and angles,
//! [`geometry::units`] conversions, and [`geometry::math`] functions with equal bits on every platform;
//! [`random`] has seeded streams; [`files`] reads and writes safely; [`picture`] draws worlds and runs;
//! `io::log` records and replays them;
//! `io::robios` drives a real EyeBot; `testing` helps to test your own planners. Those without a link are
//! features that are off by default.
//!
//! # Conventions
//!
//! Metres, radians, seconds; x forward, y left, angles counter-clockwise. A sensor that detects nothing reads
//! `f64::INFINITY`; a missing sensor is an error. No input from a user, a file or a robot causes a panic.
//!
//! # Features
//!
//! Each wing is a feature of its name and enables those that it depends on. `io` includes [`world`];
//! [`files`], [`geometry`], [`kinematics`] and [`random`] are always present. All wings are on by default, and
//! so is `picture`. With `default-features = false, features = ["vision"]` only the kernels of [`vision`]
//! are compiled; `image` adds views of that crate's images.
//!
//! Off by default: `log` (recordings; `lz4`, `zstd`: packed ones), `png` (pictures as PNG), `testing`
//! (property-test strategies and checks for your own planners), `petgraph` (search on that crate's graphs),
//! `parry2d` (worlds as shapes of that crate), `rayon` (vision kernels and evolution on several threads),
//! `checkpoint` (saved evolutions), `physics` (a walking robot), `weights` (what has been learned, in files),
//! `learn` (training of networks), `robios` (a real EyeBot).

#![cfg_attr(docsrs, feature(doc_cfg))]
// With some wings off, code used only by them is unused, and links to them are plain text.
#![cfg_attr(
    not(feature = "default"),
    allow(dead_code, unused_imports, unused_macros, rustdoc::broken_intra_doc_links)
)]

#[cfg(feature = "drive")]
pub mod drive;
#[cfg(feature = "evolve")]
pub mod evolve;
pub mod files;
pub mod geometry;
#[cfg(feature = "io")]
pub mod io;
pub mod kinematics;
#[cfg(feature = "learn")]
pub mod learn;
#[cfg(feature = "maze")]
pub mod maze;
#[cfg(feature = "nav")]
pub mod nav;
mod parameter;
#[cfg(feature = "picture")]
pub mod picture;
#[cfg(feature = "race")]
pub mod race;
pub mod random;
#[cfg(feature = "safety")]
pub mod safety;
#[cfg(feature = "scan")]
pub mod scan;
#[cfg(any(test, feature = "testing"))]
pub mod testing;
#[cfg(feature = "vision")]
pub mod vision;
#[cfg(feature = "io")]
pub mod world;

pub use parameter::ParameterError;

/// Runs the programs in the README as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// Runs the programs in the guide as tests.
#[cfg(doctest)]
mod guide {
    #[doc = include_str!("../docs/guide/first-robot.md")]
    struct FirstRobot;
    #[doc = include_str!("../docs/guide/driving.md")]
    struct Driving;
    #[doc = include_str!("../docs/guide/lidar.md")]
    struct Lidar;
    #[doc = include_str!("../docs/guide/swarms.md")]
    struct Swarms;
    #[doc = include_str!("../docs/guide/wall-following.md")]
    struct WallFollowing;
    #[doc = include_str!("../docs/guide/other-drives.md")]
    struct OtherDrives;
    #[doc = include_str!("../docs/guide/hills.md")]
    struct Hills;
    #[doc = include_str!("../docs/guide/water.md")]
    struct Water;
    #[doc = include_str!("../docs/guide/mazes.md")]
    struct Mazes;
    #[doc = include_str!("../docs/guide/navigation.md")]
    struct Navigation;
    #[doc = include_str!("../docs/guide/vision.md")]
    struct Vision;
    #[doc = include_str!("../docs/guide/evolution.md")]
    struct Evolution;
    #[doc = include_str!("../docs/guide/roads.md")]
    struct Roads;
    #[doc = include_str!("../docs/guide/traffic.md")]
    struct InTraffic;
    #[doc = include_str!("../docs/guide/racing.md")]
    struct Racing;
    #[cfg(feature = "testing")]
    #[doc = include_str!("../docs/guide/own-planner.md")]
    struct OwnPlanner;
}
