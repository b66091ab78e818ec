//! Viscosity: velocities of neighbouring cells drawn together, by the implicit Euler method.

use laguerre_core::{Error, Laplacian, Result};

use crate::vectors::{add, copied, dot, for_each, map};

/// What the residual of the linear system may be, of its right-hand side: what is left is momentum that is not conserved.
const RELATIVE: f64 = 1e-12;
/// Iterations of the conjugate gradient; the matrix is a diagonal and little more, and takes a dozen.
const MOST_ITERATIONS: usize = 1000;

/// Solves `m_i (u_i − v_i) = strength · Σ_j (A_ij / ‖p_i − p_j‖) (u_j − u_i)` and puts `u` in the place of `v`. What one cell loses the other has: the
/// Laplacian is symmetric.
///
/// # Errors
/// `Input` where the solution is not found, as where the viscosity is so large that squares of momenta overflow.
pub(super) fn slow(laplacian: &Laplacian, masses: &[f64], strength: f64, v: &mut [[f64; 3]]) -> Result<()> {
    let order = laplacian.order();
    let mut u = map(order.len(), |row| v[order[row] as usize]);
    let masses = map(order.len(), |row| masses[order[row] as usize]);
    slow_rows(laplacian, &masses, strength, &mut u)?;
    order.iter().zip(u).for_each(|(&i, u)| v[i as usize] = u);
    Ok(())
}

/// The same in the order of the rows.
fn slow_rows(laplacian: &Laplacian, masses: &[f64], strength: f64, v: &mut [[f64; 3]]) -> Result<()> {
    let ties = |i: usize| laplacian.values()[laplacian.row(i)].iter().map(|tie| strength * tie);
    let diagonal = map(masses.len(), |i| masses[i] + ties(i).sum::<f64>());
    let apply = |u: &[[f64; 3]], image: &mut [[f64; 3]]| {
        for_each(image, |i, sum| {
            *sum = u[i].map(|x| diagonal[i] * x);
            for (tie, &column) in ties(i).zip(&laplacian.columns()[laplacian.row(i)]) {
                let other = u[column as usize];
                (0..3).for_each(|c| sum[c] -= tie * other[c]);
            }
        });
    };
    let scale = |r: &[[f64; 3]], scaled: &mut [[f64; 3]]| for_each(scaled, |i, s| *s = r[i].map(|x| x / diagonal[i]));
    // The conjugate gradient from `v`, which is `u` but for the residual `−L v`.
    let right = map(v.len(), |i| v[i].map(|x| masses[i] * x));
    let bound = RELATIVE * dot(&right, &right).sqrt();
    let mut image = copied(v);
    apply(v, &mut image);
    let mut residual: Vec<[f64; 3]> = right;
    add(&mut residual, -1.0, &image);
    let mut better = copied(&residual);
    scale(&residual, &mut better);
    let mut direction = copied(&better);
    let mut slope = dot(&residual, &better);
    for _ in 0..MOST_ITERATIONS {
        if dot(&residual, &residual).sqrt() <= bound {
            return Ok(());
        }
        apply(&direction, &mut image);
        let step = slope / dot(&direction, &image);
        add(v, step, &direction);
        add(&mut residual, -step, &image);
        scale(&residual, &mut better);
        let next = dot(&residual, &better);
        let turn = next / slope;
        slope = next;
        for_each(&mut direction, |i, d| *d = std::array::from_fn(|c| better[i][c] + turn * d[c]));
    }
    Err(Error::input("the velocities after viscosity were not found: take a smaller viscosity or time step"))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use laguerre_core::{Backend, ErrorKind, PowerDiagram, Request};
    use laguerre_cpu::Cpu;

    use super::*;
    use crate::fluid::lattice;

    /// A wave between slippery walls is an eigenvector of the lattice's Laplacian: one implicit step divides it by `1 + τνλ`.
    #[test]
    fn a_wave_decays_as_it_must() {
        let (n, strength) = (8, 0.3);
        let sites = lattice([1.0, 1.0, 0.25], n * n * n / 4);
        let diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0, 1.0, 0.25]).unwrap();
        let output = Cpu::new(Some(1)).unwrap().evaluate(&diagram, &Request::moments().with_laplacian()).unwrap();
        let h = 1.0 / n as f64;
        let masses = vec![h.powi(3); sites.len()];
        let wave = |p: &[f64; 3]| [(PI * p[1]).cos(), 0.0, 0.5];
        let mut v: Vec<[f64; 3]> = sites.iter().map(wave).collect();
        slow(output.laplacian().unwrap(), &masses, strength, &mut v).unwrap();
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
        let output = Cpu::new(Some(1)).unwrap().evaluate(&diagram, &Request::moments().with_laplacian()).unwrap();
        let mut v: Vec<[f64; 3]> = sites.clone();
        let error = slow(output.laplacian().unwrap(), &[1.0 / 27.0; 27], 1e300, &mut v).unwrap_err();
        assert!(error.kind() == ErrorKind::Input && error.to_string().contains("smaller viscosity"), "{error}");
    }
}
