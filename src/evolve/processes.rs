use std::collections::VecDeque;
use std::fmt;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::ops::Range;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::evaluator::{Evaluator, Round, Trial};
use super::genome::Genome;
use crate::io::{Error, ErrorKind, Result};
use crate::parameter::require_up_to;

#[cfg(test)]
mod tests;

/// Evaluates individuals in other processes, possibly on other machines.
///
/// A process receives one individual per line on standard input: seed, generation, index, and the genome's
/// bytes in hexadecimal. It answers each with a line: the index and the bits of the fitness in hexadecimal,
/// or `error` and a message. [`serve`] implements such a process. A [piece](Self::with_piece) of several
/// individuals is sent at once; it is answered in order.
///
/// A process that ends, or takes longer for an individual than the [time limit](Self::with_time_limit), ten
/// minutes by default, is lost. It is started anew, and its piece is asked again: as the fitness depends on
/// seed, generation and index only, the result is the same. A process that is lost twice in a row, or cannot
/// be started anew, is given up, and its piece goes to another one. The evaluation fails without processes,
/// or if a piece is lost six times.
pub struct Processes {
    workers: Vec<Worker>,
    start: Mutex<Start>,
    patience: Duration,
    piece: usize,
}

/// The command of a new process.
type Start = Box<dyn FnMut() -> Command + Send>;

/// A process, and the thread that talks with it. That thread waits as long as somebody holds the other end of
/// the pipes, which may be a child of the process; nobody waits for it.
#[derive(Debug)]
struct Worker {
    child: Child,
    /// Lines of questions, and their number.
    questions: Sender<(String, usize)>,
    answers: Receiver<io::Result<Option<String>>>,
}

/// Default time limit of an individual (s).
const PATIENCE: f64 = 600.0;
/// Number of losses after which a piece fails.
const PIECE_LOSSES: u32 = 6;
/// Number of losses in a row after which a process is given up.
const PROCESS_LOSSES: u32 = 2;
/// Maximum length of an answer, whose longest part is an error message (bytes).
const LONGEST_ANSWER: usize = 1 << 12;
/// Maximum length of a question, which holds a genome (bytes).
const LONGEST_QUESTION: usize = 1 << 24;

impl fmt::Debug for Processes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { workers, patience, piece, .. } = self;
        f.debug_struct("Processes")
            .field("workers", workers)
            .field("patience", patience)
            .field("piece", piece)
            .finish_non_exhaustive()
    }
}

impl Processes {
    /// Starts `count` processes of a command; it is asked for again when a process is lost.
    ///
    /// # Errors
    ///
    /// If `count` is 0 or a process cannot be started.
    pub fn start(count: usize, command: impl FnMut() -> Command + Send + 'static) -> Result<Self> {
        if count == 0 {
            return Err(Error::invalid_input("processes", count, "at least 1"));
        }
        let mut command: Start = Box::new(command);
        let workers = (0..count).map(|_| Worker::start(command())).collect::<Result<_>>()?;
        let patience = Duration::from_secs_f64(PATIENCE);
        Ok(Self { workers, start: Mutex::new(command), patience, piece: 1 })
    }

    /// Changes the time limit of an individual, in seconds of the machine's clock.
    ///
    /// # Errors
    ///
    /// If it is not more than 0 and at most a day.
    pub fn with_time_limit(self, seconds: f64) -> Result<Self> {
        require_up_to("time limit", seconds, 86_400.0)?;
        Ok(Self { patience: Duration::from_secs_f64(seconds), ..self })
    }

    /// Changes the number of individuals that a process is sent at once, which is 1 at first. Larger pieces
    /// hide the time that messages take; what a lost process has been sent is asked again.
    ///
    /// # Errors
    ///
    /// If it is 0.
    pub fn with_piece(self, individuals: usize) -> Result<Self> {
        if individuals == 0 {
            return Err(Error::invalid_input("piece", individuals, "at least 1"));
        }
        Ok(Self { piece: individuals, ..self })
    }
}

