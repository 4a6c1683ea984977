//! The page beside a run: `--view`, and of a recording: `view`.

#![allow(clippy::naive_bytecount, reason = "kinds of a few messages")]

use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::process::{Child, ChildStderr, Stdio};

use serde_json::json;
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

use super::{roverlab, said};

/// Kinds of messages for the page.
const SCENE: u8 = 1;
const FRAME: u8 = 2;
const ENDED: u8 = 4;

/// Starts the program, and reads the address that it prints.
fn opened(words: &[&str]) -> (Child, String, BufReader<ChildStderr>) {
    let mut child = roverlab(words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut errors = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    errors.read_line(&mut line).unwrap();
    let address = line.trim().strip_prefix("view: http:").unwrap_or_else(|| panic!("{line}"));
    (child, format!("ws:{address}"), errors)
}

/// Connects and subscribes to the page's channel.
fn look(address: &str) -> WebSocket<TcpStream> {
    let stream = TcpStream::connect(address.split('/').nth(2).unwrap()).unwrap();
    let (mut page, _) = tungstenite::client(address.into_client_request().unwrap(), stream).unwrap();
    let wish = json!({ "op": "subscribe", "subscriptions": [{ "id": 1, "channelId": 0 }] });
    page.send(Message::text(wish.to_string())).unwrap();
    page
}

/// Kinds of the messages up to the end of the run, and what is said of it.
fn seen(page: &mut WebSocket<TcpStream>) -> (Vec<u8>, String) {
    let mut kinds = Vec::new();
    loop {
        if let Message::Binary(data) = page.read().unwrap() {
            kinds.push(data[13]);
            if data[13] == ENDED {
                return (kinds, String::from_utf8_lossy(&data[14..]).into_owned());
            }
        }
    }
}

#[test]
fn a_run_with_a_page_is_the_same_run() {
    let words = ["distbug", "--seed=3", "--json"];
    let (status, alone) = said(&mut roverlab(&words));
    assert_eq!(status, 0);

    let (child, address, _errors) = opened(&["distbug", "--seed=3", "--json", "--view"]);
    let mut page = look(&address);
    let (kinds, ended) = seen(&mut page);
    let output = child.wait_with_output().unwrap();
    assert_eq!(String::from_utf8(output.stdout).unwrap(), alone);
    assert_eq!(kinds.iter().filter(|kind| **kind == SCENE).count(), 1);
    assert!(kinds.iter().filter(|kind| **kind == FRAME).count() > 100);
    assert!(ended.contains("distbug: reached"), "{ended}");

    let (child, _, _errors) = opened(&["distbug", "--seed=3", "--json", "--view", "--no-wait"]);
    assert_eq!(String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap(), alone);
}

#[test]
fn a_recording_is_shown() {
    let file = format!("{}/viewed.mcap", env!("CARGO_TARGET_TMPDIR"));
    assert_eq!(said(&mut roverlab(&["distbug", "--json", "--force", "--record", &file])).0, 0);
    let (mut child, address, _errors) = opened(&["view", &file]);
    let (kinds, ended) = seen(&mut look(&address));
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(kinds.iter().filter(|kind| **kind == FRAME).count() > 100);
    assert!(ended.contains("distbug: recorded"), "{ended}");
}

#[test]
fn what_cannot_be_viewed_is_refused() {
    let taken = std::net::TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let port = format!("--view={}", taken.local_addr().unwrap().port());
    let cases: [(&[&str], &str); 5] = [
        (&["view", "nowhere.mcap"], "nowhere.mcap: "),
        (&["view", "Cargo.toml"], "Cargo.toml: "),
        (&["distbug", &port], "one that is taken; expected a free port"),
        (&["distbug", "--campaign", "--view"], "--view: found no robot that drives with --campaign"),
        (&["distbug", "--no-wait"], "--view"),
    ];
    for (words, message) in cases {
        let (status, text) = said(&mut roverlab(words));
        assert!(status == 2 && text.contains(message) && text.lines().count() == 1, "{words:?}: {text}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn nothing_listens_unless_asked() {
    let sockets = |child: &Child| {
        let files = std::fs::read_dir(format!("/proc/{}/fd", child.id())).unwrap();
        let links = files.filter_map(|file| std::fs::read_link(file.unwrap().path()).ok());
        links.filter(|link| link.to_string_lossy().starts_with("socket:")).count()
    };
    let mut child = roverlab(&["distbug", "--realtime"]).stdout(Stdio::piped()).spawn().unwrap();
    // It has told its first line, so the robot drives.
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let without = sockets(&child);
    child.kill().unwrap();
    child.wait().unwrap();
    let (mut child, ..) = opened(&["distbug", "--realtime", "--view"]);
    let with = sockets(&child);
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!((without, with), (0, 1));
}
