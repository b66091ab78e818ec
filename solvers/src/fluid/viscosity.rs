//! Viscosity: velocities of neighbouring cells drawn together, by the implicit Euler method.

use laguerre_core::algebra::{Algebra, Held};
use laguerre_core::{Backend, Error, PowerDiagram, Result};

use super::neighbors::Neighbors;
use crate::vectors::map;

/// What the residual of the linear system may be, of its right-hand side: what is left is momentum that is not conserved.
const RELATIVE: f64 = 1e-12;
/// Iterations of the conjugate gradient; the matrix is a diagonal and little more, and takes a dozen.
const MOST_ITERATIONS: usize = 1000;

/// Solves `m_i (u_i − v_i) = strength · Σ_j (A_ij / ‖p_i − p_j‖) (u_j − u_i)`, for `u`. What one cell loses the other has: the Laplacian is symmetric.
///
/// # Errors
/// `Input` where the solution is not found, as where the viscosity is so large that squares of momenta overflow; as [`Neighbors::with`], which is given the
/// diagram of the cells.
pub(super) fn slowed(
    (backend, diagram): (&dyn Backend, &PowerDiagram),
    neighbors: &mut Neighbors,
    masses: &[f64],
    strength: f64,
    v: &[[f64; 3]],
) -> Result<Vec<[f64; 3]>> {
    neighbors.with(backend, diagram, |algebra, matrix, order| {
        let masses = map(order.len(), |row| masses[order[row] as usize]);
        let rows = map(order.len(), |row| v[order[row] as usize]);
        let found = slowed_rows(algebra, matrix, &masses, strength, rows.as_flattened())?;
        let mut slowed = vec![[0.0; 3]; v.len()];
        order.iter().zip(found.as_chunks().0).for_each(|(&i, u)| slowed[i as usize] = *u);
        Ok(slowed)
    })
}

/// The same in the order of the rows: three numbers for each.
fn slowed_rows(algebra: &dyn Algebra, laplacian: &Held, masses: &[f64], strength: f64, v: &[f64]) -> Result<Vec<f64>> {
    let thrice = |x: &[f64]| algebra.vector(&map(v.len(), |k| x[k / 3]));
    let inverse = algebra.read(&algebra.inverse_diagonal(laplacian)?)?;
    // (Of a cell without neighbours it is 0.)
    let tie = |i: usize| if inverse[i] > 0.0 { strength / inverse[i] } else { 0.0 };
    let scales = thrice(&map(masses.len(), |i| (masses[i] + tie(i)).recip()))?;
    let masses = thrice(masses)?;
    let apply = |u: &Held, image: &mut Held| {
        algebra.multiply(laplacian, u, image)?;
        algebra.combine_scaled(1.0, &masses, u, strength, image)
    };
    // The conjugate gradient from `v`, which is `u` but for the residual `−L v`.
    let mut u = algebra.vector(v)?;
    let zeros = || algebra.zeros(v.len());
    let (mut residual, mut image, mut better, mut direction) = (zeros()?, zeros()?, zeros()?, zeros()?);
    algebra.combine_scaled(1.0, &masses, &u, 0.0, &mut residual)?;
    let bound = RELATIVE * algebra.dot(&residual, &residual)?.sqrt();
    apply(&u, &mut image)?;
    algebra.combine(-1.0, &image, 1.0, &mut residual)?;
    let mut slope = 0.0;
    for iteration in 0..MOST_ITERATIONS {
        if algebra.dot(&residual, &residual)?.sqrt() <= bound {
            return algebra.read(&u);
        }
        algebra.combine_scaled(1.0, &scales, &residual, 0.0, &mut better)?;
        let next = algebra.dot(&residual, &better)?;
        let turn = if iteration == 0 { 0.0 } else { next / slope };
        slope = next;
        algebra.combine(1.0, &better, turn, &mut direction)?;
        apply(&direction, &mut image)?;
        let step = slope / algebra.dot(&direction, &image)?;
        algebra.combine(step, &direction, 1.0, &mut u)?;
        algebra.combine(-step, &image, 1.0, &mut residual)?;
    }
    Err(Error::input("the velocities after viscosity were not found: take a smaller viscosity or time step"))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use laguerre_core::{ErrorKind, Request};
    use laguerre_cpu::Cpu;

    use super::*;
    use crate::fluid::lattice;

    fn neighbors(backend: &Cpu, diagram: &PowerDiagram) -> Neighbors {
        let output = backend.evaluate(diagram, &Request::moments().with_laplacian()).unwrap();
        Neighbors::of(backend, diagram, &mut output.into_arrays()).unwrap()
    }

    /// A wave between slippery walls is an eigenvector of the lattice's Laplacian: one implicit step divides it by `1 + τνλ`.
    #[test]
    fn a_wave_decays_as_it_must() {
        let (n, strength) = (8, 0.3);
        let sites = lattice([1.0, 1.0, 0.25], n * n * n / 4);
        let diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0, 1.0, 0.25]).unwrap();
        let backend = Cpu::new(Some(1)).unwrap();
        let mut neighbors = neighbors(&backend, &diagram);
        let h = 1.0 / n as f64;
        let masses = vec![h.powi(3); sites.len()];
        let wave = |p: &[f64; 3]| [(PI * p[1]).cos(), 0.0, 0.5];
        let v: Vec<[f64; 3]> = sites.iter().map(wave).collect();
        let v = slowed((&backend, &diagram), &mut neighbors, &masses, strength, &v).unwrap();
        let factor = 1.0 + strength * (2.0 - 2.0 * (PI * h).cos()) / (h * h);
        for (p, v) in sites.iter().zip(&v) {
            let [x, y, z] = wave(p);
            assert!((v[0] - x / factor).abs() < 1e-10 && (v[1] - y).abs() < 1e-10 && (v[2] - z).abs() < 1e-10, "{v:?}");
        }
    }

    #[test]
    fn what_overflows_is_refused() {
        let sites = lattice([1.0; 3], 27);
        let diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
        let backend = Cpu::new(Some(1)).unwrap();
        let mut neighbors = neighbors(&backend, &diagram);
        let error = slowed((&backend, &diagram), &mut neighbors, &[1.0 / 27.0; 27], 1e300, &sites).unwrap_err();
        assert!(error.kind() == ErrorKind::Input && error.to_string().contains("smaller viscosity"), "{error}");
    }
}
