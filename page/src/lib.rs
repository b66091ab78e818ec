//! The restricted cells as one page for a browser, with all that it needs in the one file: what the program `laguerre` writes with `--html`, and the
//! Python module with `cells.save("cells.html")`.
//!
//! Rust writes what is to be seen (`block`, `timeline`), the page's own text (`page.html`, `page.css`, the `.js` beside them) shows it by three.js
//! (`three.min.js`, MIT; how it is made is said in `three.entry.js`). The page asks no network for anything, and its own policy forbids it to.

mod block;
mod timeline;

use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use laguerre::{Backend, Container, Error, Observer, Output, PowerDiagram, Request, Result, io};
use rayon::prelude::*;
use serde::Serialize;

use block::{Block, Frame, Lengths};
pub use timeline::{Moment, Remembering, Timeline};

/// Endings of such files.
pub const ENDINGS: &[&str] = &[".html", ".htm"];
/// How many sites a page has at most: some 170 MB; browsers end at half a gigabyte of text.
pub const MOST_SITES: usize = 1_000_000;

/// What is said and drawn beside the cells.
#[derive(Debug, Default)]
pub struct Page {
    /// What it shows.
    pub title: String,
    /// Figures of the run, as they are to be read.
    pub facts: Vec<(&'static str, String)>,
    /// Which states there are, of how many.
    pub shown: String,
    /// How the run went, if it was one.
    pub plot: Option<Plot>,
    /// Names of the [`Moment::values`], with their units.
    pub fields: Vec<(&'static str, &'static str)>,
    /// The field whose colours are seen first; volume unless given.
    pub first_field: Option<&'static str>,
}

/// How a run went: a curve of positive numbers, over its rows.
#[derive(Debug, Serialize)]
pub struct Plot {
    /// What a row is.
    pub x: &'static str,
    /// What the numbers are.
    pub y: &'static str,
    /// Whether a factor is a distance.
    pub log: bool,
    /// A number for each row.
    pub values: Vec<f64>,
}

impl Plot {
    /// The curve of a run, by what its states call the numbers: `gradient` (of Lloyd's relaxation), `residual` (of transport), `kinetic` (of a fluid).
    pub fn of(name: &str, values: Vec<f64>) -> Option<Self> {
        let (x, y, log) = match name {
            "gradient" => ("iteration", "gradient (distance of sites from barycenters, in cells)", true),
            "residual" => ("step", "residual (largest relative error of a mass)", true),
            "kinetic" => ("step", "kinetic energy", false),
            _ => return None,
        };
        Some(Self { x, y, log, values })
    }
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

/// Writes the page of one diagram, whose output has geometry, watched by `observer`.
///
/// # Errors
/// `Input` where there is no geometry, or there are too many sites; `Io` where writing failed; `Interrupted` where the observer ends it.
pub fn write_still(
    path: &Path,
    page: &Page,
    diagram: &PowerDiagram,
    output: &Output,
    observer: &dyn Observer,
) -> Result<()> {
    let frame = Frame::of(diagram)?;
    let moment =
        Moment { label: String::new(), row: 0, positions: Vec::new(), weights: Vec::new(), values: Vec::new() };
    let block = block(diagram, output, frame, &moment)?;
    observer.tell(0)?;
    write(path, page, frame, &[(&moment, block)], observer)
}

/// Writes the page of a run, whose cells at each of `moments` are computed once more for it.
///
/// # Errors
/// As [`Backend::evaluate`], and `Io` where writing failed.
pub fn write_run(
    path: &Path,
    page: &Page,
    backend: &dyn Backend,
    diagram: &PowerDiagram,
    moments: &[Moment],
) -> Result<()> {
    let frame = Frame::of(diagram)?;
    let mut blocks = Vec::new();
    let mut diagram = diagram.clone();
    for moment in moments {
        diagram.set_sites(&moment.positions, &moment.weights)?;
        // Ctrl-C has come already where it ended the run.
        let output = backend.evaluate(&diagram, &Request::moments().with_geometry())?;
        blocks.push((moment, block(&diagram, &output, frame, moment)?));
    }
    write(path, page, frame, &blocks, &())
}

impl Frame {
    /// That of the diagram's container.
    fn of(diagram: &PowerDiagram) -> Result<Self> {
        let sites = diagram.positions().len();
        if sites > MOST_SITES {
            return Err(Error::input(format!(
                "{sites} sites, and a browser opens a page of {MOST_SITES} at most; write .vtu for ParaView"
            )));
        }
        let (lo, hi) = match diagram.container()? {
            Container::Domain(domain) => domain.bounding_box(),
            Container::Box(lo, hi) => (lo, hi),
        };
        let size = (0..3).map(|k| hi[k] - lo[k]).fold(0.0, f64::max);
        Ok(Self { lo, hi, size })
    }
}

fn block(diagram: &PowerDiagram, output: &Output, frame: Frame, moment: &Moment) -> Result<Block> {
    let Some(geometry) = output.geometry() else {
        return Err(Error::input("a page: the cells were computed without their geometry"));
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
    Block::new(diagram, output, geometry, frame, &fields).map_err(|e| Error::input(format!("a page: {e}")))
}

/// What volumes and weights are in units of, so that 32 bits have room for them.
fn scales(size: f64) -> [f64; 2] {
    [size * size * size, size * size]
}

fn write(path: &Path, page: &Page, frame: Frame, blocks: &[(&Moment, Block)], observer: &dyn Observer) -> Result<()> {
    let names = [("volume", "length³"), ("weight", "length²")].into_iter().chain(page.fields.iter().copied());
    let field = |(k, (name, unit)): (usize, (&'static str, &'static str))| {
        let scale = scales(frame.size).get(k).copied().unwrap_or(1.0);
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
        lo: frame.lo,
        hi: frame.hi,
        size: frame.size,
        fields: names.enumerate().map(field).collect(),
        states: blocks
            .iter()
            .map(|(moment, block)| State { label: &moment.label, row: moment.row, lengths: block.lengths })
            .collect(),
    };
    // Within a script `</script>` and `<!--` would be read by the browser first.
    let meta = serde_json::to_string(&meta).map_err(|e| Error::input(format!("a page: {e}")))?.replace('<', "\\u003c");
    let texts: Vec<String> = blocks.par_iter().map(|(_, block)| STANDARD.encode(&block.deflated)).collect();
    io::write_whole_watched(path, observer, |w| {
        for line in PAGE.split_inclusive('\n') {
            match line.trim() {
                "@title" => w.write_all(escaped(&page.title).as_bytes())?,
                "@style" => w.write_all(include_bytes!("page.css"))?,
                "@licence" => w.write_all(include_bytes!("three-LICENSE"))?,
                "@three" => w.write_all(include_bytes!("three.min.js"))?,
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

const PAGE: &str = include_str!("page.html");
const SCRIPTS: [&str; 5] = [
    include_str!("data.js"),
    include_str!("shapes.js"),
    include_str!("view.js"),
    include_str!("plot.js"),
    include_str!("panel.js"),
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
