//! Linear algebra in the memory of the first device.

mod coarser;

use crate::buffer::{LARGE, Room};
use crate::device::Device;
use crate::devices::on_device;
use crate::evaluate::Ocl;
use crate::grid::GROUP;
use crate::interface::algebra::{
    Combine, DotParts, FindBeyond, FindRisen, InvertDiagonal, Multiply, PartCells, Smooth, Stiffen, SubtractNumber,
    SumParts,
};
use crate::interface::data::{CELL_NUMBERS, SUM_EACH};
use crate::interface::kernels::{FillLaplacian, GatherCells};
use crate::laplacian::MadeLaplacian;
use laguerre_core::algebra::{Algebra, CELL, Coarsening, Coarser, Held, Kept, Smoothed, Smoothing, check_lengths};
use laguerre_core::rows::Rows;
use laguerre_core::{Error, ErrorKind, Laplacian, Result};
use rayon::prelude::*;

/// Numbers that one group adds up.
const SUMMED: usize = GROUP * SUM_EACH as usize;

/// Entries of a row that a work-item multiplies, about, and the work-items that share out a row at most.
const ENTRIES_EACH: usize = 4;
const MOST_PER_ROW: usize = 32;

/// Rows from which on a matrix is better on a device. A step of a transport of 10,000 sites in a box takes the solver 4 to 5 ms there and 14 to 21 on the
/// host, of 3,000 2 to 3 and 4 to 9, of 1,000 2 to 3 as there (one NVIDIA H200, 16 host cores). A device that is the host has the same cores, and more
/// to do until one begins: of 10,000 30 and 17 ms (PoCL, 2 cores).
const WORTH_ON_GPU: usize = 1_500;
const WORTH_ON_HOST: usize = 30_000;

struct Vector {
    numbers: Room<f64>,
    length: usize,
}

struct Matrix {
    offsets: Room<u32>,
    columns: Room<u32>,
    values: Room<f64>,
    rows: usize,
    entries: usize,
    /// More than any column.
    width: usize,
}

/// What is held by who may be on another thread, and the number of the backend whose it is: to another's device it is nothing.
struct OnDevice<T>(T, u64);

// SAFETY: OpenCL objects may be used from any thread, and what is done with these, through `Ocl`, is done while its devices are locked.
unsafe impl Send for OnDevice<Vector> {}
// SAFETY: as above; a shared reference gives no more than the object's handle.
unsafe impl Sync for OnDevice<Vector> {}
// SAFETY: as of vectors.
unsafe impl Send for OnDevice<Matrix> {}
// SAFETY: as of vectors.
unsafe impl Sync for OnDevice<Matrix> {}

const _: () = assert!(CELL_NUMBERS as usize == CELL);

/// What sums and questions come back in.
pub(crate) struct Answers {
    pub(crate) parts: Room<f64>,
    pub(crate) sums: Vec<f64>,
    is_found: Room<u32>,
}

impl Answers {
    pub(crate) const fn new() -> Self {
        Self { parts: Room::new("sums"), sums: Vec::new(), is_found: Room::new("an answer") }
    }
}

fn of_first<T>(devices: &mut [Device], work: impl FnOnce(&mut Device) -> Result<T>) -> Result<T> {
    let device = devices.first_mut().ok_or_else(|| Error::new(ErrorKind::Device, "no device is open"))?;
    work(device).map_err(|error| on_device(error, &device.name))
}

impl Device {
    /// The Laplacian that is there, if it is this one.
    fn kept(&self, kept: &Kept) -> Option<MadeLaplacian> {
        self.made.filter(|made| made.evaluation == kept.evaluation())
    }
}

