//! The sites of the command line, with their weights.

use laguerre::{Error, PowerDiagram, Result, io};

use crate::args::SitesArgs;
use crate::npz;

/// Reads the sites, and their weights where those have a file of their own.
pub(crate) fn read(args: &SitesArgs) -> Result<PowerDiagram> {
    let mut sites = match &args.columns {
        Some(columns) => io::read_sites_by_columns(&args.path, columns)?,
        None => npz::read_sites(&args.path)?,
    };
    if let Some(path) = &args.weights {
        if !sites.weights.is_empty() {
            let name = name(args);
            return Err(Error::input(format!("{name}: has weights already; leave --weights or the fourth column out")));
        }
        let weights = io::read_weights(path)?;
        if weights.len() != sites.positions.len() {
            return Err(Error::input(format!(
                "{}: {} weights, but {} has {} sites; give one for each",
                path.display(),
                weights.len(),
                name(args),
                sites.positions.len()
            )));
        }
        sites.weights = weights;
    }
    PowerDiagram::new(&sites.positions, &sites.weights).map_err(|e| e.at(name(args)))
}

/// What messages call the file of the sites.
pub(crate) fn name(args: &SitesArgs) -> String {
    if args.path.as_os_str() == "-" { "standard input".into() } else { args.path.display().to_string() }
}
