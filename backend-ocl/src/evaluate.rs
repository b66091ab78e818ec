//! The backend: all devices, and what they leave to the host.

use crate::again::Again;
use crate::believed::check_volumes;
use crate::device::Device;
use crate::devices::{Devices, on_all, on_device};
use crate::fallback;
use crate::fresh::{Ahead, Lengths};
use crate::laplacian::Made;
use crate::platform::{Found, choose};
use crate::resident::Stay;
use crate::results::Results;
use crate::single::Single;
#[cfg(feature = "test-util")]
use laguerre_core::Error;
use laguerre_core::algebra::Algebra;
use laguerre_core::assemble::{Assembler, Row};
use laguerre_core::diagram::{FramedContainer, Prepared};
use laguerre_core::geometry;
use laguerre_core::session::Resident;
use laguerre_core::site_tree::SiteTree;
use laguerre_core::{
    Backend, BackendInfo, Capabilities, DeviceChoice, ErrorKind, FacetArrays, Observer, Output, PassReport,
    PowerDiagram, Precision, Report, Request, Result, Watched,
};
use std::mem;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// Opens the OpenCL backend in a precision. In single precision cells are computed by the same kernels where several work-items share one; on other
/// devices by one for single precision alone.
///
/// # Errors
/// As [`Ocl::new`].
pub fn open(choice: &DeviceChoice, precision: Precision) -> Result<Box<dyn Backend>> {
    let may_share = |found: &Found| found.info.is_gpu && found.unusable(Precision::F64).is_none();
    if precision == Precision::F32 && !choose(choice, precision)?.iter().all(may_share) {
        return Ok(Box::new(Single::new(choice)?));
    }
    let mut opened = Ocl::new(choice, precision)?;
    if precision == Precision::F32 && !opened.devices.get_mut().iter().all(Device::shares_cells) {
        return Ok(Box::new(Single::new(choice)?));
    }
    Ok(Box::new(opened))
}

/// Backends so far.
static BACKENDS: AtomicU64 = AtomicU64::new(0);

/// The OpenCL backend.
pub struct Ocl {
    backend: &'static str,
    pub(crate) name: String,
    /// No other in the process has it.
    pub(crate) number: u64,
    pub(crate) precision: Precision,
    /// Whether the first device is a processor that the host computes with as well.
    pub(crate) is_host: bool,
    pub(crate) devices: Devices<Device>,
}

impl Ocl {
    /// Opens devices, which have doubles. In single precision it is volumes and barycenters that are single numbers, of cells that these tell well
    /// and are whole, among sites of equal weights; all else is computed in double precision.
    ///
    /// # Errors
    /// `Unavailable` where there is no OpenCL, no device, or not the one asked for; `Device` where it fails.
    pub fn new(choice: &DeviceChoice, precision: Precision) -> Result<Self> {
        let chosen = choose(choice, Precision::F64)?;
        let names: Vec<&str> = chosen.iter().map(|device| device.info.name.as_str()).collect();
        let name = names.join(", ");
        let open = |found| Device::open(found, precision).map_err(|error| on_device(error, &found.info.name));
        let devices = Devices::new(chosen.iter().map(open).collect::<Result<Vec<_>>>()?)?;
        let number = BACKENDS.fetch_add(1, Ordering::Relaxed);
        let is_host = chosen.first().is_some_and(|device| !device.info.is_gpu);
        Ok(Self { backend: "ocl", name, number, precision, is_host, devices })
    }

    /// Opens devices that compute cells by the kernel for work-items that share a cell, each alone: for tests of that kernel where no
    /// device would choose it.
    ///
    /// # Errors
    /// As [`Ocl::new`]; `Unavailable` where a device chooses that kernel anyway, in double precision.
    #[cfg(feature = "test-util")]
    pub fn sharing_cells(choice: &DeviceChoice, precision: Precision) -> Result<Self> {
        let backend = if precision == Precision::F32 { "ocl-single" } else { "ocl-sharing" };
        let mut opened = Self { backend, ..Self::new(choice, precision)? };
        let devices = opened.devices.get_mut();
        let mut are_others = true;
        for device in devices {
            are_others &= device.share_cells();
        }
        match are_others || precision == Precision::F32 {
            true => Ok(opened),
            false => Err(Error::new(ErrorKind::Unavailable, "this is how the device computes cells anyway")),
        }
    }