impl Ocl {
    fn own<'a, T: 'static>(&self, held: &'a Held) -> Result<&'a T> {
        let OnDevice(what, backend) = held.own::<OnDevice<T>>()?;
        let strange = || Error::new(ErrorKind::Device, "a vector or matrix is in the memory of other devices");
        (*backend == self.number).then_some(what).ok_or_else(strange)
    }

    fn hold<T>(&self, what: T) -> Held
    where
        OnDevice<T>: Send + Sync + 'static,
    {
        Held::new(OnDevice(what, self.number))
    }

    /// Does something with the first device that waits for no thread of a pool (nor reads or writes a megabyte).
    fn on_first<T>(&self, work: impl FnOnce(&mut Device) -> Result<T>) -> Result<T> {
        of_first(&mut self.devices.lock(), work)
    }

    /// Does something with the first device, with threads of the host.
    pub(crate) fn on_first_with_threads<T: Send>(
        &self,
        work: impl FnOnce(&mut Device) -> Result<T> + Send,
    ) -> Result<T> {
        self.devices.with(|devices| of_first(devices, work))
    }

    /// With threads of the host where numbers to be copied are so many that those copy them. (A thread of a pool has to wake up first.)
    fn on_first_for<T: Send>(&self, numbers: usize, work: impl FnOnce(&mut Device) -> Result<T> + Send) -> Result<T> {
        if numbers * size_of::<f64>() < LARGE { self.on_first(work) } else { self.on_first_with_threads(work) }
    }

    fn multiplied(&self, a: &Held, x: &Held, y: &Held, subtracts: u32) -> Result<()> {
        let (a, x, y) = (self.own::<Matrix>(a)?, self.own::<Vector>(x)?, self.own::<Vector>(y)?);
        let width = if subtracts == 0 && y.length == 3 * a.rows { 3 } else { 1 };
        check_lengths(
            x.length >= width * a.width && y.length == width * a.rows && y.length.max(x.length) < u32::MAX as usize,
        )?;
        self.on_first(|device| {
            let (offsets, columns, values, count) = (&a.offsets, &a.columns, &a.values, a.rows as u32);
            let (x, y, per_row, width) = (&x.numbers, &y.numbers, a.items_per_row(), width as u32);
            let items = a.items();
            for which in 0..width {
                let arguments = Multiply { count, per_row, offsets, columns, values, x, y, width, which, subtracts };
                device.algebra_kernels.get()?.multiply.run(&device.queue, items, GROUP, arguments)?;
            }
            Ok(())
        })
    }

    fn combined(&self, alpha: f64, scales: Option<&Held>, x: &Held, beta: f64, y: &Held) -> Result<()> {
        let (x, y) = (self.own::<Vector>(x)?, self.own::<Vector>(y)?);
        let has_scales = u32::from(scales.is_some());
        let scales = scales.map_or(Ok(x), |scales| self.own::<Vector>(scales))?;
        check_lengths(x.length == y.length && x.length == scales.length)?;
        self.on_first(|device| {
            let (scales, y) = (&scales.numbers, &y.numbers);
            let arguments = Combine { count: x.length as u32, alpha, has_scales, scales, x: &x.numbers, beta, y };
            device.algebra_kernels.get()?.combine.run(&device.queue, x.length, GROUP, arguments)
        })
    }

    /// Subtracts the mean, as [`Algebra::center`]; where it did not, `x · x`.
    fn centered(&self, x: &Held) -> Result<Option<f64>> {
        let Vector { numbers: x, length } = self.own::<Vector>(x)?;
        let (length, count) = (*length, *length as u32);
        self.on_first(|device| {
            let groups = length.div_ceil(SUMMED);
            device.answers.parts.grow(&device.context, 3 * groups)?;
            let Device { queue, answers, algebra_kernels, .. } = device;
            let kernels = algebra_kernels.get()?;
            kernels.sum_parts.run(queue, groups * GROUP, GROUP, SumParts { count, x, parts: &answers.parts })?;
            answers.parts.read(queue, 3 * groups, &mut answers.sums)?;
            let sum = |which: usize| answers.sums.iter().skip(which).step_by(3).sum::<f64>();
            let (mean, size) = (sum(0) / length as f64, sum(1) / length as f64);
            if mean.abs() <= SUMMED as f64 * f64::EPSILON * size {
                return Ok(Some(sum(2)));
            }
            kernels.subtract_number.run(queue, length, GROUP, SubtractNumber { count, number: mean, x })?;
            Ok(None)
        })
    }

    /// Whether a kernel that is run by `ask` finds something.
    fn finds(&self, ask: impl FnOnce(&Device, &Room<u32>) -> Result<()>) -> Result<bool> {
        self.on_first(|device| {
            device.unfind()?;
            ask(device, &device.answers.is_found)?;
            Ok(device.answers.is_found.first(&device.queue)? != 0)
        })
    }
}

impl Vector {
    /// Of so many numbers, which are not set.
    fn unset(device: &Device, length: usize) -> Result<Self> {
        let mut numbers = Room::new("a vector");
        numbers.grow(&device.context, length)?;
        Ok(Self { numbers, length })
    }
}

impl Algebra for Ocl {
    fn worth_from(&self) -> usize {
        if self.is_host { WORTH_ON_HOST } else { WORTH_ON_GPU }
    }

