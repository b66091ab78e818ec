//! Derivatives of masses and barycenters with respect to weights and positions, as sparse rows.
//!
//! The facet of sites i and j, at distance d, lies where both powers are equal. A point x of it moves out of cell i along its normal by `1/(2d)`
//! for each unit of `w_i` and by `−1/(2d)` for each of `w_j`; by `(x − p_i)/d · δp_i` and `(p_j − x)/d · δp_j`. Hence, with ρ the density,
//! `m_i` the mass and `b_i` the barycenter of the restricted cell,
//!
//! - `∂m_i/∂w_j = −∫ ρ / (2d)`, `∂m_i/∂p_j = ∫ ρ (p_j − x)ᵀ / d` over their facet;
//! - `∂m_i/∂w_i = Σ_j ∫ ρ / (2d)`, `∂m_i/∂p_i = Σ_j ∫ ρ (x − p_i)ᵀ / d` over all of i's facets;
//! - the same for `∂b_i` with `ρ (x − b_i) / m_i` in place of ρ.
//!
//! The domain's boundary stays where it is and adds nothing. The integrals take the facets' areas, barycenters and second moments, and
//! are exact. They are derivatives where no facet is about to appear on a triangle of the surface, all over that triangle; there, as where two sites
//! coincide, masses have none.

use crate::density::Density;
use crate::vectors::{for_each, inner};
use laguerre_core::parallel;
use laguerre_core::{CellStatus, Error, Facet, Facets, Output, PowerDiagram, Request, Result};
use std::ops::Deref;

/// Rows that one task makes.
const ROWS_AT_ONCE: usize = 256;

/// Sparse rows, one for each cell, of blocks of `N` numbers: those of row `i` are `offsets[i]..offsets[i + 1]`, sorted by column. A row has its
/// neighbours' columns and its own; that of an empty cell has none. (`values.as_flattened()` are the numbers alone.)
#[derive(Clone, Debug, PartialEq)]
pub struct Rows<const N: usize> {
    /// Row starts; one more than sites.
    pub offsets: Vec<usize>,
    /// The site that the derivative is with respect to.
    pub columns: Vec<u32>,
    /// The derivative.
    pub values: Vec<[f64; N]>,
}

impl<const N: usize> Rows<N> {
    /// Columns and values of row `i`.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, [f64; N])> {
        let row = self.offsets[i]..self.offsets[i + 1];
        self.columns[row.clone()].iter().map(|&j| j as usize).zip(self.values[row].iter().copied())
    }
}

/// The derivatives at an evaluated diagram.
#[derive(Clone, Copy, Debug)]
pub struct Derivatives<'a> {
    diagram: &'a PowerDiagram,
    positions: &'a [[f64; 3]],
    output: &'a Output,
    facets: &'a Facets,
    facet_moments: &'a [[f64; 6]],
    density: &'a Density,
}

/// A facet, as the cell of site `i` sees it, with its second moment.
struct Seen {
    i: usize,
    facet: Facet,
    second: [f64; 6],
}

impl Deref for Seen {
    type Target = Facet;

    fn deref(&self) -> &Facet {
        &self.facet
    }
}

impl<'a> Derivatives<'a> {
    /// What is to be asked of a backend.
    pub fn request(density: &Density) -> Request {
        let request = Request::moments().with_facet_second_moments();
        match density {
            // For the barycenters of mass.
            Density::Linear { .. } => request.with_second_moments(),
            _ => request,
        }
    }

    /// Of what a backend made of `diagram`, asked for [`Derivatives::request`].
    ///
    /// # Errors
    /// `Input` where `output` is not of `diagram`, or lacks what is needed; or the density is a function, which facets tell too little of.
    pub fn new(diagram: &'a PowerDiagram, output: &'a Output, density: &'a Density) -> Result<Self> {
        check(density)?;
        let positions = diagram.positions();
        if output.status().len() != positions.len() {
            return Err(Error::input(format!(
                "derivatives: {} cells of {} sites",
                output.status().len(),
                positions.len()
            )));
        }
        let facets = output.facets();
        let (Some(facets), Some(facet_moments), Some(_)) =
            (facets, facets.and_then(|f| f.second_moment()), density.centers(diagram, output))
        else {
            return Err(Error::input("derivatives: the cells are without moments: evaluate `Derivatives::request`"));
        };
        Ok(Self { diagram, positions, output, facets, facet_moments, density })
    }

    /// `∂m_i/∂w_j` (mass per length²): symmetric, and every row and column sums to 0. It is minus the weighted Laplacian.
    pub fn masses_by_weights(&self) -> Rows<1> {
        self.rows(|facet| {
            let flow = self.mass(facet) / (2.0 * facet.distance);
            ([-flow], [flow])
        })
    }

