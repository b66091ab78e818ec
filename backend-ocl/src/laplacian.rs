//! The Laplacian on one device, from the records of facets that stay there.

use crate::buffer::rooms;
use crate::device::Device;
use crate::fresh;
use crate::grid::{self, GROUP};
use crate::interface::data::PER_ROW;
use crate::interface::kernels::{CountFacets, ListFacets, MatchFacets, PackFacets, SortFacets};
use laguerre_core::algebra::Kept;
use laguerre_core::{ErrorKind, Laplacian, Request, Result};
use std::time::Instant;

/// Scratch of a diagram with its Laplacian that is larger than this share of the device's memory is freed before the solver runs: of 80 million sites it is a
/// fifth of 150 GB, and the solver needs more than half.
pub(crate) const SHARE_BETWEEN: u64 = 8;

rooms! {
    pub(crate) struct LaplacianMemory {
        place: u32 = "the Laplacian's order",
        is_long: u32 = "the Laplacian's rows",
        offsets: u32 = "the Laplacian's rows",
        columns: u32 = "the Laplacian",
        pub(crate) packed_offsets: u32 = "the Laplacian's rows",
        pub(crate) packed_columns: u32 = "the Laplacian",
        pub(crate) packed_values: f64 = "the Laplacian",
    }
}

/// A Laplacian that a device has made.
pub(crate) enum Made {
    /// It is there.
    Kept(Kept),
    Read(Laplacian),
}

/// Which one is on a device.
#[derive(Clone, Copy)]
pub(crate) struct MadeLaplacian {
    pub(crate) evaluation: u64,
    pub(crate) rows: usize,
    pub(crate) entries: usize,
    /// Whether the device computed all of the cells.
    pub(crate) is_without_host: bool,
}

impl Device {
    /// The Laplacian of the cells whose facets are all on the device; `None` where the host has to
    /// make it ([`leave_laplacian`](Self::leave_laplacian)). One that is read is put in the memory of `lists`.
    pub(crate) fn assemble_laplacian(
        &mut self,
        request: &Request,
        sites: usize,
        is_without_host: bool,
        lists: (Vec<u32>, Vec<f64>),
    ) -> Result<Option<Made>> {
        let begin = Instant::now();
        let entries = self.make_laplacian(sites)?;
        self.seconds += begin.elapsed().as_secs_f64();
        let Some(entries) = entries else { return Ok(None) };
        let (evaluation, rows) = (self.evaluation, self.shared.params.tree_sites as usize);
        let made = MadeLaplacian { evaluation, rows, entries, is_without_host };
        self.made = Some(made);
        self.give_scratch_back();
        Ok(Some(match request.keeps_laplacian() {
            true => Made::Kept(Kept::new(self.order()?, evaluation)),
            false => {
                self.lengths.of(sites).entries = entries;
                Made::Read(self.read_laplacian(made, lists)?)
            }
        }))
    }

    /// Leaves it to the host: reads the facets back.
    pub(crate) fn leave_laplacian(&mut self, request: &Request, sites: usize) -> Result<()> {
        self.lengths.of(sites).entries = 0;
        self.read_kept_facets(request, sites)?;
        self.give_scratch_back();
        Ok(())
    }

    /// Frees what only a diagram with its Laplacian needs, where it is large.
    fn give_scratch_back(&mut self) {
        let Self { memory, laplacian, memory_size, .. } = self;
        if memory.facets.bytes() + laplacian.columns.bytes() > *memory_size / SHARE_BETWEEN {
            memory.facets.free();
            laplacian.columns.free();
        }
    }

    /// The caller's index of each sorted site.
    pub(crate) fn order(&self) -> Result<Vec<u32>> {
        let mut order = Vec::new();
        self.sites.order.read(&self.queue, self.shared.params.tree_sites as usize, &mut order)?;
        Ok(order)
    }

    /// Its entries, if it could be made: there is memory for it, and no row is long.
    fn make_laplacian(&mut self, sites: usize) -> Result<Option<usize>> {
        match self.sort_columns(sites) {
            // (Drivers that allocate late say so here. What comes after it takes the place of areas that the host would need.)
            Err(error) if error.kind() == ErrorKind::Device => {
                self.laplacian = LaplacianMemory::new();
                Ok(None)
            }
            Ok(true) => self.match_columns().map(Some),
            sorted => sorted.map(|_| None),
        }
    }