    fn vector(&self, values: &[f64]) -> Result<Held> {
        self.on_first_for(values.len(), |device| {
            let mut made = Vector::unset(device, values.len())?;
            made.numbers.fill(&device.context, &device.queue, values)?;
            Ok(self.hold(made))
        })
    }

    fn zeros(&self, length: usize) -> Result<Held> {
        self.on_first(|device| {
            let mut made = Vector::unset(device, length)?;
            made.numbers.fill_with(&device.context, &device.queue, 0.0, length)?;
            Ok(self.hold(made))
        })
    }

    fn read(&self, x: &Held) -> Result<Vec<f64>> {
        let x = self.own::<Vector>(x)?;
        self.on_first_for(x.length, |device| {
            let mut values = Vec::new();
            x.numbers.read(&device.queue, x.length, &mut values)?;
            Ok(values)
        })
    }

    fn write(&self, values: &[f64], x: &mut Held) -> Result<()> {
        check_lengths(values.len() == self.own::<Vector>(x)?.length)?;
        let x = &mut x.own_mut::<OnDevice<Vector>>()?.0;
        self.on_first_for(values.len(), |device| x.numbers.write_at(&device.queue, 0, values))
    }

    fn matrix(&self, (offsets, columns, values): Rows) -> Result<Held> {
        let ends = offsets.first() == Some(&0) && offsets.last() == Some(&columns.len());
        let most = u32::MAX as usize;
        check_lengths(
            ends && offsets.is_sorted() && columns.len() == values.len() && columns.len().max(offsets.len()) < most,
        )?;
        let width = columns.par_iter().max().map_or(0, |&column| column as usize + 1);
        self.on_first_with_threads(|device| {
            let (context, queue) = (&device.context, &device.queue);
            let mut made = Matrix::unset(device, offsets.len() - 1, columns.len(), width)?;
            let begins: Vec<u32> = offsets.iter().map(|&begin| begin as u32).collect();
            made.offsets.fill(context, queue, &begins)?;
            made.columns.fill(context, queue, &columns)?;
            made.values.fill(context, queue, &values)?;
            Ok(self.hold(made))
        })
    }

    fn rows(&self, a: &Held) -> Result<Rows> {
        let a = self.own::<Matrix>(a)?;
        self.on_first_with_threads(|device| {
            let (mut columns, mut values) = (Vec::new(), Vec::new());
            a.columns.read(&device.queue, a.entries, &mut columns)?;
            a.values.read(&device.queue, a.entries, &mut values)?;
            Ok((a.offsets.read_offsets(&device.queue, a.rows)?, columns, values))
        })
    }

    fn row_count(&self, a: &Held) -> Result<usize> {
        Ok(self.own::<Matrix>(a)?.rows)
    }

    fn coarser(&self, a: &Held, inverse_diagonal: &Held, how: Coarsening) -> Result<Option<Coarser>> {
        let (a, inverse) = (self.own::<Matrix>(a)?, self.own::<Vector>(inverse_diagonal)?);
        check_lengths(a.rows > 0 && a.width <= a.rows && inverse.length == a.rows)?;
        let made = match self.on_first(|device| device.coarser(a, inverse, how)) {
            // (The host may have memory for it.)
            Err(error) if error.kind() == ErrorKind::Device => None,
            made => made?,
        };
        Ok(made.map(|(prolongation, restriction, matrix)| Coarser {
            prolongation: self.hold(prolongation),
            restriction: self.hold(restriction),
            matrix: self.hold(matrix),
        }))
    }

    fn laplacian(&self, kept: &Kept, scale: f64) -> Result<Option<Held>> {
        self.on_first(|device| {
            let Some(there) = device.kept(kept) else { return Ok(None) };
            let rows = there.rows;
            let made = Matrix::unset(device, rows, there.entries + rows, rows)?;
            let Matrix { offsets, columns, values, .. } = &made;
            let arguments = FillLaplacian {
                count: rows as u32,
                starts: &device.laplacian.packed_offsets,
                packed_columns: &device.laplacian.packed_columns,
                packed_values: &device.laplacian.packed_values,
                scale,
                offsets,
                columns,
                values,
            };
            device.algebra_kernels.get()?.fill_laplacian.run(&device.queue, rows + 1, GROUP, arguments)?;
            Ok(Some(self.hold(made)))
        })
    }

