//! The page beside a program: its display is there, and its keys are pressed.

use std::io::{BufRead, BufReader, Read};
use std::net::TcpStream;
use std::process::{Command, Stdio};

use serde_json::{Value, json};
use tungstenite::Message;
use tungstenite::client::IntoClientRequest;

use super::{Folder, python};

/// A program that waits for two keys, in Python.
const WAITS: &str = "from eye import *\nLCDMenu('ONE', 'TWO', '', 'END')\nLCDPrintf('%d ', KEYGet())\n\
                     KEYWait(KEY4)\nLCDPrintf('end')\n";

fn is_part(whole: &[u8], part: &[u8]) -> bool {
    whole.windows(part.len()).any(|window| window == part)
}

#[test]
fn a_program_gets_the_keys_of_the_page_and_shows_its_display_there() {
    if !python() {
        return;
    }
    let folder = Folder::new("page");
    let file = folder.write("waits.py", WAITS);
    let mut runner = Command::new(env!("CARGO_BIN_EXE_robios"))
        .args(["--json", "--view", file.to_str().unwrap()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut errors = BufReader::new(runner.stderr.take().unwrap());
    let mut line = String::new();
    errors.read_line(&mut line).unwrap();
    let address = line.trim().strip_prefix("view: http:").unwrap_or_else(|| panic!("{line}"));
    let stream = TcpStream::connect(address.split('/').nth(2).unwrap()).unwrap();
    let (mut page, _) =
        tungstenite::client(format!("ws:{address}").into_client_request().unwrap(), stream).unwrap();
    let send = |page: &mut tungstenite::WebSocket<TcpStream>, value: Value| {
        page.send(Message::text(value.to_string())).unwrap();
    };
    send(&mut page, json!({ "op": "advertise", "channels": [{ "id": 1, "topic": "/robot1/keys" }] }));
    send(&mut page, json!({ "op": "subscribe", "subscriptions": [{ "id": 1, "channelId": 0 }] }));
    let (mut pressed, mut ended) = (0, String::new());
    // Frames (2) have the labels, and after them the image of the display; the last message (4) is the end.
    while let Ok(message) = page.read() {
        let Message::Binary(data) = message else { continue };
        let labels = is_part(&data, b"ONE\nTWO\n\nEND");
        match data[13] {
            2 if labels && pressed == 0 => {
                for key in ["2", "1", "4"] {
                    let text = format!("{{\"key\": {key}}}");
                    page.send(Message::binary([&[1, 1, 0, 0, 0], text.as_bytes()].concat())).unwrap();
                    pressed += 1;
                }
            }
            4 => ended = String::from_utf8_lossy(&data[14..]).into_owned(),
            _ => {}
        }
    }
    let output = runner.wait_with_output().unwrap();
    let mut rest = String::new();
    errors.read_to_string(&mut rest).unwrap();
    let report: Value =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {rest}"));
    assert_eq!(pressed, 3);
    assert_eq!((&report["outcome"], &report["lcd_text"]), (&"finished".into(), &"2 end".into()), "{report}");
    assert!(ended.contains("finished"), "{ended}");
}
