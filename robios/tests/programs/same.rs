//! Runs that are equal to the byte, on a busy machine too.

use std::process::Command;

use super::{Folder, compiled, compiler, report, robios};

/// Threads that print in turn with a lock, like the book's.
const TURNS: &str = "#include \"eyebot.h\"\nstatic pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;\n\
    static void *print(void *number) { int id = (int)(intptr_t)number, i; for (i = 0; i < 10; i++) {\n\
    pthread_mutex_lock(&lock); LCDPrintf(\"%d.%d \", id, i); pthread_mutex_unlock(&lock); sleep(id); } \
    return NULL; }\n\
    int main() { pthread_t threads[3]; intptr_t i; for (i = 1; i < 4; i++)\n\
    pthread_create(&threads[i - 1], NULL, print, (void *)i); KEYWait(KEY4); pthread_exit(NULL); }\n";

/// For programs whose threads sleep or wait for each other.
#[test]
fn fifty_runs_under_load_are_the_same_each_time() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("time-same");
    folder.copy("radio.c", "radio.c");
    let mut load: Vec<_> =
        (0..4).map(|_| Command::new("sh").args(["-c", "while :; do :; done"]).spawn().unwrap()).collect();
    let mut runs = Vec::new();
    for name in
        ["square", "driving", "sensors", "motors", "display", "camera", "images", "lines", "chapter04"]
    {
        let file = folder.copy(&format!("{name}.c"), &format!("{name}.c"));
        let file = compiled(&file).display().to_string();
        runs.extend(
            [("0", "1"), ("1", "1"), ("1", "2"), ("2", "3"), ("5", "4")].map(|noise| (noise, file.clone())),
        );
    }
    let script = folder.write("two.sim", "S4 400 600 0 radio.x\nLabBot 1000 600 180 radio.x\n");
    runs.extend(["1", "2"].map(|seed| (("1", seed), script.display().to_string())));
    let threads = folder.write("turns.c", TURNS);
    for file in [folder.copy("threads.c", "threads.c"), folder.copy("older.c", "older.c"), threads] {
        runs.push((("1", "2"), compiled(&file).display().to_string()));
    }
    assert_eq!(runs.len(), 50);
    let run = |((noise, seed), file): &((&str, &str), String)| {
        let log = folder.0.join("log.mcap").display().to_string();
        let mut options = vec!["--json", "--time-limit", "60", "--noise", noise, "--seed", seed];
        if *seed == "1" {
            options.extend(["--record", &log]);
        }
        options.push(file);
        let told = robios(&options).stdout;
        (told, std::fs::read(&log).unwrap_or_default())
    };
    let differing: Vec<_> = runs.iter().filter_map(|one| differs(one, &run(one), &run(one))).collect();
    for process in &mut load {
        let _ = process.kill().and_then(|()| process.wait());
    }
    assert!(differing.is_empty(), "{differing:#?}");
}

/// What two runs of a program printed, if it differs, or how long their recordings were.
fn differs<R: std::fmt::Debug>(
    what: R,
    (one, one_log): &(Vec<u8>, Vec<u8>),
    (other, other_log): &(Vec<u8>, Vec<u8>),
) -> Option<String> {
    let logs = || format!("{what:?}: recordings of {} and {} bytes", one_log.len(), other_log.len());
    match (one == other, one_log == other_log) {
        (true, true) => None,
        (true, false) => Some(logs()),
        (false, _) => {
            let [one, other] = [one, other].map(|told| String::from_utf8_lossy(told));
            Some(format!("{what:?}: {one} and {other}"))
        }
    }
}

/// Report of a program with threads.
fn ended(name: &str, text: Option<&str>) -> serde_json::Value {
    let folder = Folder::new(&format!("same-{name}"));
    let file = text.map_or_else(|| folder.copy(name, name), |text| folder.write(name, text));
    let report = report(&["--time-limit", "120", &compiled(&file).display().to_string()]);
    assert_eq!(report["exit"], 0, "{report}");
    report
}

