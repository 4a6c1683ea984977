//! The programs whose runs can be recorded, by their names. An example that is added here can be checked by `replay`.

use std::ffi::OsString;
use std::io::Write;

use crate::common::run;
use crate::{a_to_b, ackermann, distbug, navigate, omni, wall_following};

/// Runs a program with a command line and its two outputs. Returns the exit status.
type Run = fn(Vec<OsString>, &mut dyn Write, &mut dyn Write) -> u8;

/// A program that drives robots.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Program {
    pub(crate) name: &'static str,
    pub(crate) run: Run,
}

pub(crate) const PROGRAMS: &[Program] = &[
    Program { name: "a_to_b", run: |words, out, err| run("a_to_b", words, out, err, a_to_b::work) },
    Program { name: "ackermann", run: |words, out, err| run("ackermann", words, out, err, ackermann::work) },
    Program { name: "distbug", run: |words, out, err| run("distbug", words, out, err, distbug::work) },
    Program { name: "navigate", run: |words, out, err| run("navigate", words, out, err, navigate::work) },
    Program { name: "omni", run: |words, out, err| run("omni", words, out, err, omni::work) },
    Program {
        name: "wall_following",
        run: |words, out, err| run("wall_following", words, out, err, wall_following::work),
    },
];

/// A program by its name.
pub(crate) fn named(name: &str) -> Option<&'static Program> {
    PROGRAMS.iter().find(|program| program.name == name)
}
