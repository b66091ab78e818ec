//! Sites, weights and the container they are restricted to.

use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::domain_grid::DomainGrid;
use crate::frame::Frame;
use crate::power_octree::PowerOctree;
use crate::site_tree::SiteTree;
use crate::summation::CHUNK;
use crate::{Domain, Error, Result, memory, parallel};

/// Largest coordinate magnitude that is accepted (its fifth power, a second moment, is still a number), and the inverse of the smallest extent of a container.
pub const LARGEST_COORDINATE: f64 = 1e60;

/// How far from the container's minimum corner a site may stand, in units of its frame (one to two largest extents).
/// Positions relative to the container lose a digit for each factor of ten beyond it; this bound leaves twelve.
pub const FARTHEST_SITE: f64 = 1024.0;

/// Largest difference of two weights, in squared units of the container's frame.
pub const LARGEST_WEIGHT_SPREAD: f64 = 1_048_576.0;

/// What the cells are cut by.
#[derive(Clone, Debug)]
pub enum Container {
    /// An axis-aligned box, given by its minimum and maximum corners.
    Box([f64; 3], [f64; 3]),
    /// A triangulated domain.
    Domain(Domain),
}

impl Container {
    /// Its volume (length³); a domain's is weighted by its winding number and density.
    pub fn volume(&self) -> f64 {
        match self {
            Self::Box(lo, hi) => (0..3).map(|k| hi[k] - lo[k]).product(),
            Self::Domain(domain) => domain.volume(),
        }
    }

    /// Its mean density: that volume over the part of space where there is any; 1 of a box.
    pub fn mean_density(&self) -> f64 {
        match self {
            Self::Box(..) => 1.0,
            Self::Domain(domain) => domain.mean_density(),
        }
    }
}

/// Weighted sites and the container of their cells: the input of [`Backend::evaluate`](crate::Backend::evaluate).
///
/// The power distance of `x` to site `i` is `‖x − p_i‖² − w_i`; a larger weight is a larger cell.
///
/// Of sites at one place only that of the largest weight has a cell. So it is of sites that the internal frame cannot tell apart
/// ([`PowerDiagram::merged_sites`]).
#[derive(Clone, Debug)]
pub struct PowerDiagram {
    positions: Vec<[f64; 3]>,
    /// No other positions have this number.
    positions_id: u64,
    weights: Vec<f64>,
    container: Option<Container>,
}

/// The number of the next positions.
static POSITIONS: AtomicU64 = AtomicU64::new(1);

fn next_id() -> u64 {
    POSITIONS.fetch_add(1, Ordering::Relaxed)
}

impl PowerDiagram {
    /// Sites at `positions` with `weights` (length²), one for each; an empty slice stands for all equal (a Voronoi
    /// diagram). Until restricted, the container is the bounding box of the sites.
    ///
    /// # Errors
    /// `Input` where there is no site, the lengths differ, there are more than 2³¹ sites, or a number is not finite or
    /// beyond [`LARGEST_COORDINATE`] (its square for weights).
    pub fn new(positions: &[[f64; 3]], weights: &[f64]) -> Result<Self> {
        let mut diagram = Self { positions: Vec::new(), positions_id: 0, weights: Vec::new(), container: None };
        diagram.set_sites(positions, weights)?;
        Ok(diagram)
    }

    /// Replaces the sites, keeping the container: the loop of a solver.
    ///
    /// # Errors
    /// As [`PowerDiagram::new`]; the diagram is unchanged then.
    pub fn set_sites(&mut self, positions: &[[f64; 3]], weights: &[f64]) -> Result<()> {
        check_sites(positions, weights)?;
        // Both before either: the diagram is as it was where there is no memory.
        room_for(&mut self.positions, positions, "sites")?;
        room_for(&mut self.weights, weights, "weights")?;
        self.positions_id = next_id();
        copy(&mut self.positions, positions);
        copy(&mut self.weights, weights);
        Ok(())
    }

    /// Other sites in the container of this diagram.
    ///
    /// ```
    /// # use laguerre_core::PowerDiagram;
    /// let diagram = PowerDiagram::new(&[[0.0; 3], [1.0, 2.0, 3.0]], &[])?;
    /// assert_eq!(diagram.of_other_sites(&[[0.5; 3]], &[])?.container()?.volume(), 6.0);
    /// # Ok::<(), laguerre_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`PowerDiagram::new`] and [`PowerDiagram::container`].
    pub fn of_other_sites(&self, positions: &[[f64; 3]], weights: &[f64]) -> Result<Self> {
        Ok(Self { container: Some(self.container()?), ..Self::new(positions, weights)? })
    }

