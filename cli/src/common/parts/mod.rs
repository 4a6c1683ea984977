//! Campaigns in parts, which may run on several machines.
//!
//! With `--part K/N --out FILE` a campaign does its share of the runs and writes their results to a file
//! ([`PartFile`]). `roverlab merge` starts the command again with the files of all parts; then [`PartArgs`]
//! takes the results from them in place of runs, and everything after that is the same.

mod args;
mod file;
mod outcomes;
mod part;
mod portable;
#[cfg(test)]
mod tests;

pub(crate) use args::{OF_PARTS, PartArgs};
pub(crate) use file::{Header, PartFile};
use part::Part;
pub(crate) use portable::{Portable, field, fields, portable, unexpected};
