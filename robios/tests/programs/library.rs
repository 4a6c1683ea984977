//! Selection of a program's library.

use std::fs::{self, File};
use std::process::Command;
use std::time::SystemTime;

use serde_json::Value;

use super::{Folder, compiled, compiler, library};

const PRINT: &str = "#include \"eyebot.h\"\nint main() { return LCDPrintf(\"here\"); }\n";

/// `cargo test` puts its library into `deps`, and leaves alone the one of an earlier `cargo build` beside the
/// runner.
#[test]
fn a_library_that_an_earlier_build_has_left_is_not_taken() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("library-old");
    let file = folder.write("print.c", PRINT);
    let old = File::create(folder.0.join("libeyesim.so")).unwrap();
    old.set_modified(SystemTime::UNIX_EPOCH).unwrap();
    fs::create_dir(folder.0.join("deps")).unwrap();
    fs::hard_link(library(), folder.0.join("deps/libeyesim.so")).unwrap();
    fs::hard_link(env!("CARGO_BIN_EXE_robios"), folder.0.join("robios")).unwrap();
    let output = Command::new(folder.0.join("robios")).arg("--json").arg(&file).output().unwrap();
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&told["outcome"], &told["lcd_text"]), (&"finished".into(), &"here".into()), "{told}");
}

#[test]
fn a_library_of_another_build_refuses_and_says_so() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("library-other");
    let program = compiled(&folder.write("print.c", PRINT));
    let run = |build: Option<&str>| {
        let mut command = Command::new(&program);
        command.envs(build.map(|build| ("ROBIOS_BUILD", build)));
        let output = command.output().unwrap();
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    assert_eq!(run(None), (Some(0), String::new()), "without a runner there is nothing to compare");
    let (code, said) = run(Some("another"));
    assert_eq!(code, Some(1));
    assert!(said.contains("of another build") && said.contains("cargo build -p robios"), "{said}");
}

/// Its program ends well, as it does not look at what calls return; the run does not.
#[test]
fn a_refusal_is_in_the_report() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("library-refuses");
    let text = "#include <stdlib.h>\n#include \"eyebot.h\"\nint main() { setenv(\"ROBIOS_BUILD\", \"another\", 1); \
                LCDPrintf(\"here\"); return 0; }\n";
    let file = folder.write("print.c", text);
    let output = Command::new(env!("CARGO_BIN_EXE_robios")).arg("--json").arg(&file).output().unwrap();
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (output.status.code(), &told["outcome"], &told["exit"]),
        (Some(1), &"failed".into(), &0.into())
    );
    assert!(told["error"].as_str().unwrap().contains("of another build ("), "{told}");
}

#[test]
fn a_wrong_command_line_is_one_object_too() {
    for words in [
        &["--json", "--no-such-option"][..],
        &["--json"],
        &["--json", "--noise", "9", "a.c"],
        &["--json", "no.c"],
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_robios")).args(words).output().unwrap();
        let told: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(
            (output.status.code(), &told["outcome"]),
            (Some(2), &"failed".into()),
            "{words:?}: {told}"
        );
        assert!(told["error"].is_string() && told["warnings"].is_array(), "{words:?}: {told}");
    }
}
