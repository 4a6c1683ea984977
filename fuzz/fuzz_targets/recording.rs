//! A recording: read, recovered, and what is recovered with its header is read. After `~`, an input is a list
//! of edits of a whole recording.
#![no_main]

use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use roverlab::geometry::Twist;
use roverlab::io::log::{Header, Log, LogError, LogWriter, recover};
use roverlab::io::{Clock, Drive, Lidar, MockRobot, Odometry};

static WHOLE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let writer = LogWriter::new(Vec::new(), &Header::new("fuzz", ["--seed=1"])).unwrap();
    let mut robot = writer.recorder(MockRobot::new().with_ideal_drive(), 0);
    robot.set_speed(Twist::new(0.2, 0.4)).unwrap();
    for _ in 0..3 {
        robot.wait(0.1).unwrap();
        robot.pose().unwrap();
        // Nobody has told it what to see: an error is recorded, too.
        let _ = robot.scan();
    }
    drop(robot);
    let mut bytes = writer.finish().unwrap();
    forget_checksums(&mut bytes);
    assert_eq!(recover(&bytes).unwrap().chunks, 1);
    assert!(Log::read(bytes.clone()).unwrap().entries(0).count() > 6);
    bytes
});

/// A checksum of 0 counts as none: whatever is edited is looked at.
fn forget_checksums(bytes: &mut [u8]) {
    const MAGIC: usize = 8;
    // The record's code, and where its checksum is behind its length.
    let checksums = [(0x06, 24), (0x0f, 0), (0x02, 16)];
    let mut at = MAGIC;
    while at + 9 < bytes.len() - MAGIC {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
        if let Some((_, place)) = checksums.iter().find(|(code, _)| *code == bytes[at]) {
            bytes[at + 9 + place..][..4].fill(0);
        }
        at += 9 + length;
    }
}

/// Four bytes an edit: the place, what is done there, and a byte for it.
fn edited(edits: &[u8]) -> Vec<u8> {
    let mut bytes = WHOLE.clone();
    for &[low, high, what, byte] in edits.as_chunks().0 {
        let place = usize::from(u16::from_le_bytes([low, high])) % (bytes.len() + 1);
        match what % 4 {
            0 => bytes.insert(place, byte),
            1 => bytes.truncate(bytes.len() - usize::from(byte).min(bytes.len())),
            _ if place == bytes.len() => {}
            2 => drop(bytes.remove(place)),
            _ => bytes[place] = byte,
        }
    }
    bytes
}

fuzz_target!(|bytes: &[u8]| {
    let edited = bytes.strip_prefix(b"~").map(edited);
    let bytes = edited.as_deref().unwrap_or(bytes);
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
