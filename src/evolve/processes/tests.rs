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

/// A process that runs a line of the shell.
#[cfg(unix)]
fn shell(line: &str) -> Command {
    let mut command = Command::new("sh");
    command.args(["-c", line]);
    command
}

/// Evaluates eight individuals in two processes, whose lines of the shell depend on their number.
#[cfg(unix)]
fn evaluated(piece: usize, line: impl Fn(usize) -> &'static str + Send + 'static) -> Result<Vec<f64>> {
    let mut started = 0;
    let start = move || {
        started += 1;
        shell(line(started - 1))
    };
    let mut processes = Processes::start(2, start).unwrap().with_piece(piece).unwrap();
    let genomes: Vec<Vec<u8>> = (0..8).map(|gene| vec![gene]).collect();
    let first = processes.evaluate(&genomes, trial(0).round)?;
    assert_eq!(processes.evaluate(&genomes, trial(0).round)?, first);
    Ok(first)
}

/// A line that answers one question.
#[cfg(unix)]
const ONE: &str = "read s g i x && echo \"$i 3ff000000000000$i\"";
/// A line that answers all questions.
#[cfg(unix)]
const ALL: &str = "while read s g i x; do echo \"$i 3ff000000000000$i\"; done";

#[cfg(unix)]
#[test]
fn lost_pieces_are_asked_again() {
    let expected: Vec<f64> = (0..8).map(|index| f64::from_bits(1.0_f64.to_bits() + index)).collect();
    assert_eq!(evaluated(1, |_| ALL).unwrap(), expected);
    assert_eq!(evaluated(3, |_| ALL).unwrap(), expected);
    assert_eq!(evaluated(100, |_| ALL).unwrap(), expected);
    // Each process ends after an answer.
    assert_eq!(evaluated(1, |_| ONE).unwrap(), expected);
    // All but the first end at once, or in the middle of a piece.
    assert_eq!(evaluated(1, |number| if number == 0 { ALL } else { "exit 1" }).unwrap(), expected);
    assert_eq!(evaluated(2, |number| if number == 0 { ALL } else { ONE }).unwrap(), expected);
}

#[cfg(unix)]
#[test]
fn without_processes_the_evaluation_fails() {
    let error = evaluated(1, |_| "exit 3").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Disconnected);
    assert_eq!(error.to_string(), "a process of the evaluation ended: exit status: 3");
    let mut processes = Processes::start(1, || shell("exit 3")).unwrap();
    assert!(processes.evaluate(&[vec![1_u8]], trial(0).round).is_err());
    let error = processes.evaluate(&[vec![1_u8]], trial(0).round).unwrap_err();
    assert_eq!(error.to_string(), "no process of the evaluation is left");
    let error = Processes::start(1, || shell("true")).unwrap().with_piece(0).unwrap_err();
    assert_eq!(error.to_string(), "piece is 0; expected at least 1");
}

/// What comes of one individual in a process that runs a line of the shell.
#[cfg(unix)]
fn asked(line: &str) -> String {
    let line = line.to_owned();
    let mut processes = Processes::start(1, move || shell(&line)).unwrap().with_time_limit(0.5).unwrap();
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
    assert_eq!(error.to_string(), "/no/such/program, a process of the evaluation, cannot be started");
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
