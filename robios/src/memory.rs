//! Memory shared by a program and the runner. The program keeps no descriptor of it open, so it can neither
//! close its report nor its connection to the world.

#![allow(unsafe_code)]

use std::io;
use std::os::fd::{AsRawFd, FromRawFd, OwnedFd, RawFd};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use crate::wire::LONGEST;

/// Size of the report (bytes).
pub const REPORT: usize = 1 << 17;
/// Offset of the report.
const REPORT_START: usize = 4096;
/// Offset of requests and replies.
const FRAME_START: usize = REPORT_START + REPORT;
const SIZE: usize = FRAME_START + LONGEST;
/// Identifies the memory.
const MAGIC: u32 = 0x0b10_5007;

/// Words at the beginning.
#[derive(Debug, Clone, Copy)]
enum Word {
    Magic,
    /// Whose turn it is; see [`Turn`].
    Turn,
    /// Size of the request or the reply (bytes).
    Length,
    /// Whether a process forked by the program has made a call.
    Forked,
    /// 1, with the program's exit status as of `waitpid` in the bits above.
    Status,
}

/// What happened last.
const IDLE: u32 = 0;
const QUESTION: u32 = 1;
const ANSWER: u32 = 2;
/// The program has no more requests.
const LEFT: u32 = 3;

/// The shared memory.
#[derive(Debug)]
pub struct Memory {
    start: *mut u32,
}

// SAFETY: the mapping is private to this handle and lives as long; words are atomic, and the turn decides who
// accesses the bytes behind them.
unsafe impl Send for Memory {}
// SAFETY: as above.
unsafe impl Sync for Memory {}

impl Drop for Memory {
    fn drop(&mut self) {
        // SAFETY: it was mapped with this size, and nothing refers to it any more.
        unsafe { libc::munmap(self.start.cast(), SIZE) };
    }
}

/// Result of waiting for a program's request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Asked {
    /// A request.
    Question(Vec<u8>),
    /// An oversized request, with its length.
    TooLong(usize),
    /// Nothing yet.
    Nothing,
    /// No more requests will come.
    Left,
}

impl Memory {
    /// Creates memory, and the descriptor by which a started program inherits it. Fails if the system does.
    pub fn create() -> io::Result<(Self, OwnedFd)> {
        let file = anonymous_file()?;
        let memory = Self::map(file.as_raw_fd())?;
        memory.word(Word::Magic).store(MAGIC, Ordering::Release);
        Ok((memory, file))
    }

    /// Maps the memory left open by the parent process under a descriptor, and closes that. Fails for any
    /// other descriptor.
    pub fn inherit(number: RawFd) -> io::Result<Self> {
        let refused = || io::Error::new(io::ErrorKind::InvalidInput, "not the memory of a runner");
        // SAFETY: an all-zero record of this type is valid, and the kernel fills it.
        let mut state: libc::stat = unsafe { std::mem::zeroed() };
        // SAFETY: the kernel checks the descriptor and writes to a record that outlives the call.
        let known = number > 2 && unsafe { libc::fstat(number, &raw mut state) } == 0;
        if !known || state.st_size != SIZE as i64 {
            return Err(refused());
        }
        let memory = Self::map(number)?;
        if memory.word(Word::Magic).load(Ordering::Acquire) != MAGIC {
            return Err(refused());
        }
        // SAFETY: the descriptor is open and was left to this library, which no longer needs it.
        drop(unsafe { OwnedFd::from_raw_fd(number) });
        Ok(memory)
    }

    fn map(file: RawFd) -> io::Result<Self> {
        let rights = libc::PROT_READ | libc::PROT_WRITE;
        // SAFETY: requests a new mapping; the kernel checks the arguments.
        let start = unsafe { libc::mmap(std::ptr::null_mut(), SIZE, rights, libc::MAP_SHARED, file, 0) };
        if start == libc::MAP_FAILED {
            return Err(io::Error::last_os_error());
        }
        Ok(Self { start: start.cast() })
    }

    fn word(&self, word: Word) -> &AtomicU32 {
        // SAFETY: the offset is a multiple of four below the size, and words are only accessed atomically.
        unsafe { AtomicU32::from_ptr(self.start.add(16 * word as usize)) }
    }

    fn write(&self, at: usize, bytes: &[u8]) {
        let room = SIZE.saturating_sub(at).min(bytes.len());
        // SAFETY: the target range lies within the memory, and the source does not.
        unsafe { std::ptr::copy_nonoverlapping(bytes.as_ptr(), self.start.cast::<u8>().add(at), room) };
    }