impl<G: Genome> Evaluator<G> for Processes {
    fn evaluate(&mut self, genomes: &[G], round: Round) -> Result<Vec<f64>> {
        if self.workers.is_empty() {
            return Err(Error::new(ErrorKind::Disconnected, "no process of the evaluation is left"));
        }
        let (start, patience) = (&self.start, self.patience);
        let pieces = Pieces::new(genomes.len(), self.piece, self.workers.len());
        // Any idle worker takes the next piece; the index determines where the fitness goes.
        let work = |mut worker: Worker| -> Result<Worked> {
            let mut found = Vec::new();
            let (mut losses, mut kept) = (0, None);
            while let Some(mut piece) = kept.take().or_else(|| pieces.take()) {
                let lost = match worker.ask(genomes, round, piece.individuals.clone(), patience) {
                    Ok(fitness) => {
                        found.extend(piece.individuals.zip(fitness));
                        pieces.done();
                        losses = 0;
                        continue;
                    }
                    Err(lost) => lost,
                };
                piece.losses += 1;
                losses += 1;
                let is_lost = matches!(lost.kind(), ErrorKind::Disconnected | ErrorKind::TimedOut);
                if !is_lost || piece.losses == PIECE_LOSSES {
                    pieces.stop();
                    return Err(lost);
                }
                let command = || start.lock().unwrap_or_else(PoisonError::into_inner)();
                let anew = if losses < PROCESS_LOSSES { Worker::start(command()) } else { Err(lost) };
                match anew {
                    Ok(another) => (worker, kept) = (another, Some(piece)),
                    Err(error) => {
                        pieces.again(piece);
                        return if pieces.leave() { Err(error) } else { Ok((None, found)) };
                    }
                }
            }
            Ok((Some(worker), found))
        };
        let workers = std::mem::take(&mut self.workers);
        let answers = std::thread::scope(|scope| {
            let threads: Vec<_> = workers.into_iter().map(|worker| scope.spawn(|| work(worker))).collect();
            let crashed = |_| Err(Error::new(ErrorKind::Other, "an evaluation thread panicked"));
            threads
                .into_iter()
                .map(|thread| thread.join().unwrap_or_else(crashed))
                .collect::<Result<Vec<_>>>()
        })?;
        let mut fitness = vec![f64::NAN; genomes.len()];
        for (worker, found) in answers {
            self.workers.extend(worker);
            for (index, value) in found {
                fitness[index] = value;
            }
        }
        Ok(fitness)
    }
}

/// A worker, unless it was given up, and the fitness of the individuals that it was asked for.
type Worked = (Option<Worker>, Vec<(usize, f64)>);

/// Individuals that one process is asked for at once.
#[derive(Debug)]
struct Piece {
    individuals: Range<usize>,
    /// How often a process has been lost with it.
    losses: u32,
}

/// The pieces of a generation that wait for a process.
struct Pieces {
    state: Mutex<Waiting>,
    changed: Condvar,
}

struct Waiting {
    pieces: VecDeque<Piece>,
    /// Number of pieces that are not done.
    left: usize,
    workers: usize,
    stopped: bool,
}

