//! A robot for unit tests of programs: scripted readings in, recorded commands out.

mod answers;
mod call;
mod ideal;
mod robot;
mod script;

pub use call::Call;
pub use robot::MockRobot;
pub use script::Script;

#[cfg(test)]
mod tests;