    /// The same by the first device whose sub-groups can share a cell.
    ///
    /// # Errors
    /// As [`Ocl::new`]; `Unavailable` where there is none.
    #[cfg(feature = "test-util")]
    pub fn sharing_in_sub_groups() -> Result<Self> {
        let mut opened = Self { backend: "ocl-lanes", ..Self::new(&DeviceChoice::All, Precision::F64)? };
        let devices = opened.devices.get_mut();
        match devices.iter_mut().position(Device::share_in_sub_groups) {
            Some(number) => *devices = vec![devices.swap_remove(number)],
            None => return Err(Error::new(ErrorKind::Unavailable, "no device has sub-groups that could share a cell")),
        }
        opened.name = devices[0].name.clone();
        Ok(opened)
    }
}

impl Backend for Ocl {
    fn info(&self) -> BackendInfo {
        BackendInfo::of_devices(self.backend, self.name.clone(), self.precision)
    }

    fn algebra(&self) -> Option<&dyn Algebra> {
        Some(self)
    }

    fn resident<'a>(&'a self, request: &Request, observer: &'a dyn Observer) -> Option<Box<dyn Resident + 'a>> {
        Stay::new(self, request, observer).map(|stay| Box::new(stay) as Box<dyn Resident + 'a>)
    }

    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, observer: &dyn Observer) -> Result<Output> {
        Capabilities::OF_DEVICES.check(request, diagram)?;
        let observer = Again::new(observer);
        let request = &Watched::new(request, &observer);
        self.devices.with(|devices| {
            let computed = self.compute(diagram, request, devices);
            // Sub-groups are whatever a driver makes of them: where they fail, or what they answer is not believed, each cell is one work-item's.
            let has_failed = matches!(&computed, Err(error) if error.kind() == ErrorKind::Device);
            let mut leaves = false;
            for device in devices.iter_mut().filter(|_| has_failed) {
                // (Nor is what they have believed to be as it was.)
                device.sites.forget();
                leaves |= device.leave_sub_groups();
            }
            if !leaves {
                return computed;
            }
            observer.begin_again();
            self.compute(diagram, request, devices)
        })
    }
}

impl Ocl {
    fn compute(&self, diagram: &PowerDiagram, request: &Watched<'_>, devices: &mut [Device]) -> Result<Output> {
        let container = diagram.framed_container()?;
        let integrand = request.integral().map(|f| f.framed(&container.frame)).transpose()?;
        let name: fn(&Device) -> &String = |device| &device.name;
        // Every device orders all sites for itself: its cells are cut by others' sites.
        let sorted = on_all(devices, name, &|_, device| {
            device.bring_sites(diagram)?;
            device.load(&container, request, integrand.as_ref())?;
            device.sort(&|| diagram.check_range(&container).map(|()| true))
        })?;
        let mut count = sorted.iter().flatten().copied().max();
        let sites = diagram.positions().len();
        let prepared = if sorted.contains(&None) { Some(diagram.prepare()?) } else { None };
        if let Some(prepared) = &prepared {
            count = on_all(devices, name, &|_, device| device.take(prepared))?.first().copied();
        }
        let shares = shares(count.unwrap_or(0), devices.len());
        // The memory of the output is made while the devices compute: of ten million cells that takes 0.02 s, of a million with facets as much (16 cores).
        let lengths = devices.first().map(|device| device.lengths).unwrap_or_default();
        let (computed, (mut assembler, mut ahead)) = rayon::join(
            || {
                on_all(devices, name, &|i, device| {
                    let computed = device.compute(request, sites, shares[i].clone(), shares.len())?;
                    device.read_results(request, sites)?;
                    Ok(computed)
                })
            },
            || (Assembler::new(diagram, &container, request), Ahead::new(lengths, request, sites)),
        );
        let computed = computed?;
        let mut for_host = Vec::new();
        let (mut exact_cells, mut passes) = (0, Vec::new());
        let mut tree = None;
        for (device, computed) in devices.iter().zip(computed) {
            exact_cells += device.results.exact_cells();
            for_host.extend(computed.for_host);
            join_passes(&mut passes, &computed.passes);
            tree = tree.or(computed.tree);
        }
        // What comes of facets is put in order, and read, while the sums of all cells are gone through.
        let all: Vec<Results> = devices.iter_mut().map(|device| mem::take(&mut device.results)).collect();
        let (rows, ()) = rayon::join(
            || match &mut *devices {
                [first, ..] if for_host.is_empty() => first.assemble_rows(request, &container, sites, &[], &mut ahead),
                _ => Ok(Rows::default()),
            },
            || all.iter().for_each(|results| results.assemble(&mut assembler)),
        );
        devices.iter_mut().zip(all).for_each(|(device, results)| device.results = results);
        let mut rows = rows?;
        if !for_host.is_empty() {
            let prepared = match (prepared, tree) {
                (Some(prepared), _) => prepared,
                (None, Some(made)) => {
                    Prepared { container: container.clone(), sites: SiteTree::from_device(made, sites), octree: None }
                }
                (None, None) => diagram.prepare()?,
            };
            fallback::compute(&prepared, request, &for_host, &mut assembler)?;
        }
        let mut order = Vec::new();
        if let (true, [first, ..]) = (request.needs_facets(), &mut *devices) {
            if !for_host.is_empty() {
                let of_host: Vec<_> = for_host.iter().map(|&site| (site, assembler.row(site))).collect();
                rows = first.assemble_rows(request, &container, sites, &of_host, &mut ahead)?;
            }
            let first_name = first.name.clone();
            let named = |error| on_device(error, &first_name);
            match rows.facets {
                Some(ordered) => assembler.take_facets(ordered),
                None if request.facets() => first.read_kept_facets(request, sites).map_err(named)?,
                None => {}
            }
            match rows.laplacian {
                Some(Made::Kept(kept)) => assembler.keep(kept),
                Some(Made::Read(laplacian)) => assembler.take_laplacian(laplacian),
                None if request.laplacian() => {
                    first.leave_laplacian(request, sites).map_err(named)?;
                    order = first.order().map_err(named)?;
                }
                None => {}
            }
        }
        let device_seconds = devices.iter().map(|device| device.seconds).fold(0.0, f64::max);
        let results: Vec<_> = devices.iter().map(|device| &device.results).collect();
        let row =
            |i| results.iter().map(|results| results.facets_of(i)).find(|row| !row.is_empty()).unwrap_or_default();
        let host_cells = for_host.len();
        let report = Report::of_devices(exact_cells + host_cells, host_cells, device_seconds, passes);
        let geometry = geometry::on_host(diagram, request, assembler.status())?;
        let output = assembler.finish_with(row, &order, report, geometry)?;
        if request.epsilon().is_none() {
            check_volumes(diagram, &output, self.precision, &self.name)?;
        }
        Ok(output)
    }
}

