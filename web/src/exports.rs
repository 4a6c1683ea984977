//! Functions that the page calls, and its callbacks. A text or a file is placed in memory from [`room`].
#![allow(unsafe_code, reason = "the page and the module share memory")]

use std::cell::RefCell;
use std::collections::BTreeMap;

use crate::{Job, Message};

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Receives a message: its kind and its bytes.
    fn tell(message: u32, start: *const u8, length: usize);
}

thread_local! {
    static ROOM: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static FILES: RefCell<BTreeMap<String, Vec<u8>>> = const { RefCell::new(BTreeMap::new()) };
}

fn say(message: Message, bytes: &[u8]) {
    // SAFETY: the page reads the bytes before it returns and does not keep them.
    unsafe { tell(message as u32, bytes.as_ptr(), bytes.len()) }
}

/// Allocates room for `length` bytes. Previous content is lost.
#[unsafe(no_mangle)]
extern "C" fn room(length: usize) -> *mut u8 {
    ROOM.with_borrow_mut(|room| {
        room.clear();
        room.resize(length, 0);
        room.as_mut_ptr()
    })
}

/// Takes a file opened in the page from the room: its name, a line feed, and its bytes.
#[unsafe(no_mangle)]
extern "C" fn open_file() {
    let room = ROOM.take();
    let end = room.iter().position(|&byte| byte == b'\n').unwrap_or(room.len());
    let name = String::from_utf8_lossy(&room[..end]).into_owned();
    let bytes = room.get(end + 1..).unwrap_or_default().to_vec();
    FILES.with_borrow_mut(|files| files.insert(name, bytes));
}

/// Sends the commands and their options.
#[unsafe(no_mangle)]
extern "C" fn options() {
    say(Message::Options, roverlab_cli::options().as_bytes());
}

/// Runs the job in the room to its end.
#[unsafe(no_mangle)]
extern "C" fn run() {
    std::panic::set_hook(Box::new(|panic| say(Message::Panicked, panic.to_string().as_bytes())));
    let text = String::from_utf8_lossy(&ROOM.take()).into_owned();
    match Job::parse(&text, FILES.with_borrow(Clone::clone)) {
        Ok(job) => crate::run(job, say),
        Err(error) => say(Message::Panicked, error.as_bytes()),
    }
}