impl Pieces {
    fn new(individuals: usize, size: usize, workers: usize) -> Self {
        let starts = (0..individuals).step_by(size);
        let pieces: VecDeque<Piece> = starts
            .map(|start| Piece { individuals: start..individuals.min(start.saturating_add(size)), losses: 0 })
            .collect();
        let left = pieces.len();
        let state = Mutex::new(Waiting { pieces, left, workers, stopped: false });
        Self { state, changed: Condvar::new() }
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next piece, as soon as there is one; `None` once all are done. A piece that another worker has may
    /// still be lost.
    fn take(&self) -> Option<Piece> {
        let is_waiting = |state: &mut Waiting| state.pieces.is_empty() && state.left > 0 && !state.stopped;
        let state = self.changed.wait_while(self.lock(), is_waiting);
        let mut state = state.unwrap_or_else(PoisonError::into_inner);
        if state.stopped { None } else { state.pieces.pop_front() }
    }

    fn done(&self) {
        self.lock().left -= 1;
        self.changed.notify_all();
    }

    fn again(&self, piece: Piece) {
        self.lock().pieces.push_back(piece);
        self.changed.notify_all();
    }

    /// Ends all work.
    fn stop(&self) {
        self.lock().stopped = true;
        self.changed.notify_all();
    }

    /// Counts a worker out. Returns whether it was the last one.
    fn leave(&self) -> bool {
        let mut state = self.lock();
        state.workers -= 1;
        state.workers == 0
    }
}

impl Worker {
    fn start(mut command: Command) -> Result<Self> {
        let child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut child = child.map_err(|error| {
            let program = command.get_program().display();
            let message = format!("{program}, a process of the evaluation, cannot be started");
            Error::new(ErrorKind::Other, message).with_source(error)
        })?;
        let pipes = child.stdin.take().zip(child.stdout.take());
        let (input, output) =
            pipes.ok_or_else(|| Error::new(ErrorKind::Other, "a process of the evaluation has no pipes"))?;
        let (questions, asked) = channel();
        let (answer, answers) = channel();
        std::thread::spawn(move || talk(input, BufReader::new(output), &asked, &answer));
        Ok(Self { child, questions, answers })
    }

    /// Asks the process for the fitness of some individuals.
    fn ask<G: Genome>(
        &mut self,
        genomes: &[G],
        round: Round,
        individuals: Range<usize>,
        patience: Duration,
    ) -> Result<Vec<f64>> {
        let questions: String =
            individuals.clone().map(|index| question(&genomes[index], round.trial(index))).collect();
        if self.questions.send((questions, individuals.len())).is_err() {
            return Err(self.lost(None));
        }
        individuals.map(|index| self.answer(index, patience)).collect()
    }

    /// The process's next answer.
    fn answer(&mut self, index: usize, patience: Duration) -> Result<f64> {
        match self.answers.recv_timeout(patience) {
            Ok(Ok(Some(answer))) => parse_answer(answer.trim_end(), index),
            Ok(Err(error)) if error.kind() == io::ErrorKind::InvalidData => Err(Error::caused_by(error)),
            Ok(Err(error)) => Err(self.lost(Some(error))),
            Ok(Ok(None)) | Err(RecvTimeoutError::Disconnected) => Err(self.lost(None)),
            Err(RecvTimeoutError::Timeout) => {
                // It must not answer the next question with this one's answer.
                let _ = self.child.kill();
                let most = patience.as_secs_f64();
                let message = format!("individual {index}: no answer of a process in {most} s; it is killed");
                Err(Error::new(ErrorKind::TimedOut, message))
            }
        }
    }

