//! The sweep: no public function panics, aborts, takes longer than [`SECONDS`] or needs more memory than
//! [`MEGABYTES`], whatever it is given.
//!
//! The calls are made in child processes whose memory is limited, so that one that aborts or does not end
//! takes nothing else with it.

#![cfg(target_os = "linux")]

use std::any::Any;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufRead, BufReader, Write};
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use std::{env, fs, process, thread};

use roverlab_sweep::{FUNCTIONS, Function, Picker};

/// Processor time of one call (s).
const SECONDS: f64 = if cfg!(debug_assertions) { 5.0 } else { 1.0 };
/// Address space of a process of calls.
const MEGABYTES: usize = 800;
/// Random combinations of samples per function.
const DRAWN: u64 = 24;

/// Function at which a child begins.
const BEGIN: &str = "ROVERLAB_SWEEP_FROM";

/// Functions without a call: the beginning of the path, and the reason.
const EXCEPTIONS: &[(&str, &str)] = &[
    // Robots of any type, and what is around them: `wrappers/tests` and `tests/parameters` give these
    // nonsense.
    ("drive::AToB::by", ROBOT),
    ("drive::AlongWall::new", ROBOT),
    ("drive::Chase::after", ROBOT),
    ("drive::Follower::step", BORROWS),
    ("drive::RandomDrive::by_distance_sensors", ROBOT),
    ("drive::terrain::Ascent::by_distance_sensors", ROBOT),
    ("drive::terrain::Ascent::by_lidar", ROBOT),
    ("evolve::Gait::settle", ROBOT),
    ("evolve::Gait::walk", ROBOT),
    ("io::control::", ROBOT),
    ("io::log::check_determinism", CLOSURE),
    ("io::log::visit_messages", CLOSURE),
    ("io::log::LogWriter", ROBOT),
    ("io::log::Recorder", ROBOT),
    ("io::robios::RobiosRobot", "needs a library of RoBIOS; `robios/` tests it with one"),
    ("io::sim::Fleet", ROBOT),
    ("io::sim::Onlooking", "exists during a tick only"),
    ("io::sim::Simulation::watch", CLOSURE),
    ("io::sim::Stepped::watch", CLOSURE),
    ("io::wrappers::", ROBOT),
    ("maze::MazeRunner", ROBOT),
    ("safety::CliffGuard", ROBOT),
    ("safety::Supervised", ROBOT),
    ("vision::road_elements::RoadElementFinder::see", "takes what a `LaneMarkingFinder` makes"),
    ("learn::Trainer::epoch", "takes examples of the caller's own; `learn::tests` gives it nonsense"),
    ("vision::network::FixedNetwork", "takes any inputs of the caller's; `network::tests` gives it nonsense"),
    // Functions of the caller's own.
    ("evolve::Genetic", GENES),
    ("evolve::Parallel", CLOSURE),
    ("evolve::Population", GENES),
    ("evolve::Processes::", CLOSURE),
    ("evolve::Recipe", GENES),
    ("evolve::Serial", CLOSURE),
    ("evolve::SteadyState", GENES),
    ("evolve::CmaEs::resume", GENES),
    ("evolve::Selector::select", BORROWS),
    ("evolve::checkpoint::", GENES),
    ("evolve::serve", CLOSURE),
    ("io::Script", CLOSURE),
    ("maze::FastPlanner::plan_from", CLOSURE),
    ("maze::shortest_route_between", CLOSURE),
    ("nav::elevation::ElevationPlanner", BORROWS),
    ("nav::graph::", CLOSURE),
    ("nav::grid::DStarLite", BORROWS),
    ("nav::grid::GridSearch", BORROWS),
    ("nav::grid::Quadtree::visit", CLOSURE),
    ("random::Stream::shuffle", "takes any slice"),
    ("testing::", CLOSURE),
    ("vision::in_bands", CLOSURE),
    ("vision::sector_differences", BORROWS),
    ("world::BitGrid::from_fn", CLOSURE),
    ("world::HeightField::from_fn", CLOSURE),
    ("world::Raster::regions", CLOSURE),
    ("world::formats::Parsed::map", CLOSURE),
    // Types that a caller gets from elsewhere.
    ("io::Error::", "made of any text"),
    ("io::MockRobot::", "for tests"),
    ("io::delegate::", "for wrappers"),
    ("io::log::Header::new", "made of any text"),
    ("drive::Omni", "`kinematics::Omni` has a number of wheels"),
    ("kinematics::Omni", "has a number of wheels; `tests/parameters` gives it nonsense"),
    ("kinematics::marine::", "a state has private parts; the sweep makes those of `at_rest`"),
    ("maze::CellDriveParameters", "needs a rig of sensors"),
    ("maze::MazeLocaliser", "needs a rig of sensors"),
    ("maze::mms::MmsMouse::step", "`tests` beside it give it nonsense"),
    ("picture::", "a style is open to more fields"),
    ("scan::Hypothesis", "a result"),
    ("scan::Localisation", "a result"),
    ("scan::plot_scan", "draws on any display"),
    ("vision::ColourFinder::find", BORROWS),
    ("vision::View", "borrows pixels; the sweep gives views to all that takes them"),
    ("vision::signs::SignPatches", "made by a trainer, of pictures that it was given"),
    ("vision::signs::SignTrainer", "made of any names; `tests` beside it give it nonsense"),
    ("vision::teach_hue", BORROWS),
    ("vision::lane_markings::LaneEstimate", "a result"),
    ("world::Collider", "an axis is private"),
    ("world::World::add_parry_shape", "a type of another crate"),
    ("world::formats::", "files, which `fuzz/` breaks"),
    ("world::space::", "a solid's number belongs to a space"),
];

