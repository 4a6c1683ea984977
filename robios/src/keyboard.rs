//! Soft keys typed by the user: the runner reads its standard input and forwards it through a socket.

use std::collections::VecDeque;
use std::io::{self, Read};
use std::os::unix::net::UnixStream;

use crate::keys::{KEYS, Typed};

/// Receiving end of the socket: the digits 1 to 4 stand for the soft keys. Everything else is ignored.
#[derive(Debug)]
pub struct Keyboard {
    stream: UnixStream,
    typed: VecDeque<u32>,
}

impl Keyboard {
    /// Reads the keys typed at the other end of a socket. Fails if the socket does.
    pub fn new(stream: UnixStream) -> io::Result<Self> {
        stream.set_nonblocking(true)?;
        Ok(Self { stream, typed: VecDeque::new() })
    }
}

impl Typed for Keyboard {
    fn next(&mut self) -> Option<u32> {
        let mut bytes = [0; 64];
        if let Ok(count) = self.stream.read(&mut bytes) {
            let numbers = bytes[..count].iter().filter_map(|byte| byte.checked_sub(b'1'));
            self.typed.extend(numbers.filter_map(|number| KEYS.get(usize::from(number))));
        }
        self.typed.pop_front()
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn digits_are_keys() {
        let (mut theirs, ours) = UnixStream::pair().unwrap();
        let mut keyboard = Keyboard::new(ours).unwrap();
        assert_eq!(keyboard.next(), None);
        theirs.write_all(b"1\n40x2\n").unwrap();
        assert_eq!([(); 4].map(|()| keyboard.next()), [Some(1), Some(8), Some(2), None]);
    }
}
