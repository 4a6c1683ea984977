//! Files and folders: regular ones only are read, whole ones written, and temporary ones private.

mod regular;
mod temporary_folder;

pub use regular::{irregular, open_regular, write_whole};
pub use temporary_folder::TemporaryFolder;