/// What a device has made of the facets of all cells: none of it where the host has to, or it is not asked for.
#[derive(Default)]
struct Rows {
    facets: Option<FacetArrays>,
    laplacian: Option<Made>,
}

impl Device {
    /// Puts the facets of all cells in order, of which the host has a few, and makes the Laplacian; nothing of it where not all are here.
    fn assemble_rows(
        &mut self,
        request: &Request,
        container: &FramedContainer,
        sites: usize,
        of_host: &[(u32, Row<'_>)],
        ahead: &mut Ahead,
    ) -> Result<Rows> {
        let Ahead { facets: room, columns, values } = mem::take(ahead);
        let mut rows = Rows::default();
        if !request.needs_facets() {
            return Ok(rows);
        }
        if !self.bring_facets(request, of_host).map_err(|e| on_device(e, &self.name))? {
            self.lengths = Lengths::default();
            return Ok(rows);
        }
        if request.facets() {
            rows.facets =
                self.assemble_facets(request, container, sites, room).map_err(|e| on_device(e, &self.name))?;
        }
        if request.laplacian() && (!request.facets() || rows.facets.is_some()) {
            let made = self.assemble_laplacian(request, sites, of_host.is_empty(), (columns, values));
            rows.laplacian = made.map_err(|e| on_device(e, &self.name))?;
        }
        Ok(rows)
    }
}

/// Splits the sorted sites over the devices, along the grid's order.
pub(crate) fn shares(count: usize, devices: usize) -> Vec<Range<usize>> {
    let end = |i: usize| count * i / devices;
    (0..devices).map(|i| end(i)..end(i + 1)).collect()
}

/// Adds the passes of one device to those of the others.
pub(crate) fn join_passes(all: &mut Vec<PassReport>, own: &[PassReport]) {
    all.resize(all.len().max(own.len()), PassReport::default());
    for (sum, pass) in all.iter_mut().zip(own) {
        sum.neighbors = sum.neighbors.max(pass.neighbors);
        sum.planes = sum.planes.max(pass.planes);
        sum.vertices = sum.vertices.max(pass.vertices);
        sum.triangles = sum.triangles.max(pass.triangles);
        sum.cells += pass.cells;
        sum.failed += pass.failed;
        sum.seconds = sum.seconds.max(pass.seconds);
        sum.device_seconds = sum.device_seconds.max(pass.device_seconds);
        sum.second.cells += pass.second.cells;
        sum.second.seconds = sum.second.seconds.max(pass.second.seconds);
    }
}
