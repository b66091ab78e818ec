//! Facets as the caller has them, put in order on one device, where their records are.

use crate::buffer::rooms;
use crate::device::Device;
use crate::fresh;
use crate::grid::{self, GROUP};
use crate::interface::data::PER_ROW;
use crate::interface::kernels::{CountRows, WriteRows};
use crate::laplacian::SHARE_BETWEEN;
use laguerre_core::assemble::{Row, area_unit, facet_second_unit};
use laguerre_core::diagram::FramedContainer;
use laguerre_core::{ErrorKind, FacetArrays, Request, Result};
use std::time::Instant;

/// Cells of the host's whose facets are brought to the device; where there are more, the host does it all.
const MOST_OF_HOST: usize = 4096;

rooms! {
    pub(crate) struct FacetMemory {
        offsets: u32 = "rows of facets",
        neighbors: u32 = "facets",
        areas: f64 = "facets",
        barycenters: [f64; 3] = "facets",
        distances: f64 = "facets",
        second_moments: [f64; 6] = "facets",
    }
}

impl FacetMemory {
    fn bytes(&self) -> u64 {
        let Self { offsets, neighbors, areas, barycenters, distances, second_moments } = self;
        offsets.bytes()
            + neighbors.bytes()
            + areas.bytes()
            + barycenters.bytes()
            + distances.bytes()
            + second_moments.bytes()
    }
}

impl Device {
    /// Brings the facets of the host's cells to those of the device's; whether the records of all are here then.
    pub(crate) fn bring_facets(&mut self, request: &Request, of_host: &[(u32, Row<'_>)]) -> Result<bool> {
        let Self { queue, memory, counters, shared, facets_are_kept, .. } = self;
        let more: usize = of_host.iter().map(|(_, row)| row.records().len()).sum();
        let have_room = counters.facets as usize + more <= shared.params.facet_room as usize;
        if !*facets_are_kept || of_host.len() > MOST_OF_HOST || !have_room {
            return Ok(false);
        }
        for (site, row) in of_host {
            let (begin, count) = (counters.facets, row.records().len() as u32);
            memory.facets.write_at(queue, begin as usize, row.records())?;
            if request.facets() {
                memory.facet_moments.write_at(queue, begin as usize, row.moments())?;
            }
            if request.facet_second_moments() {
                memory.facet_seconds.write_at(queue, begin as usize, row.second_moments())?;
            }
            memory.rows.write_at(queue, *site as usize, &[[u64::from(begin), u64::from(count)]])?;
            memory.outcome.write_at(queue, *site as usize, &[laguerre_core::cell::COMPLETE])?;
            counters.facets += count;
        }
        Ok(true)
    }

    /// The facets of all cells, whose records are on the device; `None` where the host has to put them in order, as there is no
    /// memory for that here. Their records are there as before. They are put in the memory of `arrays`.
    pub(crate) fn assemble_facets(
        &mut self,
        request: &Request,
        container: &FramedContainer,
        sites: usize,
        arrays: FacetArrays,
    ) -> Result<Option<FacetArrays>> {
        let made = match self.order_facets(request, container, sites, arrays) {
            // (Drivers that allocate late say so here.)
            Err(error) if error.kind() == ErrorKind::Device => None,
            made => made?,
        };
        if made.is_none() {
            self.facets = FacetMemory::new();
            self.lengths.of(sites).facets = 0;
        }
        Ok(made)
    }

    fn order_facets(
        &mut self,
        request: &Request,
        container: &FramedContainer,
        sites: usize,
        mut arrays: FacetArrays,
    ) -> Result<Option<FacetArrays>> {
        let begin = Instant::now();
        let Self { context, queue, memory, grid_kernels, row_kernels, sites: sorted, shared, seconds, .. } = self;
        let (ordered, lengths) = (&mut self.facets, &mut self.lengths);
        let kernels = row_kernels.get()?;
        // As much as for their records, so that nothing is allocated where there are a few more.
        let most = shared.params.facet_room as usize;
        let has_seconds = request.facet_second_moments();
        let fits = ordered.offsets.grow_if_possible(context, sites + 1)?
            && ordered.neighbors.grow_if_possible(context, most)?
            && ordered.areas.grow_if_possible(context, most)?
            && ordered.barycenters.grow_if_possible(context, most)?
            && ordered.distances.grow_if_possible(context, most)?
            && ordered.second_moments.grow_if_possible(context, if has_seconds { most } else { 1 })?;
        if !fits {
            return Ok(None);
        }
        ordered.offsets.fill_with(context, queue, 0, sites + 1)?;
        let FacetMemory { offsets, neighbors, areas, barycenters, distances, second_moments } = &*ordered;
        let (count, rows) = (sites as u32, &memory.rows);
        let counting = CountRows { count, outcome: &memory.outcome, rows, counts: offsets };
        kernels.count_rows.run(queue, sites, GROUP, counting)?;
        grid::scan(context, queue, grid_kernels, offsets, sites + 1, &mut sorted.sums)?;
        let writing = WriteRows {
            params: &shared.room,
            count,
            placed: &sorted.placed,
            rows,
            records: &memory.facets,
            moments: &memory.facet_moments,
            has_seconds: u32::from(has_seconds),
            seconds: &memory.facet_seconds,
            offsets,
            area_unit: area_unit(&container.frame, container.density),
            second_unit: facet_second_unit(&container.frame, container.density),
            neighbors,
            areas,
            barycenters,
            distances,
            second_moments,
        };
        kernels.write_rows.run(queue, sites * PER_ROW as usize, GROUP, writing)?;

        arrays.offsets = offsets.read_offsets(queue, sites)?;
        *seconds += begin.elapsed().as_secs_f64();
        let all = arrays.offsets.last().copied().unwrap_or(0);
        lengths.of(sites).facets = all;
        fresh::keep_fitting(&mut arrays.neighbor, all);
        fresh::keep_fitting(&mut arrays.area, all);
        fresh::keep_fitting(&mut arrays.barycenter, all);
        fresh::keep_fitting(&mut arrays.distance, all);
        arrays.second_moment.iter_mut().for_each(|seconds| fresh::keep_fitting(seconds, all));
        neighbors.read(queue, all, &mut arrays.neighbor)?;
        areas.read(queue, all, &mut arrays.area)?;
        barycenters.read(queue, all, &mut arrays.barycenter)?;
        distances.read(queue, all, &mut arrays.distance)?;
        arrays.second_moment.iter_mut().try_for_each(|seconds| second_moments.read(queue, all, seconds))?;
        Ok(Some(arrays))
    }

    /// Gives back what facets alone need, where it is large: for a call that asks for none.
    pub(crate) fn give_facets_back(&mut self) {
        let Self { memory, facets: ordered, memory_size, .. } = self;
        let bytes = memory.facet_moments.bytes() + memory.facet_seconds.bytes() + ordered.bytes();
        if bytes > *memory_size / SHARE_BETWEEN {
            memory.facet_moments.free();
            memory.facet_seconds.free();
            *ordered = FacetMemory::new();
        }
    }
}
