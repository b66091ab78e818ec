//! `laguerre completions` and `laguerre man`: what a shell completes, and pages for `man`, made of the command line itself.

use std::fs;
use std::path::Path;

use clap::{Command, CommandFactory};
use clap_mangen::Man;
use laguerre::{Error, ErrorKind, Result, io};

use crate::args::{Args, CompletionsArgs, ManArgs};
use crate::outcome::{Outcome, print};

/// Prints what the shell is to read.
pub(crate) fn completions(args: &CompletionsArgs) -> Result<Outcome> {
    let mut text = Vec::new();
    // Without what its help hides, which the generators would offer.
    let program = Args::command();
    let shown = program.get_subcommands().filter(|command| !command.is_hide_set());
    let mut command = Command::new("laguerre").version(env!("CARGO_PKG_VERSION")).subcommands(shown.cloned());
    clap_complete::generate(args.shell, &mut command, "laguerre", &mut text);
    print(&String::from_utf8_lossy(&text))?;
    Ok(Outcome::Done)
}

/// Writes a page for the program, and one for each command.
pub(crate) fn man(args: &ManArgs) -> Result<Outcome> {
    let folder = &args.folder;
    fs::create_dir_all(folder)
        .map_err(|e| Error::new(ErrorKind::Io, format!("{}: cannot make this folder: {e}", folder.display())))?;
    let mut program = Args::command();
    // With this the commands have their full names.
    program.build();
    write(folder, &program)?;
    let shown = |command: &&Command| !command.is_hide_set() && command.get_name() != "help";
    let commands: Vec<&Command> = program.get_subcommands().filter(shown).collect();
    commands.iter().try_for_each(|command| write(folder, command))?;
    print(&format!("written      {} pages in {}\n", commands.len() + 1, folder.display()))?;
    Ok(Outcome::Done)
}

fn write(folder: &Path, command: &Command) -> Result<()> {
    let name = command.get_display_name().unwrap_or_else(|| command.get_name());
    let page = page(command, name).map_err(|e| Error::new(ErrorKind::Io, format!("the page {name}: {e}")))?;
    io::write_whole(&folder.join(format!("{name}.1")), |w| w.write_all(page.as_bytes()))
}

/// The page of a command.
fn page(command: &Command, name: &str) -> std::io::Result<String> {
    let man = Man::new(command.clone()).title(name);
    let mut page = Vec::new();
    man.render_title(&mut page)?;
    man.render_name_section(&mut page)?;
    man.render_synopsis_section(&mut page)?;
    man.render_description_section(&mut page)?;
    man.render_options_section(&mut page)?;
    if command.get_subcommands().any(|command| !command.is_hide_set()) {
        man.render_subcommands_section(&mut page)?;
    }
    if command.get_after_help().is_some() {
        // Line by line, as it stands in the help.
        let mut examples = Vec::new();
        man.render_extra_section(&mut examples)?;
        let examples = String::from_utf8_lossy(&examples);
        page.extend(examples.replace(".SH EXTRA\nExamples:\n", ".SH EXAMPLES\n.nf\n").bytes());
        page.extend(b".fi\n");
    }
    Ok(String::from_utf8_lossy(&page).into_owned())
}
