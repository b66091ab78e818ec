//! A swan: the domain of the demo and of the pictures, smooth and bent, with thick and thin parts.

use std::f64::consts::TAU;

use super::{Mesh, index};

/// A section across the body: the two points of the outline in the plane z = 0 that it joins, x and y of that on the back and of that below, and its
/// half-width along z.
type Section = [f64; 5];

/// From tail to beak; both end in a point.
const SECTIONS: [Section; 18] = [
    [4.20, 1.70, 4.20, 1.70, 0.00],
    [3.60, 1.70, 3.70, 0.95, 0.50],
    [2.90, 1.40, 3.05, 0.30, 0.75],
    [2.10, 1.65, 2.30, -0.50, 1.05],
    [1.20, 1.75, 1.25, -0.95, 1.20],
    [0.30, 1.40, 0.20, -1.00, 1.10],
    [-0.30, 0.95, -0.75, -0.75, 0.85],
    [-0.52, 0.80, -1.45, -0.05, 0.60],
    [-0.62, 0.95, -1.62, 0.80, 0.42],
    [-0.50, 1.40, -1.30, 1.60, 0.32],
    [-0.15, 2.05, -0.75, 2.30, 0.26],
    [0.05, 2.80, -0.52, 2.85, 0.24],
    [-0.08, 3.50, -0.58, 3.22, 0.26],
    [-0.60, 4.00, -0.80, 3.20, 0.40],
    [-1.25, 4.05, -1.10, 2.95, 0.46],
    [-1.60, 3.25, -1.45, 2.90, 0.20],
    [-2.05, 3.10, -1.95, 2.80, 0.18],
    [-2.45, 2.70, -2.45, 2.70, 0.00],
];
/// Rings from one section to the next, and vertices of a ring.
const BETWEEN: usize = 5;
const ACROSS: u32 = 24;
/// Vertices are multiples of a power of two, so that they are the same numbers where sines differ in the last bit.
const QUANTUM: f64 = 1.0 / (1 << 20) as f64;

/// A swan that looks along −x, up is +y, the plane z = 0 is its mirror: 4,032 triangles, volume 15.9. Ellipses across it follow the cubic spline of
/// its sections.
pub fn swan() -> Mesh {
    let rings = rings();
    let (tail, beak) = (rings[0], rings[rings.len() - 1]);
    let mut mesh = Mesh::default();
    for [back_x, back_y, below_x, below_y, width] in &rings[1..rings.len() - 1] {
        for j in 0..ACROSS {
            let (sin, cos) = (TAU * f64::from(j) / f64::from(ACROSS)).sin_cos();
            let between = |back: f64, below: f64| 0.5 * ((1.0 + cos) * back + (1.0 - cos) * below);
            mesh.vertices.push([between(*back_x, *below_x), between(*back_y, *below_y), width * sin]);
        }
    }
    let [tail, beak] = [tail, beak].map(|[x, y, ..]| {
        mesh.vertices.push([x, y, 0.0]);
        index(mesh.vertices.len() - 1)
    });
    mesh.vertices.iter_mut().flatten().for_each(|x| *x = (*x / QUANTUM).round() * QUANTUM);
    let last = tail / ACROSS - 1;
    for (j, next) in (0..ACROSS).map(|j| (j, (j + 1) % ACROSS)) {
        mesh.triangles.push([tail, j, next]);
        for ring in (0..last).map(|ring| ring * ACROSS) {
            let [a, b, c, d] = [ring + j, ring + next, ring + ACROSS + next, ring + ACROSS + j];
            mesh.triangles.extend([[a, c, b], [a, d, c]]);
        }
        mesh.triangles.push([beak, last * ACROSS + next, last * ACROSS + j]);
    }
    mesh
}

/// Points of the uniform cubic B-spline whose control points are the sections, with one more beyond each end, such that it begins and ends there.
fn rings() -> Vec<Section> {
    let beyond = |end: Section, before: Section| std::array::from_fn(|k| 2.0 * end[k] - before[k]);
    let [first, second, .., before_last, last] = SECTIONS;
    let mut controls = vec![beyond(first, second)];
    controls.extend(SECTIONS);
    controls.push(beyond(last, before_last));
    let at = |i: usize| {
        let (span, t) = (i / BETWEEN, (i % BETWEEN) as f64 / BETWEEN as f64);
        // (The last of the four is nothing at the end of a span, where there may be no such control point.)
        let weights = [
            (1.0 - t) * (1.0 - t) * (1.0 - t),
            (3.0 * t - 6.0) * t * t + 4.0,
            ((3.0 - 3.0 * t) * t + 3.0) * t + 1.0,
            t * t * t,
        ];
        std::array::from_fn(|k| {
            (0..4).filter(|&c| weights[c] > 0.0).map(|c| weights[c] * controls[span + c][k]).sum::<f64>() / 6.0
        })
    };
    (0..=BETWEEN * (SECTIONS.len() - 1)).map(at).collect()
}

#[cfg(test)]
mod tests {
    use robust::{Coord, orient2d};

    use super::*;

    #[test]
    fn no_two_sections_meet_but_in_its_ends() {
        // Each ring is an ellipse across its chord in the plane z = 0: where chords do not meet, neither do the rings.
        let rings = rings();
        let chords: Vec<[Coord<f64>; 2]> =
            rings.iter().map(|&[a, b, c, d, _]| [Coord { x: a, y: b }, Coord { x: c, y: d }]).collect();
        let apart = |[a, b]: [Coord<f64>; 2], [c, d]: [Coord<f64>; 2]| orient2d(a, b, c) * orient2d(a, b, d) > 0.0;
        for i in 1..chords.len() - 1 {
            for j in i + 1..chords.len() - 1 {
                assert!(apart(chords[i], chords[j]) || apart(chords[j], chords[i]), "rings {i} and {j}");
            }
        }
    }

    #[test]
    fn it_is_the_same_numbers_everywhere() {
        let domain = swan().domain();
        assert_eq!((domain.vertices().len(), domain.triangles().len()), (2018, 4032));
        assert!(domain.notes().is_empty(), "{:?}", domain.notes());
        // Any order of these sums is exact: they are whole numbers of quanta.
        let sum = |k: usize| domain.vertices().iter().map(|p| p[k] / QUANTUM).sum::<f64>();
        assert_eq!([0, 1, 2].map(sum), [135_675_211.0, 3_711_015_323.0, 0.0]);
        assert!((domain.volume() - 15.869_178_746_792).abs() < 1e-12, "{}", domain.volume());
    }
}
