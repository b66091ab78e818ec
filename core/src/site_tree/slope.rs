//! How weights slope and curve about a leaf.

/// A bound of higher degree is taken where it leaves less than this share of the range of weights.
const WORTH_A_DEGREE: f64 = 0.6;

/// What is added to the diagonal of the normal equations, as a share: flat sets of sites leave slopes open.
const RIDGE: f64 = 1e-6;

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
