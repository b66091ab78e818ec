//! What the cells are cut by, as the command line says it.

use std::collections::{HashMap, HashSet};

use laguerre::engine::parallel;
use laguerre::{CellStatus, Domain, Error, MergedSites, Output, PowerDiagram, Result};

use crate::args::{ContainerArgs, Corners};
use crate::outcome::note;

/// The domain or box of the command line.
#[derive(Debug)]
pub(crate) enum Container {
    Domain(Domain),
    Box(Corners),
    /// Neither was given.
    Default,
}

impl Container {
    /// Reads the domain if there is one, passing its notes on.
    pub(crate) fn read(args: &ContainerArgs) -> Result<Self> {
        if args.domain.is_some() || args.image.is_some() {
            parallel::start()?;
        }
        let place = args.r#box.map(|corners| (corners.lo, corners.hi));
        let read = match (&args.domain, &args.image) {
            (Some(path), _) => {
                let domain = if args.orient { Domain::load_oriented(path)? } else { Domain::load(path)? };
                Some((path, domain))
            }
            (None, Some(path)) => Some((path, Domain::load_image(path, place)?)),
            (None, None) => None,
        };
        match (read, args.r#box) {
            (Some((path, domain)), _) => {
                for remark in domain.notes() {
                    note(&format!("{}: {remark}", path.display()));
                }
                Ok(Self::Domain(domain))
            }
            (None, Some(corners)) => Ok(Self::Box(corners)),
            (None, None) => Ok(Self::Default),
        }
    }

    pub(crate) fn domain(&self) -> Option<&Domain> {
        match self {
            Self::Domain(domain) => Some(domain),
            _ => None,
        }
    }

    /// Restricts `diagram` to this.
    pub(crate) fn restrict(&self, diagram: PowerDiagram) -> Result<PowerDiagram> {
        match self {
            Self::Domain(domain) => Ok(diagram.restricted_to(domain)),
            Self::Box(corners) => diagram.in_box(corners.lo, corners.hi),
            Self::Default => Ok(diagram),
        }
    }
}

/// Of sites too near to each other to be told apart all but one are without a cell, which is not what they look like in the file.
pub(crate) fn note_if_merged(diagram: &PowerDiagram) -> Result<()> {
    if let Some(MergedSites { count, first: [i, j], .. }) = diagram.merged_sites()? {
        note(&format!(
            "sites too near to another to be told from it in the box or domain: {count} (first site {j}, from site {i}); \
             of each such group one has a cell"
        ));
    }
    Ok(())
}

/// Says which cells are empty because another site stands at the very place of theirs.
pub(crate) fn note_if_coincident(diagram: &PowerDiagram, output: &Output) {
    let key = |p: &[f64; 3]| p.map(|x| (x + 0.0).to_bits());
    let sites = || diagram.positions().iter().enumerate();
    let empty: HashSet<_> =
        sites().filter(|&(i, _)| output.status()[i] == CellStatus::Empty).map(|(_, p)| key(p)).collect();
    if empty.is_empty() {
        return;
    }
    let mut first_at = HashMap::new();
    let others = sites().filter(|(_, p)| empty.contains(&key(p)));
    let twice: Vec<_> =
        others.map(|(i, p)| (*first_at.entry(key(p)).or_insert(i), i)).filter(|(i, j)| i != j).collect();
    if let Some((i, j)) = twice.first() {
        note(&format!(
            "sites at the place of another: {} (first site {j}, at that of site {i}); of each such group one at most has a cell, \
             the first of those with the largest weight",
            twice.len()
        ));
    }
}

/// What the cells must sum to: the container's own box, volume and barycenter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whole {
    pub(crate) lo: [f64; 3],
    pub(crate) hi: [f64; 3],
    pub(crate) volume: f64,
    pub(crate) barycenter: [f64; 3],
    /// Whether the volume is a mass.
    pub(crate) has_density: bool,
}

impl Whole {
    pub(crate) fn of(diagram: &PowerDiagram) -> Result<Self> {
        use laguerre::Container;
        let container = diagram.container()?;
        let volume = container.volume();
        let whole = match container {
            Container::Domain(domain) => {
                let (lo, hi) = domain.bounding_box();
                Self { lo, hi, volume, barycenter: domain.barycenter(), has_density: domain.has_density() }
            }
            Container::Box(lo, hi) => {
                let barycenter = std::array::from_fn(|k| lo[k] + (hi[k] - lo[k]) / 2.0);
                Self { lo, hi, volume, barycenter, has_density: false }
            }
        };
        if whole.volume > 0.0 && whole.volume.is_finite() {
            return Ok(whole);
        }
        Err(Error::input(format!("the volume {} of the domain or box is no positive number", whole.volume)))
    }

    /// Length of the box's diagonal.
    pub(crate) fn diagonal(&self) -> f64 {
        let [x, y, z] = std::array::from_fn(|k| self.hi[k] - self.lo[k]);
        x.hypot(y).hypot(z)
    }
}
