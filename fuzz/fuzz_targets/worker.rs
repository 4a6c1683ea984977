//! Questions for a process that evaluates gaits: each line is answered or refused, and what is read walks.
#![no_main]

use libfuzzer_sys::fuzz_target;
use roverlab::evolve::{Gait, serve};

fuzz_target!(|bytes: &[u8]| {
    let mut answers = Vec::new();
    let served = serve(bytes, &mut answers, |genome: &Vec<u8>, _| {
        let gait = Gait::from_bytes(genome, 2, 1)?;
        Ok(gait.point(genome.len()).iter().sum())
    });
    let lines = bytes.split(|&byte| byte == b'\n').filter(|line| !line.is_empty()).count();
    let answered = answers.iter().filter(|&&byte| byte == b'\n').count();
    assert!(answered <= lines && (served.is_err() || answered > 0 || bytes.is_empty()));
});
