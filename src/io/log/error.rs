use std::io;

use thiserror::Error;

use crate::parameter::debug_as_sentence;

/// Why a file cannot be used as a recording.
#[derive(Error)]
#[non_exhaustive]
pub enum LogError {
    /// It is no MCAP file.
    #[error("found no MCAP file; expected a recording, which begins with the bytes of one")]
    NoMcap,
    /// It is an MCAP file of some other program.
    #[error(
        "found an MCAP file of another program (library `{library}`); expected a recording made by roverlab"
    )]
    Foreign {
        /// What wrote it, as it says itself.
        library: String,
    },
    /// Its header is lost, so that nobody knows which program it is of.
    #[error("found a recording without its header; expected one that says which program it is of")]
    NoHeader,
    /// It ends too early, as after a crash.
    #[error(
        "found the end of the file at byte {at}; expected more: the recording was cut off, and `recover` gives back its complete chunks"
    )]
    Truncated {
        /// Bytes in the file.
        at: u64,
    },
    /// Its bytes are not those that were written.
    #[error(
        "found damage: {what}; expected a recording as it was written; `recover` gives back its intact chunks"
    )]
    Damaged {
        /// What is wrong.
        what: String,
    },
    /// A later version of this crate made it.
    #[error(
        "found a recording of schema {found}; expected schema {supported} or older: a newer version made it"
    )]
    Newer {
        /// Its schema.
        found: u32,
        /// The newest schema that this version knows.
        supported: u32,
    },
    /// It holds several recordings.
    #[error("found {runs} runs in one file; expected a file for each")]
    SeveralRuns {
        /// How many.
        runs: usize,
    },
    /// Its chunks are compressed.
    #[error(
        "found chunks compressed by `{compression}`; expected uncompressed ones, or a build with the feature `{compression}`"
    )]
    Compressed {
        /// The name of the compression.
        compression: String,
    },
    /// It has no such robot.
    #[error("found {robots} robots in the recording; expected one of index {index}")]
    NoRobot {
        /// The index that was asked for.
        index: usize,
        /// How many robots there are.
        robots: usize,
    },
    /// It cannot be read or written.
    #[error("the recording cannot be read or written: {0}")]
    Io(#[from] io::Error),
}

debug_as_sentence!(LogError);

impl LogError {
    pub(super) fn damaged(what: impl Into<String>) -> Self {
        Self::Damaged { what: what.into() }
    }
}
