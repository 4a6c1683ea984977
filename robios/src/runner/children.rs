use std::collections::BTreeMap;
use std::env;
use std::ffi::OsString;
use std::io::{Read, Write};
use std::os::fd::{AsFd, AsRawFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crate::memory::Memory;
use crate::plan::{BUILD, Plan, names};
use crate::process;
use crate::report::{Report, Stage};
use crate::verdict::{Ending, Truth, Verdict};
use roverlab::files::TemporaryFolder;
use roverlab::world::Scene;

use super::options::{Options, whole};
use super::panels::Panels;
use super::place::{home, library};
use super::programs::{Program, is_python};
use super::stopwatch::Stopwatch;

/// A running program.
#[derive(Debug)]
pub(crate) struct Running {
    child: Child,
    memory: Arc<Memory>,
    relays: Vec<Relay>,
    /// Duration of the run so far.
    stopwatch: Stopwatch,
}

/// Maximum output of a program per stream (bytes); the rest is dropped.
const MOST_OUTPUT: usize = 1 << 16;
/// Maximum length of a last line (bytes).
const MOST_OF_LINE: usize = 500;
/// How long the runner keeps reading output if another process holds the pipe open.
pub(super) const LEFT_OPEN: Duration = Duration::from_secs(1);
/// Interval of the checks whether a program has ended.
pub(super) const LOOK: Duration = Duration::from_millis(1);

/// Runs a program with its own world in the program's process.
pub(crate) fn run_alone(
    program: &Program,
    plan: &Plan,
    scene: &Scene,
    options: &Options,
    folder: &TemporaryFolder,
) -> Result<Vec<Verdict>, String> {
    let mut plan = plan.clone();
    plan.index = program.robot;
    if program.robot != 0 {
        // Robot and start apply to the first robot.
        (plan.robot, plan.start) = (None, None);
    }
    let variables = plan.variables().into_iter().map(|(name, value)| (name, OsString::from(value))).collect();
    let (ending, report) = match start(program, variables, options, folder, Stopwatch::start(), None)? {
        Ok(running) => running.wait(options.real_limit),
        Err(message) => (Ending::NotStarted(message), Report::default()),
    };
    let placed = &scene.robots[program.robot];
    let truth = if report.known {
        Truth::reported(&report, options.time_limit)
    } else {
        Truth { pose: placed.pose, ..Truth::default() }
    };
    Ok(vec![Verdict::new(&program.name, program.robot, ending, &report, truth)])
}

/// Starts a program in a run measured by a stopwatch. The inner error is the program's own failure to start.
pub(crate) fn start(
    program: &Program,
    variables: BTreeMap<&'static str, OsString>,
    options: &Options,
    folder: &TemporaryFolder,
    stopwatch: Stopwatch,
    panels: Option<&Panels>,
) -> Result<Result<Running, String>, String> {
    let file = match &program.file {
        Ok(file) => file,
        Err(message) => return Ok(Err(message.clone())),
    };
    let (memory, file_of_memory) =
        Memory::create().map_err(|error| format!("no memory to share with the program: {error}"))?;
    let memory = Arc::new(memory);
    let (library, home) = (library()?, home()?);
    let mut command = if is_python(file) { python(file) } else { Command::new(file) };
    command.args(&program.arguments).current_dir(&program.folder).stdin(Stdio::null());
    for name in [names::SHARED, names::WORLD, names::ROBOT, names::START] {
        command.env_remove(name);
    }
    command.envs(variables).env(names::KEYS, &options.keys);
    command.env(names::MEMORY, file_of_memory.as_raw_fd().to_string());
    command
        .env(names::COSTS, options.costs_by_whole_name())
        .env(names::FRAME_RATE, options.frame_rate.to_string());
    command.env(names::CPU_TIME, options.cpu_time.to_string());
    command.env_remove(names::KEYBOARD).env_remove(names::SCREEN);
    let keyboard = if options.is_live() { keyboard(program, &mut command, panels)? } else { None };
    let screen = panels.map(|panels| screen(program, &mut command, panels)).transpose()?;
    command.env(names::LIBRARY, &library).env(names::BUILD, BUILD).env("PYTHONDONTWRITEBYTECODE", "1");
    if let Some(lcd) = &options.lcd {
        command.env(names::LCD, whole(lcd));
    }
    let path = search_path("LD_LIBRARY_PATH", &[folder.path(), library.parent().unwrap_or(Path::new("."))]);
    command.env("LD_LIBRARY_PATH", path);
    // Makes the iteration order of Python's sets reproducible.
    command.env("PYTHONHASHSEED", "0");
    command.env("PYTHONPATH", search_path("PYTHONPATH", &[&home.join("python")]));
    second_name(&library, folder);
    if options.json {
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
    }
    let files: Vec<BorrowedFd<'_>> =
        [file_of_memory.as_fd()].into_iter().chain(keyboard.iter().chain(&screen).map(AsFd::as_fd)).collect();
    match process::start(&mut command, &files, Some(&memory)) {
        Err(error) => Ok(Err(format!("{}: cannot be started: {error}", file.display()))),
        Ok(mut child) => {
            let stdout = child.stdout.take().map(Relay::start);
            let stderr = child.stderr.take().map(Relay::start);
            let relays = stdout.into_iter().chain(stderr).collect();
            Ok(Ok(Running { child, memory, relays, stopwatch }))
        }
    }
}

/// A socket for a program, whose number there is in a variable: our end, and the program's.
fn socket(name: &str, command: &mut Command) -> Result<(UnixStream, UnixStream), String> {
    let (ours, theirs) = UnixStream::pair().map_err(|error| format!("no socket: {error}"))?;
    command.env(name, theirs.as_raw_fd().to_string());
    Ok((ours, theirs))
}

/// Socket for the display of a program with a page beside it.
fn screen(program: &Program, command: &mut Command, panels: &Panels) -> Result<UnixStream, String> {
    let (ours, theirs) = socket(names::SCREEN, command)?;
    panels.connect_display(program.robot, ours);
    Ok(theirs)
}

/// Socket for keys that are pressed in the page, or typed for the first program; the others' keys are
/// automatic then.
fn keyboard(
    program: &Program,
    command: &mut Command,
    panels: Option<&Panels>,
) -> Result<Option<UnixStream>, String> {
    if let Some(panels) = panels {
        let (ours, theirs) = socket(names::KEYBOARD, command)?;
        panels.connect_keys(program.robot, ours);
        return Ok(Some(theirs));
    }
    if !program.is_first {
        command.env(names::KEYS, "AUTO");
        return Ok(None);
    }
    let (mut ours, theirs) = socket(names::KEYBOARD, command)?;
    thread::spawn(move || {
        // Ends with the input, with the program, or with this process.
        let _ = std::io::copy(&mut std::io::stdin().lock(), &mut ours);
    });
    Ok(Some(theirs))
}

fn python(file: &Path) -> Command {
    let mut command = Command::new(env::var_os("PYTHON").unwrap_or_else(|| "python3".into()));
    // Unbuffered, so that output is complete however the program ends.
    command.arg("-u").arg(file);
    command
}

/// Folders, followed by those listed in an environment variable.
fn search_path(name: &str, first: &[&Path]) -> OsString {
    let rest = env::var_os(name).unwrap_or_default();
    let rest: Vec<PathBuf> = env::split_paths(&rest).filter(|path| !path.as_os_str().is_empty()).collect();
    let all = first.iter().map(|path| path.to_path_buf()).chain(rest);
    // A folder with a colon in its name cannot be listed; the dynamic loader then searches its default paths.
    env::join_paths(all).unwrap_or_default()
}

/// A link to the library under its other name, for programs linked against the real robot's.
fn second_name(library: &Path, folder: &TemporaryFolder) {
    let name = library.file_name().map(|name| name.to_string_lossy().replace("eyesim", "eyebot"));
    if let Some(name) = name {
        // It may exist already, and most programs do not need it.
        let _ = std::os::unix::fs::symlink(library, folder.path().join(&name));
    }
}

/// Forwards a program's output to standard error up to a limit; the rest is read and dropped.
#[derive(Debug)]
struct Relay {
    thread: JoinHandle<()>,
    /// The end of the output.
    tail: Arc<Mutex<Vec<u8>>>,
}

impl Relay {
    fn start(mut output: impl Read + Send + 'static) -> Self {
        let tail = Arc::new(Mutex::new(Vec::new()));
        let kept = Arc::clone(&tail);
        let thread = thread::spawn(move || {
            let (mut passed, mut buffer) = (0, vec![0; 1 << 14]);
            while let Ok(count @ 1..) = output.read(&mut buffer) {
                let fitting = count.min(MOST_OUTPUT - passed);
                passed += fitting;
                let _ = std::io::stderr().write_all(&buffer[..fitting]);
                let mut tail = kept.lock().unwrap_or_else(PoisonError::into_inner);
                tail.extend_from_slice(&buffer[..count]);
                let surplus = tail.len().saturating_sub(MOST_OF_LINE);
                tail.drain(..surplus);
            }
        });
        Self { thread, tail }
    }

    /// The last line, once all output is read or the patience is exhausted.
    fn last_line(&self, patience: &Stopwatch) -> String {
        while !self.thread.is_finished() && patience.seconds() < LEFT_OPEN.as_secs_f64() {
            thread::sleep(LOOK);
        }
        let tail = self.tail.lock().unwrap_or_else(PoisonError::into_inner);
        let text = String::from_utf8_lossy(&tail);
        text.lines().rfind(|line| !line.trim().is_empty()).unwrap_or_default().trim().to_owned()
    }
}

impl Running {
    /// Process number.
    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    /// Memory shared with the runner.
    pub(crate) fn memory(&self) -> &Arc<Memory> {
        &self.memory
    }

    /// Whether the program has ended.
    pub(crate) fn has_ended(&mut self) -> bool {
        !matches!(self.child.try_wait(), Ok(None))
    }

    /// Waits until the program has ended, and ends it at its real-time limit.
    pub(crate) fn wait(mut self, real_limit: f64) -> (Ending, Report) {
        let over = || Ending::OutOfTime(format!("ended after {real_limit} real seconds"));
        let ending = loop {
            let status = self.child.try_wait();
            match status {
                Ok(Some(status)) if self.was_killed(status) => {
                    let late = self.stopwatch.seconds() >= real_limit;
                    break if late { over() } else { Ending::Offence(ORPHAN.into()) };
                }
                Ok(Some(status)) => break of_status(status),
                Ok(None) if self.stopwatch.seconds() < real_limit => thread::sleep(LOOK),
                Ok(None) => break over(),
                Err(error) => break Ending::NotStarted(error.to_string()),
            }
        };
        // Its child processes go with it and hold no pipe open.
        process::kill_all(self.child.id());
        let _ = self.child.wait();
        let patience = Stopwatch::start();
        let mut last_words = String::new();
        for relay in &self.relays {
            // Standard error comes last.
            last_words = relay.last_line(&patience);
        }
        let mut report = Report::read(&self.memory);
        let ending = match (report.stage, ending) {
            (Stage::TimedOut, _) => Ending::time_limit(),
            // Its calls have failed, whatever it made of that.
            (Stage::Refused, Ending::Exit(code, _)) => {
                let reason = report.notes.pop().unwrap_or(last_words);
                let reason = if reason.is_empty() { REFUSED.into() } else { reason };
                Ending::Exit(code, Some(reason))
            }
            (_, Ending::Exit(code, _)) if code != 0 && !last_words.is_empty() => {
                Ending::Exit(code, Some(last_words))
            }
            (_, ending) => ending,
        };
        if self.memory.has_forked() {
            report.notes.push(FORKED.into());
        }
        (ending, report)
    }

    /// Whether the parent process of the program was killed before it could record the exit status.
    fn was_killed(&self, status: ExitStatus) -> bool {
        status.signal().is_some() && !self.memory.has_status()
    }
}

/// Message for a program that has killed its parent.
const ORPHAN: &str = "it has ended its parent process, or all of its group, and so itself";
/// Message for a program whose forked processes make calls.
const FORKED: &str = "a process that the program has forked calls RoBIOS: it has no robot, so its calls fail";

/// Message for a program whose library does not say why it has no robot.
const REFUSED: &str = "its library has refused to work: it may be of another build than the runner";

fn of_status(status: ExitStatus) -> Ending {
    match (status.code(), status.signal()) {
        (Some(code), _) => Ending::Exit(code, None),
        (None, signal) => Ending::Signal(signal.unwrap_or_default()),
    }
}
