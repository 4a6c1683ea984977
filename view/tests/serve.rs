//! The server beside a run, as browsers and viewers meet it.

#![allow(clippy::naive_bytecount, reason = "kinds of a few messages")]

use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::thread;
use std::time::{Duration, Instant};

use roverlab::geometry::{Pose, Twist};
use roverlab::io::log::{Header, Log, LogWriter};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Clock, Display, Drive, Key, Keys, Lidar, LidarScan, Odometry};
use roverlab::world::{RobotSpec, Scene, World};
use roverlab_view::Message;
use roverlab_view::serve::{Beside, Opening, Player};
use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::http::HeaderValue;
use tungstenite::{Error, Message as Frame, WebSocket};

const PROTOCOL: &str = "foxglove.websocket.v1";

fn scene() -> Scene {
    Scene::with_robot(World::walled(3.0, 2.0), RobotSpec::s4(), Pose::new(0.5, 1.0, 0.3))
}

fn beside() -> Beside {
    Beside::open(&Opening { port: 0, command: "circle --seed=1".into() }).unwrap()
}

/// A program that drives in a circle and looks around. Returns everything that it has met.
fn drive(simulation: &Simulation, seconds: f64) -> Vec<f64> {
    let mut robot = simulation.robot(0).unwrap();
    let (mut scan, mut met) = (LidarScan::default(), Vec::new());
    robot.set_speed(Twist::new(0.2, 0.6)).unwrap();
    while robot.now().unwrap() < seconds {
        robot.wait(0.1).unwrap();
        robot.scan_into(&mut scan).unwrap();
        robot.print("on\n").unwrap();
        let pose = robot.pose().unwrap();
        met.extend([pose.x, pose.y, pose.heading, scan.ranges[0], scan.ranges[100]]);
    }
    met
}

fn alone(seconds: f64) -> Vec<f64> {
    drive(&Simulation::new(&scene(), SimOptions::with_noise(1.0, 1)).unwrap(), seconds)
}

/// The same run with a page beside it. `first` happens when the scene is known.
fn watched(page: &Beside, seconds: f64, first: impl FnOnce()) -> Vec<f64> {
    let simulation = Simulation::new(&scene(), SimOptions::with_noise(1.0, 1)).unwrap();
    simulation.watch(page.scene(&scene()));
    first();
    drive(&simulation, seconds)
}

