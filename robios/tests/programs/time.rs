//! Duration of calls, further fields of a report, and reproducibility.

use std::process::Command;

use serde_json::Value;

use super::{Folder, compiled, compiler, programs, python, report, robios};

/// A program that counts its loops in two seconds.
const COUNT: &str = "#include \"eyebot.h\"\nint main() { int n = 0; while (OSGetCount() < 2000) { CALLS; n++; }\n\
                     LCDPrintf(\"%d\", n); return 0; }\n";

#[test]
fn loops_take_as_long_as_on_eyesim() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("time-loops");
    let costs =
        folder.write("costs", "PSDGet query 40  # slower\nVWSetSpeed local 1\n").display().to_string();
    let count = |calls: &str, options: &[&str]| -> i32 {
        let file = folder.write("count.c", &COUNT.replace("CALLS", calls));
        let told = report(&[options, &[file.to_str().unwrap()]].concat());
        told["lcd_text"].as_str().unwrap().parse().unwrap_or_else(|_| panic!("{told}"))
    };
    let near = |found: i32, expected: i32, calls: &str| {
        assert!((found - expected).abs() <= expected / 50 + 1, "{calls}: {found} of {expected}");
    };
    for (calls, options, expected) in [
        ("PSDGet(1)", &[][..], 120),
        ("PSDGet(1), PSDGet(2), MOTORDrive(1, 0), MOTORDrive(2, 0)", &[], 30),
        ("VWSetSpeed(0, 0), VWDone()", &[], 60),
        ("OSWait(100)", &[], 20),
        ("KEYRead()", &[], 50_000),
        ("PSDGet(1)", &["--frame-rate", "30"], 60),
        ("PSDGet(1)", &["--call-costs", "free"], 10_000),
        ("PSDGet(1)", &["--call-costs", &costs], 40),
        ("VWSetSpeed(0, 0)", &["--call-costs", &costs], 1961),
    ] {
        near(count(calls, options), expected, calls);
    }
    let refused = report(&["--call-costs", "missing", programs().join("square.c").to_str().unwrap()]);
    assert!(refused["error"].as_str().unwrap().contains("missing: "), "{refused}");
    let refused = robios(&["--json", "--frame-rate", "0", "x.c"]);
    assert!(String::from_utf8_lossy(&refused.stderr).contains("1 to 1000 frames"));
}

#[test]
fn an_order_reaches_the_robot_with_its_frame() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("time-orders");
    // One motor is set a frame after the other, so a robot meant to go straight turns a little; and a program
    // that ends at once has still given its commands.
    let file = folder.write(
        "motors.c",
        "#include \"eyebot.h\"\nint main() { int x, y, phi; MOTORDrive(1, 50); MOTORDrive(2, 50); OSWait(1000);\n\
         VWGetPosition(&x, &y, &phi); LCDPrintf(\"%d\", phi); MOTORDrive(1, 0); MOTORDrive(2, 0); return 0; }\n",
    );
    let heading =
        |options: &[&str]| report(&[options, &[file.to_str().unwrap()]].concat())["lcd_text"].clone();
    assert_ne!(heading(&[]), "0");
    assert_eq!(heading(&["--call-costs", "free"]), "0");
    let file =
        folder.write("parting.c", "#include \"eyebot.h\"\nint main() { VWStraight(100, 100); return 0; }\n");
    let told = report(&[file.to_str().unwrap()]);
    assert!((told["path_length_mm"].as_f64().unwrap() - 100.0).abs() < 2.0, "{told}");
}

#[test]
fn computing_is_charged_where_somebody_asks() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("time-computing");
    let file = folder.write(
        "compute.c",
        "#include \"eyebot.h\"\nint main() { volatile long i; OSGetCount(); for (i = 0; i < 200000000; i++) ;\n\
         LCDPrintf(\"%d\", OSGetCount()); return 0; }\n",
    );
    let run = |options: &[&str]| report(&[options, &[file.to_str().unwrap()]].concat());
    assert_eq!(run(&[])["lcd_text"], "0");
    let told = run(&["--cpu-time", "10"]);
    assert!(told["lcd_text"].as_str().unwrap().parse::<i32>().unwrap() > 300, "{told}");
    assert!(told["warnings"][0].as_str().unwrap().contains("not reproducible"), "{told}");
}

