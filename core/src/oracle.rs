//! The naive oracle: every site clips every cell, in sorted order, with no grid and no early stop. It shares the clipping
//! with the backends, so it tests completeness; what tests the clipping is what shares nothing with it.

use crate::assemble::{Assembler, CellRecord, FinishedCells};
use crate::backend::{Backend, BackendInfo, Observer, Watched};
use crate::cell::{self, CellSums, PlainStore, bisector, v3};
use crate::geometry::{GeometryAssembler, Shaper, Shapes};
use crate::output::CellStatus;
use crate::{Error, ErrorKind, Output, PowerDiagram, Report, Request, Result};

/// The naive backend, of quadratic cost.
#[derive(Clone, Debug, Default)]
pub struct Naive {
    only: Option<Vec<u32>>,
}

impl Naive {
    /// An oracle for the given sites alone (the caller's indices); other cells are left `Empty`.
    pub fn only(sites: &[u32]) -> Self {
        Self { only: Some(sites.to_vec()) }
    }
}

impl Backend for Naive {
    fn info(&self) -> BackendInfo {
        BackendInfo::of_host("naive", "oracle".into(), 1)
    }

    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, observer: &dyn Observer) -> Result<Output> {
        request.check(diagram)?;
        let watched = Watched::new(request, observer);
        let prepared = diagram.prepare()?;
        let mut assembler = Assembler::new(diagram, &prepared.container, request);
        let integrand = request.integral().map(|f| f.framed(&prepared.container.frame)).transpose()?;
        let flags = cell::flags_of(request);
        let mut geometry = request
            .geometry()
            .then(|| GeometryAssembler::new(diagram.positions().len(), &prepared.container.frame, request.solids()));
        let mut finished = FinishedCells::default();
        let mut shaper = Shaper::new(request.solids());
        let sites: Vec<[f64; 4]> = prepared.sites.sites().collect();
        for (i, &[x, y, z, w]) in sites.iter().enumerate() {
            let site = prepared.sites.order()[i];
            if self.only.as_ref().is_some_and(|only| !only.contains(&site)) {
                continue;
            }
            let mut store = PlainStore::new([x, y, z], prepared.domain_grid()).with_integrand(integrand.as_ref());
            let corner = |c: [f64; 3]| v3(c[0] - x, c[1] - y, c[2] - z);
            let mut status = cell::begin(&mut store, corner(prepared.container.lo), corner(prepared.container.hi));
            for (j, &[nx, ny, nz, nw]) in sites.iter().enumerate() {
                if j != i && status != cell::EMPTY {
                    status = cell::clip(&mut store, bisector(v3(nx - x, ny - y, nz - z), w - nw), j as u32);
                }
            }
            let mut sums = CellSums::default();
            if matches!(status, cell::CUT | cell::UNTOUCHED | cell::COMPLETE) {
                status = cell::integrate_cell(&mut store, flags, 0, &mut sums);
            }
            let status = match status {
                cell::COMPLETE => CellStatus::Complete,
                cell::EMPTY => CellStatus::Empty,
                other => return Err(Error::new(ErrorKind::Device, format!("cell {i} ended with status {other}"))),
            };
            finished.push(CellRecord { site, status, sums }, &store, flags, prepared.sites.order());
            if let Some(geometry) = geometry.as_mut().filter(|_| status != CellStatus::Empty) {
                let mut shapes = Shapes::default();
                let (order, frame) = (prepared.sites.order(), &prepared.container.frame);
                let made = shaper.add(&store, i as u32, sums.volume, order, frame, &mut shapes);
                if made != cell::COMPLETE {
                    return Err(Error::new(
                        ErrorKind::Device,
                        format!("the geometry of cell {i} ended with status {made}"),
                    ));
                }
                geometry.add(&shapes);
            }
            watched.advance(1)?;
        }
        assembler.add(vec![finished]);
        assembler.finish(
            prepared.sites.order(),
            Report::default(),
            geometry.map(GeometryAssembler::finish).transpose()?,
        )
    }
}
