//! The next coarser level of a multigrid, on the device (`kernels/aggregation.cl`).

use super::{Answers, Matrix, Vector};
use crate::buffer::Room;
use crate::device::Device;
use crate::grid::{self, GROUP};
use crate::interface::algebra::{
    BalanceRows, ChooseRoots, CountColumns, JoinRest, JoinRoots, ListColumns, MultiplyRows, Prolong, RankFree,
    SortColumns, SpreadRanks,
};
use crate::interface::data::ROW_GROUP;
use laguerre_core::Result;
use laguerre_core::algebra::Coarsening;

/// Times that unknowns begin aggregates; some ten are usual. Whoever is left then joins a neighbor's.
const MOST_ROUNDS: usize = 64;

const NO_AGGREGATE: u32 = u32::MAX;

/// The unknown that began the aggregate of each, and the number of that aggregate at its own place.
struct Aggregates {
    joined: Room<u32>,
    numbers: Room<u32>,
    count: usize,
}

impl Device {
    /// `P`, `Pᵀ` and `Pᵀ A P`; `None` where there is no coarser level, or a row has more entries than there is room for.
    pub(super) fn coarser(
        &mut self,
        a: &Matrix,
        inverse: &Vector,
        how: Coarsening,
    ) -> Result<Option<(Matrix, Matrix, Matrix)>> {
        let aggregates = self.aggregates(a, inverse, how.strong)?;
        if aggregates.count == 0 || aggregates.count >= a.rows {
            return Ok(None);
        }
        let Some(prolongation) = self.prolongation(a, inverse, &aggregates, how)? else { return Ok(None) };
        let restriction = self.transposed(&prolongation)?;
        let Some(half) = self.product(a, &prolongation)? else { return Ok(None) };
        let Some(coarse) = self.product(&restriction, &half)? else { return Ok(None) };
        let (offsets, columns, values) = (&coarse.offsets, &coarse.columns, &coarse.values);
        let balancing = BalanceRows { count: coarse.rows as u32, offsets, columns, values };
        self.algebra_kernels.get()?.balance_rows.run(&self.queue, coarse.rows, GROUP, balancing)?;
        Ok(Some((prolongation, restriction, coarse)))
    }

    /// Unknowns with all their strong neighbors, none of which two share: in rounds, each of those that no other outranks at the same time.
    fn aggregates(&mut self, a: &Matrix, inverse: &Vector, strong: f64) -> Result<Aggregates> {
        let rows = a.rows;
        let (mut root, mut ranks, mut near) =
            (Room::new("aggregates"), Room::new("aggregates"), Room::new("aggregates"));
        root.fill_with(&self.context, &self.queue, NO_AGGREGATE, rows)?;
        ranks.grow(&self.context, rows)?;
        near.grow(&self.context, rows)?;
        let (root, ranks, near) = (&root, &ranks, &near);
        let (count, inverse) = (rows as u32, &inverse.numbers);
        let Matrix { offsets, columns, values, .. } = a;
        for _ in 0..MOST_ROUNDS {
            self.unfind()?;
            let Self { queue, algebra_kernels, answers: Answers { is_found, .. }, .. } = &*self;
            let kernels = algebra_kernels.get()?;
            let ranking = RankFree { count, offsets, columns, values, inverse, strong, root, ranks, is_found };
            kernels.rank_free.run(queue, rows, GROUP, ranking)?;
            if is_found.first(queue)? == 0 {
                break;
            }
            let spreading = SpreadRanks { count, offsets, columns, values, inverse, strong, ranks, near };
            kernels.spread_ranks.run(queue, rows, GROUP, spreading)?;
            let choosing = ChooseRoots { count, offsets, columns, values, inverse, strong, ranks, near, root };
            kernels.choose_roots.run(queue, rows, GROUP, choosing)?;
            let joining = JoinRoots { count, offsets, columns, values, inverse, strong, root };
            kernels.join_roots.run(queue, rows, GROUP, joining)?;
        }
        let (mut joined, mut numbers) = (Room::new("aggregates"), Room::new("aggregates"));
        joined.grow(&self.context, rows)?;
        numbers.fill_with(&self.context, &self.queue, 0, rows + 1)?;
        let rest =
            JoinRest { count, offsets, columns, values, inverse, strong, root, joined: &joined, numbers: &numbers };
        self.algebra_kernels.get()?.join_rest.run(&self.queue, rows, GROUP, rest)?;
        let count = self.begins(&numbers, rows)?;
        Ok(Aggregates { joined, numbers, count })
    }

