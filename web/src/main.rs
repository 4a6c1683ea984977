//! Runs command lines like the page, and prints their results: `roverlab-web distbug --seed=1`. Without
//! arguments, prints the commands and their options.

use std::io::Write;
use std::sync::{Arc, Mutex, PoisonError};

use roverlab_web::{Job, Message, run};

fn main() -> std::io::Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let mut out = std::io::stdout();
    if words.is_empty() {
        return writeln!(out, "{}", roverlab_cli::options());
    }
    let ended = Arc::new(Mutex::new(String::new()));
    let told = Arc::clone(&ended);
    run(Job { words, ..Job::default() }, move |message, bytes| {
        if message == Message::Ended {
            *told.lock().unwrap_or_else(PoisonError::into_inner) =
                String::from_utf8_lossy(bytes).into_owned();
        }
    });
    writeln!(out, "{}", ended.lock().unwrap_or_else(PoisonError::into_inner))
}
