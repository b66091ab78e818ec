//! The scheduler of one device (paper, Alg. 1): passes, substeps, batches.

use super::cells::Todo;
use super::room::{FEWEST_CELLS, MOST_CELLS};
use super::sample::{MAY_FAIL, SHARE_OF_SCRATCH, WORTH_LEAVING};
use super::{Computed, Device};
use crate::buffer::failed;
use crate::builds::{Lanes, Stage, Way};
use crate::facets::FacetMemory;
use crate::grid::GROUP;
use crate::interface::data::VAST_WORDS;
use crate::interface::kernels::LookAbout;
use crate::platform::DeviceId;
use crate::program::MOST_PLANES;
use laguerre_core::output::Substep;
use laguerre_core::passes::{Capacities, Cells, PassOutcome, run_passes};
use laguerre_core::{Precision, Request, Result, Watched};
use std::ops::Range;
use std::time::Instant;

/// Cells of which some need each stage that may come: from here on these are built before (`ahead.rs`). Those that need more room are fewer: 5 of a million white ones.
const WORTH_BUILDING_AHEAD: usize = 1 << 18;
const WORTH_BUILDING_LARGE: usize = 1 << 19;

/// Of all cells the share that the table of offsets leaves where weights differ, from which on these are `First`'s by the tree, before those of them that reach far are `Far`'s: of 215,222 cells of transport in
/// a domain 58,000, of which 8,283 are then; of a million with affine weights it leaves 4,473, of which
/// 3,592 are still `Far`'s after 0.8 ms in `First`, while `Far` has some 4,210 at once in 0.8, and no other build is needed. (One NVIDIA H200.)
const SHARE_BY_TREE: usize = 16;

/// Cells with open signs, at most, that `Wide` computes with those that need more room, where these are its own anyway, and not `Exact` before: a stage less to build and to wait for (of
/// 300,000 white sites with weights of transport in the bunny's box nine, 1.5 of 50 ms; the first transport of a process took 71 s, with `Exact` 79; one NVIDIA H200).
const FEW_OPEN: u32 = 512;

impl Device {
    /// Computes the cells of a range of the sorted sites (paper, Alg. 1), one of `of` ranges. `sites` is the number of the caller's. What comes of them is
    /// then on the device.
    pub(crate) fn compute(
        &mut self,
        request: &Watched<'_>,
        sites: usize,
        share: Range<usize>,
        of: usize,
    ) -> Result<Computed> {
        // Coincident sites have no cell; when they have moved apart, no more is to be allocated.
        self.most_cells = sites.div_ceil(of);
        if !request.facets() {
            self.give_facets_back();
        }
        self.clear(request, sites, self.most_cells)?;
        self.was_swept = false;
        self.facets_are_kept = request.needs_facets() && of == 1;
        let together = self.lanes(request);
        self.look_about(sites, if together.is_some() { share.clone() } else { 0..0 })?;
        let first = if together.is_some() { Capacities::FIRST } else { self.first_capacities(share.clone())? };
        let of_table = together.map(|lanes| self.choose_table(lanes, share.clone())).transpose()?;
        let (of_table, may_begin_by_table) = of_table.unzip();
        let (most_fail, many_reach_far) = match together {
            Some(lanes) if self.shared.params.has_table == 0 => self.failures(lanes, share.clone())?,
            _ => (false, false),
        };
        if many_reach_far {
            self.make_octree(request)?;
        } else if may_begin_by_table == Some(true) && !most_fail {
            self.shared.params.has_table = 1;
        }
        self.shared.params.leaves_if_far = self.leaves_if_far(share.len(), most_fail || many_reach_far);
        let begin = match together {
            Some(lanes) if most_fail || many_reach_far => Some((lanes, Stage::Far)),
            Some(lanes) if self.begins_in_single() => Some((lanes, Stage::Single)),
            // (Without the table those go on from `First` to `Far`, which settles signs as well.)
            _ if self.shared.params.has_table == 0 => together.map(|lanes| (lanes, Stage::First)),
            _ => together.zip(of_table),
        };
        if let Some((lanes, stage)) = begin {
            self.build_ahead(request, lanes, stage, share.len());
        }
        let mut for_host = Vec::new();
        let passes = run_passes(
            first,
            Todo::Sorted(share.clone()),
            |room, _| room.grown(),
            |room, todo| {
                if room.planes > MOST_PLANES {
                    for_host.extend(self.callers(todo)?);
                    return Ok(PassOutcome::default());
                }
                let together = begin.filter(|_| room == first);
                self.pass(request, room, todo, room == first, together, &mut for_host)
            },
        );
        self.programs.settle();
        if self.memory.begun.bytes() > self.memory_size / SHARE_OF_SCRATCH {
            self.give_begun_up();
        }
        let passes = passes?;
        let left = self.counters.left as usize;
        if left > 0 {
            std::mem::swap(&mut self.memory.todo, &mut self.memory.left);
            for_host.extend(self.callers(&Todo::Listed(left))?);
        }
        if let Some(report) = passes.first() {
            let too_many = report.failed as f64 > MAY_FAIL * report.cells as f64;
            let may_grow = first.grown().planes <= MOST_PLANES;
            self.first = Some((share.len(), if too_many && may_grow { first.grown() } else { first }));
        }
        let Self { queue, shared, sites: sorted, .. } = self;
        let tree = match for_host.is_empty() || sorted.is_from_host {
            true => None,
            false => Some(sorted.read_tree(queue, &shared.params)?),
        };
        Ok(Computed { passes, for_host, tree })
    }

