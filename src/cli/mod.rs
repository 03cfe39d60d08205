//! The command line `complete-mesh`: `fill`, `holes`, `demo`, `sample`. `docs/cli.md` describes it.

mod args;
mod candidates;
mod console;
mod demo;
mod failure;
mod fill;
mod guidance;
mod holes;
mod interrupt;
mod output;
mod points;
mod report;
mod sample;
mod skin;
mod sources;

use args::{Cli, Command};
use clap::Parser;
use console::Console;
use failure::{Failure, USAGE};
use std::process::ExitCode;

/// Runs the command line on the arguments of this process. The exit codes: 0 done, 1 a hole could
/// not be filled, 2 usage, 3 a file cannot be read or written, 4 the mesh or an option is invalid,
/// 130 interrupted.
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version are asked for, and go to stdout; everything else is a mistake. A
            // closed pipe is no reason to fail.
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { USAGE } else { 0 });
        }
    };
    let console = Console::new(cli.json, cli.quiet);
    interrupt::listen();
    let done = match &cli.command {
        Command::Fill(args) => fill::run(args, &console),
        Command::Holes(args) => holes::run(args, &console),
        Command::Demo(args) => demo::run(args, &console),
        Command::Sample(args) => sample::run(args, &console),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            console.fail(&failure);
            ExitCode::from(failure.code())
        }
    }
}

/// Stops before the next step if the user asked to.
fn check_interrupt() -> Result<(), Failure> {
    if interrupt::requested() {
        return Err(Failure::Library(crate::Error::Cancelled));
    }
    Ok(())
}