    /// The error of a process that has ended.
    fn lost(&mut self, error: Option<std::io::Error>) -> Error {
        let status = self.child.wait().map_or_else(|_| "unknown".into(), |status| status.to_string());
        let message = format!("a process of the evaluation ended: {status}");
        let lost = Error::new(ErrorKind::Disconnected, message);
        match error {
            Some(error) => lost.with_source(error),
            None => lost,
        }
    }
}

/// Passes questions to a process, and its answers back, until either side ends.
fn talk(
    mut input: ChildStdin,
    mut output: BufReader<ChildStdout>,
    questions: &Receiver<(String, usize)>,
    answers: &Sender<io::Result<Option<String>>>,
) {
    for (text, count) in questions {
        // Beside the answers, as a process that answers while it is asked may wait for its answers to be read.
        let ended = std::thread::scope(|scope| {
            let input = &mut input;
            let asked = scope.spawn(move || input.write_all(text.as_bytes()).and_then(|()| input.flush()));
            for _ in 0..count {
                let answer = read_line(&mut output, LONGEST_ANSWER);
                let goes_on = matches!(answer, Ok(Some(_)));
                if answers.send(answer).is_err() || !goes_on {
                    return true;
                }
            }
            !matches!(asked.join(), Ok(Ok(())))
        });
        if ended {
            return;
        }
    }
}

/// Reads a line with its end; `None` at the end of the input. Fails if it is longer than `most` bytes.
fn read_line(input: &mut impl BufRead, most: usize) -> io::Result<Option<String>> {
    let mut line = String::new();
    input.take(most as u64 + 1).read_line(&mut line)?;
    if line.len() > most {
        let message = format!("a line of the evaluation has more than {most} bytes");
        return Err(io::Error::new(io::ErrorKind::InvalidData, message));
    }
    Ok((!line.is_empty()).then_some(line))
}

impl Drop for Worker {
    fn drop(&mut self) {
        // A process that reads its input ends with it; any other is killed here.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Answers the questions of [`Processes`] until the input ends: the main function of an evaluation process.
///
/// # Errors
///
/// If a question is malformed or the connection breaks.
pub fn serve<G: Genome>(
    mut input: impl BufRead,
    mut output: impl Write,
    mut fitness: impl FnMut(&G, Trial) -> Result<f64>,
) -> Result<()> {
    let broken = |error: io::Error| {
        Error::new(ErrorKind::Disconnected, "the link to the evaluation is broken").with_source(error)
    };
    while let Some(line) = read_line(&mut input, LONGEST_QUESTION).map_err(broken)? {
        let (genome, trial) = parse_question::<G>(line.trim_end())?;
        let answer = match fitness(&genome, trial) {
            Ok(value) => format!("{} {:016x}\n", trial.index, value.to_bits()),
            Err(error) => format!("{} error {}\n", trial.index, error.to_string().replace('\n', " ")),
        };
        output.write_all(answer.as_bytes()).and_then(|()| output.flush()).map_err(broken)?;
    }
    Ok(())
}

fn question<G: Genome>(genome: &G, trial: Trial) -> String {
    let Trial { round: Round { seed, generation }, index } = trial;
    let digits: Vec<String> = genome.to_bytes().iter().map(|byte| format!("{byte:02x}")).collect();
    format!("{seed} {generation} {index} {}\n", digits.concat())
}

fn parse_question<G: Genome>(line: &str) -> Result<(G, Trial)> {
    let refused = || {
        let expected = "seed, generation, index and the genome's bytes in hexadecimal digits";
        Error::invalid_input("question", format!("`{line}`"), expected)
    };
    let parse = || {
        let mut words = line.split(' ');
        let seed = words.next()?.parse().ok()?;
        let generation = words.next()?.parse().ok()?;
        let index = words.next()?.parse().ok()?;
        let digits = words.next()?;
        let bytes: Option<Vec<u8>> = (0..digits.len())
            .step_by(2)
            .map(|i| digits.get(i..i + 2).and_then(|pair| u8::from_str_radix(pair, 16).ok()))
            .collect();
        Some((G::from_bytes(&bytes?)?, Round { seed, generation }.trial(index)))
    };
    parse().ok_or_else(refused)
}

fn parse_answer(line: &str, index: usize) -> Result<f64> {
    let rest = line.strip_prefix(&format!("{index} "));
    if let Some(message) = rest.and_then(|rest| rest.strip_prefix("error ")) {
        return Err(Error::new(
            ErrorKind::Other,
            format!("individual {index} cannot be evaluated: {message}"),
        ));
    }
    rest.and_then(|bits| u64::from_str_radix(bits, 16).ok()).map(f64::from_bits).ok_or_else(|| {
        let expected = format!("{index} and the fitness in hexadecimal digits");
        Error::invalid_input("answer of a process of the evaluation", format!("`{line}`"), &expected)
    })
}