    /// Reads back what came of the cells of all of the caller's sites.
    pub(crate) fn read_results(&mut self, request: &Request, sites: usize) -> Result<()> {
        let Self { queue, memory, results, shared, facets_are_kept, .. } = self;
        let width = shared.params.sums_width as usize;
        results.width = width;
        memory.outcome.read(queue, sites, &mut results.outcomes)?;
        memory.sums.read(queue, sites * width, &mut results.sums)?;
        if request.needs_facets() && !*facets_are_kept {
            memory.rows.read(queue, sites, &mut results.rows)?;
        }
        Ok(())
    }

    /// Begins to build the stages that come after `begin` where cells are so many that some need each.
    fn build_ahead(&mut self, request: &Request, lanes: Lanes, begin: Stage, cells: usize) {
        if cells < WORTH_BUILDING_AHEAD {
            return;
        }
        let is_tree = self.is_tree();
        let stages = [
            (Stage::First, begin == Stage::Single),
            (Stage::Integrals, request.needs_facets()),
            (Stage::Surface, self.domain.is_some()),
            (Stage::Far, is_tree && begin != Stage::Far),
            (Stage::Exact, !is_tree),
            (self.stage_of_large(request), cells >= WORTH_BUILDING_LARGE),
        ];
        let ways = stages.into_iter().filter(|&(_, is_needed)| is_needed).map(|(stage, _)| Way::Together(lanes, stage));
        let ways: Vec<Way> = ways.collect();
        self.programs.build_ahead(&self.context, DeviceId(self.id), &ways, &self.shared.params);
    }

    /// Whether what the first stage does not complete is found by the tree.
    pub(super) fn is_tree(&self) -> bool {
        self.shared.params.has_table == 0 || self.shared.params.equal_weights == 0
    }

    /// The stage of cells that need more room. (What of facets is asked for may leave signs open: so with facets and with the Laplacian alone a cell
    /// ends in the same stage, and has the same bits.)
    fn stage_of_large(&self, request: &Request) -> Stage {
        if request.needs_facets() && self.domain.is_some() { Stage::Wide } else { Stage::Large }
    }

    /// Whether single precision was asked for, and can do what is: volumes and barycenters of cells that the table of offsets proves complete.
    fn begins_in_single(&self) -> bool {
        let params = &self.shared.params;
        self.precision == Precision::F32 && params.has_table != 0 && params.equal_weights != 0 && params.flags == 0
    }

    /// Finds how near the surface is to each of a range of the sorted sites, of which there are at most `sites`.
    pub(super) fn look_about(&mut self, sites: usize, share: Range<usize>) -> Result<()> {
        let Self { context, queue, memory, grid_kernels, shared, domain, .. } = self;
        let has_surface = domain.is_some() && !share.is_empty();
        memory.abouts.grow(context, if has_surface { sites } else { 1 })?;
        if has_surface {
            let begin = Instant::now();
            let arguments = LookAbout {
                params: &shared.room,
                sites: &self.sites.sites,
                first: share.start as u32,
                count: share.len() as u32,
                clearances: &memory.clearances,
                windings: &memory.windings,
                abouts: &memory.abouts,
            };
            grid_kernels.look_about.run(queue, share.len(), GROUP, arguments)?;
            queue.finish().map_err(|e| failed("looking about the sites", e))?;
            self.seconds += begin.elapsed().as_secs_f64();
        }
        Ok(())
    }

