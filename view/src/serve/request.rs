//! Requests of browsers and viewers, and their answers.

use std::io::{self, Read, Write};

use tungstenite::handshake::machine::TryParse;
use tungstenite::handshake::server::{Request, Response, create_response, write_response};
use tungstenite::http::{HeaderValue, StatusCode};

use super::{pages, protocol};

/// Maximum length of a request (bytes).
const LONGEST: usize = 1 << 14;

/// Origins of viewers that are installed; a browser sends that of the site whose page connects.
const INSTALLED: [&str; 1] = ["file://"];

/// A request's answer.
#[derive(Debug)]
pub(super) enum Answer {
    /// The connection becomes a WebSocket, after this response.
    Upgrade(Response),
    File {
        kind: &'static str,
        text: String,
    },
    Refusal(StatusCode, String),
}

/// Reads a request, up to its empty line. Returns it and the bytes after it; `None` if it is none that is
/// answered here.
pub(super) fn read(stream: &mut impl Read) -> io::Result<Option<(Request, Vec<u8>)>> {
    let (mut bytes, mut part) = (Vec::new(), [0; 1024]);
    while bytes.len() < LONGEST {
        let length = stream.read(&mut part)?;
        if length == 0 {
            return Ok(None);
        }
        bytes.extend_from_slice(&part[..length]);
        match Request::try_parse(&bytes) {
            Ok(Some((end, request))) => return Ok(Some((request, bytes.split_off(end)))),
            Ok(None) => {}
            Err(_) => return Ok(None),
        }
    }
    Ok(None)
}

/// Decides on a request to the server of a token at a port.
pub(super) fn answer(request: &Request, token: &str, port: u16) -> Answer {
    let header = |name: &str| request.headers().get(name).and_then(|value| value.to_str().ok());
    let own = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{port}"));
    // Otherwise a site could make its name mean this machine.
    if !header("Host").is_some_and(|host| own.iter().any(|name| name.eq_ignore_ascii_case(host))) {
        return refused(StatusCode::FORBIDDEN, format!("expected the host {}", own[0]));
    }
    if let Some(origin) = header("Origin") {
        let site = origin.strip_prefix("http://").unwrap_or_default();
        if !own.iter().any(|name| name == site) && !INSTALLED.contains(&origin) {
            return refused(
                StatusCode::FORBIDDEN,
                format!("found the origin {origin}; expected http://{}", own[0]),
            );
        }
    }
    let path = request.uri().path();
    let Some(name) = path.strip_prefix('/').and_then(|path| path.strip_prefix(token)) else {
        return refused(StatusCode::FORBIDDEN, "expected the address that the program has printed".into());
    };
    if header("Upgrade").is_some_and(|what| what.eq_ignore_ascii_case("websocket")) {
        return upgrade(request, name, header("Sec-WebSocket-Protocol"));
    }
    match name.strip_prefix('/').and_then(pages::file) {
        Some((kind, text)) => Answer::File { kind, text },
        None => refused(
            StatusCode::NOT_FOUND,
            format!("no file {name}; expected the page, at a / behind the token"),
        ),
    }
}

fn upgrade(request: &Request, name: &str, offered: Option<&str>) -> Answer {
    if !matches!(name, "" | "/") {
        return refused(StatusCode::NOT_FOUND, format!("no WebSocket {name}"));
    }
    let spoken = |offered: &str| {
        let mut names = offered.split(',').map(str::trim);
        names.find_map(|name| protocol::NAMES.into_iter().find(|known| *known == name))
    };
    let protocol = match offered.map(|offered| (offered, spoken(offered))) {
        Some((offered, None)) => {
            let expected = protocol::NAMES.join(" or ");
            return refused(
                StatusCode::BAD_REQUEST,
                format!("found the protocols {offered}; expected {expected}"),
            );
        }
        found => found.and_then(|(_, name)| name),
    };
    match create_response(request) {
        Ok(mut response) => {
            if let Some(name) = protocol {
                response.headers_mut().insert("Sec-WebSocket-Protocol", HeaderValue::from_static(name));
            }
            Answer::Upgrade(response)
        }
        Err(error) => refused(StatusCode::BAD_REQUEST, error.to_string()),
    }
}

pub(super) fn refused(status: StatusCode, why: String) -> Answer {
    Answer::Refusal(status, why)
}

/// Writes an answer.
pub(super) fn write(out: &mut impl Write, answer: &Answer) -> io::Result<()> {
    let (status, kind, text) = match answer {
        Answer::Upgrade(response) => {
            return write_response(&mut *out, response).map_err(io::Error::other).and_then(|()| out.flush());
        }
        Answer::File { kind, text } => (StatusCode::OK, *kind, text),
        Answer::Refusal(status, why) => (*status, "text/plain", why),
    };
    let length = text.len();
    write!(
        out,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {length}\r\n\
         Cache-Control: no-store\r\nReferrer-Policy: no-referrer\r\nX-Content-Type-Options: nosniff\r\n\
         Connection: close\r\n\r\n{text}"
    )?;
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answered(lines: &[&str]) -> Answer {
        let mut text: &[u8] = &(lines.join("\r\n") + "\r\n\r\n").into_bytes();
        let (request, rest) = read(&mut text).unwrap().unwrap();
        assert!(rest.is_empty());
        answer(&request, "secret", 80)
    }

    #[test]
    fn strangers_are_refused() {
        let page = ["GET /secret/ HTTP/1.1", "Host: localhost:80"];
        assert!(matches!(answered(&page), Answer::File { kind: "text/html", .. }));
        let cases: [&[&str]; 6] = [
            &["GET / HTTP/1.1", "Host: localhost:80"],
            &["GET /secre/ HTTP/1.1", "Host: localhost:80"],
            &["GET /secretive/ HTTP/1.1", "Host: localhost:80"],
            &["GET /secret/ HTTP/1.1", "Host: rebound.example:80"],
            &["GET /secret/ HTTP/1.1"],
            &["GET /secret/ HTTP/1.1", "Host: localhost:80", "Origin: https://evil.example"],
        ];
        for lines in cases {
            assert!(matches!(answered(lines), Answer::Refusal(..)), "{lines:?}");
        }
        let mut garbage: &[u8] = b"\x16\x03\x01\x02\x00";
        assert!(read(&mut garbage).unwrap().is_none());
        assert!(read(&mut io::repeat(b'a')).unwrap().is_none());
    }
}
