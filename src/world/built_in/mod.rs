//! What scenes know by name without a file: the robots, objects and worlds of the book's scripts.
//!
//! They have the names that EyeSim gives them; how they look and how large they are is our own.

mod fields;
mod objects;
mod paint;
mod road;
mod robots;
mod signs;
