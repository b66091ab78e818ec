//! `--html`: the restricted cells as one page for a browser, with all that it needs in the one file.
//!
//! Rust writes what is to be seen (`block`, `timeline`), the page's own text (`page.html`, `page.css`, the `.js` beside them) shows it by three.js
//! (`three.min.js`, MIT; how it is made is said in `three.entry.js`). The page asks no network for anything, and its own policy forbids it to.

mod block;
mod timeline;

use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use laguerre::{Backend, Error, Output, PowerDiagram, Request, Result, io};
use rayon::prelude::*;
use serde::Serialize;

use crate::container::Whole;
use crate::report::{Report, grouped};
use block::{Block, Frame, Lengths};
pub(crate) use timeline::{Moment, Remembering, Timeline};

/// Endings of such files.
pub(crate) const ENDINGS: &[&str] = &[".html", ".htm"];
/// Some 170 MB; browsers end at half a gigabyte of text.
const MOST_SITES: usize = 1_000_000;

/// What is said and drawn beside the cells.
#[derive(Debug, Default)]
pub(crate) struct Page {
    pub(crate) title: String,
    /// Figures of the run, as they are to be read.
    pub(crate) facts: Vec<(&'static str, String)>,
    /// Which states there are, of how many.
    pub(crate) shown: String,
    pub(crate) plot: Option<Plot>,
    /// Names of the [`Moment::values`], with their units.
    pub(crate) fields: Vec<(&'static str, &'static str)>,
    /// The field whose colours are seen first; volume unless given.
    pub(crate) first_field: Option<&'static str>,
}

/// How a run went: a curve of positive numbers, over its rows.
#[derive(Debug, Serialize)]
pub(crate) struct Plot {
    /// What a row is.
    pub(crate) x: &'static str,
    pub(crate) y: &'static str,
    /// Whether a factor is a distance.
    pub(crate) log: bool,
    pub(crate) values: Vec<f64>,
}

/// What the page's script reads beside the blocks.
#[derive(Serialize)]
struct Meta<'a> {
    title: &'a str,
    facts: &'a [(&'static str, String)],
    shown: &'a str,
    plot: &'a Option<Plot>,
    first: &'a str,
    lo: [f64; 3],
    hi: [f64; 3],
    size: f64,
    fields: Vec<Field<'a>>,
    states: Vec<State<'a>>,
}

/// What cells are coloured by.
#[derive(Serialize)]
struct Field<'a> {
    name: &'a str,
    unit: &'a str,
    /// The block's number for 1.
    scale: f64,
    /// The least and the largest of all states, and those but for a hundredth at each end.
    range: [f64; 2],
    most: [f64; 2],
}

#[derive(Serialize)]
struct State<'a> {
    label: &'a str,
    row: usize,
    #[serde(flatten)]
    lengths: Lengths,
}

/// Checks that there are not too many sites for a page.
///
/// # Errors
/// `Input` where there are.
pub(crate) fn check_sites(path: Option<&PathBuf>, sites: usize) -> Result<()> {
    match path {
        Some(_) if sites > MOST_SITES => Err(Error::input(format!(
            "--html: {} sites, and a browser opens a page of {} at most; write .vtu for ParaView with integrate -o",
            grouped(sites as u64),
            grouped(MOST_SITES as u64)
        ))),
        _ => Ok(()),
    }
}

/// Writes the page of one diagram, whose output has geometry.
///
/// # Errors
/// `Io` where writing failed.
pub(crate) fn write_still(path: &Path, page: &Page, diagram: &PowerDiagram, output: &Output) -> Result<()> {
    let whole = Whole::of(diagram)?;
    let moment =
        Moment { label: String::new(), row: 0, positions: Vec::new(), weights: Vec::new(), values: Vec::new() };
    let block = block(diagram, output, frame(&whole), &moment)?;
    write(path, page, &whole, &[(&moment, block)])
}

/// Writes the page of a run, whose cells at each of `moments` are computed once more for it.
///
/// # Errors
/// As [`Backend::evaluate`], and `Io` where writing failed.
pub(crate) fn write_run(
    path: &Path,
    page: &Page,
    backend: &dyn Backend,
    diagram: &PowerDiagram,
    moments: &[Moment],
) -> Result<()> {
    let whole = Whole::of(diagram)?;
    let mut blocks = Vec::new();
    let mut diagram = diagram.clone();
    for moment in moments {
        diagram.set_sites(&moment.positions, &moment.weights)?;
        // Ctrl-C has come already where it ended the run.
        let output = backend.evaluate(&diagram, &Request::moments().with_geometry())?;
        blocks.push((moment, block(&diagram, &output, frame(&whole), moment)?));
    }
    write(path, page, &whole, &blocks)
}

