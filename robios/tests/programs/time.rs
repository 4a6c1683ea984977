//! Duration of calls, and what programs need of compilers and other libraries.

use std::process::Command;

use serde_json::Value;

use super::{Folder, compiler, programs, python, report, robios};

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