    fn read_laplacian(&self, kept: &Kept) -> Result<Option<Laplacian>> {
        self.on_first_with_threads(|device| {
            device.kept(kept).map(|made| device.read_laplacian(made, Default::default())).transpose()
        })
    }

    fn cells(&self, kept: &Kept, density: f64) -> Result<Option<Held>> {
        self.on_first(|device| {
            // (Sums of the host's cells are not there.)
            let Some(rows) = device.kept(kept).filter(|made| made.is_without_host).map(|made| made.rows) else {
                return Ok(None);
            };
            let made = Vector::unset(device, CELL * rows)?;
            let Device { queue, algebra_kernels, memory, sites, shared, .. } = device;
            let unit = shared.params.frame_unit;
            let arguments = GatherCells {
                params: &shared.room,
                count: rows as u32,
                order: &sites.order,
                sites: &sites.sites,
                outcome: &memory.outcome,
                sums: &memory.sums,
                per_unit: unit * (shared.params.laplacian_unit / unit / density).cbrt(),
                cells: &made.numbers,
            };
            algebra_kernels.get()?.gather_cells.run(queue, rows, GROUP, arguments)?;
            Ok(Some(self.hold(made)))
        })
    }

    fn multiply(&self, a: &Held, x: &Held, y: &mut Held) -> Result<()> {
        self.multiplied(a, x, y, 0)
    }

    fn subtract(&self, a: &Held, x: &Held, y: &mut Held) -> Result<()> {
        self.multiplied(a, x, y, 1)
    }

    fn combine(&self, alpha: f64, x: &Held, beta: f64, y: &mut Held) -> Result<()> {
        self.combined(alpha, None, x, beta, y)
    }

    fn combine_scaled(&self, alpha: f64, d: &Held, x: &Held, beta: f64, y: &mut Held) -> Result<()> {
        self.combined(alpha, Some(d), x, beta, y)
    }

    fn smooth(&self, how: Smoothing<'_>, r: &mut Held, t: &mut Held, x: &mut Held) -> Result<()> {
        let (a, d, s) =
            (self.own::<Matrix>(how.matrix)?, self.own::<Vector>(how.inverse_diagonal)?, self.own::<Vector>(how.last)?);
        let (r, t, x) = (self.own::<Vector>(r)?, self.own::<Vector>(t)?, self.own::<Vector>(x)?);
        check_lengths(a.width <= a.rows && [d, s, r, t, x].iter().all(|vector| vector.length == a.rows))?;
        self.on_first(|device| {
            let arguments = Smooth {
                count: a.rows as u32,
                per_row: a.items_per_row(),
                offsets: &a.offsets,
                columns: &a.columns,
                values: &a.values,
                inverse: &d.numbers,
                alpha: how.alpha,
                beta: how.beta,
                has_last: u32::from(how.before == Smoothed::WithLast),
                is_nothing: u32::from(how.before == Smoothed::Nothing),
                last: &s.numbers,
                residual: &r.numbers,
                step: &t.numbers,
                solution: &x.numbers,
            };
            device.algebra_kernels.get()?.smooth.run(&device.queue, a.items(), GROUP, arguments)
        })
    }

    fn dot(&self, x: &Held, y: &Held) -> Result<f64> {
        let (x, y) = (self.own::<Vector>(x)?, self.own::<Vector>(y)?);
        check_lengths(x.length == y.length)?;
        let y = &y.numbers;
        self.on_first(|device| {
            let groups = x.length.div_ceil(SUMMED);
            device.answers.parts.grow(&device.context, groups)?;
            let Device { queue, answers, algebra_kernels, .. } = device;
            let kernels = algebra_kernels.get()?;
            let arguments = DotParts { count: x.length as u32, x: &x.numbers, y, parts: &answers.parts };
            kernels.dot_parts.run(queue, groups * GROUP, GROUP, arguments)?;
            answers.parts.read(queue, groups, &mut answers.sums)?;
            Ok(answers.sums.iter().sum())
        })
    }

    fn center(&self, x: &mut Held) -> Result<f64> {
        let square = self.centered(x)?;
        square.map_or_else(|| self.dot(x, x), Ok)
    }

    fn inverse_diagonal(&self, a: &Held) -> Result<Held> {
        let a = self.own::<Matrix>(a)?;
        self.on_first(|device| {
            let made = Vector::unset(device, a.rows)?;
            let (offsets, columns, values, count) = (&a.offsets, &a.columns, &a.values, a.rows as u32);
            let arguments = InvertDiagonal { count, offsets, columns, values, inverse: &made.numbers };
            device.algebra_kernels.get()?.invert_diagonal.run(&device.queue, a.rows, GROUP, arguments)?;
            Ok(self.hold(made))
        })
    }

