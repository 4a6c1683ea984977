//! Compiles the peers, always with full optimisation for any processor of its kind.

fn main() {
    println!("cargo::rerun-if-changed=src/maze.c");
    cc::Build::new()
        .file("src/maze.c")
        .opt_level(3)
        .warnings_into_errors(false)
        .compile("roverlab_bench_maze");
}
