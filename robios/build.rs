//! Compiles the two RoBIOS functions with `printf` arguments, and identifies builds.

use std::collections::BTreeSet;
use std::hash::{DefaultHasher, Hasher};
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Source folders of library and runner, from the folders of `robios` and of `robios-runner`.
const SOURCES: [[&str; 2]; 2] = [["src", "../src"], ["../src", "../../src"]];

fn main() -> io::Result<()> {
    let for_page = std::env::var_os("CARGO_CFG_TARGET_FAMILY").is_some_and(|family| family == "wasm");
    let [own, above] = SOURCES;
    let sources = if Path::new(own[0]).is_dir() { own } else { above };
    if std::env::var_os("CARGO_FEATURE_C").is_some() && !for_page {
        cc::Build::new().file(format!("{}/shim.c", sources[0])).warnings(true).compile("eyesim_shim");
    }
    let mut files = BTreeSet::new();
    for folder in sources {
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
