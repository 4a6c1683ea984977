//! The programs whose runs can be recorded, by their names. An example that is added here can be checked by `replay`.

use std::ffi::OsString;
use std::io::Write;

use crate::common::run;
use crate::maze_drive::{maze_explore, maze_left, maze_lidar};
use crate::{
    a_to_b, ackermann, bug_compare, camera, color_tracking, cone_drive, cone_race, coverage, distbug, edges,
    follow_me, genetic, lidar_scan, localise, micromouse, motion, navigate, omni, random_drive, safety,
    starman, wall_following,
};

/// Runs a program with a command line and its two outputs. Returns the exit status.
type Run = fn(Vec<OsString>, &mut dyn Write, &mut dyn Write) -> u8;

/// A program that drives robots.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Program {
    pub(crate) name: &'static str,
    pub(crate) run: Run,
}

/// A table of programs from the names of their modules.
macro_rules! programs {
    ($($name:ident),* $(,)?) => {
        /// All programs, in the order of their names.
        pub(crate) const PROGRAMS: &[Program] = &[$(Program {
            name: stringify!($name),
            run: |words, out, err| run(stringify!($name), words, out, err, $name::work),
        }),*];
    };
}

programs!(
    a_to_b,
    ackermann,
    bug_compare,
    camera,
    color_tracking,
    cone_drive,
    cone_race,
    coverage,
    distbug,
    edges,
    follow_me,
    genetic,
    lidar_scan,
    localise,
    maze_explore,
    maze_left,
    maze_lidar,
    micromouse,
    motion,
    navigate,
    omni,
    random_drive,
    safety,
    starman,
    wall_following
);

/// A program by its name.
pub(crate) fn named(name: &str) -> Option<&'static Program> {
    PROGRAMS.iter().find(|program| program.name == name)
}
