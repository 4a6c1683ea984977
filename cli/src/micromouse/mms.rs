//! Both ends of the protocol of the simulator mms.

use std::ffi::OsString;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread;
use std::time::Duration;

use roverlab::maze::mms::{MmsMouse, MmsReferee, Move};
use roverlab::maze::{Cell, Direction, ExplorationOutcome, Maze};

use super::plan::with_maze;
use super::{Args, scene};
use crate::common::{Failure, Outcome, Printed, Report, Stopwatch, rounded, run_printing};

/// Maximum length of a line (bytes).
const LINE: usize = 4096;
/// Maximum number of lines in transit.
const PIPE: usize = 1024;
/// Maximum number of invalid lines, and of all lines, before a program is stopped.
const NONSENSE: u64 = 1000;
const LINES: u64 = 2_000_000;

/// Acts as a mouse for the simulator, if requested: commands go to standard output, everything else to
/// standard error. Returns the exit status.
pub(crate) fn drive_for_another(words: &[OsString]) -> Option<u8> {
    let [_, command, options @ ..] = words else { return None };
    if command != "micromouse" || !options.iter().any(|word| word == "--mms") {
        return None;
    }
    let (out, err) = (&mut io::stderr(), &mut io::stderr());
    Some(run_printing("micromouse", words[1..].to_vec(), out, err, |_: &Args| {
        let (mouse, verdict) = converse(&mut io::stdin().lock(), &mut io::stdout())?;
        let unknown = mouse.maze().map_or(0, Maze::unknown_walls);
        let text = match verdict {
            ExplorationOutcome::Unreachable => "no way leads to the goal".into(),
            _ => format!("the best route is proved with {unknown} walls unknown, and driven"),
        };
        Ok(Printed { text, message: None, status: 0 })
    }))
}

/// Drives in a simulator that reads `output` and writes `input`.
pub(crate) fn converse(
    input: &mut dyn BufRead,
    output: &mut dyn Write,
) -> Result<(MmsMouse, ExplorationOutcome), Failure> {
    let broken = |error: io::Error| Failure::run(format!("the simulator cannot be reached: {error}"));
    let mut mouse = MmsMouse::new();
    let mut answer = None;
    loop {
        let step = mouse.step(answer.as_deref());
        match step.map_err(|error| Failure::run(format!("the simulator: {error}")))? {
            Move::Done(verdict) => return Ok((mouse, verdict)),
            Move::Say(line) => writeln!(output, "{line}").and_then(|()| output.flush()).map_err(broken)?,
        }
        answer = None;
        if mouse.awaits() {
            answer = Some(match read_line(input) {
                Heard::Line(line) => line,
                Heard::End => return Err(Failure::run("the simulator has ended; expected an answer")),
                Heard::TooLong => return Err(too_long("the simulator")),
                Heard::Broken(error) => return Err(broken(error)),
            });
        }
    }
}

fn too_long(who: &str) -> Failure {
    Failure::run(format!("{who}: found a line of more than {LINE} bytes; expected shorter ones"))
}

/// Result of reading a line.
#[derive(Debug)]
enum Heard {
    Line(String),
    TooLong,
    End,
    Broken(io::Error),
}

fn read_line(input: &mut dyn BufRead) -> Heard {
    let mut line = Vec::new();
    match input.take(LINE as u64 + 1).read_until(b'\n', &mut line) {
        Ok(0) => Heard::End,
        Ok(_) if line.len() > LINE => Heard::TooLong,
        Ok(_) => Heard::Line(String::from_utf8_lossy(&line).trim_end().to_owned()),
        Err(error) => Heard::Broken(error),
    }
}

/// Runs a mouse written for the simulator, and reports its score.
pub(crate) fn run_program(args: &Args, command: &str) -> Result<Report, Failure> {
    let mut file = scene::maze(args)?;
    // As in that simulator; mice cannot learn them otherwise.
    file.maze.set_start(Cell::default(), Direction::North);
    file.maze.set_goals(file.maze.centre());
    let mut program = Program::start(command)?;
    let mut referee = MmsReferee::new(file.maze.clone());
    let trouble = program.serve(&mut referee, args).and_then(|()| program.stop(args.patience)).err();
    let score = *referee.score();
    let outcome = match (score.solved, &trouble) {
        (_, Some(_)) => Outcome::failure("failed"),
        (true, None) => Outcome::verdict("solved"),
        (false, None) => Outcome::failure("unsolved"),
    };
    let report = Report { error: trouble, ..Report::new(outcome) };
    let best = score.best;
    Ok(with_maze(report, args, &file)
        .field("program", command)
        .field("solved", score.solved)
        .field("score", rounded(score.value()))
        .field("commands", referee.commands())
        .field("ignored_lines", referee.ignored().0)
        .field("total_distance", score.total_distance)
        .field("total_turns", score.total_turns)
        .field("total_effective_distance", score.total_effective)
        .field("best_run_distance", best.map(|run| run.distance))
        .field("best_run_turns", best.map(|run| run.turns))
        .field("best_run_effective_distance", best.map(|run| run.effective)))
}

