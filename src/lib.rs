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
//! Topics that are not listed are not implemented yet.
//!
//! | chapter | topic | module |
//! |---|---|---|
//! | 1 Robots and simulation | simulated worlds and robots | [`io::sim`] |
//! | 1 Robots and simulation | EyeSim files: `.sim`, `.wld`, `.maz`, `.robi`, `.esObj` | [`world::formats`] |
//! | 2 Sensors and programs | robot capabilities: distance sensors, camera, keys, display, radio | [`io`] |
//! | 3 Driving | v-omega drive, encoders; random drive, coverage, point to point, path followers, PID | [`io`], [`drive`] |
//! | 4 Lidar | scans, features, noise filters; localisation in a known world | [`io`], [`scan`] |
//! | 5 Swarms | any number of robots in one world; followers, chains, formations | [`io::sim`], [`drive`] |
//! | 6 Wall following | walls of any shape, by distance sensors, PID or lidar | [`drive`] |
//! | 7 Alternative drives | cars and omnidirectional drives: kinematics, control, simulation | [`kinematics`], [`drive`], [`io::sim`] |
//! | 8 Boats and subs | craft in water: six degrees of freedom, thrusters, depth hold | [`kinematics::marine`], [`drive::marine`] |
//! | 9 Mazes | models and files, flood fill, exploration, time-optimal runs | [`maze`] |
//! | 10 Navigation | DistBug, scan matching, reachable goals; ROS maps | [`nav`], [`scan`], [`world::formats`] |
//! | 10 Navigation | planning on grid maps: A\*, Dijkstra, jump point search, any-angle paths, quadtrees | [`nav::grid`], [`world`] |
//! | 11 Robot vision | edges, colours, motion, blobs, lines | [`vision`] |
//! | 12 Evolution | genetic algorithms, CMA evolution strategy | [`evolve`] |
//! | 13 Driverless cars | roads and their files, the lane by camera, the referee of Free Drive | [`world::road`], [`vision::lane_markings`], [`drive`] |
//! | 14 Formula SAE | cone tracks, centre lines, racing lines, referee; racing cars | [`race`], [`io::sim`] |
//! | 14 Formula SAE | safety: state machine, monitors, stopping distance | [`safety`] |
//!
//! Besides the chapters: [`ParameterError`] is the error of constructors; [`geometry`] has poses, angles and
//! units; [`random`] has seeded random streams; [`world`] describes worlds and robots, with random courses in
//! [`world::generate`]; [`picture`] draws worlds and runs.
//!
//! # Conventions
//!
//! Metres, radians, seconds; x forward, y left, angles counter-clockwise. A sensor that detects nothing reads
//! `f64::INFINITY`; a missing sensor is an error. No input from a user, a file or a robot causes a panic.
//!
//! # Features
//!
//! Each wing is a feature of its name and enables those that it depends on. `io` includes [`world`];
//! [`geometry`], [`kinematics`] and [`random`] are always present. All wings are on by default, and so is
//! `picture`. With `default-features = false, features = ["vision"]` only the kernels of [`vision`] are
//! compiled; `image` adds views of that crate's images.
//!
//! Off by default: `log` (recordings), `png` (pictures as PNG), `testing` (property-test strategies and
//! checks for your own planners), `petgraph` (search on that crate's graphs), `rayon` (vision kernels and
//! evolution on several threads), `checkpoint` (saved evolutions), `physics` (a walking robot), `robios` (a
//! real EyeBot).

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
pub mod geometry;
#[cfg(feature = "io")]
pub mod io;
pub mod kinematics;
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
    #[doc = include_str!("../docs/guide/mazes.md")]
    struct Mazes;
    #[doc = include_str!("../docs/guide/navigation.md")]
    struct Navigation;
    #[doc = include_str!("../docs/guide/vision.md")]
    struct Vision;
    #[doc = include_str!("../docs/guide/evolution.md")]
    struct Evolution;
    #[doc = include_str!("../docs/guide/racing.md")]
    struct Racing;
    #[cfg(feature = "testing")]
    #[doc = include_str!("../docs/guide/own-planner.md")]
    struct OwnPlanner;
}