    fn is_within(&self, x: &Held, factor: f64, bound: &Held) -> Result<bool> {
        let (x, bound) = (self.own::<Vector>(x)?, self.own::<Vector>(bound)?);
        check_lengths(x.length == bound.length)?;
        let bounds = &bound.numbers;
        let found = self.finds(|device, is_found| {
            let arguments = FindBeyond { count: x.length as u32, x: &x.numbers, factor, bounds, is_found };
            device.algebra_kernels.get()?.find_beyond.run(&device.queue, x.length, GROUP, arguments)
        })?;
        Ok(!found)
    }

    fn rises_too_far(&self, a: &Held, x: &Held, cells: &Held, share: f64, flattest: f64) -> Result<bool> {
        let (a, x, cells) = (self.own::<Matrix>(a)?, self.own::<Vector>(x)?, self.own::<Vector>(cells)?);
        let most = a.rows.max(a.width);
        check_lengths(x.length >= most && cells.length >= CELL * most)?;
        let (x, cells) = (&x.numbers, &cells.numbers);
        self.finds(|device, is_found| {
            let (offsets, columns, count) = (&a.offsets, &a.columns, a.rows as u32);
            let arguments = FindRisen { count, offsets, columns, x, cells, share, flattest, is_found };
            device.algebra_kernels.get()?.find_risen.run(&device.queue, a.rows, GROUP, arguments)
        })
    }

    fn stiffened(&self, a: &Held, x: &Held, cells: &Held, share: f64, flattest: f64) -> Result<Held> {
        let (a, x, cells) = (self.own::<Matrix>(a)?, self.own::<Vector>(x)?, self.own::<Vector>(cells)?);
        let most = a.rows.max(a.width);
        check_lengths(x.length >= most && cells.length >= CELL * most)?;
        self.on_first(|device| {
            let made = Matrix::unset(device, a.rows, a.entries, a.width)?;
            let arguments = Stiffen {
                count: a.rows as u32,
                offsets: &a.offsets,
                columns: &a.columns,
                values: &a.values,
                x: &x.numbers,
                cells: &cells.numbers,
                share,
                flattest,
                made_offsets: &made.offsets,
                made_columns: &made.columns,
                made_values: &made.values,
            };
            device.algebra_kernels.get()?.stiffen.run(&device.queue, a.rows + 1, GROUP, arguments)?;
            Ok(self.hold(made))
        })
    }

    fn parted(&self, a: &Held, cells: &Held, depth: f64) -> Result<Held> {
        let (a, cells) = (self.own::<Matrix>(a)?, self.own::<Vector>(cells)?);
        check_lengths(cells.length >= CELL * a.rows.max(a.width))?;
        self.on_first(|device| {
            let made = Vector::unset(device, a.rows)?;
            let (offsets, columns, count) = (&a.offsets, &a.columns, a.rows as u32);
            let arguments = PartCells { count, offsets, columns, cells: &cells.numbers, depth, changes: &made.numbers };
            device.algebra_kernels.get()?.part_cells.run(&device.queue, a.rows, GROUP, arguments)?;
            Ok(self.hold(made))
        })
    }
}

impl Matrix {
    /// Work-items that share out the entries of a row where a vector is multiplied: one for each four that it has on average.
    fn items_per_row(&self) -> u32 {
        let entries = self.entries / self.rows.max(1);
        (entries / ENTRIES_EACH).clamp(1, MOST_PER_ROW).next_power_of_two() as u32
    }

    /// All of these, in whole groups.
    fn items(&self) -> usize {
        self.rows.div_ceil(GROUP / self.items_per_row() as usize) * GROUP
    }

    /// Of so many rows, entries and columns, which are not set.
    fn unset(device: &Device, rows: usize, entries: usize, width: usize) -> Result<Self> {
        let (offsets, columns, values) = (Room::new("a matrix"), Room::new("a matrix"), Room::new("a matrix"));
        let mut made = Self { offsets, columns, values, rows, entries, width };
        made.offsets.grow(&device.context, rows + 1)?;
        made.columns.grow(&device.context, entries)?;
        made.values.grow(&device.context, entries)?;
        Ok(made)
    }
}
