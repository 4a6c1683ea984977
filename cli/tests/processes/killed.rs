//! Runs that are killed: recordings lose their last chunk at most, and evolutions go on to the same end.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use std::{fs, thread};

use roverlab::io::log::recover;
use roverlab::random::Stream;
use serde_json::Value;

use super::{roverlab, said};

/// A process that records to a file, which it does not find there.
fn recorder(log: &Path) -> Child {
    let _ = fs::remove_file(log);
    let mut command = roverlab(&["distbug", "--json", "--seed", "2", "--record"]);
    command.arg(log).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// Kills processes that record into a folder at random times. What is on disk is the beginning of the whole
/// recording, and all of its complete chunks can be saved. A second process that wants to record to the same
/// file is refused, and changes nothing.
#[allow(clippy::disallowed_methods, reason = "processes are killed at times on the wall clock")]
fn kill_recorders(kills: usize, folder: &Path) {
    let elsewhere = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("whole-{kills}.mcap"));
    let log = folder.join(format!("killed-{kills}.mcap"));
    let began = Instant::now();
    assert!(recorder(&elsewhere).wait().unwrap().success());
    let duration = began.elapsed().as_secs_f64();
    let whole = fs::read(&elsewhere).unwrap();
    let mut times = Stream::new(1);
    let (mut cut, mut refused) = (0, 0);
    for kill in 0..kills {
        let mut child = recorder(&log);
        thread::sleep(Duration::from_secs_f64(times.between(0.0, duration)));
        if kill % 2 == 1 && log.exists() && child.try_wait().unwrap().is_none() {
            let (_, said) =
                said(roverlab(&["distbug", "--seed", "3", "--time-limit", "1", "--record"]).arg(&log));
            let is_over = child.try_wait().unwrap().is_some();
            // On a full disk the first one has given up its file, and the second one finds no room.
            let is_refused =
                ["somebody who records to it", "No space left"].iter().any(|why| said.contains(why));
            assert!(is_over || is_refused, "{said}");
            if is_over {
                continue;
            }
            refused += 1;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let Ok(part) = fs::read(&log) else { continue };
        assert!(whole.starts_with(&part), "the file is not the beginning of the whole recording");
        if let Ok(saved) = recover(&part) {
            cut += usize::from(part.len() < whole.len());
            // All that is lost is what is behind the last complete chunk.
            let again = recover(&saved.bytes).unwrap();
            assert_eq!((again.chunks, again.lost), (saved.chunks, 0));
            assert!(saved.lost < 2 << 20, "{} bytes are lost", saved.lost);
        }
    }
    println!("{cut} of {kills} recordings were cut off; {refused} second recorders were refused");
}

#[test]
fn a_killed_process_loses_its_last_chunk_at_most() {
    kill_recorders(4, Path::new(env!("CARGO_TARGET_TMPDIR")));
}

mod campaigns {
    use super::*;

    #[test]
    #[ignore = "takes minutes: cargo test -p roverlab-cli --test processes killed::campaigns -- --ignored"]
    fn a_thousand_killed_processes_lose_their_last_chunk_at_most() {
        kill_recorders(1000, Path::new(env!("CARGO_TARGET_TMPDIR")));
    }

    /// With `SMALL_DISK`, a folder on a file system that is smaller than the recording, as by
    /// `mount -t tmpfs -o size=SIZE none FOLDER`.
    #[test]
    #[ignore = "takes minutes: cargo test -p roverlab-cli --test processes killed::campaigns -- --ignored"]
    fn a_full_disk_keeps_the_beginning_of_a_recording() {
        let folder = std::env::var_os("SMALL_DISK").expect("SMALL_DISK names a folder on a small disk");
        let log = Path::new(&folder).join("full.mcap");
        let (status, said) = said(roverlab(&["distbug", "--seed", "2", "--record"]).arg(&log));
        assert!(status != 0 && said.contains("the recording is incomplete"), "{status}: {said}");
        assert!(recover(&fs::read(&log).unwrap()).is_ok_and(|saved| saved.header && saved.chunks > 0));
        fs::remove_file(log).unwrap();
        kill_recorders(1001, Path::new(&folder));
    }
}

/// An evolution that keeps what it has come to in a folder.
fn resumable(folder: &Path) -> Command {
    let options = ["starman", "--json", "--population", "8", "--generations", "6", "--seconds", "4"];
    let mut command = roverlab(&options);
    command.args(["--leading", "2", "--threads", "1", "--checkpoint"]).arg(folder.join("run.json"));
    command
}

/// How many generations a checkpoint holds; 0 without one.
fn generations_kept(folder: &Path) -> usize {
    let text = fs::read_to_string(folder.join("run.json")).unwrap_or_default();
    let checkpoint: Value = serde_json::from_str(&text).unwrap_or_default();
    checkpoint["state"]["history"].as_array().map_or(0, Vec::len)
}

/// Starts the evolution and kills it once it has kept so many generations.
fn kill_after(generations: usize, folder: &Path) {
    let mut child = resumable(folder).stdout(Stdio::null()).spawn().unwrap();
    while generations_kept(folder) < generations {
        assert!(child.try_wait().unwrap().is_none(), "it ended before generation {generations}");
        thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    assert!(!child.wait().unwrap().success(), "it was killed");
}

/// An empty folder.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    // It need not be there.
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The population that an evolution ends with.
fn population(folder: &Path) -> Value {
    let (status, said) = said(&mut resumable(folder));
    let report: Value = serde_json::from_str(&said).unwrap();
    assert!(status == 0 && report["population_hash"].is_string(), "{said}");
    report["population_hash"].clone()
}

#[test]
fn a_killed_evolution_goes_on_to_the_same_end() {
    let (killed, whole) = (folder("killed"), folder("whole"));
    for generations in [1, 2, 3, 5] {
        kill_after(generations, &killed);
    }
    assert_eq!(population(&killed), population(&whole));
}
