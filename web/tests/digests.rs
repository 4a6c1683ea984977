//! Each system's run of seed 1 in the page: `digests.txt` has the digest of everything the page shows of it,
//! here and in a browser. `REGENERATE=1` rewrites it.

use std::fs;
use std::sync::{Arc, Mutex};

use roverlab_web::{Job, Message, run};
use serde_json::Value;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/digests.txt");

/// The module's report on a run's end.
fn ended(words: &str) -> Value {
    let words: Vec<String> = words.split(' ').map(String::from).collect();
    let end = Arc::new(Mutex::new(Value::Null));
    let told = Arc::clone(&end);
    run(Job { words, ..Job::default() }, move |message, bytes| {
        if message == Message::Ended {
            *told.lock().unwrap() = serde_json::from_slice(bytes).unwrap();
        }
    });
    end.lock().unwrap().clone()
}

#[test]
fn what_the_page_shows_is_what_it_was() {
    let text = fs::read_to_string(FILE).unwrap();
    let mut found = String::new();
    for line in text.lines() {
        let Some((words, _)) = line.rsplit_once(' ').filter(|_| !line.starts_with('#')) else {
            found.extend([line, "\n"]);
            continue;
        };
        let end = ended(words);
        assert!(end["status"].as_u64() < Some(2), "{words}: {end}");
        found.extend([words, " ", end["digest"].as_str().unwrap(), "\n"]);
    }
    if std::env::var_os("REGENERATE").is_some() {
        fs::write(FILE, found).unwrap();
    } else {
        assert_eq!(text, found, "REGENERATE=1 writes it anew, if this is meant");
    }
}

#[test]
fn a_run_that_is_looked_at_is_the_commands_own() {
    let words = "distbug --seed=4 --noise=2 --json";
    let looked_at = ended(words)["output"].as_str().unwrap().trim().to_owned();
    let alone = roverlab_cli::run_words(words.split(' ').map(Into::into), None);
    assert_eq!(looked_at, alone.output.trim());
    assert!(looked_at.contains(r#""outcome":"reached""#), "{looked_at}");
}
