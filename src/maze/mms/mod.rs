//! The text protocol of the maze simulator mms (github.com/mackorone/mms): a mouse writes commands, one per
//! line, and reads the answers.
//!
//! [`MmsReferee`] answers as the simulator does and keeps its score, so any mouse written for mms can run
//! here. [`MmsMouse`] is this library's solver. Both are free of input and output: the caller passes the
//! lines on.
//!
//! ```
//! use roverlab::maze::mms::{MmsMouse, Move, MmsReferee};
//! use roverlab::maze::Maze;
//!
//! let mut referee = MmsReferee::new(Maze::open(4, 4)?);
//! let mut mouse = MmsMouse::new();
//! let mut answer = None;
//! while let Move::Say(line) = mouse.step(answer.as_deref()).expect("the referee's answers are valid") {
//!     answer = referee.answer(&line);
//! }
//! assert!(referee.score().solved);
//! # Ok::<(), roverlab::ParameterError>(())
//! ```

mod mouse;
mod referee;
mod score;
#[cfg(test)]
mod tests;

pub use mouse::{MmsError, MmsMouse, Move};
pub use referee::MmsReferee;
pub use score::{MmsRun, Score};
