//! What bounds the sites of a node beside its box: their weights by a polynomial, their places by a slab.

/// Sites from which on an affine, and a quadratic bound are tried.
const ENOUGH_FOR_SLOPE: usize = 6;
const ENOUGH_FOR_CURVATURE: usize = 16;

/// A bound of higher degree is taken where it leaves less than this share of the range of weights.
const WORTH_A_DEGREE: f64 = 0.6;

/// What is added to the diagonal of the normal equations, as a share: flat sets of sites leave slopes open.
const RIDGE: f64 = 1e-6;

/// Roundings of a bound's value, here and where it is evaluated, in units of the sum of its terms' sizes.
const ROUNDINGS: f64 = 32.0 * f64::EPSILON;

/// Squarings of the matrix for the thinnest direction: any direction gives a true slab, a better one a thinner.
const SQUARINGS: usize = 5;

/// Constant, slope and curvature of an upper bound of the weights of `sites`, less `base`, about the middle of their box; of least degree that
/// is tighter by enough.
pub(super) fn fit_weights(
    sites: &[[f64; 4]],
    middle: [f64; 3],
    halves: [f64; 3],
    base: f64,
) -> (f64, [f64; 3], [f64; 3]) {
    let widest = halves.iter().fold(f64::MIN_POSITIVE, |a, &b| a.max(b));
    let (mut top, mut range) = extent_of_rest(sites, middle, base, [0.0; 3], [0.0; 3]);
    let (mut g, mut q) = ([0.0; 3], [0.0; 3]);
    if range > 0.0 && sites.len() >= ENOUGH_FOR_SLOPE {
        let degrees = if sites.len() >= ENOUGH_FOR_CURVATURE { 2 } else { 1 };
        for degree in 1..=degrees {
            let rows = sites.iter().map(|site| {
                let [x, y, z]: [f64; 3] = std::array::from_fn(|k| (site[k] - middle[k]) / widest);
                ([1.0, x, y, z, x * x, y * y, z * z], site[3] - base)
            });
            let solution = if degree == 1 {
                let affine = least_squares(rows.map(|([a, x, y, z, ..], value)| ([a, x, y, z], value)));
                affine.map(|[a, x, y, z]| [a, x, y, z, 0.0, 0.0, 0.0])
            } else {
                least_squares(rows)
            };
            let Some(solution) = solution else { continue };
            let slope = std::array::from_fn(|k| solution[1 + k] / widest);
            let curvature = std::array::from_fn(|k| solution[4 + k] / widest / widest);
            let (largest, left) = extent_of_rest(sites, middle, base, slope, curvature);
            if left < WORTH_A_DEGREE * range {
                (top, range, g, q) = (largest, left, slope, curvature);
            }
        }
    }
    let heaviest = sites.iter().fold(0.0_f64, |w, site| w.max(site[3] - base));
    let terms: f64 = (0..3).map(|k| (g[k].abs() + q[k].abs() * halves[k]) * halves[k]).sum();
    (top + ROUNDINGS * (top.abs() + heaviest + terms), g, q)
}

/// The largest of the weights less `base`, slope and curvature, and the range of these.
fn extent_of_rest(sites: &[[f64; 4]], middle: [f64; 3], base: f64, g: [f64; 3], q: [f64; 3]) -> (f64, f64) {
    let (mut top, mut bottom) = (f64::NEG_INFINITY, f64::INFINITY);
    for site in sites {
        let mut rest = site[3] - base;
        for k in 0..3 {
            let u = site[k] - middle[k];
            rest -= (g[k] + q[k] * u) * u;
        }
        top = top.max(rest);
        bottom = bottom.min(rest);
    }
    (top, top - bottom)
}

