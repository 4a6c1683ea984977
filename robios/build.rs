//! Compiles the two RoBIOS functions with `printf` arguments, and identifies builds.

use std::collections::BTreeSet;
use std::hash::{DefaultHasher, Hasher};
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Source folders of library and runner.
const SOURCES: [&str; 2] = ["src", "../src"];

fn main() -> io::Result<()> {
    if std::env::var_os("CARGO_CFG_TARGET_FAMILY").is_none_or(|family| family != "wasm") {
        cc::Build::new().file("src/shim.c").warnings(true).compile("eyesim_shim");
    }
    let mut files = BTreeSet::new();
    for folder in SOURCES {
        println!("cargo:rerun-if-changed={folder}");
        list(Path::new(folder), &mut files)?;
    }
    let mut hasher = DefaultHasher::new();
    for file in files {
        hasher.write(&fs::read(file)?);
    }
    println!("cargo:rustc-env=EYESIM_BUILD={:016x}", hasher.finish());
    Ok(())
}

/// Adds all files of a folder.
fn list(folder: &Path, files: &mut BTreeSet<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            list(&path, files)?;
        } else {
            files.insert(path);
        }
    }
    Ok(())
}
