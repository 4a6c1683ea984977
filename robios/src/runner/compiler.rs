use std::io::{self, Read};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::mpsc;
use std::thread;

use super::children::{LEFT_OPEN, LOOK};
use super::stopwatch::Stopwatch;
use crate::process;

/// Time in which a program has to compile, in all attempts (s).
pub(super) const LIMIT: f64 = 60.0;
/// Maximum length of messages (bytes); the rest is read and dropped.
const MOST_SAID: u64 = 1 << 20;

/// Runs a compiler in its own process group, which is killed at the end. Returns its exit status and what it
/// wrote to standard error, or `None` if it still runs when the stopwatch reaches the limit (s).
pub(super) fn run(
    command: &mut Command,
    clock: &Stopwatch,
    limit: f64,
) -> io::Result<Option<(ExitStatus, String)>> {
    let mut child = process::start(command.stderr(Stdio::piped()), &[], None)?;
    let (sender, said) = mpsc::channel();
    if let Some(mut messages) = child.stderr.take() {
        thread::spawn(move || {
            let mut text = Vec::new();
            // What cannot be read is missing from the message.
            let _ = messages.by_ref().take(MOST_SAID).read_to_end(&mut text);
            let _ = io::copy(&mut messages, &mut io::sink());
            let _ = sender.send(text);
        });
    }
    let ended = loop {
        match child.try_wait() {
            Ok(None) if clock.seconds() < limit => thread::sleep(LOOK),
            ended => break ended,
        }
    };
    process::kill_all(child.id());
    let _ = child.wait();
    let Some(status) = ended? else { return Ok(None) };
    let text = said.recv_timeout(LEFT_OPEN).unwrap_or_default();
    Ok(Some((status, String::from_utf8_lossy(&text).into_owned())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::time::Duration;

    fn shell(text: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", text]).stdin(Stdio::null()).stdout(Stdio::null());
        command
    }

    #[test]
    fn status_and_messages_are_returned() {
        let clock = Stopwatch::start();
        let (status, said) = run(&mut shell("echo wrong >&2; exit 3"), &clock, LIMIT).unwrap().unwrap();
        assert_eq!((status.code(), said.as_str()), (Some(3), "wrong\n"));
        assert!(run(&mut Command::new("/no such compiler"), &clock, LIMIT).is_err());
    }

    #[test]
    fn a_compiler_ends_at_its_limit_with_its_children() {
        let file = std::env::temp_dir().join(format!("compilers-{}", std::process::id()));
        let mut command = shell("sleep 100 & echo $! > \"$CHILD\"; wait");
        let ended = run(command.env("CHILD", &file), &Stopwatch::start(), 2.0).unwrap();
        assert!(ended.is_none());
        let number = fs::read_to_string(&file).unwrap();
        fs::remove_file(&file).unwrap();
        // Empty for a process that has ended and that nobody has waited for.
        let words = format!("/proc/{}/cmdline", number.trim());
        let ends = (0..1000).any(|_| {
            thread::sleep(Duration::from_millis(10));
            fs::read(&words).map_or(true, |words| words.is_empty())
        });
        assert!(ends, "process {number} goes on");
    }
}
