use std::io;

use thiserror::Error;

use crate::parameter::debug_as_sentence;

/// Reason why a file is not a usable recording.
#[derive(Error)]
#[non_exhaustive]
pub enum LogError {
    /// It is not an MCAP file.
    #[error("found no MCAP file; expected a recording, which begins with the bytes of one")]
    NoMcap,
    /// It is another program's MCAP file.
    #[error(
        "found an MCAP file of another program (library `{library}`); expected a recording made by roverlab"
    )]
    Foreign {
        /// Name of the writing library, as stated in the file.
        library: String,
    },
    /// Its header is lost, so its program is unknown.
    #[error("found a recording without its header; expected one that says which program it is of")]
    NoHeader,
    /// It is truncated, as after a crash.
    #[error(
        "found the end of the file at byte {at}; expected more: the recording was cut off, and `recover` gives back its complete chunks"
    )]
    Truncated {
        /// Size of the file (bytes).
        at: u64,
    },
    /// Its content is corrupted.
    #[error(
        "found damage: {what}; expected a recording as it was written; `recover` gives back its intact chunks"
    )]
    Damaged {
        /// What is damaged.
        what: String,
    },
    /// It was made by a later version of this crate.
    #[error(
        "found a recording of schema {found}; expected schema {supported} or older: a newer version made it"
    )]
    Newer {
        /// Its schema version.
        found: u32,
        /// The newest supported schema version.
        supported: u32,
    },
    /// It contains several recordings.
    #[error("found {runs} runs in one file; expected a file for each")]
    SeveralRuns {
        /// Number of recordings.
        runs: usize,
    },
    /// Its chunks are compressed, and this build lacks the decompressor.
    #[error(
        "found chunks compressed by `{compression}`; expected uncompressed ones, or a build with the feature `{compression}`"
    )]
    Compressed {
        /// Name of the compression.
        compression: String,
    },
    /// It contains no such robot.
    #[error("found {robots} robots in the recording; expected one of index {index}")]
    NoRobot {
        /// Requested index.
        index: usize,
        /// Number of robots.
        robots: usize,
    },
    /// Reading or writing failed.
    #[error("the recording cannot be read or written: {0}")]
    Io(#[from] io::Error),
}

debug_as_sentence!(LogError);

impl LogError {
    pub(super) fn damaged(what: impl Into<String>) -> Self {
        Self::Damaged { what: what.into() }
    }
}
