//! Robots, objects and worlds of the book's scripts, which scenes know by name without a file.
//!
//! Their names are those of EyeSim; appearance and dimensions are our own.

mod fields;
mod objects;
mod paint;
mod road;
mod robots;
mod signs;
