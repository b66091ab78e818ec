//! The experiments of the paper (Basselin et al., "Restricted Power Diagrams on the GPU", Eurographics 2021, §6), as text.

mod counts;
mod equal;
mod overhead;
mod precision;
mod timings;

use std::collections::HashMap;
use std::rc::Rc;

use clap::ValueEnum;
use laguerre::{Backend, Domain, Error, PowerDiagram, Result, io};

use crate::args::{Corners, Distribution, Experiment, PaperArgs};
use crate::domains;
use crate::evaluate::open;
use crate::outcome::{Outcome, print, say};
use crate::plot;
use crate::report::{grouped, machine};
use crate::sample::Sampler;

const SEED: u64 = 1;
const FILES: &[&str] = &[".md"];

/// What the experiments share.
struct Lab {
    backend: Box<dyn Backend>,
    repetitions: u32,
    sites: HashMap<(Distribution, u32), Rc<Vec<[f64; 3]>>>,
    bunny: Domain,
    power: Option<Rc<equal::Inside>>,
}

pub(crate) fn run(args: &PaperArgs) -> Result<Outcome> {
    args.markdown.iter().try_for_each(|path| io::check_output(path, FILES))?;
    args.picture.iter().try_for_each(|path| io::check_output(path, plot::ENDINGS))?;
    let backend = open(&args.backend)?;
    let info = backend.info();
    let bunny = domains::in_unit_cube(&domains::bunny()?)?;
    let mut lab = Lab { backend, repetitions: args.repetitions, sites: HashMap::new(), bunny, power: None };
    let key = key(info.backend, &args.only);
    let (machine, threads) = machine();
    let computed_by = match info.backend {
        "cpu" => format!("`cpu`, {} threads", info.threads),
        other => format!("`{other}` on {}", info.device),
    };
    let mut text = format!(
        "### {} sites, backend {computed_by}, {}\n\nMachine: {machine}, {threads} threads. Medians of {} after \
         one to warm up, the spread in brackets; the whole call is from arrays in memory to results in memory. \
         Compared are the device's times, or without a device the fastest calls. Volumes and barycenters, no facets. \
         Sites fill the unit cube, and each domain is scaled into it.\n",
        grouped(args.sites.into()),
        info.precision.word(),
        lab.repetitions
    );
    for experiment in &args.only {
        let part = match experiment {
            Experiment::Fig9 => counts::run(&mut lab, args.sites, args.picture.as_deref())?,
            Experiment::Fig10 => timings::run(&mut lab, args.sites)?,
            Experiment::Fig11 => overhead::run(&mut lab, args.sites)?,
            Experiment::Precision => precision::run(&mut lab, args.sites, &args.backend)?,
        };
        text.push('\n');
        text.push_str(&part);
        // What is done is kept, should the rest be interrupted.
        if let Some(path) = &args.markdown {
            let whole = format!("<!-- paper {key}: begin -->\n{text}<!-- paper {key}: end -->\n");
            io::write_whole(path, |w| w.write_all(whole.as_bytes()))?;
        }
    }
    if args.markdown.is_none() {
        print(&text)?;
    }
    Ok(Outcome::Done)
}

impl Lab {
    /// The sites of a distribution in the cube, made once.
    fn sites(&mut self, distribution: Distribution, count: u32) -> Result<Rc<Vec<[f64; 3]>>> {
        if let Some(sites) = self.sites.get(&(distribution, count)) {
            return Ok(sites.clone());
        }
        let mut sampler = Sampler::new(Corners::UNIT_CUBE, None, SEED).relaxed_by(self.backend.as_ref());
        let sites = Rc::new(sampler.sample(distribution, count)?);
        self.sites.insert((distribution, count), sites.clone());
        Ok(sites)
    }

    /// The sites of Fig. 11, with weights for equal volumes, made once.
    fn power(&mut self, count: u32) -> Result<Rc<equal::Inside>> {
        if let Some(power) = &self.power {
            return Ok(power.clone());
        }
        let sites = self.sites(Distribution::Blue, count)?;
        let power = Rc::new(equal::inside(self.backend.as_ref(), &sites, &self.bunny)?);
        self.power = Some(power.clone());
        Ok(power)
    }
}

/// The diagram of some sites in a domain, or else in the cube.
fn diagram(sites: &[[f64; 3]], weights: &[f64], domain: Option<&Domain>) -> Result<PowerDiagram> {
    let diagram = PowerDiagram::new(sites, weights)?;
    match domain {
        Some(domain) => Ok(diagram.restricted_to(domain)),
        None => diagram.in_box(Corners::UNIT_CUBE.lo, Corners::UNIT_CUBE.hi),
    }
}

/// What the marker comments say, so that text replaces text of the same backend and experiments.
fn key(backend: &str, only: &[Experiment]) -> String {
    if only == Experiment::value_variants() {
        return backend.to_owned();
    }
    let names = only.iter().filter_map(|experiment| Some(experiment.to_possible_value()?.get_name().to_owned()));
    format!("{backend} {}", names.collect::<Vec<_>>().join(" "))
}

/// A row of a table; said on standard error too, for whoever waits.
fn row(cells: &[String]) -> String {
    let row = format!("| {} |", cells.join(" | "));
    say(&row);
    row + "\n"
}

/// The head of a table.
fn head(cells: &[&str]) -> String {
    format!("| {} |\n|{}\n", cells.join(" | "), "---|".repeat(cells.len()))
}

/// A domain by its name, in the cube.
fn domain(name: &str) -> Result<Domain> {
    let found = domains::named(name).unwrap_or_else(|| Err(Error::input(format!("no domain {name}"))));
    domains::in_unit_cube(&found?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markers_name_what_is_not_all() {
        assert_eq!(key("cpu", Experiment::value_variants()), "cpu");
        assert_eq!(key("ocl", &[Experiment::Fig10, Experiment::Precision]), "ocl fig10 precision");
    }
}
