//! Memory of the report of a program in a page.

use std::sync::{Mutex, PoisonError};

/// Size of the report (bytes).
pub const REPORT: usize = 1 << 17;

/// The memory.
#[derive(Debug)]
pub struct Memory(Mutex<Vec<u8>>);

impl Default for Memory {
    fn default() -> Self {
        Self(Mutex::new(vec![0; REPORT]))
    }
}

impl Memory {
    /// Writes a part of the report.
    pub fn write_report(&self, at: usize, bytes: &[u8]) {
        let mut report = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let end = REPORT.min(at + bytes.len());
        if let Some(room) = report.get_mut(at..end) {
            room.copy_from_slice(&bytes[..room.len()]);
        }
    }

    /// The report.
    pub fn report(&self) -> Vec<u8> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
