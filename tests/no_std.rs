//! The core of the safety system compiles without the standard library.

use std::path::Path;
use std::process::Command;
use std::{env, fs};

#[test]
fn the_safety_core_compiles_alone() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/safety");
    let folder = env::temp_dir().join(format!("roverlab-no-std-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let modules = ["cause", "machine", "monitor", "stopping"].map(|name| {
        let file = source.join(name).with_extension("rs");
        format!("#[path = {file:?}]\npub mod {name};\n")
    });
    let root = folder.join("core.rs");
    fs::write(&root, format!("#![no_std]\n{}", modules.concat())).unwrap();
    let compiler = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(compiler)
        .args(["--edition", "2024", "--crate-type", "lib", "--emit", "metadata", "--out-dir"])
        .args([&folder, &root])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    fs::remove_dir_all(folder).unwrap();
}