    /// `∂m_i/∂p_j` (mass per length), one number for each coordinate of `p_j`; every column sums to 0.
    pub fn masses_by_positions(&self) -> Rows<3> {
        self.rows(|facet| {
            let over = |x| self.moment(facet, x).map(|m| m / facet.distance);
            (over(self.positions[facet.neighbor]).map(|m| -m), over(self.positions[facet.i]))
        })
    }

    /// `∂b_i/∂w_j` (per length), one number for each coordinate of the barycenter (of mass).
    pub fn barycenters_by_weights(&self) -> Rows<3> {
        let (masses, centers) = self.cells();
        self.rows(|facet| {
            let flow = self.moment(facet, centers[facet.i]).map(|m| m / (2.0 * facet.distance * masses[facet.i]));
            (flow.map(|m| -m), flow)
        })
    }

    /// `∂b_i/∂p_j`: number `3 r + c` is that of the barycenter's coordinate `r` with respect to the position's coordinate `c`.
    ///
    /// # Errors
    /// `Input` where the density is not uniform: it would take third moments of the facets.
    pub fn barycenters_by_positions(&self) -> Result<Rows<9>> {
        if *self.density != Density::Uniform {
            return Err(positions_need_uniform());
        }
        let (masses, centers) = self.cells();
        Ok(self.rows(|facet| {
            let (b, share) = (facet.barycenter, facet.distance * masses[facet.i]);
            // ∫ (x − b_i)(x − p)ᵀ dA.
            let over = |p: [f64; 3]| {
                std::array::from_fn(|k| {
                    let (r, c) = (k / 3, k % 3);
                    let arms = (b[r] - centers[facet.i][r]) * (b[c] - p[c]);
                    (facet.area * arms + entry(&facet.second, r, c)) / share
                })
            };
            let other: [f64; 9] = over(self.positions[facet.neighbor]);
            (other.map(|m| -m), over(self.positions[facet.i]))
        }))
    }

    /// What a function of masses and barycenters changes with: by each position and each weight, from what it changes with by each mass, and by each
    /// barycenter (an empty slice stands for zeros; empty cells take no part). That is the product of these derivatives with the transposed matrices above, in one pass over
    /// the facets: with `φ_i(x) = u_i + v_i·(x − b_i)/m_i`, where `u` and `v` are given, it is `Σ_j ∫ ρ (φ_i − φ_j)(x − p_i)/d` by `p_i`, and `Σ_j ∫ ρ (φ_i − φ_j)/(2d)` by `w_i`.
    ///
    /// # Errors
    /// `Input` where there is not one number for each site, or the density is not uniform and it changes with barycenters:
    /// positions would take third moments.
    pub fn pull_back(&self, by_masses: &[f64], by_barycenters: &[[f64; 3]]) -> Result<(Vec<[f64; 3]>, Vec<f64>)> {
        if *self.density != Density::Uniform && !by_barycenters.is_empty() {
            return Err(positions_need_uniform());
        }
        let positions = self.gathered(by_masses, by_barycenters, |facet, jump, tilt| {
            let moment = self.moment(facet, self.positions[facet.i]);
            let tilted = |c: usize| (0..3).map(|r| tilt[r] * entry(&facet.second, r, c)).sum::<f64>();
            std::array::from_fn(|c| (jump * moment[c] + tilted(c)) / facet.distance)
        })?;
        Ok((positions, self.pull_back_to_weights(by_masses, by_barycenters)?))
    }

    /// The same by weights alone, for any density.
    ///
    /// # Errors
    /// `Input` where there is not one number for each site.
    pub fn pull_back_to_weights(&self, by_masses: &[f64], by_barycenters: &[[f64; 3]]) -> Result<Vec<f64>> {
        let weights = self.gathered(by_masses, by_barycenters, |facet, jump, tilt| {
            // Of the tilt about the facet's barycenter what a density that is not even has to do with.
            let uneven = inner(tilt, self.moment(facet, facet.barycenter));
            [(self.mass(facet) * jump + uneven) / (2.0 * facet.distance)]
        })?;
        Ok(weights.into_iter().map(|[w]| w).collect())
    }

