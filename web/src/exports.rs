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

/// The job in the room. From now on, panics are reported.
fn job() -> Result<Job, String> {
    std::panic::set_hook(Box::new(|panic| say(Message::Panicked, panic.to_string().as_bytes())));
    Job::parse(&text(), FILES.with_borrow(Clone::clone))
}

/// The text in the room.
fn text() -> String {
    String::from_utf8_lossy(&ROOM.take()).into_owned()
}

/// Functions of the module with the commands.
#[cfg(not(feature = "programs"))]
mod commands {
    use super::{job, say};
    use crate::Message;

    /// Sends the commands and their options.
    #[unsafe(no_mangle)]
    extern "C" fn options() {
        say(Message::Options, roverlab_cli::options().as_bytes());
    }

    /// Runs the job in the room to its end.
    #[unsafe(no_mangle)]
    extern "C" fn run() {
        match job() {
            Ok(job) => crate::run(job, say),
            Err(error) => say(Message::Panicked, error.as_bytes()),
        }
    }
}

/// Functions of the module for programs, beside those of RoBIOS.
#[cfg(feature = "programs")]
mod programs {
    use std::cell::RefCell;

    use super::{job, say, text};
    use crate::Message;
    use crate::program::Program;

    thread_local! {
        static PROGRAM: RefCell<Option<Program>> = const { RefCell::new(None) };
    }

    /// Gives the program of the job in the room its robot. Returns 1 if it cannot run.
    #[unsafe(no_mangle)]
    extern "C" fn begin() -> u32 {
        match job().and_then(|job| Program::begin(job, say)) {
            Ok(program) => {
                PROGRAM.set(Some(program));
                0
            }
            Err(error) => {
                say(Message::Panicked, error.as_bytes());
                1
            }
        }
    }

    /// Shows the line in the room, which the program has printed.
    #[unsafe(no_mangle)]
    extern "C" fn printed() {
        let line = text();
        PROGRAM.with_borrow(|program| program.iter().for_each(|program| program.printed(&line)));
    }

    /// Ends the run of a program with an exit status; the room has its last words.
    #[unsafe(no_mangle)]
    extern "C" fn finish(status: i32) {
        let words = text();
        if let Some(program) = PROGRAM.take() {
            program.finish(status, &words);
        }
    }

    /// Allocates memory of the program's for a call of RoBIOS.
    #[unsafe(no_mangle)]
    extern "C" fn take(length: usize) -> *mut u64 {
        // In whole words, so that numbers of any kind are aligned.
        Box::into_raw(vec![0_u64; length.div_ceil(8).max(1)].into_boxed_slice()).cast()
    }

    /// Frees memory that was taken with this length.
    #[unsafe(no_mangle)]
    extern "C" fn give_back(start: *mut u64, length: usize) {
        let words = std::ptr::slice_from_raw_parts_mut(start, length.div_ceil(8).max(1));
        // SAFETY: the page gives back what it has taken, once.
        drop(unsafe { Box::from_raw(words) });
    }
}
