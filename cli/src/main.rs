//! The program `roverlab`, a wrapper of its library.

fn main() -> std::process::ExitCode {
    roverlab_cli::main()
}
