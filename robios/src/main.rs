//! Runs programs written for RoBIOS in simulated worlds: C and C++ as executables or as source text, and
//! Python.

mod runner;

fn main() -> std::process::ExitCode {
    runner::main()
}
