//! A recording: read, recovered, and what is recovered is read.
#![no_main]

use libfuzzer_sys::fuzz_target;
use roverlab::io::log::{Log, recover};

fuzz_target!(|bytes: &[u8]| {
    let _ = Log::read(bytes.to_vec());
    if let Ok(saved) = recover(bytes) {
        Log::read(saved.bytes).expect("what is recovered reads");
    }
});