    /// One pass. The first in two substeps: all cells, `together` if so asked, and then those that turn out to be near the surface, batch by batch. What
    /// needs exact signs, or more than can be done together, is left to the end; what needs more room than a device has for cells that are
    /// computed together is the host's: one such cell took a single work-item 0.45 s (one NVIDIA H200).
    pub(super) fn pass(
        &mut self,
        request: &Watched<'_>,
        room: Capacities,
        cells: &Todo,
        is_first: bool,
        together: Option<(Lanes, Stage)>,
        for_host: &mut Vec<u32>,
    ) -> Result<PassOutcome<Todo>> {
        let mut now = cells.clone();
        let all = now.count();
        let mut way = together.map_or(Way::Alone(room), |(lanes, stage)| Way::Together(lanes, stage));
        let mut interior_only = is_first && self.domain.is_some();
        let mut is_second = false;
        let large = self.stage_of_large(request);
        let begin = self.seconds;
        let mut second = Substep::default();
        while now.count() > 0 {
            let before = self.seconds;
            self.run_in_batches(request, way, &now, interior_only, &mut second)?;
            if !self.goes_on_giving(way) {
                self.finish(request, way, &mut second)?;
            }
            self.forget_begun_in_part();
            if is_second {
                second.seconds += self.seconds - before;
            }
            let is_far = matches!(way, Way::Together(_, Stage::Far)) && self.counters.full == 0;
            if is_far && large == Stage::Wide && self.counters.later <= FEW_OPEN {
                self.leave_later()?;
            }
            let Self { memory, counters, .. } = self;
            now = Todo::Listed(counters.full as usize);
            if counters.full > 0 {
                std::mem::swap(&mut memory.todo, &mut memory.full);
                counters.full = 0;
                if let Way::Together(lanes, stage @ (Stage::Far | Stage::Sweep)) = way {
                    // (What began with what others show is tried once more, with sites from all over: of a million scanned sites 103,000 take 9 ms, and took 36 in `Far`.)
                    let is_shown = stage == Stage::Far && !self.was_swept;
                    self.was_swept = true;
                    way = Way::Together(lanes, if is_shown { self.stage_of_far(now.count()) } else { Stage::Far });
                }
            } else if let (Way::Together(lanes, stage), 1..) = (way, counters.later)
                && matches!(
                    stage,
                    Stage::Single | Stage::First | Stage::Close | Stage::Far | Stage::Sweep | Stage::Large
                )
            {
                // (What most cells need is more than a few more digits.)
                let are_few = stage == Stage::Single && counters.later as usize <= all / 2;
                let most_reach_far = counters.most_reach_far();
                let is_worth_leaving = counters.later >= WORTH_LEAVING && most_reach_far;
                now = Todo::Listed(counters.later as usize);
                std::mem::swap(&mut memory.todo, &mut memory.later);
                (counters.later, counters.beyond) = (0, 0);
                let is_worth_giving = self.is_worth_giving(now.count(), most_reach_far);
                if matches!(stage, Stage::Single | Stage::First) && is_worth_leaving {
                    self.leave_table(now.count())?;
                }
                let params = &mut self.shared.params;
                let is_weighted_table = params.has_table != 0 && params.equal_weights == 0;
                if stage == Stage::First && is_weighted_table && is_worth_leaving && SHARE_BY_TREE * now.count() > all {
                    // (What the table has left, most of it for what may be farther, is the same stage's once more, by the tree.)
                    params.has_table = 0;
                    continue;
                }
                let next = match stage {
                    Stage::Single | Stage::First if self.is_tree() => self.stage_of_far(now.count()),
                    Stage::Single if are_few => Stage::First,
                    Stage::Single | Stage::First if is_worth_giving => Stage::Far,
                    Stage::Close if self.is_tree() => Stage::Far,
                    Stage::Large => Stage::Wide,
                    _ => Stage::Exact,
                };
                way = Way::Together(lanes, next);
            } else if let (Way::Alone(_), 1..) = (way, counters.surface) {
                now = Todo::Listed(counters.surface as usize);
                std::mem::swap(&mut memory.todo, &mut memory.surface);
                counters.surface = 0;
                second.cells += if is_second { 0 } else { now.count() };
                interior_only = false;
                is_second = true;
            } else if let (Way::Together(lanes, stage), 1..) = (way, counters.left) {
                now = Todo::Listed(counters.left as usize);
                std::mem::swap(&mut memory.todo, &mut memory.left);
                counters.left = 0;
                second.cells += if is_second { 0 } else { now.count() };
                if stage == Stage::Vast {
                    for_host.extend(self.callers(&now)?);
                    break;
                }
                let most_are_left = now.count() >= WORTH_LEAVING as usize && 2 * now.count() > all;
                way = match stage {
                    Stage::Exact if most_are_left && self.leave_table(now.count())? => Way::Together(lanes, Stage::Far),
                    Stage::Large | Stage::Wide => Way::Together(lanes, Stage::Vast),
                    _ => Way::Together(lanes, large),
                };
                interior_only = false;
                is_second = true;
            }
        }
        let failed = Todo::Listed(self.counters.later as usize);
        std::mem::swap(&mut self.memory.todo, &mut self.memory.later);
        self.counters.later = 0;
        let neighbors = std::mem::take(&mut self.counters.visited);
        let triangles = std::mem::take(&mut self.counters.tried);
        Ok(PassOutcome { failed, neighbors, triangles, device_seconds: self.seconds - begin, second })
    }

