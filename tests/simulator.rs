//! The simulator as a whole: motion, collisions, noise, time, radio and lockstep, through the public
//! interface alone.

#[allow(unreachable_pub, reason = "the library's own, which is public there with the feature `testing`")]
#[path = "../src/testing/cases.rs"]
mod cases;
#[path = "simulator/common.rs"]
mod common;
#[path = "simulator/scenes.rs"]
mod scenes;

#[path = "simulator/collisions.rs"]
mod collisions;
#[path = "simulator/drives.rs"]
mod drives;
#[path = "simulator/limits.rs"]
mod limits;
#[path = "simulator/lockstep.rs"]
mod lockstep;
#[path = "simulator/motion.rs"]
mod motion;
#[path = "simulator/noise.rs"]
mod noise;
#[path = "simulator/race_car.rs"]
mod race_car;
#[path = "simulator/threads.rs"]
mod threads;