/// Where everything is.
fn frame(whole: &Whole) -> Frame {
    let size = (0..3).map(|k| whole.hi[k] - whole.lo[k]).fold(0.0, f64::max);
    Frame { lo: whole.lo, size }
}

fn block(diagram: &PowerDiagram, output: &Output, frame: Frame, moment: &Moment) -> Result<Block> {
    let Some(geometry) = output.geometry() else {
        return Err(Error::input("--html: the cells were computed without their geometry"));
    };
    let none;
    let weights = match diagram.weights() {
        [] => {
            none = vec![0.0; output.volume().len()];
            &none
        }
        weights => weights,
    };
    let own = moment.values.iter().map(|values| (values.as_slice(), 1.0));
    let fields: Vec<(&[f64], f64)> =
        [output.volume(), weights].into_iter().zip(scales(frame.size)).chain(own).collect();
    Block::new(diagram, output, geometry, frame, &fields).map_err(|e| Error::input(format!("--html: {e}")))
}

/// What volumes and weights are in units of, so that 32 bits have room for them.
fn scales(size: f64) -> [f64; 2] {
    [size * size * size, size * size]
}

fn write(path: &Path, page: &Page, whole: &Whole, blocks: &[(&Moment, Block)]) -> Result<()> {
    let names = [("volume", "length³"), ("weight", "length²")].into_iter().chain(page.fields.iter().copied());
    let field = |(k, (name, unit)): (usize, (&'static str, &'static str))| {
        let scale = scales(frame(whole).size).get(k).copied().unwrap_or(1.0);
        let [most, range] = ranges(blocks.iter().flat_map(|(_, block)| block.fields[k].iter().copied()).collect());
        let times = |ends: [f64; 2]| ends.map(|x| x * scale);
        Field { name, unit, scale, range: times(range), most: times(most) }
    };
    let meta = Meta {
        title: &page.title,
        facts: &page.facts,
        shown: &page.shown,
        plot: &page.plot,
        first: page.first_field.unwrap_or("volume"),
        lo: whole.lo,
        hi: whole.hi,
        size: frame(whole).size,
        fields: names.enumerate().map(field).collect(),
        states: blocks
            .iter()
            .map(|(moment, block)| State { label: &moment.label, row: moment.row, lengths: block.lengths })
            .collect(),
    };
    // Within a script `</script>` and `<!--` would be read by the browser first.
    let meta = serde_json::to_string(&meta).map_err(|e| Error::input(format!("--html: {e}")))?.replace('<', "\\u003c");
    let texts: Vec<String> = blocks.par_iter().map(|(_, block)| STANDARD.encode(&block.deflated)).collect();
    io::write_whole(path, |w| {
        for line in PAGE.split_inclusive('\n') {
            match line.trim() {
                "@title" => w.write_all(escaped(&page.title).as_bytes())?,
                "@style" => w.write_all(include_bytes!("page/page.css"))?,
                "@licence" => w.write_all(include_bytes!("page/three-LICENSE"))?,
                "@three" => w.write_all(include_bytes!("page/three.min.js"))?,
                "@script" => SCRIPTS.iter().try_for_each(|script| w.write_all(script.as_bytes()))?,
                "@meta" => w.write_all(meta.as_bytes())?,
                "@blocks" => {
                    for (k, text) in texts.iter().enumerate() {
                        writeln!(w, "<script type=\"text/plain\" id=\"block-{k}\">{text}</script>")?;
                    }
                }
                _ => w.write_all(line.as_bytes())?,
            }
        }
        Ok(())
    })
}

const PAGE: &str = include_str!("page/page.html");
const SCRIPTS: [&str; 5] = [
    include_str!("page/data.js"),
    include_str!("page/shapes.js"),
    include_str!("page/view.js"),
    include_str!("page/plot.js"),
    include_str!("page/panel.js"),
];

/// Text as it stands in HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The least and the largest number, and those that a hundredth is below and above.
fn ranges(mut numbers: Vec<f32>) -> [[f64; 2]; 2] {
    if numbers.is_empty() {
        return [[0.0; 2]; 2];
    }
    numbers.par_sort_unstable_by(f32::total_cmp);
    let last = numbers.len() - 1;
    let at = |k: usize| f64::from(numbers[k]);
    [[at(0), at(last)], [at(last / 100), at(last - last / 100)]]
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
