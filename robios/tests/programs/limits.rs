//! Enforced limits, and misbehaving programs: they close foreign files, leave their first thread, fork, end
//! their parent, wait for each other.

use std::time::Instant;

use serde_json::Value;

use super::{Folder, compiler, report};

const BUSY: &str = "#include \"eyebot.h\"\nint main() { for (;;) PSDGet(1); }\n";
const HANG: &str = "#include \"eyebot.h\"\nint main() { LCDPrintf(\"on\"); for (;;) ; }\n";

/// Runs a program alone, and then beside an idle one, and returns both reports.
fn alone_and_beside(name: &str, text: &str, options: &[&str]) -> [Value; 2] {
    let folder = Folder::new(&format!("limits-{name}"));
    let file = folder.write(&format!("{name}.c"), text);
    folder.write("idle.c", "#include \"eyebot.h\"\nint main() { OSWait(100); return 0; }\n");
    let script = folder.write("two.sim", &format!("S4 500 500 0 {name}.x\nS4 500 1500 0 idle.x\n"));
    [file, script].map(|file| report(&[options, &[file.to_str().unwrap()]].concat()))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
#[allow(clippy::disallowed_methods, reason = "a limit in real time is what is tested")]
fn the_real_limit_ends_shared_runs() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("limits-real");
    folder.write("busy.c", BUSY);
    folder.write("hang.c", HANG);
    folder.write("brief.c", "#include \"eyebot.h\"\nint main() { return OSWait(100); }\n");
    // Programs start slightly after their run, whose limit is theirs; a program that ends before makes the
    // check exact.
    for names in [&["busy", "busy", "brief"][..], &["busy", "hang"], &["hang"; 2]] {
        let line = |(number, name): (usize, &&str)| format!("S4 500 {} 0 {name}.x\n", 300 * (number + 1));
        let script = folder.write("all.sim", &names.iter().enumerate().map(line).collect::<String>());
        let picture = folder.0.join("run.svg").display().to_string();
        let begin = Instant::now();
        let all = report(&[
            "--real-limit",
            "2",
            "--time-limit",
            "900000",
            "--hang-limit",
            "900",
            "--picture",
            &picture,
            script.to_str().unwrap(),
        ]);
        assert!(begin.elapsed().as_secs_f64() < 30.0, "{names:?}: {all}");
        for (robot, name) in all["robots"].as_array().unwrap().iter().zip(names) {
            let ends = *name == "brief";
            let expected = if ends {
                ("finished", Value::Null)
            } else {
                ("timed_out", "ended after 2 real seconds".into())
            };
            assert_eq!((robot["outcome"].as_str().unwrap(), robot["error"].clone()), expected, "{all}");
        }
    }
}

#[test]
fn the_first_thread_may_leave() {
    if !compiler() || !cfg!(target_os = "linux") {
        return;
    }
    let text = "#include \"eyebot.h\"\nvoid *drive(void *a) { VWStraight(200, 200); VWWait(); LCDPrintf(\"there\"); \
                return a; }\nint main() { pthread_t t; pthread_create(&t, NULL, drive, NULL); pthread_exit(NULL); }\n";
    for all in alone_and_beside("leave", text, &["--real-limit", "30"]) {
        let robot = &all["robots"][0];
        assert_eq!((&robot["outcome"], &robot["lcd_text"]), (&"finished".into(), &"there".into()), "{all}");
        assert!(number(&robot["sim_time_s"]) > 1.0 && number(&robot["path_length_mm"]) > 195.0, "{all}");
    }
}