    /// Replaces the weights alone; a device to which the positions were brought last is not brought them again.
    ///
    /// # Errors
    /// As [`PowerDiagram::new`]; the diagram is unchanged then.
    pub fn set_weights(&mut self, weights: &[f64]) -> Result<()> {
        check_weights(self.positions.len(), weights)?;
        room_for(&mut self.weights, weights, "weights")?;
        copy(&mut self.weights, weights);
        Ok(())
    }

    /// The same without a copy: exchanges the sites for others, and the weights where some are given too.
    ///
    /// # Errors
    /// As [`PowerDiagram::new`]; nothing is changed then.
    pub fn exchange_sites(&mut self, positions: &mut Vec<[f64; 3]>, weights: Option<&mut Vec<f64>>) -> Result<()> {
        check_sites(positions, weights.as_deref().unwrap_or(&self.weights))?;
        std::mem::swap(&mut self.positions, positions);
        self.positions_id = next_id();
        if let Some(weights) = weights {
            std::mem::swap(&mut self.weights, weights);
        }
        Ok(())
    }

    /// Restricts the cells to a triangulated domain (shared, not copied).
    #[must_use]
    pub fn restricted_to(self, domain: &Domain) -> Self {
        Self { container: Some(Container::Domain(domain.clone())), ..self }
    }

    /// Restricts the cells to the box with minimum corner `lo` and maximum corner `hi`.
    ///
    /// # Errors
    /// `Input` where the box is not finite, inverted, or flat.
    pub fn in_box(self, lo: [f64; 3], hi: [f64; 3]) -> Result<Self> {
        for k in 0..3 {
            let axis = ["x", "y", "z"][k];
            if !(lo[k].abs() <= LARGEST_COORDINATE && hi[k].abs() <= LARGEST_COORDINATE) {
                return Err(Error::input(format!(
                    "box: its {axis} range {:e}..{:e} is not within ±1e60",
                    lo[k], hi[k]
                )));
            }
            let what = match hi[k] - lo[k] {
                wide if wide > 1.0 / LARGEST_COORDINATE => continue,
                narrow if narrow > 0.0 => "no wider than 1e-60; choose another unit",
                _ => "empty or flat; give minimum corner, then maximum corner",
            };
            return Err(Error::input(format!("box: its {axis} range {:e}..{:e} is {what}", lo[k], hi[k])));
        }
        Ok(Self { container: Some(Container::Box(lo, hi)), ..self })
    }

    /// The sites, in the caller's order and unit.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// A number that no other positions have, for who has a copy of them.
    #[doc(hidden)]
    pub fn positions_id(&self) -> u64 {
        self.positions_id
    }

    /// The weights, in the caller's order and unit; empty where all are equal.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The domain, if the diagram is restricted to one.
    pub fn domain(&self) -> Option<&Domain> {
        match &self.container {
            Some(Container::Domain(domain)) => Some(domain),
            _ => None,
        }
    }

    /// Keeps the container that it has, if that is the bounding box of the sites, for when they move.
    ///
    /// # Errors
    /// As [`PowerDiagram::container`].
    pub fn keep_container(&mut self) -> Result<()> {
        self.container = Some(self.container()?);
        Ok(())
    }

    /// The container: the domain, the box, or the bounding box of the sites.
    ///
    /// # Errors
    /// `Input` where no container was given and the bounding box of the sites is flat.
    pub fn container(&self) -> Result<Container> {
        if let Some(container) = &self.container {
            return Ok(container.clone());
        }
        let (lo, hi) = bounding_box(&self.positions);
        if (0..3).any(|k| hi[k] - lo[k] <= 1.0 / LARGEST_COORDINATE) {
            let (whose, cells) = match self.positions.len() {
                1 => ("one site".into(), "its cell"),
                n => (format!("the {n} sites"), "their cells"),
            };
            let what = match (0..3).all(|k| hi[k] > lo[k]) {
                true => "no wider than 1e-60: choose another unit".to_owned(),
                false => format!("flat: give a box or a domain to restrict {cells} to"),
            };
            return Err(Error::input(format!("the bounding box of {whose} is {what}")));
        }
        Ok(Container::Box(lo, hi))
    }

