//! The page beside a run, served from the program that runs, and Foxglove's WebSocket protocol for it and for
//! other viewers.
//!
//! Only the loopback interface is listened on. The address contains a token, and requests of other sites'
//! pages are refused. A client that reads too slowly misses the oldest messages; the run never waits for it.

mod beside;
mod hub;
mod outbox;
mod pages;
mod player;
mod protocol;
mod request;
mod server;

pub use beside::{Beside, Devices};
pub use player::Player;
pub use server::Opening;