    fn read(&self, at: usize, length: usize) -> Vec<u8> {
        let mut bytes = vec![0; SIZE.saturating_sub(at).min(length)];
        let (length, target) = (bytes.len(), bytes.as_mut_ptr());
        // SAFETY: as for `write`.
        unsafe { std::ptr::copy_nonoverlapping(self.start.cast::<u8>().add(at), target, length) };
        bytes
    }

    /// Writes a part of the report.
    pub fn write_report(&self, at: usize, bytes: &[u8]) {
        let room = REPORT.saturating_sub(at).min(bytes.len());
        self.write(REPORT_START + at, &bytes[..room]);
    }

    /// The report.
    pub fn report(&self) -> Vec<u8> {
        self.read(REPORT_START, REPORT)
    }

    /// Records that a process forked by the program has made a call.
    pub fn note_fork(&self) {
        self.word(Word::Forked).store(1, Ordering::Relaxed);
    }

    /// Whether a forked process has made a call.
    pub fn has_forked(&self) -> bool {
        self.word(Word::Forked).load(Ordering::Relaxed) != 0
    }

    /// Records the program's exit status.
    pub fn note_status(&self, status: i32) {
        self.word(Word::Status).store((status as u32) << 8 | 1, Ordering::Release);
    }

    /// Whether the program's exit status is known.
    pub fn has_status(&self) -> bool {
        self.word(Word::Status).load(Ordering::Acquire) & 1 != 0
    }

    /// Sends a request to the world and returns its reply.
    pub fn ask(&self, question: &[u8]) -> Vec<u8> {
        self.put(question);
        self.say(QUESTION);
        while self.word(Word::Turn).load(Ordering::Acquire) == QUESTION {
            wait(self.word(Word::Turn), QUESTION, Duration::from_secs(1));
        }
        self.frame(LONGEST)
    }

    /// Announces that there will be no more requests.
    pub fn leave(&self) {
        self.say(LEFT);
    }

    /// The next request, after waiting for at most `patience`.
    pub fn asked(&self, longest: usize, patience: Duration) -> Asked {
        let turn = self.word(Word::Turn);
        let mut now = turn.load(Ordering::Acquire);
        if now == IDLE || now == ANSWER {
            wait(turn, now, patience);
            now = turn.load(Ordering::Acquire);
        }
        match now {
            QUESTION => {
                let length = self.word(Word::Length).load(Ordering::Relaxed) as usize;
                if length > longest { Asked::TooLong(length) } else { Asked::Question(self.frame(longest)) }
            }
            LEFT => Asked::Left,
            _ => Asked::Nothing,
        }
    }

    /// Whether there is a request, or the program has left, after waiting for at most `patience`.
    pub fn is_asked(&self, patience: Duration) -> bool {
        let turn = self.word(Word::Turn);
        let now = turn.load(Ordering::Acquire);
        if now == ANSWER || now == IDLE {
            wait(turn, now, patience);
        }
        matches!(turn.load(Ordering::Acquire), QUESTION | LEFT)
    }

    /// Sends a reply.
    pub fn answer(&self, answer: &[u8]) {
        self.put(answer);
        self.say(ANSWER);
    }

    fn put(&self, frame: &[u8]) {
        self.write(FRAME_START, frame);
        self.word(Word::Length).store(frame.len() as u32, Ordering::Relaxed);
    }

    fn frame(&self, longest: usize) -> Vec<u8> {
        let length = self.word(Word::Length).load(Ordering::Relaxed) as usize;
        self.read(FRAME_START, length.min(longest))
    }

    fn say(&self, turn: u32) {
        self.word(Word::Turn).store(turn, Ordering::Release);
        wake(self.word(Word::Turn));
    }
}

/// An anonymous file of the right size.
#[cfg(target_os = "linux")]
fn anonymous_file() -> io::Result<OwnedFd> {
    let flags = libc::MFD_CLOEXEC | libc::MFD_ALLOW_SEALING;
    // SAFETY: the name ends with a zero byte.
    let number = unsafe { libc::memfd_create(c"robios".as_ptr(), flags) };
    if number < 0 {
        return Err(io::Error::last_os_error());
    }
    // SAFETY: the descriptor is new and has no other owner.
    let file = unsafe { OwnedFd::from_raw_fd(number) };
    let seals = libc::F_SEAL_SHRINK | libc::F_SEAL_GROW | libc::F_SEAL_SEAL;
    // A program cannot truncate what the runner reads.
    // SAFETY: changes the size of a file and seals it.
    if unsafe {
        libc::ftruncate(number, SIZE as i64) != 0 || libc::fcntl(number, libc::F_ADD_SEALS, seals) != 0
    } {
        return Err(io::Error::last_os_error());
    }
    Ok(file)
}