#[test]
fn time_passes_while_a_program_waits_for_a_process() {
    if !compiler() || !cfg!(target_os = "linux") {
        return;
    }
    // The child sleeps in real time, and has no robot.
    let text = "#include \"eyebot.h\"\n#include <sys/wait.h>\nint main() { VWSetSpeed(100, 0);\n\
                if (fork() == 0) { int failed = VWSetSpeed(300, 0); sleep(2); _exit(failed); }\n\
                wait(NULL); VWSetSpeed(0, 0); OSWait(500); return 0; }\n";
    for all in alone_and_beside("forks", text, &["--real-limit", "30"]) {
        let robot = &all["robots"][0];
        assert_eq!(robot["outcome"], "finished", "{all}");
        let path = number(&robot["path_length_mm"]);
        assert!((150.0..450.0).contains(&path), "two seconds at 100 mm/s, and what the machine adds: {all}");
        let warnings = all["warnings"].as_array().unwrap();
        assert!(
            warnings.iter().any(|text| text.as_str().unwrap().contains("has forked calls RoBIOS")),
            "{all}"
        );
    }
}

#[test]
fn a_program_may_close_all_descriptors() {
    if !compiler() {
        return;
    }
    let text = "#include \"eyebot.h\"\nint main() { int i; VWStraight(100, 100); for (i = 3; i < 4096; i++) close(i);\n\
                VWWait(); LCDPrintf(\"there\"); for (i = 3; i < 4096; i++) close(i); VWStraight(100, 100); VWWait();\n\
                return 0; }\n";
    for all in alone_and_beside("closes", text, &[]) {
        let robot = &all["robots"][0];
        assert_eq!((&robot["outcome"], &robot["lcd_text"]), (&"finished".into(), &"there".into()), "{all}");
        assert!((number(&robot["path_length_mm"]) - 200.0).abs() < 3.0, "{all}");
    }
}

#[test]
fn a_program_that_ends_its_parent_is_reported() {
    if !compiler() || !cfg!(target_os = "linux") {
        return;
    }
    for (name, how) in [("parent", "kill(getppid(), SIGKILL)"), ("group", "kill(0, SIGKILL)")] {
        let text = format!(
            "#include \"eyebot.h\"\nint main() {{ VWStraight(100, 100); VWWait(); {how}; for (;;) pause(); }}\n"
        );
        for all in alone_and_beside(name, &text, &["--real-limit", "30"]) {
            let robot = &all["robots"][0];
            assert_eq!(robot["outcome"], "failed", "{all}");
            assert!(robot["error"].as_str().unwrap().contains("has ended its parent process"), "{all}");
            assert!(number(&robot["path_length_mm"]) > 95.0 && number(&robot["sim_time_s"]) > 1.0, "{all}");
        }
    }
}

#[test]
fn programs_that_wait_for_each_other_are_named() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("limits-deadlock");
    folder.write(
        "wait.c",
        "#include \"eyebot.h\"\nint main() { char text[100]; int id; OSWait(500); RADIOReceive(&id, text, 100); \
         return 0; }\n",
    );
    let script = folder.write("two.sim", "S4 500 500 0 wait.x\nLabBot 500 1500 0 wait.x\n");
    let all = report(&["--time-limit", "20", script.to_str().unwrap()]);
    let errors: Vec<&str> = (0..2).map(|robot| all["robots"][robot]["error"].as_str().unwrap()).collect();
    assert!(
        errors[0].contains("waited for a radio message since 0.5") && errors[0].contains("robot 2, wait.x")
    );
    assert!(errors[1].contains("robot 1, wait.x") && errors[1].contains("none of them sends"), "{all}");
}

