//! The program `robios`, a wrapper of its library.

fn main() -> std::process::ExitCode {
    eyesim::runner::main()
}