/// Characters in a line of the display.
const COLUMNS: usize = 80;

/// What a program has printed, in one line. Spaces at the ends of the display's lines are not in the report.
fn words(report: &serde_json::Value) -> String {
    let text = report["lcd_text"].as_str().unwrap();
    let lines: Vec<String> = text.lines().map(|line| format!("{line:<COLUMNS$}")).collect();
    lines.concat()
}

#[test]
fn threads_wake_each_other_in_order() {
    if !compiler() || !cfg!(target_os = "linux") {
        return;
    }
    let first = ended("conditions.c", None);
    let words = words(&first);
    // Everybody had the lock in turn, although each holds it while it waits.
    let holders: String =
        words.split(' ').filter_map(|word| word.strip_prefix('h')?.chars().next()).collect();
    assert_eq!(holders, "012012012012", "{words}");
    let turns: String =
        words.split(' ').filter_map(|word| word.chars().next().filter(|c| "AB".contains(*c))).collect();
    assert_eq!(turns, "AB".repeat(10), "{words}");
    // Both readers at once, whenever the writer leaves them the lock.
    let shared: Vec<&str> = words.split(' ').filter(|word| word.starts_with(['r', 'w'])).collect();
    assert_eq!(shared.len(), 12, "{words}");
    assert!(shared.windows(2).any(|pair| pair[0].starts_with('r') && pair[0] == pair[1]), "{words}");
}

/// The same in C++ and by C11's names.
#[test]
fn threads_of_other_libraries_wake_in_order() {
    if !compiler() || !cfg!(target_os = "linux") {
        return;
    }
    let cpp = "#include \"eyebot.h\"\n#include <thread>\n#include <mutex>\n#include \
               <condition_variable>\n#include <vector>\n\
               std::mutex lock; std::condition_variable go; int turn = -1;\n\
               void run(int me) { for (int i = 0; i < 5; i++) { std::unique_lock<std::mutex> hold(lock);\n\
               go.wait(hold, [] { return turn >= 0; }); LCDPrintf(\"%d.%d@%d \", me, i, OSGetCount());\n\
               if (i == 2) go.wait_for(hold, std::chrono::milliseconds(30)); PSDGet(PSD_FRONT); } }\n\
               int main() { std::vector<std::thread> all; for (int i = 0; i < 5; i++) all.emplace_back(run, \
               i);\n\
               OSWait(50); { std::lock_guard<std::mutex> hold(lock); turn = 0; } go.notify_all();\n\
               for (auto &one : all) one.join(); return 0; }\n";
    let c11 = "#include \"eyebot.h\"\n#include <threads.h>\nstatic mtx_t lock; static cnd_t go; static int \
               ready;\n\
               static int run(void *me) { int i; for (i = 0; i < 5; i++) { mtx_lock(&lock); while (!ready) \
               cnd_wait(&go, &lock);\n\
               LCDPrintf(\"%d.%d@%d \", (int)(intptr_t)me, i, OSGetCount()); PSDGet(PSD_LEFT); \
               mtx_unlock(&lock); } return 0; }\n\
               int main() { thrd_t all[4]; intptr_t i; mtx_init(&lock, mtx_plain); cnd_init(&go);\n\
               for (i = 0; i < 4; i++) thrd_create(&all[i], run, (void *)i); OSWait(50); mtx_lock(&lock); \
               ready = 1;\n\
               cnd_broadcast(&go); mtx_unlock(&lock); for (i = 0; i < 4; i++) thrd_join(all[i], NULL); \
               return 0; }\n";
    for (name, text, count) in [("cpp.cpp", cpp, 25), ("c11.c", c11, 20)] {
        let first = ended(name, Some(text));
        assert_eq!(words(&first).split_whitespace().count(), count, "{first}");
    }
}

