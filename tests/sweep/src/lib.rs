//! Nonsense for every public function of roverlab.
//!
//! A build script (`generate/`) reads the library's source and writes a call of each public function and
//! method, with arguments that are [`Sample`]s. Types whose public fields or constructors can be given
//! samples get samples of their own; `samples.rs` has those of all others. A new function is therefore swept
//! without anybody thinking of it; one that cannot be is to be named in `tests/sweep.rs`, with a reason.

mod sample;
mod samples;

pub use sample::{Picker, Sample};

/// Calls a function with the arguments that a picker chooses. `None` if an argument could not be made.
pub type Call = fn(&mut Picker) -> Option<()>;

/// A public function.
#[derive(Debug, Clone, Copy)]
pub struct Function {
    /// Public path.
    pub name: &'static str,
    /// Whether its documentation says when it panics.
    pub panics: bool,
    /// The call, or why there is none.
    pub call: Result<Call, &'static str>,
}

#[allow(
    clippy::all,
    clippy::pedantic,
    unused_assignments,
    unused_mut,
    unused_variables,
    missing_docs,
    deprecated,
    reason = "as the build script writes it"
)]
mod generated {
    use std::path::PathBuf;

    use image::{GrayImage, RgbImage, RgbaImage};
    use nalgebra::UnitQuaternion;

    use super::{Function, Picker, Sample};
    include!(concat!(env!("OUT_DIR"), "/generated.rs"));
}

pub use generated::FUNCTIONS;