const ROBOT: &str = "takes a robot of any type";
const CLOSURE: &str = "takes a function";
const GENES: &str = "takes genomes of any type";
const BORROWS: &str = "borrows, or takes a function by its type";

fn excepted(name: &str) -> bool {
    EXCEPTIONS.iter().any(|(path, _)| name.starts_with(path))
}

/// Number of the call that runs, for the watchdog.
static CALL: AtomicUsize = AtomicUsize::new(0);

/// Where the last panic was.
static PLACE: Mutex<String> = Mutex::new(String::new());

/// Tells the parent, which reads lines.
fn tell(line: &str) {
    let mut out = std::io::stderr().lock();
    let _ = writeln!(out, "sweep {}", line.replace('\n', " "));
}

/// Ends the process if one call takes too long.
fn watch() {
    let main = fs::read_link("/proc/thread-self").expect("a thread");
    let spent = move || -> f64 {
        let text = fs::read_to_string(format!("/proc/{}/schedstat", main.display())).unwrap_or_default();
        text.split(' ').next().and_then(|word| word.parse().ok()).unwrap_or(0.0) * 1e-9
    };
    thread::spawn(move || {
        let (mut call, mut since, mut waits) = (0, spent(), 0);
        loop {
            thread::sleep(Duration::from_millis(50));
            let now = CALL.load(Ordering::SeqCst);
            waits += 1;
            if now != call {
                (call, since, waits) = (now, spent(), 0);
            } else if spent() - since > SECONDS || waits > 600 {
                tell("slow");
                process::exit(3);
            }
        }
    });
}

fn message(panic: &(dyn Any + Send)) -> String {
    let text =
        panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("a panic").chars().take(200).collect()
}

/// Makes one call. Returns the counts of samples, and whether the function was reached.
fn make(function: &Function, mut picker: Picker, what: &str) -> (Vec<usize>, bool) {
    let Ok(call) = function.call else { return (Vec::new(), false) };
    CALL.fetch_add(1, Ordering::SeqCst);
    let called = catch_unwind(AssertUnwindSafe(|| call(&mut picker).is_some()));
    let counts = std::mem::take(&mut picker.counts);
    match called {
        Ok(called) => (counts, called),
        Err(panic) => {
            if !function.panics {
                tell(&format!("panic {what}: {}, {}", message(&*panic), PLACE.lock().unwrap()));
            }
            (counts, true)
        }
    }
}

/// Gives a function all its samples.
fn sweep(function: &Function) {
    let skip: BTreeSet<String> =
        env::var("ROVERLAB_SWEEP_SKIP").unwrap_or_default().split(';').map(Into::into).collect();
    let mut reached = 0;
    let mut try_one = |picker: Picker, what: String| {
        if skip.contains(&what) {
            return Vec::new();
        }
        tell(&format!("try {what}"));
        let (counts, called) = make(function, picker, &what);
        reached += usize::from(called);
        counts
    };
    let counts = try_one(Picker::one(usize::MAX, 0), "ordinary".into());
    for (argument, count) in counts.iter().enumerate() {
        // Of long lists of samples, such as those of all fields of parameters, all; of very long ones, some.
        let step = (count / 400).max(1);
        for sample in (1..*count).step_by(step) {
            try_one(Picker::one(argument, sample), format!("argument {argument} sample {sample}"));
        }
    }
    if counts.len() > 1 {
        for sample in 1..12 {
            try_one(Picker::all(sample), format!("all {sample}"));
        }
        for seed in 0..DRAWN {
            try_one(Picker::drawn(seed), format!("drawn {seed}"));
        }
    }
    tell(&format!("reached {reached}"));
}

