//! The command line; all of it is in [`complete_mesh::cli`].

fn main() -> std::process::ExitCode {
    complete_mesh::cli::run()
}
