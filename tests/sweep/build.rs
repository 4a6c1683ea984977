//! Writes a call of every public function of the library.

#[path = "generate/calls.rs"]
mod calls;
#[path = "generate/samples.rs"]
mod samples;
#[path = "generate/source.rs"]
mod source;
#[path = "generate/types.rs"]
mod types;

use std::path::Path;
use std::{env, fs};

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let library = root.join("../../src");
    println!("cargo::rerun-if-changed={}", library.display());
    for own in ["src/samples", "src/samples.rs", "src/sample.rs", "generate", "build.rs"] {
        println!("cargo::rerun-if-changed={own}");
    }
    let crate_ = source::read(&library);
    let mut files = ["src/sample.rs", "src/samples.rs"].map(|file| root.join(file)).to_vec();
    let parts = fs::read_dir(root.join("src/samples")).expect("a folder");
    files.extend(parts.map(|file| file.expect("a file").path()));
    let mut known = types::Known::by_hand(&files);
    let samples = samples::derive(&crate_, &mut known);
    let calls = calls::write(&crate_, &known);
    let file = Path::new(&env::var("OUT_DIR").expect("cargo sets it")).join("generated.rs");
    fs::write(file, format!("{samples}\n{calls}")).expect("a generated file");
}
