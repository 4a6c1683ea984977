use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use tungstenite::http::StatusCode;
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Message, WebSocket};

use super::hub::Hub;
use super::outbox::{Outbox, deadline, now};
use super::protocol::{self, Wish};
use super::request::{self, Answer};

/// Options of a server.
#[derive(Debug, Clone, Default)]
pub struct Opening {
    /// Its port; a free one if 0.
    pub port: u16,
    /// The command line that runs.
    pub command: String,
}

/// Serves the page and the channels of a hub until it is dropped.
#[derive(Debug)]
pub(super) struct Server {
    pub(super) hub: Arc<Hub>,
    address: String,
    port: u16,
    over: Arc<AtomicBool>,
}

/// Maximum number of connections at the same time.
const MOST_CONNECTIONS: usize = 32;
/// Maximum size of a client's message (bytes).
const LONGEST: usize = 1 << 16;
/// Time for a request to arrive, and for its answer to be taken.
const PATIENCE: Duration = Duration::from_secs(5);
/// Time for the last messages of a run to be taken.
const LAST_PATIENCE: Duration = Duration::from_secs(10);

impl Server {
    /// Listens on the loopback interface. Fails if the port is taken.
    pub(super) fn open(opening: &Opening) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, opening.port))?;
        let port = listener.local_addr()?.port();
        let (token, session) = (random()?, random()?);
        let address = format!("http://127.0.0.1:{port}/{token}/");
        let hub = Arc::new(Hub::new(format!("roverlab {}", opening.command), session));
        let over = Arc::new(AtomicBool::new(false));
        let desk = Arc::new(Desk { hub: Arc::clone(&hub), token, port, connections: AtomicUsize::new(0) });
        let is_over = Arc::clone(&over);
        thread::Builder::new().name("view".into()).spawn(move || {
            for stream in listener.incoming().flatten() {
                if is_over.load(Ordering::Relaxed) {
                    return;
                }
                desk.take(stream);
            }
        })?;
        Ok(Self { hub, address, port, over })
    }

    /// Address of the page.
    pub(super) fn address(&self) -> &str {
        &self.address
    }

    /// Ends all connections once everything has been sent.
    pub(super) fn finish(&self) {
        self.hub.finish(LAST_PATIENCE);
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        self.hub.finish(Duration::ZERO);
        // Wakes the thread that waits for connections.
        let _ = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port));
    }
}

/// 128 random bits in hexadecimal.
fn random() -> io::Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(io::Error::other)?;
    Ok(data_encoding::HEXLOWER.encode(&bytes))
}

/// Attends to connections.
#[derive(Debug)]
struct Desk {
    hub: Arc<Hub>,
    token: String,
    port: u16,
    connections: AtomicUsize,
}

impl Desk {
    /// Attends to a connection in a thread of its own.
    fn take(self: &Arc<Self>, mut stream: TcpStream) {
        if self.connections.fetch_add(1, Ordering::Relaxed) >= MOST_CONNECTIONS {
            let why = format!("found {MOST_CONNECTIONS} connections; expected fewer");
            let _ = request::write(&mut stream, &request::refused(StatusCode::SERVICE_UNAVAILABLE, why));
            self.connections.fetch_sub(1, Ordering::Relaxed);
            return;
        }
        let desk = Arc::clone(self);
        let attend = move || {
            // A connection that breaks has no consequence.
            let _ = desk.attend(&stream);
            desk.connections.fetch_sub(1, Ordering::Relaxed);
        };
        if thread::Builder::new().name("viewer".into()).spawn(attend).is_err() {
            self.connections.fetch_sub(1, Ordering::Relaxed);
        }
    }

    fn attend(&self, stream: &TcpStream) -> io::Result<()> {
        stream.set_nodelay(true)?;
        let mut hasty = Hasty { stream, end: deadline(PATIENCE) };
        let Some((request, rest)) = request::read(&mut hasty)? else {
            let why = "expected a request of a browser".into();
            return request::write(&mut hasty, &request::refused(StatusCode::BAD_REQUEST, why));
        };
        let answer = request::answer(&request, &self.token, self.port);
        hasty.end = deadline(PATIENCE);
        request::write(&mut hasty, &answer)?;
        if !matches!(answer, Answer::Upgrade(_)) {
            return stream.shutdown(Shutdown::Write);
        }
        stream.set_read_timeout(None)?;
        stream.set_write_timeout(None)?;
        self.talk(stream, rest)
    }

    /// Speaks the protocol with a client until either side ends it.
    fn talk(&self, stream: &TcpStream, rest: Vec<u8>) -> io::Result<()> {
        let outbox = Outbox::default();
        let (out, frames) = (stream.try_clone()?, outbox.clone());
        let client = self.hub.join(&outbox);
        let writer = thread::Builder::new().name("viewer".into()).spawn(move || send(out, &frames));
        if writer.is_ok() {
            self.listen(stream, rest, client, &outbox);
        }
        self.hub.leave(client);
        outbox.abandon();
        stream.shutdown(Shutdown::Both)
    }

    fn listen(&self, stream: &TcpStream, rest: Vec<u8>, client: u64, outbox: &Outbox) {
        let config = WebSocketConfig::default().max_message_size(Some(LONGEST)).max_frame_size(Some(LONGEST));
        let ends = Ends { stream, outbox };
        let mut socket = WebSocket::from_partially_read(ends, rest, Role::Server, Some(config));
        while let Ok(message) = socket.read() {
            let wish = match &message {
                Message::Text(text) => Wish::of_text(text),
                Message::Binary(data) => Wish::of_data(data),
                _ => continue,
            };
            if let Err(wrong) = wish.and_then(|wish| self.hub.heed(client, wish)) {
                outbox.push(protocol::status(&wrong), true);
            }
        }
    }
}

/// Sends what is in an outbox.
fn send(mut stream: TcpStream, outbox: &Outbox) {
    while let Some(frame) = outbox.next() {
        if stream.write_all(&frame).is_err() {
            outbox.abandon();
        }
    }
    let _ = stream.shutdown(Shutdown::Both);
}

/// A connection until a time, however few bytes come at once.
struct Hasty<'a> {
    stream: &'a TcpStream,
    end: Instant,
}

impl Hasty<'_> {
    fn left(&self) -> io::Result<Duration> {
        let left = self.end.saturating_duration_since(now());
        if left.is_zero() { Err(io::ErrorKind::TimedOut.into()) } else { Ok(left) }
    }
}

impl Read for Hasty<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        self.stream.set_read_timeout(Some(self.left()?))?;
        (&*self.stream).read(out)
    }
}

impl Write for Hasty<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(Some(self.left()?))?;
        (&*self.stream).write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The reading end of a connection. Answers to pings are queued with all other messages.
struct Ends<'a> {
    stream: &'a TcpStream,
    outbox: &'a Outbox,
}

impl Read for Ends<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        (&*self.stream).read(out)
    }
}

impl Write for Ends<'_> {
    fn write(&mut self, frame: &[u8]) -> io::Result<usize> {
        self.outbox.push(frame.to_vec(), false);
        Ok(frame.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
