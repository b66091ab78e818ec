//! The Laplacian of the cells where linear algebra is done: with a backend that has one of its own, else with the host.

use std::sync::Arc;

use laguerre_core::algebra::{Algebra, Held};
use laguerre_core::{Backend, Error, ErrorKind, Laplacian, OutputArrays, PowerDiagram, Request, Result};

use crate::transport::{HOST, host_matrix};

fn missing() -> Error {
    Error::new(ErrorKind::Device, "the backend gave no Laplacian though asked to")
}

/// It: some 200 bytes a particle, until the next step has found its own. (Where memory was too little for it the sums are the host's, which differ by roundings.)
#[derive(Clone, Debug)]
pub(super) struct Neighbors {
    /// The particle that each row is of.
    order: Vec<u32>,
    /// `Σ_j A_ij / ‖p_i − p_j‖`, first in each row, and the addends, negative.
    matrix: Arc<Held>,
    is_with_backend: bool,
}

impl Neighbors {
    /// Takes the Laplacian out of an output of a diagram, which is evaluated once more where the backend kept it and has it no more, or no room for the matrix.
    ///
    /// # Errors
    /// Those of the evaluation, and `Device` where there is none.
    pub(super) fn of(backend: &dyn Backend, diagram: &PowerDiagram, arrays: &mut OutputArrays) -> Result<Self> {
        if let Some((kept, algebra)) = arrays.kept.take().zip(backend.algebra()) {
            return match algebra.laplacian(&kept, 1.0) {
                Ok(Some(matrix)) => {
                    Ok(Self { order: kept.order().to_vec(), matrix: Arc::new(matrix), is_with_backend: true })
                }
                Err(error) if error.kind() != ErrorKind::Device => Err(error),
                _ => Self::evaluated(backend, diagram),
            };
        }
        Self::of_host(&arrays.laplacian.take().ok_or_else(missing)?)
    }

    /// That of the host, by an evaluation of the diagram.
    fn evaluated(backend: &dyn Backend, diagram: &PowerDiagram) -> Result<Self> {
        let mut output = backend.evaluate(diagram, &Request::moments().with_laplacian())?;
        Self::of_host(&output.take_laplacian().ok_or_else(missing)?)
    }

    pub(super) fn of_host(laplacian: &Laplacian) -> Result<Self> {
        let matrix = Arc::new(host_matrix(laplacian, 1.0)?);
        Ok(Self { order: laplacian.order().to_vec(), matrix, is_with_backend: false })
    }

    /// Does something with the matrix and the particles that its rows are of. Where the backend cannot, for want of memory or because the matrix is another backend's, the host does, with the
    /// cells of `diagram` evaluated once more.
    ///
    /// # Errors
    /// Those of `work` and of the evaluation.
    pub(super) fn with<T>(
        &mut self,
        backend: &dyn Backend,
        diagram: &PowerDiagram,
        work: impl Fn(&dyn Algebra, &Held, &[u32]) -> Result<T>,
    ) -> Result<T> {
        if self.is_with_backend {
            match work(backend.algebra().unwrap_or(&HOST), &self.matrix, &self.order) {
                Err(error) if error.kind() == ErrorKind::Device => {}
                other => return other,
            }
            *self = Self::evaluated(backend, diagram)?;
        }
        work(&HOST, &self.matrix, &self.order)
    }
}
