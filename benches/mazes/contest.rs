//! The methods beside each other in one run.

use std::time::Instant;

use crate::task::{METHODS, Method, Task, filler};

/// Rounds in which every method fills every maze so many times in a row.
const ROUNDS: usize = 41;
const CALLS: u32 = 64;

#[allow(clippy::disallowed_methods, reason = "a benchmark measures time")]
fn seconds(calls: u32, mut call: impl FnMut()) -> f64 {
    let start = Instant::now();
    (0..calls).for_each(|_| call());
    start.elapsed().as_secs_f64() / f64::from(calls)
}

/// The least time of a call: of several, since other programs only ever add to it.
pub(crate) fn least_seconds(mut call: impl FnMut()) -> f64 {
    (0..9).map(|_| seconds(1, &mut call)).fold(f64::INFINITY, f64::min)
}

/// Prints the mean time of each method over all mazes, and the worst maze for the wave of bits beside our
/// queue.
pub(crate) fn table(tasks: &[Task]) {
    let mut fillers = METHODS.map(filler);
    // All mazes in turn, as a robot meets them, then each maze on its own; medians of rounds in which the
    // methods alternate.
    let mut in_turn = METHODS.map(|_| Vec::new());
    let mut each = METHODS.map(|_| vec![f64::INFINITY; tasks.len()]);
    for _ in 0..ROUNDS {
        for (fill, times) in fillers.iter_mut().zip(&mut in_turn) {
            times.push(seconds(1, || tasks.iter().for_each(&mut *fill)) / tasks.len() as f64);
        }
    }
    for _ in 0..9 {
        for ((fill, times), method) in fillers.iter_mut().zip(&mut each).zip(METHODS) {
            let calls = if method == Method::Sweep { 4 } else { CALLS };
            for (task, least) in tasks.iter().zip(times) {
                *least = least.min(seconds(calls, || fill(task)));
            }
        }
    }
    let medians = in_turn.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    });
    println!("\nflood fill of {} mazes of 16 x 16 in turn, median of {ROUNDS} rounds", tasks.len());
    println!("{:28} {:>12} {:>24}", "", "ns a fill", "times as fast as passes");
    for (method, time) in METHODS.iter().zip(medians) {
        println!("{:28} {:12.0} {:24.1}", method.name(), 1e9 * time, medians[0] / time);
    }
    let [sweep, _, own, wave] = each;
    let least =
        |peer: &[f64]| peer.iter().zip(&wave).map(|(peer, wave)| peer / wave).fold(f64::INFINITY, f64::min);
    println!(
        "each maze on its own: the wave is at least {:.1} times as fast as our queue, and {:.0} times as the passes\n",
        least(&own),
        least(&sweep)
    );
}
