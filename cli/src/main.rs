//! The program `laguerre`: restricted power diagrams on the command line.
#![forbid(unsafe_code)]

mod args;
mod bench;
mod container;
mod demo;
mod density;
mod derivatives;
mod devices;
mod domains;
mod evaluate;
mod files;
mod fluid;
mod integrate;
mod kernels;
mod lloyd;
mod manual;
mod npz;
mod outcome;
mod page;
mod paper;
mod picture;
mod plot;
mod report;
mod sample;
mod sites;
mod slice;
mod solver;
mod timing;
mod transport;
mod tune;
mod uneven;
mod verify;

use std::process::ExitCode;

use clap::Parser;

use args::{Args, Command};

fn main() -> ExitCode {
    outcome::leave_nothing_when_interrupted();
    kernels::listen();
    let result = match Args::try_parse() {
        Ok(Args { command }) => match command {
            Command::Integrate(args) => integrate::run(&args),
            Command::Verify(args) => verify::run(&args),
            Command::Sample(args) => sample::run(&args),
            Command::Demo(args) => demo::run(&args),
            Command::Lloyd(args) => lloyd::run(&args),
            Command::Transport(args) => transport::run(&args),
            Command::Fluid(args) => fluid::run(&args),
            Command::Tune(args) => tune::run(&args),
            Command::Bench(args) => bench::run(&args),
            Command::Devices(args) => devices::run(&args),
            Command::Completions(args) => manual::completions(&args),
            Command::Man(args) => manual::man(&args),
            Command::Paper(args) => paper::run(&args),
        },
        Err(error) => return outcome::command_line(&error),
    };
    outcome::exit_code(result)
}
