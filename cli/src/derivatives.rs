//! `laguerre integrate --derivatives`: sparse matrices as `.npz` that `scipy.sparse.load_npz` reads.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use laguerre::engine::memory;
use laguerre::solvers::density::Density;
use laguerre::solvers::derivatives::{Derivatives, Rows};
use laguerre::{Output, PowerDiagram, Request, Result};

use crate::npz;

/// A matrix, and the file that it is written to.
#[derive(Clone, Debug)]
pub(crate) struct Asked {
    what: What,
    pub(crate) path: PathBuf,
}

/// Of what, with respect to what; coordinates of sites and barycenters are rows and columns 3 i, 3 i + 1, 3 i + 2.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum What {
    VolumesByWeights,
    VolumesByPositions,
    BarycentersByWeights,
    BarycentersByPositions,
}

impl What {
    /// Bytes for each site: a cell's own entry and those of some 16 neighbours, row by row and then all together.
    fn bytes(self) -> u64 {
        let numbers = match self {
            Self::VolumesByWeights => 1,
            Self::VolumesByPositions | Self::BarycentersByWeights => 3,
            Self::BarycentersByPositions => 9,
        };
        2 * 17 * 8 * (1 + numbers)
    }
}

/// Reads `volumes-by-weights=FILE`.
pub(crate) fn parse(text: &str) -> std::result::Result<Asked, String> {
    let names = || What::value_variants().iter().filter_map(ValueEnum::to_possible_value);
    let known = || names().map(|name| name.get_name().to_owned()).collect::<Vec<_>>().join(", ");
    let (name, path) = text
        .split_once('=')
        .filter(|(_, path)| !path.is_empty())
        .ok_or_else(|| format!("NAME=FILE.npz is needed, NAME one of {}", known()))?;
    let what = What::from_str(name, false).map_err(|_| format!("'{name}' is none of {}", known()))?;
    Ok(Asked { what, path: path.into() })
}

/// What is to be asked of a backend besides.
pub(crate) fn request(request: Request) -> Request {
    let wanted = Derivatives::request(&Density::Uniform);
    let request = if wanted.facets() { request.with_facets() } else { request };
    let request = if wanted.second_moments() { request.with_second_moments() } else { request };
    if wanted.facet_second_moments() { request.with_facet_second_moments() } else { request }
}

/// Writes the matrix that is asked for.
///
/// # Errors
/// `Io` where writing failed, `Input` where there is no memory for it.
pub(crate) fn write(asked: &Asked, diagram: &PowerDiagram, output: &Output) -> Result<()> {
    let all = Derivatives::new(diagram, output, &Density::Uniform)?;
    let path = &asked.path;
    memory::probe(diagram.positions().len() as u64, asked.what.bytes(), "derivatives")?;
    match asked.what {
        What::VolumesByWeights => write_rows(path, &all.masses_by_weights(), 1),
        What::VolumesByPositions => write_rows(path, &all.masses_by_positions(), 1),
        What::BarycentersByWeights => write_rows(path, &all.barycenters_by_weights(), 3),
        What::BarycentersByPositions => write_rows(path, &all.barycenters_by_positions()?, 3),
    }
}

/// Writes blocks of `high` rows, and `N / high` columns.
fn write_rows<const N: usize>(path: &Path, rows: &Rows<N>, high: usize) -> Result<()> {
    let (wide, sites) = (N / high, rows.offsets.len() - 1);
    // A block gives each of its rows `wide` entries.
    let all = (0..sites).flat_map(|i| (0..high).map(move |r| (i, r)));
    let of_row = |(i, r): (usize, usize)| {
        rows.row(i).flat_map(move |(j, block)| (0..wide).map(move |c| (wide * j + c, block[wide * r + c])))
    };
    let starts = all.clone().scan(0, |end, (i, _)| {
        *end += wide * (rows.offsets[i + 1] - rows.offsets[i]);
        Some(*end)
    });
    let csr = npz::Csr {
        shape: [high * sites, wide * sites],
        count: N * rows.columns.len(),
        starts: std::iter::once(0).chain(starts),
        entries: || all.clone().flat_map(of_row),
    };
    npz::write_csr(path, csr)
}
