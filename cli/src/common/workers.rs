use std::num::NonZero;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::{Failure, Progress};

/// Number of working threads: the requested one, or one per core.
pub(crate) fn threads(asked: Option<NonZero<usize>>) -> usize {
    let cores = || std::thread::available_parallelism().map_or(1, NonZero::get);
    asked.map_or_else(cores, NonZero::get)
}

/// Results of `count` pieces of work in order, done by several threads whose number does not affect them.
/// Ends at the first failure. `things` names the pieces in the progress line.
pub(crate) fn share_out<T: Send>(
    things: &str,
    count: u64,
    threads: usize,
    work: impl Fn(u64) -> Result<T, Failure> + Sync,
) -> Result<Vec<T>, Failure> {
    let (next, done, failed) = (AtomicU64::new(0), AtomicU64::new(0), AtomicBool::new(false));
    let results = Mutex::new(Vec::new());
    let drive = |mut told: Box<dyn FnMut(u64) + '_>| {
        while !failed.load(Ordering::Relaxed) {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return;
            }
            let result = work(index);
            failed.fetch_or(result.is_err(), Ordering::Relaxed);
            results.lock().expect("no thread has panicked").push((index, result));
            told(done.fetch_add(1, Ordering::Relaxed) + 1);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads.min(usize::try_from(count).unwrap_or(usize::MAX)) {
            scope.spawn(|| drive(Box::new(|_| {})));
        }
        let mut progress = Progress::start();
        drive(Box::new(|done| progress.show(|| format!("{done} of {count} {things}"))));
    });
    let mut results = results.into_inner().expect("no thread has panicked");
    results.sort_by_key(|(index, _)| *index);
    results.into_iter().map(|(_, result)| result).collect()
}