    fn prolongation(
        &mut self,
        a: &Matrix,
        inverse: &Vector,
        aggregates: &Aggregates,
        Coarsening { strong, omega }: Coarsening,
    ) -> Result<Option<Matrix>> {
        let (count, inverse) = (a.rows as u32, &inverse.numbers);
        let Matrix { offsets, columns, values, .. } = a;
        let Aggregates { joined, numbers, count: width } = aggregates;
        self.in_two(a.rows, *width, |device, made, is_found, fills| {
            let arguments = Prolong {
                count,
                offsets,
                columns,
                values,
                inverse,
                strong,
                omega,
                joined,
                numbers,
                fills,
                starts: &made.offsets,
                made_columns: &made.columns,
                made_values: &made.values,
                is_found,
            };
            device.algebra_kernels.get()?.prolong.run(&device.queue, a.rows, GROUP, arguments)
        })
    }

    fn transposed(&mut self, a: &Matrix) -> Result<Matrix> {
        let rows = a.width;
        let mut made = Matrix::unset(self, rows, a.entries, a.rows)?;
        made.offsets.fill_with(&self.context, &self.queue, 0, rows + 1)?;
        let (mut listed, mut listed_rows, mut listed_places) =
            (Room::new("a transpose"), Room::new("a transpose"), Room::new("a transpose"));
        listed.fill_with(&self.context, &self.queue, 0, rows)?;
        listed_rows.grow(&self.context, a.entries)?;
        listed_places.grow(&self.context, a.entries)?;
        let counting = CountColumns { count: a.entries as u32, columns: &a.columns, counts: &made.offsets };
        self.algebra_kernels.get()?.count_columns.run(&self.queue, a.entries, GROUP, counting)?;
        self.begins(&made.offsets, rows)?;
        let (starts, listed_rows, listed_places) = (&made.offsets, &listed_rows, &listed_places);
        let Matrix { offsets, columns, values, .. } = a;
        let listing =
            ListColumns { count: a.rows as u32, offsets, columns, starts, listed: &listed, listed_rows, listed_places };
        self.algebra_kernels.get()?.list_columns.run(&self.queue, a.rows, GROUP, listing)?;
        let (made_columns, made_values) = (&made.columns, &made.values);
        let sorting = SortColumns { starts, values, listed_rows, listed_places, made_columns, made_values };
        let group = ROW_GROUP as usize;
        self.algebra_kernels.get()?.sort_columns.run(&self.queue, rows * group, group, sorting)?;
        Ok(made)
    }

    /// `None` where a row has more entries than there is room for.
    fn product(&mut self, a: &Matrix, b: &Matrix) -> Result<Option<Matrix>> {
        let Matrix { offsets, columns, values, .. } = a;
        self.in_two(a.rows, b.width, |device, made, is_found, fills| {
            let arguments = MultiplyRows {
                offsets,
                columns,
                values,
                other_offsets: &b.offsets,
                other_columns: &b.columns,
                other_values: &b.values,
                fills,
                starts: &made.offsets,
                made_columns: &made.columns,
                made_values: &made.values,
                is_found,
            };
            let group = ROW_GROUP as usize;
            device.algebra_kernels.get()?.multiply_rows.run(&device.queue, a.rows * group, group, arguments)
        })
    }

    /// A matrix whose entries `work` counts, and then makes; `None` where it finds a row too long.
    fn in_two(
        &mut self,
        rows: usize,
        width: usize,
        work: impl Fn(&Self, &Matrix, &Room<u32>, u32) -> Result<()>,
    ) -> Result<Option<Matrix>> {
        let mut made = Matrix::unset(self, rows, 1, width)?;
        made.offsets.fill_with(&self.context, &self.queue, 0, rows + 1)?;
        self.unfind()?;
        work(self, &made, &self.answers.is_found, 0)?;
        if self.answers.is_found.first(&self.queue)? != 0 {
            return Ok(None);
        }
        made.entries = self.begins(&made.offsets, rows)?;
        made.columns.grow(&self.context, made.entries)?;
        made.values.grow(&self.context, made.entries)?;
        work(self, &made, &self.answers.is_found, 1)?;
        Ok(Some(made))
    }

    /// From numbers of entries where each row begins; how many there are in all.
    fn begins(&mut self, counts: &Room<u32>, rows: usize) -> Result<usize> {
        let Self { context, queue, grid_kernels, sites, .. } = self;
        grid::scan_all(context, queue, grid_kernels, counts, rows, &mut sites.sums)
    }

    /// Nothing is found yet.
    pub(super) fn unfind(&mut self) -> Result<()> {
        self.answers.is_found.fill(&self.context, &self.queue, &[0])
    }
}
