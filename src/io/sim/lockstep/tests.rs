use super::*;
use crate::random::Stream;
use proptest::prelude::*;

/// A world whose state is the history of what programs have told it, tick by tick.
#[derive(Debug, Clone, Default)]
struct Ledger {
    time: u64,
    told: Vec<u64>,
    history: u64,
}

impl Ticking for Ledger {
    fn time(&self) -> u64 {
        self.time
    }

    fn run(&mut self, ticks: u64) {
        let fold = |sum: u64, told: &u64| sum.rotate_left(7).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ told;
        for _ in 0..ticks {
            self.time += 1;
            self.history = self.told.iter().fold(self.history, fold);
        }
    }
}

/// What a program does: it waits some milliseconds, tells a number and reads the history.
type Script = Vec<(u16, u64)>;

/// Duration of a tick (s).
const TICK: f64 = 0.010;
/// Duration of a call (s).
const CALL: f64 = 0.0003;

/// What each program reads, each in a thread of its own that `delays` hold up, started in some order.
fn in_threads(scripts: &[Script], backwards: bool, delays: u64) -> Vec<Vec<(u64, u64)>> {
    let ledger = Ledger { told: vec![0; scripts.len()], ..Ledger::default() };
    let shared = Arc::new(Lockstep::new(ledger, TICK, scripts.len(), 60.0));
    let programs: Vec<_> =
        (0..scripts.len()).map(|index| Program::claim(&shared, index, CALL, None).unwrap()).collect();
    thread::scope(|scope| {
        let mut work: Vec<_> = programs.into_iter().zip(scripts).enumerate().collect();
        if backwards {
            work.reverse();
        }
        let threads: Vec<_> = work
            .into_iter()
            .map(|(index, (mut program, script))| {
                let mut random = Stream::new(delays).child("delay", index as u64);
                let read = move || {
                    let act = |&(wait, number): &(u16, u64)| {
                        for _ in 0..random.below(4) {
                            thread::yield_now();
                        }
                        program.pass(f64::from(wait) / 1000.0).unwrap();
                        let tell = |world: &mut Ledger, me: usize| {
                            world.told[me] = number;
                            Ok((world.time, world.history))
                        };
                        program.call(tell).unwrap()
                    };
                    script.iter().map(act).collect::<Vec<_>>()
                };
                (index, scope.spawn(read))
            })
            .collect();
        let mut seen = vec![Vec::new(); scripts.len()];
        for (index, thread) in threads {
            seen[index] = thread.join().unwrap();
        }
        seen
    })
}

/// The same in one thread: whatever is due at a tick happens before the next one.
fn one_by_one(scripts: &[Script]) -> Vec<Vec<(u64, u64)>> {
    let mut world = Ledger { told: vec![0; scripts.len()], ..Ledger::default() };
    let mut calls = Vec::new();
    for (index, script) in scripts.iter().enumerate() {
        let mut clock = 0;
        for &(wait, number) in script {
            clock += u64::from(wait) * 1_000_000;
            calls.push((clock / nanoseconds(TICK), index, number));
            clock += nanoseconds(CALL);
        }
    }
    calls.sort_by_key(|&(tick, index, _)| (tick, index));
    let mut seen = vec![Vec::new(); scripts.len()];
    for (tick, index, number) in calls {
        world.run(tick.saturating_sub(world.time));
        world.told[index] = number;
        seen[index].push((world.time, world.history));
    }
    seen
}

proptest! {
    #![proptest_config(crate::testing::cases(64))]
    #[test]
    fn threads_order_and_load_change_nothing(
        scripts in prop::collection::vec(prop::collection::vec((0..40_u16, any::<u64>()), 0..30), 1..5),
        backwards: bool, delays: u64,
    ) {
        prop_assert_eq!(in_threads(&scripts, backwards, delays), one_by_one(&scripts));
    }
}

#[test]
fn a_program_that_has_ended_holds_nobody_back() {
    let scripts = [vec![(5, 1)], vec![(2000, 7), (2000, 9)]];
    let seen = in_threads(&scripts, false, 1);
    assert_eq!(seen[1].last().unwrap().0, 400);
}

#[test]
fn clocks_of_programs_that_wait_as_long_agree() {
    let shared = Arc::new(Lockstep::new(Ledger { told: vec![0; 2], ..Ledger::default() }, TICK, 2, 60.0));
    let programs = [0, 1].map(|index| Program::claim(&shared, index, CALL, None).unwrap());
    let times = thread::scope(|scope| {
        programs
            .map(|mut program| {
                scope.spawn(move || {
                    program.pass(5.0).unwrap();
                    program.look(|world, _| Ok(world.time)).unwrap()
                })
            })
            .map(|thread| thread.join().unwrap())
    });
    assert_eq!(times, [500, 500]);
}

/// Two programs, of which the first waits while the second is used as given. Returns what the first one gets.
fn waiting(patience: f64, second: impl FnOnce(Program<Ledger>) + Send) -> Result<u64> {
    let ledger = Ledger { told: vec![0; 2], ..Ledger::default() };
    let shared = Arc::new(Lockstep::new(ledger, TICK, 2, patience));
    let [mut waits, other] = [0, 1].map(|index| Program::claim(&shared, index, CALL, None).unwrap());
    thread::scope(|scope| {
        scope.spawn(move || second(other));
        waits.pass(1.0)?;
        waits.look(|world, _| Ok(world.time))
    })
}

#[test]
fn a_thread_may_compute_before_its_first_call() {
    let late = |program: Program<Ledger>| {
        thread::sleep(Duration::from_millis(100));
        program.look(|_, _| Ok(())).unwrap();
    };
    assert_eq!(waiting(60.0, late).unwrap(), 100);
}

/// As when a main program uses one robot and then joins the thread that drives the other.
#[test]
fn a_wait_for_a_blocked_thread_ends_and_names_its_robot() {
    let blocked = |program: Program<Ledger>| {
        program.look(|_, _| Ok(())).unwrap();
        // Longer than the other one's patience; a wait without an end would end here, without an error.
        thread::sleep(Duration::from_secs(1));
    };
    let error = waiting(0.1, blocked).unwrap_err().to_string();
    assert!(error.contains("robot 0 waits for robot 1"), "{error}");
}