#[test]
fn what_a_robot_lacks_is_said_once() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("time-notes");
    let file = folder.write(
        "lacks.c",
        "#include \"eyebot.h\"\nint main() { BYTE image[QVGA_SIZE]; int i; for (i = 0; i < 100; i++) PSDGet(77);\n\
         CAMGet(image); LIDARSet(720, 0, 10); SERVOSet(9, 10); VWGetSpeed(NULL, NULL); for (i = 20; i < 90; i++)\n\
         PSDGet(i); return 0; }\n",
    );
    let output = robios(&["--json", file.to_str().unwrap()]);
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    let warnings: Vec<&str> =
        told["warnings"].as_array().unwrap().iter().map(|w| w.as_str().unwrap()).collect();
    let messages = String::from_utf8_lossy(&output.stderr);
    for expected in [
        "PSDGet: the robot has no PSD 77",
        "CAMGet: camera is off",
        "LIDARSet: lidar range is 720",
        "no servo 9",
    ] {
        let found: Vec<_> = warnings.iter().filter(|warning| warning.contains(expected)).collect();
        assert_eq!(found.len(), 1, "{expected}: {warnings:?}");
        assert_eq!(messages.lines().filter(|line| line.contains(expected)).count(), 1, "{messages}");
    }
    assert_eq!(warnings.iter().filter(|warning| warning.contains("PSDGet")).count(), 3, "{warnings:?}");
}

#[test]
fn what_is_wrong_with_a_program_is_said_and_not_what_is_odd() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("time-errors");
    // Compiles with the headers included by older versions, except for one mistake.
    let odd = "#include \"eyebot.h\"\nint a = INT_MAX, b = INT_MIN, c = UCHAR_MAX;\nint main() { MISTAKE return 0; }\n";
    let wrong = folder.write("wrong.c", &odd.replace("MISTAKE", "mistake();; return undeclared;"));
    let told = report(&[wrong.to_str().unwrap()]);
    assert!(told["error"].as_str().unwrap().contains("undeclared"), "{told}");
    let right = folder.write("right.c", &odd.replace("MISTAKE", ""));
    assert_eq!(report(&[right.to_str().unwrap()])["outcome"], "finished");
    let sorts = folder.write(
        "sorts.cpp",
        "#include \"eyebot.h\"\nint main() { int n[] = {2, 1}; std::sort(n, n + 2); LCDPrintf(\"%d\", n[0]); }\n",
    );
    assert_eq!(report(&[sorts.to_str().unwrap()])["lcd_text"], "1");
}

#[test]
fn robots_start_where_a_maze_of_any_columns_says() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("time-maze");
    let maze = folder.write("maze.maz", " _ _ _\n|  _ _|\n| S __|\n1000\n");
    let file = folder.write(
        "look.c",
        "#include \"eyebot.h\"\nint main() { int x, y, z, phi; SIMGetRobot(0, &x, &y, &z, &phi); VWTurn(-90, 90);\n\
         VWWait(); LCDPrintf(\"%d %d %d\", x, y, (PSDGet(PSD_FRONT) + 50) / 100); return 0; }\n",
    );
    let told = report(&["--world", maze.to_str().unwrap(), file.to_str().unwrap()]);
    assert_eq!(told["lcd_text"], "500 500 24", "the right edge is there: {told}");
}

#[test]
fn starman_walks_by_its_servos() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("time-starman");
    folder.write(
        "walk.c",
        "#include \"eyebot.h\"\nint gait(int reach) { int i, x, y, phi; SIMSetRobot(1, 1000, 1000, 0, 90);\n\
         VWSetPosition(0, 0, 0); for (i = 1; i <= 5; i++) SERVOSet(i, 128); OSWait(2000);\n\
         for (i = 0; i < 10; i++) { SERVOSet(3, 128 + reach); OSWait(1000); SERVOSet(3, 128); OSWait(1000); }\n\
         VWGetPosition(&x, &y, &phi); return abs(x) + abs(y); }\n\
         int main() { int x, y, z, phi, still = gait(0), walks = gait(27), again = gait(27);\n\
         SIMGetRobot(1, &x, &y, &z, &phi); LCDPrintf(\"%d %d %d %d %d\", still, walks, again, x, y); return 0; }\n",
    );
    let script = folder
        .write("walk.sim", "robot ../../robots/Articulated/starman.robi\nStarman 1000 300 1000 90 walk.x\n");
    let all = report(&[script.to_str().unwrap()]);
    let words = all["lcd_text"].as_str().unwrap().split(' ').map(|word| word.parse::<i32>().unwrap());
    let [still, walks, again, x, y] = words.collect::<Vec<_>>().try_into().unwrap();
    assert!(still <= 2 && walks > 5 && (walks - again).abs() <= 1, "{all}");
    assert!(x == 1000 && (1000 - y - again).abs() <= 2, "it has gone back along its heading: {all}");
    assert!(
        all["warnings"]
            .as_array()
            .unwrap()
            .iter()
            .any(|text| text.as_str().unwrap().contains("walking robot"))
    );
}