/// A running program. Two threads own its streams, so that it cannot block this process; they end with the
/// streams, without being joined.
struct Program {
    name: String,
    child: Child,
    said: Receiver<Heard>,
    answers: Option<SyncSender<String>>,
}

impl Program {
    fn start(command: &str) -> Result<Self, Failure> {
        let mut words = command.split_whitespace();
        let name = words.next().ok_or_else(|| {
            Failure::input("--mms-run: found no name; expected a program and its arguments")
        })?;
        let mut command = Command::new(name);
        command.args(words).stdin(Stdio::piped()).stdout(Stdio::piped());
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn().map_err(|error| {
            let expected = "expected a program that can be started";
            Failure::input(format!("--mms-run {name}: found {error}; {expected}"))
        })?;
        let (say, said) = sync_channel(PIPE);
        let (answers, to_answer) = sync_channel::<String>(PIPE);
        if let Some(output) = child.stdout.take() {
            thread::spawn(move || {
                let mut output = BufReader::new(output);
                loop {
                    let heard = read_line(&mut output);
                    let last = !matches!(heard, Heard::Line(_));
                    if say.send(heard).is_err() || last {
                        return;
                    }
                }
            });
        }
        if let Some(mut input) = child.stdin.take() {
            thread::spawn(move || {
                while let Ok(answer) = to_answer.recv() {
                    if writeln!(input, "{answer}").and_then(|()| input.flush()).is_err() {
                        return;
                    }
                }
            });
        }
        Ok(Self { name: name.to_owned(), child, said, answers: Some(answers) })
    }

    /// Answers until the program ends or misbehaves.
    fn serve(&mut self, referee: &mut MmsReferee, args: &Args) -> Result<(), String> {
        let clock = Stopwatch::start();
        let name = self.name.clone();
        loop {
            let line = match self.said.recv_timeout(Duration::from_secs_f64(args.patience)) {
                Ok(Heard::Line(line)) => line,
                Ok(Heard::End) | Err(RecvTimeoutError::Disconnected) => return Ok(()),
                Ok(Heard::TooLong) => return Err(too_long(&name).to_string()),
                Ok(Heard::Broken(error)) => return Err(format!("{name}: cannot be read: {error}")),
                Err(RecvTimeoutError::Timeout) => {
                    return Err(format!("{name}: found silence for {} s; expected commands", args.patience));
                }
            };
            if let Some(answer) = referee.answer(&line) {
                match self.answers.as_ref().map(|answers| answers.try_send(answer)) {
                    Some(Err(TrySendError::Full(_))) => {
                        return Err(format!("{name}: does not read its answers; {PIPE} are waiting"));
                    }
                    // It has closed its input and may end now.
                    Some(Err(TrySendError::Disconnected(_)) | Ok(())) | None => {}
                }
            }
            let (ignored, first) = referee.ignored();
            if ignored > NONSENSE {
                let first = first.unwrap_or_default();
                return Err(format!(
                    "{name}: found {ignored} lines that are no commands, the first {first:?}; expected mazeWidth, \
                     wallFront, moveForward, ..."
                ));
            }
            if referee.commands() + ignored > LINES {
                return Err(format!("{name}: found more than {LINES} lines; expected an end before"));
            }
            if clock.seconds() > args.mms_limit {
                return Err(format!("{name}: found no end after {} s; expected one before", args.mms_limit));
            }
        }
    }

    /// Waits for the program's end, or kills it.
    fn stop(&mut self, patience: f64) -> Result<(), String> {
        self.answers = None;
        let clock = Stopwatch::start();
        let name = &self.name;
        while clock.seconds() < patience.min(2.0) {
            match self.child.try_wait() {
                Ok(Some(status)) => return ended(name, status),
                Ok(None) => thread::sleep(Duration::from_millis(5)),
                Err(error) => return Err(format!("{name}: its end cannot be awaited: {error}")),
            }
        }
        Err(format!("{name}: closed its output and goes on; expected its end"))
    }
}

fn ended(name: &str, status: ExitStatus) -> Result<(), String> {
    if status.success() {
        Ok(())
    } else {
        Err(format!("{name}: ended with {status}; expected exit status 0"))
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // It may have ended by itself, without those that it started.
        #[cfg(unix)]
        let _ = rustix::process::kill_process_group(
            rustix::process::Pid::from_child(&self.child),
            rustix::process::Signal::KILL,
        );
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
