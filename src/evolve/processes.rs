use std::io::{self, BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use super::evaluator::{Evaluator, Round, Trial};
use super::genome::Genome;
use crate::io::{Error, ErrorKind, Result};
use crate::parameter::require_up_to;

/// Evaluates individuals in other processes, possibly on other machines.
///
/// A process receives one individual per line on standard input: seed, generation, index, and the genome's
/// bytes in hexadecimal. It answers each with a line: the index and the bits of the fitness in hexadecimal,
/// or `error` and a message. [`serve`] implements such a process.
///
/// A process that takes longer for an individual than the [time limit](Self::with_time_limit), ten minutes by
/// default, is killed, and the evaluation fails.
#[derive(Debug)]
pub struct Processes {
    workers: Vec<Worker>,
    patience: Duration,
}

/// A process, and the thread that talks with it. That thread waits as long as somebody holds the other end of
/// the pipes, which may be a child of the process; nobody waits for it.
#[derive(Debug)]
struct Worker {
    child: Child,
    questions: Sender<String>,
    answers: Receiver<io::Result<Option<String>>>,
}

/// Default time limit of an individual (s).
const PATIENCE: f64 = 600.0;
/// Maximum length of an answer, whose longest part is an error message (bytes).
const LONGEST_ANSWER: usize = 1 << 12;
/// Maximum length of a question, which holds a genome (bytes).
const LONGEST_QUESTION: usize = 1 << 24;

impl Processes {
    /// Starts `count` processes of a command.
    ///
    /// # Errors
    ///
    /// If `count` is 0 or a process cannot be started.
    pub fn start(count: usize, mut command: impl FnMut() -> Command) -> Result<Self> {
        if count == 0 {
            return Err(Error::invalid_input("processes", count, "at least 1"));
        }
        let workers = (0..count).map(|_| Worker::start(command())).collect::<Result<_>>()?;
        Ok(Self { workers, patience: Duration::from_secs_f64(PATIENCE) })
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
}

impl<G: Genome> Evaluator<G> for Processes {
    fn evaluate(&mut self, genomes: &[G], round: Round) -> Result<Vec<f64>> {
        let (next, patience) = (AtomicUsize::new(0), self.patience);
        // Any idle worker takes the next individual; the index determines where the fitness goes.
        let work = |worker: &mut Worker| -> Result<Vec<(usize, f64)>> {
            let mut found = Vec::new();
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(genome) = genomes.get(index) else { return Ok(found) };
                found.push((index, worker.ask(genome, round.trial(index), patience)?));
            }
        };
        let answers = std::thread::scope(|scope| {
            let threads: Vec<_> =
                self.workers.iter_mut().map(|worker| scope.spawn(|| work(worker))).collect();
            let crashed = |_| Err(Error::new(ErrorKind::Other, "an evaluation thread panicked"));
            threads
                .into_iter()
                .map(|thread| thread.join().unwrap_or_else(crashed))
                .collect::<Result<Vec<_>>>()
        })?;
        let mut fitness = vec![f64::NAN; genomes.len()];
        for (index, value) in answers.into_iter().flatten() {
            fitness[index] = value;
        }
        Ok(fitness)
    }
}

impl Worker {
    fn start(mut command: Command) -> Result<Self> {
        let failed = |error: std::io::Error| {
            Error::new(ErrorKind::Other, "a process of the evaluation cannot be started").with_source(error)
        };
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().map_err(failed)?;
        let pipes = child.stdin.take().zip(child.stdout.take());
        let (input, output) =
            pipes.ok_or_else(|| Error::new(ErrorKind::Other, "a process of the evaluation has no pipes"))?;
        let (questions, asked) = channel();
        let (answer, answers) = channel();
        std::thread::spawn(move || talk(input, BufReader::new(output), &asked, &answer));
        Ok(Self { child, questions, answers })
    }

    /// Asks the process for the fitness.
    fn ask<G: Genome>(&mut self, genome: &G, trial: Trial, patience: Duration) -> Result<f64> {
        if self.questions.send(question(genome, trial)).is_err() {
            return Err(self.lost(None));
        }
        match self.answers.recv_timeout(patience) {
            Ok(Ok(Some(answer))) => parse_answer(answer.trim_end(), trial.index),
            Ok(Err(error)) if error.kind() == io::ErrorKind::InvalidData => Err(Error::caused_by(error)),
            Ok(Err(error)) => Err(self.lost(Some(error))),
            Ok(Ok(None)) | Err(RecvTimeoutError::Disconnected) => Err(self.lost(None)),
            Err(RecvTimeoutError::Timeout) => {
                // It must not answer the next question with this one's answer.
                let _ = self.child.kill();
                let (index, most) = (trial.index, patience.as_secs_f64());
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
    questions: &Receiver<String>,
    answers: &Sender<io::Result<Option<String>>>,
) {
    for question in questions {
        let asked = input.write_all(question.as_bytes()).and_then(|()| input.flush());
        let answer = asked.and_then(|()| read_line(&mut output, LONGEST_ANSWER));
        let goes_on = matches!(answer, Ok(Some(_)));
        if answers.send(answer).is_err() || !goes_on {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(index: usize) -> Trial {
        Round { seed: 7, generation: 3 }.trial(index)
    }

    #[test]
    fn questions_are_answered() {
        let questions = [question(&vec![1_u8, 255], trial(0)), question(&vec![2_u8], trial(9))].concat();
        let mut answers = Vec::new();
        serve(questions.as_bytes(), &mut answers, |genome: &Vec<u8>, asked| {
            assert_eq!(asked.round, trial(0).round);
            Ok(f64::from(genome[0]) + 0.1)
        })
        .unwrap();
        let answers = String::from_utf8(answers).unwrap();
        let found: Vec<f64> =
            answers.lines().zip([0, 9]).map(|(line, index)| parse_answer(line, index).unwrap()).collect();
        assert_eq!(found, [1.1, 2.1]);
    }

    #[test]
    fn nonsense_is_named() {
        let text = |line| parse_question::<Vec<u8>>(line).unwrap_err().to_string();
        let expected = "expected seed, generation, index and the genome's bytes in hexadecimal digits";
        assert_eq!(text("1 2"), format!("question is `1 2`; {expected}"));
        assert_eq!(text("1 2 3 0g"), format!("question is `1 2 3 0g`; {expected}"));
        let text = |line| parse_answer(line, 4).unwrap_err().to_string();
        assert_eq!(text("4 error no ground"), "individual 4 cannot be evaluated: no ground");
        assert!(text("5 00").starts_with("answer of a process of the evaluation is `5 00`; expected 4 and"));
    }

    /// What comes of one individual in a process that runs a line of the shell.
    #[cfg(unix)]
    fn asked(line: &str) -> String {
        let shell = || {
            let mut command = Command::new("sh");
            command.args(["-c", line]);
            command
        };
        let mut processes = Processes::start(1, shell).unwrap().with_time_limit(0.5).unwrap();
        processes.evaluate(&[vec![1_u8]], trial(0).round).unwrap_err().to_string()
    }

    #[cfg(unix)]
    #[test]
    fn processes_that_never_answer_or_never_end_a_line_are_ended() {
        let late = "individual 0: no answer of a process in 0.5 s; it is killed";
        // The second one's child keeps the pipes open.
        for line in ["exec sleep 60", "sleep 5 & wait"] {
            assert_eq!(asked(line), late, "{line}");
        }
        assert_eq!(asked("yes | tr -d '\\n'"), "a line of the evaluation has more than 4096 bytes");
        assert!(Processes::start(1, || Command::new("true")).unwrap().with_time_limit(f64::NAN).is_err());
    }

    #[test]
    fn a_question_without_an_end_is_refused() {
        let endless = io::BufReader::new(io::repeat(b'1'));
        let served = serve::<Vec<u8>>(endless, Vec::new(), |_, _| Ok(0.0));
        let error = std::error::Error::source(&served.unwrap_err()).map(ToString::to_string);
        assert_eq!(error.as_deref(), Some("a line of the evaluation has more than 16777216 bytes"));
    }

    #[test]
    fn processes_that_end_or_cannot_start_are_errors() {
        let error = Processes::start(1, || Command::new("/no/such/program")).unwrap_err();
        assert_eq!(error.to_string(), "a process of the evaluation cannot be started");
        // The test binary, run with a test name that does not exist, ends without an answer.
        let idle = || {
            let mut command = Command::new(std::env::current_exe().unwrap());
            command.args(["--exact", "no such test"]);
            command
        };
        assert!(Processes::start(2, idle).unwrap().evaluate(&[vec![1_u8]], trial(0).round).is_err());
        assert_eq!(
            Processes::start(0, || Command::new("x")).unwrap_err().to_string(),
            "processes is 0; expected at least 1"
        );
    }
}