    /// Leaves the cells that are for later to the stage of those that need more room, which are left to the end.
    fn leave_later(&mut self) -> Result<()> {
        let Self { queue, memory, counters, .. } = self;
        let mut later = Vec::new();
        memory.later.read(queue, counters.later as usize, &mut later)?;
        memory.left.write_at(queue, counters.left as usize, &later)?;
        counters.left += counters.later;
        (counters.later, counters.beyond) = (0, 0);
        Ok(())
    }

    /// Runs over the given cells, batch by batch; those of the last batch that have been given are to be finished.
    fn run_in_batches(
        &mut self,
        request: &Watched<'_>,
        way: Way,
        cells: &Todo,
        interior_only: bool,
        second: &mut Substep,
    ) -> Result<()> {
        let count = cells.count();
        let mut batch = self.room_for_batch(request, count, MOST_CELLS)?;
        if matches!(way, Way::Together(_, Stage::Vast)) {
            batch = batch.min(self.vast_cells()).min(count);
            while batch > 1 && !self.memory.vast.grow_if_possible(&self.context, batch * VAST_WORDS as usize)? {
                batch /= 2;
            }
            self.memory.vast.grow(&self.context, batch * VAST_WORDS as usize)?;
        }
        let mut begin = 0;
        while begin < count {
            let end = (begin + batch).min(count);
            self.shared.params.facet_base = self.results.facet_count as u64;
            let before = self.unended();
            if let Some(late) = self.run(way, cells, 1, begin..end, interior_only)? {
                // A driver that allocates late: nothing ran.
                if self.give_begun_up() {
                    continue;
                }
                if !request.needs_facets() || batch <= FEWEST_CELLS {
                    return Err(late);
                }
                self.finish(request, way, second)?;
                self.read_facets(request)?;
                self.memory.facets.free();
                self.memory.facet_moments.free();
                self.memory.facet_seconds.free();
                self.memory.given.free();
                self.facets = FacetMemory::new();
                batch = self.room_for_batch(request, count, batch / 2)?;
                continue;
            }
            request.advance((end - begin).saturating_sub(self.unended() - before))?;
            self.make_room_for_facets(request)?;
            begin = end;
            if begin < count {
                self.finish(request, way, second)?;
            }
        }
        Ok(())
    }

    /// The caller's indices of cells.
    fn callers(&self, cells: &Todo) -> Result<Vec<u32>> {
        let (mut listed, mut order) = (Vec::new(), Vec::new());
        self.memory.todo.read(&self.queue, cells.count(), &mut listed)?;
        self.sites.order.read(&self.queue, usize::MAX, &mut order)?;
        Ok(match cells {
            Todo::Sorted(range) => order[range.clone()].to_vec(),
            Todo::Listed(_) => listed.iter().map(|&site| order[site as usize]).collect(),
        })
    }
}
