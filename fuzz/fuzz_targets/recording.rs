//! A recording: read, recovered, and what is recovered with its header is read.
#![no_main]

use libfuzzer_sys::fuzz_target;
use roverlab::io::log::{Log, LogError, recover};

fuzz_target!(|bytes: &[u8]| {
    let _ = Log::read(bytes.to_vec());
    if let Ok(saved) = recover(bytes) {
        match Log::read(saved.bytes) {
            Err(LogError::NoHeader | LogError::Foreign { .. }) if !saved.header => {}
            // Its header is whole, and names a schema of the future.
            Err(LogError::Newer { .. }) if saved.header => {}
            read => drop(read.expect("what is recovered reads")),
        }
    }
});
