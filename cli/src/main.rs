//! The program `roverlab`: its library half does the work.

fn main() -> std::process::ExitCode {
    roverlab_cli::main()
}
