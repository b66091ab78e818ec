//! How the program ends: exit codes, the one line of an error, and standard output that may close early.

use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::CommandFactory;
use clap::error::ErrorKind as ClapErrorKind;
use laguerre::{Error, ErrorKind, Result};
use serde::Serialize;

use crate::args::Args;

/// How a command ended that was not prevented from its work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Everything asked for was done.
    Done,
    /// Results were written, but some cells are marked as not certified, or a solver is not within its tolerance.
    Uncertified,
    /// Results were looked at, and some cells are wrong.
    Refuted,
    /// Ctrl-C came, and what was done until then is written.
    Interrupted,
}

const WRONG_INPUT: u8 = 2;
const UNAVAILABLE: u8 = 3;
const UNCERTIFIED: u8 = 4;
/// What shells say of a program that Ctrl-C ended.
const INTERRUPTED: u8 = 130;

/// The exit code, after saying on standard error in one line why it is not 0.
pub(crate) fn exit_code(result: Result<Outcome>) -> ExitCode {
    match result {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Uncertified | Outcome::Refuted) => UNCERTIFIED.into(),
        Ok(Outcome::Interrupted) => INTERRUPTED.into(),
        Err(error) => {
            say(&format!("{error}{}", options_for(&error)));
            match error.kind() {
                ErrorKind::Unavailable | ErrorKind::Device => UNAVAILABLE.into(),
                ErrorKind::Interrupted => INTERRUPTED.into(),
                _ => WRONG_INPUT.into(),
            }
        }
    }
}

/// The options of this program that do what the library's error says to do.
fn options_for(error: &Error) -> String {
    // What a file is called is no advice.
    let message = if error.place().file.is_none() { error.to_string() } else { String::new() };
    let options = [
        ("compute in f32", "--precision f32"),
        ("integrals in f64", "--precision f64"),
        ("the CPU", "--backend cpu"),
        ("have them normalized", "--normalize"),
    ];
    let given: Vec<&str> = options.iter().filter(|(advice, _)| message.contains(advice)).map(|o| o.1).collect();
    if given.is_empty() { String::new() } else { format!(" ({})", given.join(", ")) }
}

/// Whether a command ends by itself when Ctrl-C comes, and whether it came.
static ENDS_BY_ITSELF: AtomicBool = AtomicBool::new(false);
static CAME: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C (and on Unix SIGTERM and SIGHUP) remove what is half-written and exit with code 130.
pub(crate) fn leave_nothing_when_interrupted() {
    let interrupted = || {
        let is_first = !CAME.swap(true, Ordering::SeqCst);
        if is_first && ENDS_BY_ITSELF.load(Ordering::SeqCst) {
            if io::stderr().is_terminal() {
                note("ends soon, with what there is by then; Ctrl-C again ends at once");
            }
            return;
        }
        laguerre::io::abandon_writing();
        std::process::exit(INTERRUPTED.into());
    };
    // `try`: a signal that the caller has set aside (`nohup`, a job in the background) stays set aside, and nothing else is lost.
    let _ = ctrlc::try_set_handler(interrupted);
}

/// From now on the first Ctrl-C only makes [`is_interrupted`] true, for a command that looks often and then ends well. The second does as
/// before.
pub(crate) fn end_well_when_interrupted() {
    ENDS_BY_ITSELF.store(true, Ordering::SeqCst);
}

/// Whether Ctrl-C came.
pub(crate) fn is_interrupted() -> bool {
    CAME.load(Ordering::SeqCst)
}

/// What clap has to say: help and version as they are, errors in one line.
pub(crate) fn command_line(error: &clap::Error) -> ExitCode {
    if error.kind() == ClapErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        // Who says nothing asks what there is to say.
        let _ = write!(io::stdout(), "{}", error.render());
        return ExitCode::SUCCESS;
    }
    if !error.use_stderr() {
        // Nothing is lost where the reader of a help text has gone.
        let _ = error.print();
        return ExitCode::SUCCESS;
    }
    let rendered = error.to_string();
    // The paragraphs before the usage, which the hint at --help stands for.
    let said = rendered.split("\n\nUsage:").next().unwrap_or_default();
    let said = said.split("\n\nFor more information").next().unwrap_or_default();
    let words: Vec<&str> = said.split_whitespace().collect();
    let line = words.join(" ");
    let line = line.strip_prefix("error: ").unwrap_or(&line);
    say(&format!("{line}; see laguerre {}--help", command_named()));
    WRONG_INPUT.into()
}

/// The command that the command line names, with a blank behind it, if it names one.
fn command_named() -> String {
    let named = std::env::args_os().nth(1).unwrap_or_default().to_string_lossy().into_owned();
    if Args::command().find_subcommand(&named).is_some() { format!("{named} ") } else { String::new() }
}

/// Says one line on standard error.
pub(crate) fn say(line: &str) {
    // Where standard error is closed there is nobody left to tell.
    let _ = writeln!(io::stderr(), "laguerre: {}", line.replace('\n', " "));
}

/// Says something worth knowing on standard error.
pub(crate) fn note(line: &str) {
    say(&format!("note: {line}"));
}

/// Whether standard output has results, and is not for words.
static HAS_RESULTS: AtomicBool = AtomicBool::new(false);

/// From now on [`print`] prints to standard error, for a command that writes results to standard output.
pub(crate) fn print_beside_results() {
    HAS_RESULTS.store(true, Ordering::SeqCst);
}

/// Prints to standard output. Where its reader has gone, the rest of the work is still wanted: that is no error.
///
/// # Errors
/// `Io` where it cannot be written for another reason.
pub(crate) fn print(text: &str) -> Result<()> {
    if HAS_RESULTS.load(Ordering::SeqCst) {
        // Where standard error is closed there is nobody left to tell.
        let _ = io::stderr().write_all(text.as_bytes());
        return Ok(());
    }
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            Err(Error::new(ErrorKind::Io, format!("standard output: cannot write: {e}")))
        }
        _ => Ok(()),
    }
}

/// Prints the object of `--json`, as one line.
///
/// # Errors
/// As [`print`].
pub(crate) fn print_json(object: &impl Serialize) -> Result<()> {
    let json = serde_json::to_string(object).map_err(|e| Error::input(format!("--json: {e}")))?;
    print(&format!("{json}\n"))
}