    /// The neighbors of each row, sorted, and the areas of their facets; `false` where it cannot be.
    fn sort_columns(&mut self, sites: usize) -> Result<bool> {
        let Self { context, queue, memory, grid_kernels, row_kernels, sites: sorted, shared, .. } = self;
        let ties = &mut self.laplacian;
        let kernels = row_kernels.get()?;
        // As much as for their records, so that nothing is allocated where there are a few more.
        let (count, most) = (shared.params.tree_sites, shared.params.facet_room as usize);
        let rows = count as usize;
        let fits = ties.place.grow_if_possible(context, sites)?
            && ties.offsets.grow_if_possible(context, rows + 1)?
            && ties.packed_offsets.grow_if_possible(context, rows + 1)?
            && ties.columns.grow_if_possible(context, most)?
            && ties.packed_columns.grow_if_possible(context, most)?
            && ties.packed_values.grow_if_possible(context, most)?;
        if !fits {
            return Ok(false);
        }
        ties.offsets.fill_with(context, queue, 0, rows + 1)?;
        ties.packed_offsets.fill_with(context, queue, 0, rows + 1)?;
        ties.is_long.fill_with(context, queue, 0, 1)?;
        let LaplacianMemory { place, is_long, offsets, columns, packed_columns, packed_values, .. } = &*ties;
        let (order, rooms) = (&sorted.order, &memory.rows);
        let counting =
            CountFacets { order, count, outcome: &memory.outcome, rows: rooms, place, counts: offsets, is_long };
        kernels.count_facets.run(queue, rows, GROUP, counting)?;
        if is_long.first(queue)? != 0 {
            return Ok(false);
        }
        grid::scan(context, queue, grid_kernels, offsets, rows + 1, &mut sorted.sums)?;
        let (items, records) = (rows * PER_ROW as usize, &memory.facets);
        // (Where the packed ones are afterwards.)
        let (listed, areas) = (packed_columns, packed_values);
        let listing = ListFacets { order, count, rows: rooms, records, place, offsets, listed };
        kernels.list_facets.run(queue, items, GROUP, listing)?;
        let sorting = SortFacets { order, count, rows: rooms, records, listed, offsets, columns, areas };
        kernels.sort_facets.run(queue, items, GROUP, sorting)?;
        Ok(true)
    }

    /// Its entries: the values of both sides of a facet where both see it, one after the other.
    fn match_columns(&mut self) -> Result<usize> {
        let Self { context, queue, memory, grid_kernels, row_kernels, sites: sorted, shared, .. } = self;
        let kernels = row_kernels.get()?;
        let count = shared.params.tree_sites;
        let (rows, items) = (count as usize, count as usize * PER_ROW as usize);
        let LaplacianMemory { offsets, columns, packed_offsets, packed_columns, packed_values, .. } = &self.laplacian;
        let (areas, records) = (packed_values, &memory.facets);
        let (params, counts) = (&shared.room, packed_offsets);
        let matching = MatchFacets { params, sites: &sorted.sites, count, offsets, columns, areas, records, counts };
        kernels.match_facets.run(queue, items, GROUP, matching)?;
        grid::scan(context, queue, grid_kernels, packed_offsets, rows + 1, &mut sorted.sums)?;
        let starts = packed_offsets;
        let packing = PackFacets { count, offsets, columns, records, starts, packed_columns, packed_values };
        kernels.pack_facets.run(queue, items, GROUP, packing)?;
        Ok(packed_offsets.number(queue, rows)? as usize)
    }

    /// The Laplacian that is on the device, of its last evaluation, in the memory of the two lists.
    pub(crate) fn read_laplacian(
        &self,
        made: MadeLaplacian,
        (mut columns, mut values): (Vec<u32>, Vec<f64>),
    ) -> Result<Laplacian> {
        let LaplacianMemory { packed_offsets, packed_columns, packed_values, .. } = &self.laplacian;
        fresh::keep_fitting(&mut columns, made.entries);
        fresh::keep_fitting(&mut values, made.entries);
        let offsets = packed_offsets.read_offsets(&self.queue, made.rows)?;
        packed_columns.read(&self.queue, made.entries, &mut columns)?;
        packed_values.read(&self.queue, made.entries, &mut values)?;
        Ok(Laplacian::of_fitting(self.order()?, (offsets, columns, values)))
    }
}