#[test]
#[ignore = "a process of the sweep"]
fn child() {
    let Some(from) = env::var(BEGIN).ok().and_then(|text| text.parse::<usize>().ok()) else { return };
    set_hook(Box::new(|info| {
        *PLACE.lock().unwrap() = info.location().map(ToString::to_string).unwrap_or_default();
    }));
    let work = move || {
        watch();
        for (index, function) in FUNCTIONS.iter().enumerate().skip(from) {
            if function.call.is_ok() {
                tell(&format!("function {index}"));
                sweep(function);
            }
            // Each process begins anew where the last one failed, with what is to be left out there.
            if env::var_os("ROVERLAB_SWEEP_SKIP").is_some_and(|skip| !skip.is_empty()) {
                tell(&format!("next {}", index + 1));
                process::exit(0);
            }
        }
        tell("end");
    };
    thread::spawn(work).join().expect("a sweep");
}

impl Findings {
    fn add(&mut self, function: &'static str, found: String) {
        println!("{function}: {found}");
        self.wrong.entry(function).or_default().push(found);
    }
}

/// What was found, by function.
#[derive(Default)]
struct Findings {
    wrong: BTreeMap<&'static str, Vec<String>>,
    never: Vec<&'static str>,
    calls: usize,
}

/// How a child ended: where the next one begins, and what it leaves out there.
struct Ended {
    from: usize,
    skip: Vec<String>,
}

fn run_child(begin: Ended, findings: &mut Findings) -> Option<Ended> {
    let own = env::current_exe().expect("this program");
    let limited = format!("ulimit -v {}; exec \"$0\" --exact child --ignored --nocapture", MEGABYTES * 1024);
    let mut child = Command::new("sh")
        .args(["-c", &limited])
        .arg(own)
        .env(BEGIN, begin.from.to_string())
        .env("ROVERLAB_SWEEP_SKIP", begin.skip.join(";"))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a process");
    let (mut at, mut what, mut ended, mut next, mut last) =
        (begin.from, String::new(), false, None, String::new());
    for line in BufReader::new(child.stderr.take().expect("its messages")).lines() {
        let Ok(line) = line else { break };
        let Some(told) = line.strip_prefix("sweep ") else {
            last = line;
            continue;
        };
        match told.split_once(' ').unwrap_or((told, "")) {
            ("function", index) => at = index.parse().expect("an index"),
            ("try", tried) => {
                what = tried.into();
                findings.calls += 1;
            }
            ("panic", found) => findings.add(FUNCTIONS[at].name, format!("panic: {found}")),
            ("reached", "0") => findings.never.push(FUNCTIONS[at].name),
            ("next", index) => next = index.parse().ok(),
            ("slow", _) => last = "slow".into(),
            ("end", _) => ended = true,
            _ => {}
        }
    }
    let _ = child.wait();
    if ended {
        return None;
    }
    if let Some(from) = next {
        return Some(Ended { from, skip: Vec::new() });
    }
    findings.add(FUNCTIONS[at].name, format!("{what}: {last}"));
    let mut skip = if at == begin.from { begin.skip } else { Vec::new() };
    skip.push(what);
    if skip.len() > 3 {
        return Some(Ended { from: at + 1, skip: Vec::new() });
    }
    Some(Ended { from: at, skip })
}

mod campaigns {
    use super::*;

    #[test]
    #[ignore = "takes minutes: .ci/run sweep"]
    fn nothing_that_is_given_hurts() {
        let mut findings = Findings::default();
        let mut begin = Some(Ended { from: 0, skip: Vec::new() });
        while let Some(from) = begin {
            begin = run_child(from, &mut findings);
        }
        println!(
            "{} calls of {} functions",
            findings.calls,
            FUNCTIONS.iter().filter(|function| function.call.is_ok()).count()
        );
        let never: Vec<_> = findings.never.iter().filter(|name| !excepted(name)).collect();
        assert!(findings.wrong.is_empty(), "{:#?}", findings.wrong);
        assert!(never.is_empty(), "no sample reaches these: {never:#?}");
    }
}

#[test]
fn what_is_not_called_has_a_reason() {
    let without = FUNCTIONS.iter().filter_map(|function| Some((function.name, function.call.err()?)));
    let missing: Vec<_> = without.filter(|(name, _)| !excepted(name)).collect();
    assert!(missing.is_empty(), "{}: {missing:#?}", missing.len());
    let stale: Vec<_> = EXCEPTIONS
        .iter()
        .filter(|(path, _)| !FUNCTIONS.iter().any(|function| function.name.starts_with(path)))
        .collect();
    assert!(stale.is_empty(), "{stale:#?}");
}