    /// Everything moved into the internal frame, with the tree over the sites. Called by backends, once an evaluation.
    ///
    /// # Errors
    /// `Input` where a site or weight is out of range of the container ([`FARTHEST_SITE`], [`LARGEST_WEIGHT_SPREAD`]),
    /// or where there is none.
    #[doc(hidden)]
    pub fn prepare(&self) -> Result<Prepared> {
        let container = self.framed_container()?;
        self.check_range(&container)?;
        let frame = &container.frame;
        let positions = parallel::map(self.positions.len(), CHUNK, |i| frame.enter(self.positions[i]));
        let weights = parallel::map(self.weights.len(), CHUNK, |i| frame.enter_weight(self.weights[i]));
        Ok(Prepared { container, sites: SiteTree::new(&positions, &weights), octree: None })
    }

    /// The container in its internal frame.
    ///
    /// # Errors
    /// As [`PowerDiagram::container`].
    #[doc(hidden)]
    pub fn framed_container(&self) -> Result<FramedContainer> {
        Ok(match self.container()? {
            Container::Box(lo, hi) => {
                let frame = Frame::of_box(lo, hi);
                FramedContainer { frame, lo: frame.enter(lo), hi: frame.enter(hi), density: 1.0, grid: None }
            }
            Container::Domain(domain) => {
                let grid = domain.grid(self.positions.len());
                let (lo, hi) = (grid.corner([0; 3]), grid.corner(grid.dims()));
                FramedContainer {
                    frame: *domain.frame(),
                    lo,
                    hi,
                    density: domain.density(),
                    grid: Some(Arc::clone(grid)),
                }
            }
        })
    }

    /// Sites at places of their own that count as one: coordinates within [`SMALLEST`](crate::frame::SMALLEST) (7·10⁻⁴⁶) of the
    /// container's extent from the frame's origin are 0, or products of the predicates could underflow; and those of sites outside the container are
    /// rounded where the container is far from zero and they are not.
    ///
    /// # Errors
    /// As [`PowerDiagram::container`].
    pub fn merged_sites(&self) -> Result<Option<MergedSites>> {
        let frame = match self.container()? {
            Container::Box(lo, hi) => Frame::of_box(lo, hi),
            Container::Domain(domain) => *domain.frame(),
        };
        let key = |p: [f64; 3]| frame.enter(p).map(|x| (x + 0.0).to_bits());
        // Of two places that become one at most one comes back.
        let rounded: HashSet<[u64; 3]> =
            self.positions.iter().filter(|&&p| frame.leave(frame.enter(p)) != p).map(|&p| key(p)).collect();
        if rounded.is_empty() {
            return Ok(None);
        }
        let mut first_at: HashMap<[u64; 3], usize> = HashMap::new();
        let mut merged: Option<MergedSites> = None;
        for (i, &p) in self.positions.iter().enumerate().filter(|(_, p)| rounded.contains(&key(**p))) {
            let first = *first_at.entry(key(p)).or_insert(i);
            if self.positions[first] != p {
                merged.get_or_insert(MergedSites { first: [first, i], count: 0 }).count += 1;
            }
        }
        Ok(merged)
    }

    /// Whether all sites and weights are in range of the container.
    ///
    /// # Errors
    /// `Input` for the first that is not ([`FARTHEST_SITE`], [`LARGEST_WEIGHT_SPREAD`]).
    #[doc(hidden)]
    pub fn check_range(&self, container: &FramedContainer) -> Result<()> {
        let frame = &container.frame;
        let is_far = |p: &[f64; 3]| frame.enter(*p).iter().any(|x| x.abs() > FARTHEST_SITE);
        if let Some(i) = first(&self.positions, is_far) {
            let p = self.positions[i];
            return Err(Error::input(format!(
                "site {i} at {p:?} is out of range: sites must stand within about {FARTHEST_SITE} times the largest extent of \
                 the domain or box; leave it out, or give a larger box",
            ))
            .of_site(i));
        }
        let unit2 = frame.unit() * frame.unit();
        let base = self.weights.iter().copied().fold(f64::INFINITY, f64::min);
        if let Some(i) = first(&self.weights, |w| (w - base) / unit2 > LARGEST_WEIGHT_SPREAD) {
            return Err(Error::input(format!(
                "site {i} has weight {}, the smallest weight is {base}: weights must differ by less than about \
                 {LARGEST_WEIGHT_SPREAD} times the squared largest extent of the domain or box; are they squared lengths?",
                self.weights[i]
            ))
            .of_site(i));
        }
        Ok(())
    }
}