/// OpenCV is found through `pkg-config`: here, a library of one function.
#[test]
fn opencv_is_found() {
    if !compiler() || !Command::new("pkg-config").arg("--version").output().is_ok_and(|o| o.status.success())
    {
        return;
    }
    let folder = Folder::new("time-opencv");
    std::fs::create_dir_all(folder.0.join("opencv2")).unwrap();
    let program = "#include <opencv2/opencv.hpp>\n#include \"eyebot.h\"\nint main() { cv::Mat gray(120, 160, CV_8UC1, \
                   cv::Scalar(0)), edges; cv::rectangle(gray, cv::Rect(40, 40, 60, 40), cv::Scalar(255), -1);\n\
                   cv::Canny(gray, edges, 50, 150); LCDPrintf(\"%d\", cv::countNonZero(edges) > 100); }\n";
    let file = folder.write("canny.cpp", program);
    let installed = Command::new("pkg-config").args(["--exists", "opencv4"]).status().unwrap().success();
    if installed {
        assert_eq!(report(&[file.to_str().unwrap()])["lcd_text"], "1");
        return;
    }
    folder.write("opencv2/opencv.hpp", "inline int answer() { return 42; }\n");
    folder.write(
        "opencv4.pc",
        &format!("Name: o\nDescription: o\nVersion: 4\nCflags: -I{}\n", folder.0.display()),
    );
    let file = folder.write(
        "answer.cpp",
        "#include <opencv2/opencv.hpp>\n#include \"eyebot.h\"\nint main() { LCDPrintf(\"%d\", answer()); }\n",
    );
    let output = Command::new(env!("CARGO_BIN_EXE_robios"))
        .args(["--json", file.to_str().unwrap()])
        .env("PKG_CONFIG_PATH", &folder.0)
        .output()
        .unwrap();
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(told["lcd_text"], "42", "{told}");
}

/// A Python program finds edges in a camera image by OpenCV, where that is installed.
#[test]
fn python_programs_use_opencv() {
    if !python() {
        return;
    }
    if !Command::new("python3").args(["-c", "import cv2, numpy"]).output().unwrap().status.success() {
        eprintln!("skipped: Python has no `cv2`");
        return;
    }
    let folder = Folder::new("time-cv2");
    let file = folder.write(
        "canny.py",
        "from eye import *\nimport cv2, numpy\nCAMInit(QVGA)\n\
         image = numpy.frombuffer(CAMGet(), dtype=numpy.uint8).reshape(240, 320, 3)\n\
         edges = cv2.Canny(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), 50, 150)\n\
         LCDPrintf(\"%d\", int(numpy.count_nonzero(edges) > 100))\n",
    );
    assert_eq!(report(&[file.to_str().unwrap()])["lcd_text"], "1");
}

/// Threads that print in turn with a lock, like the book's.
const TURNS: &str = "#include \"eyebot.h\"\nstatic pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;\n\
    static void *print(void *number) { int id = (int)(intptr_t)number, i; for (i = 0; i < 10; i++) {\n\
    pthread_mutex_lock(&lock); LCDPrintf(\"%d.%d \", id, i); pthread_mutex_unlock(&lock); sleep(id); } return NULL; }\n\
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
    let differing: Vec<_> = runs.iter().filter(|one| run(one) != run(one)).collect();
    for process in &mut load {
        let _ = process.kill().and_then(|()| process.wait());
    }
    assert!(differing.is_empty(), "{differing:?}");
}