/// A connection to an address, with headers of its own.
fn try_join(address: &str, headers: &[(&'static str, &str)]) -> Result<WebSocket<TcpStream>, u16> {
    let address = address.replace("http:", "ws:");
    let stream = TcpStream::connect(address.split('/').nth(2).unwrap()).unwrap();
    let mut request = address.into_client_request().unwrap();
    for (name, value) in headers {
        request.headers_mut().insert(*name, HeaderValue::from_str(value).unwrap());
    }
    match tungstenite::client(request, stream) {
        Ok((socket, _)) => Ok(socket),
        Err(tungstenite::HandshakeError::Failure(Error::Http(response))) => Err(response.status().as_u16()),
        Err(error) => panic!("{error}"),
    }
}

fn join(address: &str) -> WebSocket<TcpStream> {
    try_join(address, &[("Sec-WebSocket-Protocol", PROTOCOL)]).unwrap()
}

/// The next message of a kind on a connection.
fn operation(socket: &mut WebSocket<TcpStream>, op: &str) -> Value {
    loop {
        if let Frame::Text(text) = socket.read().unwrap() {
            let value: Value = serde_json::from_str(&text).unwrap();
            if value["op"] == op {
                return value;
            }
        }
    }
}

/// Numbers of the channels that are advertised, by topic, until there is a topic.
fn channels(socket: &mut WebSocket<TcpStream>, until: &str) -> Vec<(String, u64)> {
    let mut found: Vec<(String, u64)> = Vec::new();
    while !found.iter().any(|(topic, _)| topic == until) {
        for channel in operation(socket, "advertise")["channels"].as_array().unwrap() {
            let topic = channel["topic"].as_str().unwrap().to_owned();
            assert_eq!(channel["encoding"], if topic == "/page" { "roverlab" } else { "protobuf" });
            found.push((topic, channel["id"].as_u64().unwrap()));
        }
    }
    found
}

fn send(socket: &mut WebSocket<TcpStream>, value: &Value) {
    socket.send(Frame::text(value.to_string())).unwrap();
}

/// Subscribes to the page's channel, which is the first one.
fn look(address: &str) -> WebSocket<TcpStream> {
    let mut socket = join(address);
    send(&mut socket, &json!({ "op": "subscribe", "subscriptions": [{ "id": 7, "channelId": 0 }] }));
    socket
}

/// What came on the page's channel until the connection ended: of each message its kind and its bytes.
fn seen(mut socket: WebSocket<TcpStream>) -> Vec<(u8, Vec<u8>)> {
    let mut messages = Vec::new();
    loop {
        match socket.read() {
            Ok(Frame::Binary(data)) => {
                assert_eq!((data[0], &data[1..5]), (1, &[7, 0, 0, 0][..]));
                messages.push((data[13], data[14..].to_vec()));
            }
            Ok(_) => {}
            Err(Error::ConnectionClosed) => return messages,
            Err(error) => panic!("{error}"),
        }
    }
}

fn count(messages: &[(u8, Vec<u8>)], kind: Message) -> usize {
    messages.iter().filter(|(other, _)| *other == kind as u8).count()
}

#[test]
fn pages_come_and_go_and_the_run_is_the_same() {
    let expected = alone(20.0);
    let page = beside();
    let address = page.address().to_owned();
    let mut others = Vec::new();
    let met = watched(&page, 20.0, || {
        let both = [look(&address), look(&address)];
        page.wait();
        others.extend(both.map(|socket| thread::spawn(move || seen(socket))));
        // One that leaves without a word, and one that never reads.
        drop(look(&address));
        others.push(thread::spawn({
            let late = look(&address);
            move || seen(late)
        }));
    });
    assert_eq!(met, expected);
    page.told("at the end");
    page.ended(0, "circle: driven", "");
    drop(page);
    for messages in others.into_iter().map(|other| other.join().unwrap()) {
        assert_eq!(count(&messages, Message::Scene), 1);
        assert!(count(&messages, Message::Frame) > 400, "{}", count(&messages, Message::Frame));
        let (kind, ended) = messages.last().unwrap();
        assert_eq!(*kind, Message::Ended as u8);
        assert!(String::from_utf8_lossy(ended).contains("circle: driven"));
        let told = messages.iter().find(|(kind, _)| *kind == Message::Told as u8).unwrap();
        let time = f64::from_le_bytes(told.1[..8].try_into().unwrap());
        assert!((20.0..=20.2).contains(&time) && told.1[8..] == *b"at the end", "{time} s");
    }
}

#[test]
fn who_never_reads_holds_nobody_up() {
    let expected = alone(60.0);
    let page = beside();
    let mut sleeper = None;
    let met = watched(&page, 60.0, || {
        sleeper = Some(look(page.address()));
        page.wait();
    });
    assert_eq!(met, expected);
    // So much that it is in no buffer of the system.
    for line in 0..40_000 {
        page.told(&format!("{line} {}", "x".repeat(1000)));
    }
    let messages = {
        let socket = sleeper.unwrap();
        thread::sleep(Duration::from_millis(200));
        thread::spawn(move || seen(socket))
    };
    drop(page);
    let messages = messages.join().unwrap();
    let last = messages.iter().rfind(|(kind, _)| *kind == Message::Told as u8).unwrap();
    assert!(last.1[8..].starts_with(b"39999 "), "the newest are there");
    assert!(count(&messages, Message::Told) < 40_000, "the oldest are not");
}

/// Several together cost no more time than one.
#[test]
#[allow(clippy::disallowed_methods, reason = "it is the real time that is measured")]
fn who_never_reads_is_not_waited_for_at_the_end() {
    let page = beside();
    let sleepers: Vec<_> = (0..3).map(|_| look(page.address())).collect();
    page.wait();
    thread::sleep(Duration::from_millis(500));
    for line in 0..20_000 {
        page.told(&format!("{line} {}", "x".repeat(1000)));
    }
    let begin = Instant::now();
    drop(page);
    let waited = begin.elapsed().as_secs_f64();
    assert!((9.0..15.0).contains(&waited), "{waited} s");
    drop(sleepers);
}

#[test]
fn who_comes_later_gets_what_is_said_once() {
    let page = beside();
    page.told("before the scene");
    watched(&page, 1.0, || ());
    page.told("after it");
    let mut viewer = join(page.address());
    assert_eq!(operation(&mut viewer, "serverInfo")["capabilities"], json!(["clientPublish", "time"]));
    let known = channels(&mut viewer, "/robot1/transforms");
    let id = |topic: &str| known.iter().find(|(known, _)| known == topic).unwrap().1;
    for (number, topic) in ["/scene", "/robot1/transforms"].iter().enumerate() {
        let subscription = json!({ "id": number, "channelId": id(topic) });
        send(&mut viewer, &json!({ "op": "subscribe", "subscriptions": [subscription] }));
        let Frame::Binary(data) = viewer.read().unwrap() else { panic!("{topic}") };
        assert_eq!((data[0], usize::from(data[1])), (1, number));
        assert!(data.len() > 50, "{topic}");
    }
    let late = look(page.address());
    page.wait();
    let late = thread::spawn(move || seen(late));
    thread::sleep(Duration::from_millis(100));
    drop(page);
    let messages = late.join().unwrap();
    assert_eq!((count(&messages, Message::Scene), count(&messages, Message::Told)), (1, 2));
}

#[test]
fn keys_reach_the_program() {
    let page = beside();
    let simulation = Simulation::new(&scene(), SimOptions::default()).unwrap();
    simulation.watch(page.scene(&scene()));
    let mut hand = look(page.address());
    page.wait();
    send(
        &mut hand,
        &json!({ "op": "advertise", "channels": [{ "id": 3, "topic": "/robot1/keys", "encoding": "json" }] }),
    );
    let press = |hand: &mut WebSocket<TcpStream>, text: &str| {
        hand.send(Frame::binary([&[1, 3, 0, 0, 0][..], text.as_bytes()].concat())).unwrap();
    };
    press(&mut hand, r#"{"key": 5}"#);
    let refused = operation(&mut hand, "status")["message"].as_str().unwrap().to_owned();
    assert!(refused.contains("a number from 1 to 4"), "{refused}");
    press(&mut hand, r#"{"key": 2}"#);
    let mut robot = simulation.robot(0).unwrap();
    let pressed = (0..1000).find_map(|_| {
        robot.wait(0.02).unwrap();
        thread::sleep(Duration::from_millis(2));
        robot.read_key().unwrap()
    });
    assert_eq!(pressed, Some(Key::Key2));
}

#[test]
fn strangers_are_refused() {
    let page = beside();
    let address = page.address();
    let own = address.rsplitn(3, '/').last().unwrap();
    let protocol = ("Sec-WebSocket-Protocol", PROTOCOL);
    for origin in ["https://evil.example", "http://127.0.0.1:1", "null"] {
        assert_eq!(try_join(address, &[protocol, ("Origin", origin)]).unwrap_err(), 403, "{origin}");
    }
    assert_eq!(try_join(&format!("{own}/"), &[protocol]).unwrap_err(), 403);
    assert_eq!(try_join(&format!("{own}/{}/", "0".repeat(32)), &[protocol]).unwrap_err(), 403);
    assert_eq!(try_join(address, &[protocol, ("Host", "rebound.example")]).unwrap_err(), 403);
    assert_eq!(try_join(address, &[("Sec-WebSocket-Protocol", "mqtt")]).unwrap_err(), 400);
    assert!(try_join(address, &[protocol, ("Origin", own)]).is_ok());
    assert!(try_join(address.trim_end_matches('/'), &[]).is_ok(), "a viewer");
    let get = |path: &str| {
        let mut stream = TcpStream::connect(own.trim_start_matches("http://")).unwrap();
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {}\r\n\r\n", own.trim_start_matches("http://")).unwrap();
        let mut text = String::new();
        match stream.read_to_string(&mut text) {
            Err(error) if error.kind() != ErrorKind::ConnectionReset => panic!("{error}"),
            _ => text,
        }
    };
    let path = address.strip_prefix(own).unwrap();
    assert!(
        get("/").starts_with("HTTP/1.1 403") && get(&format!("{path}../secret")).starts_with("HTTP/1.1 404")
    );
    assert!(get(path).contains("<title>") && get(&format!("{path}main.js")).contains("import "));
    assert!(Beside::open(&Opening { port: port_of(own), command: String::new() }).is_err(), "it is taken");
}

#[test]
fn who_dawdles_over_a_request_holds_a_place_for_seconds() {
    let page = beside();
    let place = page.address().split('/').nth(2).unwrap().to_owned();
    let open = || TcpStream::connect(&place).unwrap();
    let said = |mut stream: TcpStream| {
        let mut text = String::new();
        match stream.read_to_string(&mut text) {
            Err(error) if error.kind() != ErrorKind::ConnectionReset => panic!("{error}"),
            _ => text,
        }
    };
    let silent: Vec<TcpStream> = (0..31).map(|_| open()).collect();
    let mut dripping = open();
    dripping.write_all(b"G").unwrap();
    let refused = said(open());
    assert!(refused.starts_with("HTTP/1.1 503"), "{refused}");
    let drips = (0..40).take_while(|_| {
        thread::sleep(Duration::from_millis(500));
        dripping.write_all(b"E").is_ok()
    });
    let drips = drips.count();
    assert!((6..30).contains(&drips), "{drips} drips of half a second each");
    for stream in silent {
        assert_eq!(said(stream), "");
    }
    assert!(try_join(page.address(), &[("Sec-WebSocket-Protocol", PROTOCOL)]).is_ok(), "there is room again");
}

fn port_of(own: &str) -> u16 {
    own.rsplit(':').next().unwrap().parse().unwrap()
}

#[test]
fn recordings_are_played_in_time_for_viewers_and_at_once_for_the_page() {
    let scene = scene();
    let writer = LogWriter::new(Vec::new(), &Header::new("circle", ["--seed=1"])).unwrap();
    writer.show(&scene);
    let mut robot =
        writer.recorder(Simulation::new(&scene, SimOptions::default()).unwrap().robot(0).unwrap(), 0);
    robot.set_speed(Twist::new(0.2, 0.0)).unwrap();
    for _ in 0..10 {
        robot.wait(0.1).unwrap();
        robot.pose().unwrap();
    }
    drop(robot);
    let log = Log::read(writer.finish().unwrap()).unwrap();
    let player = Player::open(&log, &Opening::default()).unwrap();

    let mut page = look(player.address());
    let mut kinds = Vec::new();
    let mut last = Vec::new();
    while kinds.last() != Some(&(Message::Ended as u8)) {
        if let Frame::Binary(data) = page.read().unwrap() {
            kinds.push(data[13]);
            if data[13] == Message::Frame as u8 {
                last = data[14..].to_vec();
            }
        }
    }
    let frames = kinds.iter().filter(|kind| **kind == Message::Frame as u8).count();
    assert!((26..=28).contains(&frames), "{frames} frames of 40 ms in a second");
    let x = f32::from_le_bytes(last[16..20].try_into().unwrap());
    assert!((x - 0.65).abs() < 0.02, "{x} m");

    let mut viewer = join(player.address());
    let known = channels(&mut viewer, "/robot1/odometry");
    let id = known.iter().find(|(topic, _)| topic == "/robot1/odometry").unwrap().1;
    send(&mut viewer, &json!({ "op": "subscribe", "subscriptions": [{ "id": 1, "channelId": id }] }));
    let mut times = Vec::new();
    while times.len() < 10 {
        if let Frame::Binary(data) = viewer.read().unwrap()
            && data[0] == 1
        {
            times.push(u64::from_le_bytes(data[5..13].try_into().unwrap()) / 10_000_000);
        }
    }
    assert_eq!(times, (1..=10).map(|tenth| 10 * tenth).collect::<Vec<_>>());
}