/// The slope at `origin`, and the curvature, of the quadratic that fits the weights of `sites` best, mixed terms among its ten, where it leaves
/// less by enough than `slope` and `curvature` do.
pub(super) fn fit_slope(
    sites: &[[f64; 4]],
    origin: [f64; 3],
    base: f64,
    slope: [f64; 3],
    curvature: [f64; 3],
) -> Option<([f64; 3], [f64; 3])> {
    let (_, range) = extent_of_rest(sites, origin, base, slope, curvature);
    let away = |site: &[f64; 4]| -> [f64; 3] { std::array::from_fn(|k| site[k] - origin[k]) };
    let widest = sites.iter().flat_map(away).fold(f64::MIN_POSITIVE, |a, x| a.max(x.abs()));
    let terms = |site: &[f64; 4]| {
        let [x, y, z] = away(site).map(|x| x / widest);
        [1.0, x, y, z, x * x, y * y, z * z, x * y, y * z, z * x]
    };
    let solution = least_squares(sites.iter().map(|site| (terms(site), site[3] - base)))?;
    let (mut top, mut bottom) = (f64::NEG_INFINITY, f64::INFINITY);
    for site in sites {
        let fitted: f64 = terms(site).iter().zip(&solution).map(|(a, b)| a * b).sum();
        top = top.max(site[3] - base - fitted);
        bottom = bottom.min(site[3] - base - fitted);
    }
    let scaled = |first: usize, unit: f64| std::array::from_fn(|k| solution[first + k] / unit);
    (top - bottom < WORTH_A_DEGREE * range).then(|| (scaled(1, widest), scaled(4, widest * widest)))
}

/// The coefficients of `N` terms that fit values best, from each site's terms and its value.
fn least_squares<const N: usize>(rows: impl ExactSizeIterator<Item = ([f64; N], f64)>) -> Option<[f64; N]> {
    let mut matrix = [[0.0; N]; N];
    let mut right = [0.0; N];
    let ridge = RIDGE * rows.len() as f64;
    for (terms, value) in rows {
        for row in 0..N {
            for column in 0..N {
                matrix[row][column] += terms[row] * terms[column];
            }
            right[row] += terms[row] * value;
        }
    }
    for (i, row) in matrix.iter_mut().enumerate() {
        row[i] += ridge;
    }
    // Gauss–Jordan; positive definite, so that no pivot is sought.
    for pivot in 0..N {
        let inverse = 1.0 / matrix[pivot][pivot];
        for row in (0..N).filter(|&row| row != pivot) {
            let share = matrix[row][pivot] * inverse;
            for column in pivot..N {
                matrix[row][column] -= share * matrix[pivot][column];
            }
            right[row] -= share * right[pivot];
        }
    }
    let solution: [f64; N] = std::array::from_fn(|row| right[row] / matrix[row][row]);
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}

/// A unit vector across the thinnest direction of the sites, and the least and the largest `normal·p`, rounded outward.
pub(super) fn thinnest_slab(sites: &[[f64; 4]]) -> ([f64; 3], f64, f64) {
    let share = 1.0 / sites.len() as f64;
    let mean: [f64; 3] = std::array::from_fn(|k| share * sites.iter().map(|site| site[k]).sum::<f64>());
    let mut spread = [[0.0; 3]; 3];
    for site in sites {
        let d: [f64; 3] = std::array::from_fn(|k| site[k] - mean[k]);
        for i in 0..3 {
            for j in 0..3 {
                spread[i][j] += d[i] * d[j];
            }
        }
    }
    // The thinnest direction of the spread is the longest of what it leaves of its trace: there the powers of that matrix lead.
    let trace = spread[0][0] + spread[1][1] + spread[2][2];
    let mut power: [[f64; 3]; 3] =
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { trace - spread[i][j] } else { -spread[i][j] }));
    for _ in 0..SQUARINGS {
        let unit = 1.0 / (power[0][0] + power[1][1] + power[2][2]);
        power = power.map(|row| row.map(|x| x * unit));
        power = std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| power[i][k] * power[k][j]).sum()));
    }
    let along = power.map(|row| row[0] * 0.577 + row[1] * 0.5771 + row[2] * 0.5772);
    let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
    // Not a number where the sites are one.
    let normal = if length > 0.0 { along.map(|x| x / length) } else { [1.0, 0.0, 0.0] };
    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut size = 0.0_f64;
    for &[x, y, z, _] in sites {
        let height = normal[0] * x + normal[1] * y + normal[2] * z;
        lo = lo.min(height);
        hi = hi.max(height);
        size = size.max(x.abs() + y.abs() + z.abs());
    }
    let outward = 8.0 * f64::EPSILON * size;
    (normal, lo - outward, hi + outward)
}