/// Checks what a diagram is to have, on all threads; the first site that is wrong is named.
fn check_sites(positions: &[[f64; 3]], weights: &[f64]) -> Result<()> {
    if positions.is_empty() {
        return Err(Error::input("no sites: at least one is needed"));
    }
    if positions.len() > 1 << 31 {
        return Err(Error::input(format!("{} sites: at most 2147483648 are possible", positions.len())));
    }
    let is_wrong = |x: &f64| x.is_nan() || x.abs() > LARGEST_COORDINATE;
    let found = first(positions, |p| p.iter().any(is_wrong));
    if let Some((i, x)) = found.and_then(|i| Some((i, positions[i].iter().find(|x| is_wrong(x))?))) {
        return Err(Error::input(format!(
            "site {i}: coordinate {x:e} is not a number within ±1e60; choose another unit"
        ))
        .of_site(i));
    }
    check_weights(positions.len(), weights)
}

fn check_weights(sites: usize, weights: &[f64]) -> Result<()> {
    if !weights.is_empty() && weights.len() != sites {
        return Err(Error::input(format!("{} weights for {sites} sites: give one for each, or none", weights.len())));
    }
    let is_wrong = |w: &f64| w.is_nan() || w.abs() > LARGEST_COORDINATE * LARGEST_COORDINATE;
    if let Some(i) = first(weights, is_wrong) {
        return Err(Error::input(format!(
            "site {i}: weight {:e} is not a number within ±1e120; choose another unit",
            weights[i]
        ))
        .of_site(i));
    }
    Ok(())
}

/// The first that is as asked for, looked for on all threads of a pool if this is one of them. (None is begun for it: one that is shared has no threads
/// after a `fork`.)
fn first<T: Sync>(all: &[T], is: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    let of_range = |mut range: Range<usize>| range.find(|&i| is(&all[i]));
    match rayon::current_thread_index() {
        Some(_) => parallel::chunks(all.len(), CHUNK, of_range).into_iter().flatten().next(),
        None => of_range(0..all.len()),
    }
}

/// Makes room in `old` for all of `new`.
fn room_for<T>(old: &mut Vec<T>, new: &[T], what: &str) -> Result<()> {
    let more = new.len().saturating_sub(old.len());
    old.try_reserve_exact(more).or_else(|_| memory::probe(new.len() as u64, size_of::<T>() as u64, what))
}

/// Copies `new` to `old`, which has room for it; on all threads as [`first`].
fn copy<T: Copy + Send + Sync>(old: &mut Vec<T>, new: &[T]) {
    if old.len() == new.len() && rayon::current_thread_index().is_some() {
        parallel::for_each(old, CHUNK, |i, x| *x = new[i]);
    } else {
        old.clear();
        old.extend_from_slice(new);
    }
}

/// Sites that count as standing where another does, though they do not ([`PowerDiagram::merged_sites`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct MergedSites {
    /// How many.
    pub count: usize,
    /// The first of them, after the one that it is not told from.
    pub first: [usize; 2],
}

/// The smallest box around `points`, as its minimum and maximum corners.
pub fn bounding_box(points: &[[f64; 3]]) -> ([f64; 3], [f64; 3]) {
    let mut lo = [f64::INFINITY; 3];
    let mut hi = [f64::NEG_INFINITY; 3];
    for p in points {
        for k in 0..3 {
            lo[k] = lo[k].min(p[k]);
            hi[k] = hi[k].max(p[k]);
        }
    }
    (lo, hi)
}

/// What cells are restricted to, in its internal frame.
#[derive(Clone, Debug)]
pub struct FramedContainer {
    /// The map between the caller's world and the frame.
    pub frame: Frame,
    /// Minimum corner of the initial cell (the box, or the domain's grid), in the frame.
    pub lo: [f64; 3],
    /// Maximum corner of the initial cell, in the frame.
    pub hi: [f64; 3],
    /// Mass per volume where the winding number is one.
    pub density: f64,
    grid: Option<Arc<DomainGrid>>,
}

impl FramedContainer {
    /// The domain's grid, if the diagram is restricted to a domain.
    pub fn domain_grid(&self) -> Option<&DomainGrid> {
        self.grid.as_deref()
    }

    /// The same, to be kept and compared: evaluations with the same domain and about as many sites share it.
    pub fn shared_grid(&self) -> Option<&Arc<DomainGrid>> {
        self.grid.as_ref()
    }
}

/// A diagram in the internal frame, its sites sorted on the host.
#[derive(Debug)]
pub struct Prepared {
    /// The container of the cells.
    pub container: FramedContainer,
    /// The sites, sorted.
    pub sites: SiteTree,
    /// Which of them have the least power where, if it is worth while ([`Prepared::with_octree_if_hard`]).
    pub octree: Option<PowerOctree>,
}

impl Prepared {
    /// The domain's grid, if the diagram is restricted to a domain.
    pub fn domain_grid(&self) -> Option<&DomainGrid> {
        self.container.domain_grid()
    }
}