/// A program whose threads wait for each other ends at its time limit at once, and the report says who waits.
#[test]
fn threads_that_wait_for_each_other_are_named() {
    if !compiler() || !cfg!(target_os = "linux") {
        return;
    }
    let folder = Folder::new("same-deadlock");
    let both = "#include \"eyebot.h\"\nstatic pthread_mutex_t a = PTHREAD_MUTEX_INITIALIZER, b = \
                PTHREAD_MUTEX_INITIALIZER;\n\
                static void *other(void *p) { pthread_mutex_lock(&b); OSWait(500); pthread_mutex_lock(&a); \
                return p; }\n\
                int main() { pthread_t t; pthread_mutex_lock(&a); pthread_create(&t, NULL, other, NULL); \
                OSWait(600);\n\
                pthread_mutex_lock(&b); return 0; }\n";
    let alone = "#include \"eyebot.h\"\nstatic pthread_mutex_t a = PTHREAD_MUTEX_INITIALIZER;\n\
                 int main() { OSWait(500); pthread_mutex_lock(&a); pthread_mutex_lock(&a); return 0; }\n";
    let join = "#include \"eyebot.h\"\nstatic pthread_mutex_t a = PTHREAD_MUTEX_INITIALIZER;\n\
                static pthread_cond_t c = PTHREAD_COND_INITIALIZER;\n\
                static void *wait_for(void *p) { OSWait(500); pthread_mutex_lock(&a); pthread_cond_wait(&c, \
                &a); return p; }\n\
                int main() { pthread_t t; pthread_create(&t, NULL, wait_for, NULL); pthread_join(t, NULL); \
                return 0; }\n";
    for (name, text, said) in [
        (
            "both.c",
            both,
            "thread 2 for a mutex of thread 1 since 0.50 s, thread 1 for a mutex of thread 2 since 0.60 s",
        ),
        ("alone.c", alone, "thread 1 for a mutex of itself since 0.50 s"),
        ("join.c", join, "thread 2 for a condition since 0.50 s, and another for the end of a thread"),
    ] {
        let all =
            report(&["--time-limit", "30", "--real-limit", "20", folder.write(name, text).to_str().unwrap()]);
        assert_eq!(
            (&all["outcome"], &all["sim_time_s"]),
            (&"timed_out".into(), &30.0.into()),
            "{name}: {all}"
        );
        let warnings = all["warnings"].to_string();
        assert!(warnings.contains(&format!("wait for each other: {said}")), "{name}: {all}");
    }
}

/// Sleeping and waiting threads end when they are cancelled, and their cleanup handlers hold the lock.
#[test]
fn cancelled_threads_end() {
    if !compiler() || !cfg!(target_os = "linux") {
        return;
    }
    let text = "#include \"eyebot.h\"\nstatic pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;\n\
                static pthread_cond_t never = PTHREAD_COND_INITIALIZER; static int cleaned;\n\
                static void clean(void *p) { cleaned += pthread_mutex_unlock(&lock) == 0; }\n\
                static void *naps(void *p) { for (;;) sleep(1000); }\n\
                static void *waits(void *p) { pthread_mutex_lock(&lock); pthread_cleanup_push(clean, NULL);\n\
                for (;;) pthread_cond_wait(&never, &lock); pthread_cleanup_pop(1); return p; }\n\
                static void *polls(void *p) { for (;;) { PSDGet(PSD_FRONT); OSWait(100); } }\n\
                int main() { void *(*bodies[])(void *) = {naps, waits, polls}; pthread_t threads[3]; \
                void *result; int i, n = 0;\n\
                for (i = 0; i < 3; i++) pthread_create(&threads[i], NULL, bodies[i], NULL); OSWait(3500);\n\
                for (i = 0; i < 3; i++) { pthread_cancel(threads[i]); \
                pthread_join(threads[i], &result); n += result == PTHREAD_CANCELED; }\n\
                LCDPrintf(\"%d %d %d\", n, cleaned, OSGetCount() < 4000); return \
                pthread_mutex_trylock(&lock); }\n";
    let all = report(&[Folder::new("same-cancel").write("cancel.c", text).to_str().unwrap()]);
    assert_eq!((&all["lcd_text"], &all["exit"]), (&"3 1 1".into(), &0.into()), "{all}");
}
