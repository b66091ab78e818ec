//! Which cell is farthest from the mass asked for, and what stands in its way, where that can be shown.

use std::fmt;

use laguerre_core::Facet;

use super::End;
use super::newton::{Problem, State};

/// A residual is what rounding leaves where it is no more than so many times what one rounding changes: each weight is rounded, and those of a
/// cell's neighbours are, too. Measured: 0.1 to 1 of pairs and fives of sites from 1e-9 to 1e-15 apart.
const ROUNDINGS: f64 = 8.0;

/// The cell whose mass is farthest from the one asked for, by the part of that.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Worst {
    /// Its site.
    pub site: usize,
    /// Where that is.
    pub position: [f64; 3],
    /// The cell's mass.
    pub mass: f64,
    /// The mass asked for.
    pub target: f64,
    /// What stands in the way, where that can be shown.
    pub cause: Option<Cause>,
}

/// Why no step brings a mass closer to the one asked for.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    /// No double is between those that the weights are: a weight that changes by its rounding, `ε·max(|w|, d²)`, moves a facet of area A by
    /// that over 2d, where d is the distance of the two sites, and A times as much mass from one to the other.
    Rounding {
        /// The sites: the worst and a neighbour, or two others, whose rounding outweighs what a step could gain elsewhere.
        sites: [usize; 2],
        /// Their distance.
        distance: f64,
        /// The mass that one rounding of a weight moves between the two.
        change: f64,
    },
    /// Cells touch none but each other, and no weights were found for which they get from others what they lack.
    Apart {
        /// How many cells.
        cells: usize,
        /// The mass that they lack together.
        lacking: f64,
    },
}

impl Worst {
    /// That of a state, where `end` is the end.
    pub(super) fn new(problem: &Problem<'_>, state: &State, end: End) -> Self {
        let off = |i: usize| (state.masses[i] / problem.targets[i] - 1.0).abs();
        let stuck = problem.stuck.as_deref();
        let is_among = |i: &usize| stuck.is_none_or(|stuck| stuck[*i]);
        let all = 0..state.masses.len();
        let site = all.clone().filter(is_among).max_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap_or(0);
        let lacking = |i: usize| problem.targets[i] - state.masses[i];
        let cause = match stuck {
            Some(_) => Some(Cause::Apart {
                cells: all.clone().filter(is_among).count(),
                lacking: all.filter(is_among).map(lacking).sum::<f64>() / state.scale,
            }),
            None if end == End::Stalled => rounding(problem, state, site),
            None => None,
        };
        let (mass, target) = (state.masses[site] / state.scale, problem.targets[site] / state.scale);
        Self { site, position: problem.diagram.positions()[site], mass, target, cause }
    }
}

/// What rounding does to one cell: the part of its target, and the mass that goes over the facet where that is most.
struct Change {
    part: f64,
    facet: Facet,
    mass: f64,
}

/// Where the residual is what rounding leaves of the worst cell, or less than it leaves of another.
fn rounding(problem: &Problem<'_>, state: &State, worst: usize) -> Option<Cause> {
    let facets = state.output.facets()?;
    let change = |site: usize| {
        let over = |facet: &Facet| {
            let size = state.weights[site].abs().max(state.weights[facet.neighbor].abs());
            let rounding = f64::EPSILON * size.max(facet.distance * facet.distance);
            problem.density.at(facet.barycenter) * facet.area / (2.0 * facet.distance) * rounding
        };
        let changes = || facets.of(site).map(|facet| (over(&facet), facet));
        let (mass, facet) = changes().max_by(|a, b| a.0.total_cmp(&b.0))?;
        // And the mass is a sum, rounded as well.
        let all = changes().map(|(mass, _)| mass).sum::<f64>() * state.scale + f64::EPSILON * state.masses[site];
        Some(Change { part: all / problem.targets[site], facet, mass })
    };
    let explains = |change: &Change| state.residual <= ROUNDINGS * change.part;
    let most =
        || (0..state.masses.len()).filter_map(|i| Some((i, change(i)?))).max_by(|a, b| a.1.part.total_cmp(&b.1.part));
    let (site, Change { facet, mass, .. }) = change(worst)
        .map(|change| (worst, change))
        .filter(|found| explains(&found.1))
        .or_else(most)
        .filter(|found| explains(&found.1))?;
    Some(Cause::Rounding { sites: [site, facet.neighbor], distance: facet.distance, change: mass })
}

impl fmt::Display for Worst {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { site, position, mass, target, cause } = self;
        write!(f, "site {site} at {position:?} has the mass {mass:?}, not {target:?}")?;
        match cause {
            Some(Cause::Rounding { sites: [a, b], distance, change }) => write!(
                f,
                ": what is left is rounding: that of a weight moves {change:.1e} between sites {a} and {b}, at a distance of {distance:.1e}"
            ),
            Some(Cause::Apart { cells, lacking }) => write!(
                f,
                ": its cell is one of {cells} that touch no others and lack {lacking:.1e}, and no weights were found that bring it there"
            ),
            None => Ok(()),
        }
    }
}