#[cfg(not(target_os = "linux"))]
fn anonymous_file() -> io::Result<OwnedFd> {
    use std::sync::atomic::AtomicUsize;
    static FILES: AtomicUsize = AtomicUsize::new(0);
    let name = format!("robios-memory-{}-{}", std::process::id(), FILES.fetch_add(1, Ordering::Relaxed));
    let path = std::env::temp_dir().join(name);
    let file = std::fs::OpenOptions::new().read(true).write(true).create_new(true).open(&path)?;
    std::fs::remove_file(&path)?;
    file.set_len(SIZE as u64)?;
    Ok(file.into())
}

/// Waits until a word may no longer have a value, or the patience is exhausted.
#[cfg(target_os = "linux")]
pub(crate) fn wait(word: &AtomicU32, value: u32, patience: Duration) {
    let time = libc::timespec {
        tv_sec: patience.as_secs() as libc::time_t,
        tv_nsec: libc::c_long::from(patience.subsec_nanos() as i32),
    };
    let nothing = std::ptr::null::<u32>();
    // SAFETY: the kernel compares a word of mapped memory, and reads a time that outlives the call.
    unsafe {
        libc::syscall(libc::SYS_futex, word.as_ptr(), libc::FUTEX_WAIT, value, &raw const time, nothing, 0)
    };
}

/// Wakes those that wait for a word.
#[cfg(target_os = "linux")]
pub(crate) fn wake(word: &AtomicU32) {
    // SAFETY: the kernel wakes those that wait for a word of mapped memory.
    unsafe { libc::syscall(libc::SYS_futex, word.as_ptr(), libc::FUTEX_WAKE, i32::MAX) };
}

/// Where the system cannot wait for a word, sleeps briefly.
#[cfg(not(target_os = "linux"))]
pub(crate) fn wait(_: &AtomicU32, _: u32, patience: Duration) {
    std::thread::sleep(patience.min(Duration::from_micros(50)));
}

/// They wake up by themselves.
#[cfg(not(target_os = "linux"))]
pub(crate) fn wake(_: &AtomicU32) {}

#[cfg(test)]
mod tests {
    use std::os::fd::IntoRawFd;

    use super::*;

    #[test]
    fn questions_and_answers_cross_it() {
        let (ours, file) = Memory::create().unwrap();
        let theirs = Memory::inherit(file.into_raw_fd()).unwrap();
        assert_eq!(ours.asked(100, Duration::ZERO), Asked::Nothing);
        std::thread::scope(|scope| {
            let program = scope.spawn(|| {
                for i in 0..1000_u32 {
                    assert_eq!(theirs.ask(&i.to_le_bytes()), (i + 1).to_le_bytes());
                }
                theirs.leave();
            });
            loop {
                match ours.asked(100, Duration::from_secs(10)) {
                    Asked::Question(bytes) => {
                        let number = u32::from_le_bytes(bytes.try_into().unwrap());
                        ours.answer(&(number + 1).to_le_bytes());
                    }
                    Asked::Left => break,
                    other => panic!("{other:?}"),
                }
            }
            program.join().unwrap();
        });
        theirs.write_report(REPORT - 2, b"abcd");
        assert_eq!(ours.report()[REPORT - 2..], *b"ab", "what is behind it is left alone");
    }

    #[test]
    fn no_length_is_believed_and_no_stranger_accepted() {
        let (ours, file) = Memory::create().unwrap();
        ours.word(Word::Length).store(u32::MAX, Ordering::Relaxed);
        ours.word(Word::Turn).store(QUESTION, Ordering::Relaxed);
        assert_eq!(ours.asked(100, Duration::ZERO), Asked::TooLong(u32::MAX as usize));
        drop(file);
        assert!(Memory::inherit(-1).is_err());
        let other = std::fs::File::open("/dev/null").unwrap();
        assert!(Memory::inherit(other.as_raw_fd()).is_err());
    }
}
