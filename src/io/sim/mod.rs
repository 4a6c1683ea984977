//! Robots in a simulated world.

mod lcd;

pub use lcd::Lcd;