/// A thread's query waits for its frame, while others run in the same simulated time: whatever the others do
/// meanwhile, they see every reading in time.
#[test]
fn a_thread_that_calls_without_sleeping_leaves_time_to_others() {
    if !compiler() || !cfg!(target_os = "linux") {
        return;
    }
    let text = |body: &str| {
        format!(
            "#include \"eyebot.h\"\nvolatile int distance = 9999;\nvoid *sense(void *a) {{ for (;;) distance = \
             PSDGet(PSD_FRONT); }}\nint main() {{ pthread_t t; pthread_create(&t, NULL, sense, NULL);\n\
             VWSetSpeed(200, 0); while (distance > 1000) {body}; VWSetSpeed(0, 0); OSWait(100); \
             LCDPrintf(\"%d\", PSDGet(PSD_FRONT)); return 0; }}\n"
        )
    };
    let folder = Folder::new("limits-polling");
    for (name, body) in [("waits.c", "OSWait(10)"), ("spins.c", "")] {
        let file = folder.write(name, &text(body));
        let all = report(&["--time-limit", "60", "--real-limit", "60", file.to_str().unwrap()]);
        assert_eq!(all["outcome"], "finished", "{name}: {all}");
        let left: f64 = all["lcd_text"].as_str().unwrap().parse().unwrap();
        assert!((960.0..1001.0).contains(&left), "{name}: it stops within some frames: {all}");
    }
    let drive = "#include \"eyebot.h\"\nvoid *sense(void *a) { for (;;) PSDGet((int)(intptr_t)a); }\n\
                 int main() { intptr_t i; for (i = 1; i < 4; i++) { pthread_t t; pthread_create(&t, NULL, sense, \
                 (void *)i); }\nVWStraight(300, 100); VWWait(); LCDPrintf(\"there\"); return 0; }\n";
    let file = folder.write("three.c", drive);
    let all = report(&["--time-limit", "60", file.to_str().unwrap()]);
    assert_eq!((&all["outcome"], &all["lcd_text"]), (&"finished".into(), &"there".into()), "{all}");
    assert!((3.0..4.5).contains(&number(&all["sim_time_s"])), "{all}");
    let print = "#include \"eyebot.h\"\nvoid *print(void *a) { int n = 0; for (;;) LCDSetPrintf(0, 0, \"%d\", n++); }\n\
                 int main() { pthread_t t; pthread_create(&t, NULL, print, NULL);\n\
                 OSWait(1000); return OSGetCount() > 1020; }\n";
    let all = report(&["--time-limit", "60", folder.write("print.c", print).to_str().unwrap()]);
    assert_eq!(all["outcome"], "finished", "{all}");
}

/// Each sleeping thread looks after the others only when it is the next to wake up.
#[test]
fn many_sleeping_threads_take_little() {
    if !compiler() || !cfg!(target_os = "linux") {
        return;
    }
    let text = "#include \"eyebot.h\"\nvoid *nap(void *a) { int i; for (i = 0; i < 10; i++) OSWait(100 + \
                (int)(intptr_t)a); return NULL; }\nint main() { pthread_t t[30]; intptr_t i;\n\
                for (i = 0; i < 30; i++) pthread_create(t + i, NULL, nap, (void *)i);\n\
                for (i = 0; i < 30; i++) pthread_join(t[i], NULL); LCDPrintf(\"%d\", OSGetCount()); return 0; }\n";
    let file = Folder::new("limits-crowd").write("crowd.c", text);
    let all = report(&["--real-limit", "10", file.to_str().unwrap()]);
    assert_eq!(all["outcome"], "finished", "{all}");
    assert!((1.29..1.32).contains(&number(&all["sim_time_s"])), "{all}");
}

#[test]
fn a_command_before_a_busy_loop_arrives_in_a_shared_world_too() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("limits-order");
    folder.write("hang.c", "#include \"eyebot.h\"\nint main() { VWSetSpeed(50, 0); for (;;) ; }\n");
    folder.write("long.c", "#include \"eyebot.h\"\nint main() { OSWait(10000); return 0; }\n");
    let script = folder.write("two.sim", "S4 500 500 0 hang.x\nLabBot 500 1500 0 long.x\n");
    let all = report(&["--time-limit", "20", "--hang-limit", "1", script.to_str().unwrap()]);
    let path = number(&all["robots"][0]["path_length_mm"]);
    assert!((950.0..1001.0).contains(&path), "20 s at 50 mm/s: {all}");
}