    /// Sums over each cell's facets of what `of` makes of the jump of φ at the facet's barycenter, and of the jump of its gradient.
    fn gathered<const N: usize>(
        &self,
        by_masses: &[f64],
        by_barycenters: &[[f64; 3]],
        of: impl Fn(&Seen, f64, [f64; 3]) -> [f64; N] + Sync,
    ) -> Result<Vec<[f64; N]>> {
        let n = self.positions.len();
        for (what, length) in [("masses", by_masses.len()), ("barycenters", by_barycenters.len())] {
            if length != n && (length > 0 || what == "masses") {
                return Err(Error::input(format!(
                    "derivatives by {what}: {length} of them for {n} sites: give one for each"
                )));
            }
        }
        let (masses, centers) = self.cells();
        let gradient = |i: usize| match by_barycenters.get(i) {
            Some(v) if masses[i] > 0.0 => v.map(|v| v / masses[i]),
            _ => [0.0; 3],
        };
        let at = |i: usize, slope: [f64; 3], x: [f64; 3]| {
            let arm = if masses[i] > 0.0 { std::array::from_fn(|k| x[k] - centers[i][k]) } else { [0.0; 3] };
            by_masses[i] + inner(slope, arm)
        };
        let mut sums = vec![[0.0; N]; n];
        for_each(&mut sums, |i, sum| {
            let own = gradient(i);
            for facet in self.facets.of(i) {
                let (j, b) = (facet.neighbor, facet.barycenter);
                let other = gradient(j);
                let jump = at(i, own, b) - at(j, other, b);
                let tilt = std::array::from_fn(|k| own[k] - other[k]);
                let added = of(&Seen { i, facet, second: self.facet_moments[facet.number] }, jump, tilt);
                (0..N).for_each(|k| sum[k] += added[k]);
            }
        });
        Ok(sums)
    }

    /// Masses and their barycenters.
    fn cells(&self) -> (Vec<f64>, Vec<[f64; 3]>) {
        let (masses, centers) = (self.density.masses(self.output), self.density.centers(self.diagram, self.output));
        (masses.unwrap_or_default(), centers.unwrap_or_default())
    }

    /// `∫ ρ` over a facet.
    fn mass(&self, facet: &Seen) -> f64 {
        self.density.at(facet.barycenter) * facet.area
    }

    /// `∫ ρ (x − o)` over a facet.
    fn moment(&self, facet: &Seen, o: [f64; 3]) -> [f64; 3] {
        let (mass, b) = (self.mass(facet), facet.barycenter);
        let gradient = match *self.density {
            Density::Linear { gradient, .. } => gradient,
            _ => [0.0; 3],
        };
        std::array::from_fn(|r| {
            let pulled: f64 = (0..3).map(|c| entry(&facet.second, r, c) * gradient[c]).sum();
            mass * (b[r] - o[r]) + pulled
        })
    }

    /// Rows made of what each facet adds to its neighbour's column, and to its cell's own.
    fn rows<const N: usize>(&self, of: impl Fn(&Seen) -> ([f64; N], [f64; N]) + Sync) -> Rows<N> {
        let row = |i: usize| {
            let mut row = Vec::new();
            if self.output.status()[i] == CellStatus::Empty {
                return row;
            }
            let mut own = [0.0; N];
            for facet in self.facets.of(i) {
                let (other, to_own) = of(&Seen { i, facet, second: self.facet_moments[facet.number] });
                (0..N).for_each(|n| own[n] += to_own[n]);
                row.push((facet.neighbor as u32, other));
            }
            let place = row.partition_point(|(j, _)| (*j as usize) < i);
            row.insert(place, (i as u32, own));
            row
        };
        let chunks = parallel::chunks(self.positions.len(), ROWS_AT_ONCE, |range| range.map(row).collect::<Vec<_>>());
        let offsets = Vec::with_capacity(self.positions.len() + 1);
        let mut made = Rows { offsets, columns: Vec::new(), values: Vec::new() };
        made.offsets.push(0);
        for row in chunks.into_iter().flatten() {
            made.columns.extend(row.iter().map(|(j, _)| j));
            made.values.extend(row.iter().map(|(_, value)| value));
            made.offsets.push(made.columns.len());
        }
        made
    }
}

/// Checks that derivatives with a density are exact: the barycenter of a facet tells no more of a function than a Newton step needs.
///
/// # Errors
/// `Input` where it is a function.
pub(crate) fn check(density: &Density) -> Result<()> {
    match density {
        Density::Function(_) => Err(Error::input(
            "derivatives are there for uniform and linear densities, and for those of voxels or tetrahedra, not for functions",
        )),
        _ => Ok(()),
    }
}

fn positions_need_uniform() -> Error {
    Error::input("derivatives of barycenters with respect to positions are there for the uniform density alone")
}

/// Entry (r, c) of a second moment.
fn entry(second: &[f64; 6], r: usize, c: usize) -> f64 {
    second[if r == c { r } else { r + c + 2 }]
}
