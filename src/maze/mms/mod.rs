//! The text protocol of the maze simulator mms (github.com/mackorone/mms): a mouse writes commands, a line each, and reads
//! the answers.
//!
//! A [`MmsReferee`] answers as the simulator does and counts its score, so that any mouse written for mms can be run here. An
//! [`MmsMouse`] is our solver at the other end of the line. Both are pure: whoever holds the streams passes the lines on.
//!
//! ```
//! use roverlab::maze::mms::{MmsMouse, Move, MmsReferee};
//! use roverlab::maze::Maze;
//!
//! let mut referee = MmsReferee::new(Maze::open(4, 4)?);
//! let mut mouse = MmsMouse::new();
//! let mut answer = None;
//! while let Move::Say(line) = mouse.step(answer.as_deref()).expect("the answers of a referee make sense") {
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
