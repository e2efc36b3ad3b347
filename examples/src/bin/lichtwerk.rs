//! The `lichtwerk` program; see [`lichtwerk::program`].

fn main() -> std::process::ExitCode {
    lichtwerk::program::main()
}
