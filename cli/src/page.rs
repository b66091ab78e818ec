//! `--html`: what the program says on a page beside its cells.

use std::path::{Path, PathBuf};

use laguerre::{Domain, Error, PowerDiagram, Result};
use laguerre_page::MOST_SITES;
pub(crate) use laguerre_page::{ENDINGS, Moment, Page, Plot, Remembering, Timeline, write_run, write_still};

use crate::report::{Report, grouped};

/// Checks that a page can show the cells: that they are not too many, and have a geometry.
///
/// # Errors
/// `Input` where it cannot.
pub(crate) fn check_cells(path: Option<&PathBuf>, diagram: &PowerDiagram) -> Result<()> {
    let sites = diagram.positions().len();
    if path.is_none() {
        return Ok(());
    }
    if sites > MOST_SITES {
        return Err(Error::input(format!(
            "--html: {} sites, and a browser opens a page of {} at most; write .vtu for ParaView with integrate -o",
            grouped(sites as u64),
            grouped(MOST_SITES as u64)
        )));
    }
    if diagram.domain().is_some_and(Domain::has_density) {
        return Err(Error::input(
            "--html: the cells of a domain with a density are not shown; leave it out, or --image",
        ));
    }
    Ok(())
}

/// What the page is called: what it shows, of which file, in which domain.
pub(crate) fn title(what: &str, sites: &str, domain: Option<&Path>) -> String {
    let name = |path: &Path| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let domain = domain.map_or_else(String::new, |path| format!(" in {}", name(path)));
    format!("{what} {}{domain}", name(Path::new(sites)))
}

/// The figures of a diagram that was integrated.
pub(crate) fn facts(report: &Report) -> Vec<(&'static str, String)> {
    let mut facts = vec![
        ("sites", grouped(report.sites as u64)),
        (
            "cells",
            format!(
                "{}, {} empty, {} not certified",
                grouped(report.cells as u64),
                grouped(report.empty as u64),
                report.uncertified
            ),
        ),
        ("sum of volumes", format!("{} of {}", report.volume_sum, report.domain_volume)),
        ("relative error", format!("{:.1e}", report.relative_error)),
        ("computed in", format!("{:.3} s", report.seconds.compute)),
    ];
    facts.extend(made_by(report.backend, &report.device, report.precision, report.threads));
    facts
}

/// Who computed, by which command.
pub(crate) fn made_by(backend: &str, device: &str, precision: &str, threads: usize) -> [(&'static str, String); 3] {
    let threads = if threads == 1 { "1 thread".into() } else { format!("{threads} threads") };
    [
        ("backend", format!("{backend}, {precision}, {threads}, {device}")),
        ("version", format!("laguerre {}", env!("CARGO_PKG_VERSION"))),
        ("command", command()),
    ]
}

/// The command line, as a shell would read it.
fn command() -> String {
    let quoted = |word: String| {
        let is_plain = |c: char| c.is_alphanumeric() || "-_./,=:+@%".contains(c);
        if !word.is_empty() && word.chars().all(is_plain) { word } else { format!("'{}'", word.replace('\'', "'\\''")) }
    };
    let words = std::env::args_os().skip(1).map(|word| quoted(word.to_string_lossy().into_owned()));
    ["laguerre".to_owned()].into_iter().chain(words).collect::<Vec<_>>().join(" ")
}
