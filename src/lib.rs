//! The systems of a robotics textbook as a library: driving, mapping, navigating, seeing and learning robots, after
//! *Robot Adventures in Python and C* (Thomas Bräunl, 2020).
//!
//! An algorithm is written once, against small traits for what a robot can do ([`io`]), and does not know whether
//! the robot is simulated, recorded or real. The same seed, world and program give the same run, to the last bit, on
//! every platform.
//!
//! # Example
//!
//! A robot with a lidar finds its way past a wall, and nothing is touched:
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
//! What is not listed is not there yet.
//!
//! | chapter | what | where |
//! |---|---|---|
//! | 1 Robots and simulation | simulated worlds and robots | [`io::sim`] |
//! | 1 Robots and simulation | EyeSim's files: `.sim`, `.wld`, `.maz`, `.robi`, `.esObj` | [`world::formats`] |
//! | 2 Sensors and programs | what a robot can be asked: distance sensors, camera, keys, display, radio | [`io`] |
//! | 3 Driving | the v-omega drive, encoders; random drive, coverage, from A to B, path followers, PID | [`io`], [`drive`] |
//! | 4 Lidar | scans, what they show, and taking their noise out; localisation in a known world | [`io`], [`scan`] |
//! | 5 Swarms | any number of robots in one world; followers, chains, formations | [`io::sim`], [`drive`] |
//! | 6 Wall following | walls of any shape, by distance sensors, PID or lidar | [`drive`] |
//! | 7 Alternative drives | cars and wheels with rollers: kinematics, control, simulation | [`kinematics`], [`drive`], [`io::sim`] |
//! | 7 Driving in terrain | hills, robots on belts; the highest place, plans, the steepest way up | [`io::sim`], [`nav::elevation`], [`drive::terrain`] |
//! | 9 Mazes | models and files, flood fill, exploration, time-optimal runs | [`maze`] |
//! | 10 Navigation | DistBug, scan matching, which goals can be reached; ROS maps | [`nav`], [`scan`], [`world::formats`] |
//! | 10 Navigation | planning on grid maps: A\*, Dijkstra, jump point search, any-angle paths, quadtrees | [`nav::grid`], [`world`] |
//! | 11 Robot vision | edges, colours, motion, blobs, lines | [`vision`] |
//! | 12 Evolution | genetic algorithms, evolution strategy with covariance adaptation | [`evolve`] |
//! | 14 Formula SAE | tracks of cones, the way between them, racing lines, referee; racing cars | [`race`], [`io::sim`] |
//! | 14 Formula SAE | the safety system's state machine, monitors, stopping distance | [`safety`] |
//!
//! Beside the chapters: [`ParameterError`] is how constructors refuse; [`geometry`] has poses, angles and
//! units; [`random`] seeded random streams; [`world`] what a world and a robot are, with random courses in
//! [`world::generate`]; [`picture`] draws worlds and runs.
//!
//! # Conventions
//!
//! Metres, radians, seconds; x forward, y left, angles counter-clockwise. A sensor that sees nothing reads
//! `f64::INFINITY`; one that is missing is an error. Nothing panics on what a user, a file or a robot gives it.
//!
//! # Features
//!
//! Each wing above is a feature of its name, and brings those that it imports; `io` has [`world`] too, and
//! [`geometry`], [`kinematics`] and [`random`] are always there. All are on by default, as `picture` is. With
//! `default-features = false, features = ["vision"]` the kernels of [`vision`] are compiled alone; `image` adds views of
//! that crate's images.
//!
//! Off by default: `log` adds recordings, `png` pictures as PNG; `testing` strategies for property tests and
//! checks for planners of one's own; `petgraph` searches graphs of that crate; `rayon` runs vision kernels
//! and evaluates populations on several threads; `checkpoint` saves evolutions; `physics` adds a walking
//! robot; `robios` drives a real EyeBot.

#![cfg_attr(docsrs, feature(doc_cfg))]
// Where some wings are off, what they alone would use is left over, and links to them are plain text.
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

/// The programs in the README run as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// So do those in the guide.
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
