//! Laws of a validated mesh, and what is refused.

use super::*;

const CUBE: [[u32; 3]; 12] = [
    [0, 2, 1],
    [1, 2, 3],
    [4, 5, 6],
    [5, 7, 6],
    [0, 1, 4],
    [1, 5, 4],
    [2, 6, 3],
    [3, 6, 7],
    [0, 4, 2],
    [2, 4, 6],
    [1, 3, 5],
    [3, 7, 5],
];
const OCTAHEDRON: [[u32; 3]; 8] =
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

fn cube(lo: [f64; 3], hi: [f64; 3]) -> Vec<[f64; 3]> {
    (0..8).map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 0 { lo[k] } else { hi[k] })).collect()
}

fn octahedron(center: [f64; 3], radius: f64) -> Vec<[f64; 3]> {
    (0..6)
        .map(|i| {
            let mut v = center;
            v[i / 2] += if i % 2 == 0 { radius } else { -radius };
            v
        })
        .collect()
}

fn message(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> String {
    Domain::new(vertices, triangles).expect_err("must be refused").to_string()
}

fn assert_close(found: f64, right: f64) {
    assert!((found - right).abs() <= 4e-16 * right.abs(), "{found} is not {right}");
}

#[test]
fn integrals_of_known_shapes() {
    for moved in [0.0, 0.375, 1000.0, -1000.0, 1_000_000.0] {
        let domain = Domain::new(&cube([moved; 3], [moved + 0.5, moved + 1.25, moved + 3.0]), &CUBE).unwrap();
        assert_close(domain.volume(), 0.5 * 1.25 * 3.0);
        assert_close(domain.area(), 2.0 * (0.5 * 1.25 + 1.25 * 3.0 + 0.5 * 3.0));
        for (x, half) in domain.barycenter().into_iter().zip([0.25, 0.625, 1.5]) {
            assert_close(x, moved + half);
        }
        assert_eq!(domain.bounding_box(), ([moved; 3], [moved + 0.5, moved + 1.25, moved + 3.0]));
        let domain = Domain::new(&octahedron([moved, moved - 7.0, 2.0 * moved], 0.75), &OCTAHEDRON).unwrap();
        assert_close(domain.volume(), 4.0 / 3.0 * 0.75_f64.powi(3));
        assert_close(domain.area(), 4.0 * 3.0_f64.sqrt() * 0.75 * 0.75);
        for (x, right) in domain.barycenter().into_iter().zip([moved, moved - 7.0, 2.0 * moved]) {
            assert!((x - right).abs() <= 4e-16 * (right.abs() + 1.0), "{x} is not {right}");
        }
    }
    for scale in [1e-55, 1e55] {
        let domain = Domain::new(&cube([scale; 3], [3.0 * scale; 3]), &CUBE).unwrap();
        let side = 3.0 * scale - scale;
        // Three more roundings in the quotient.
        assert!((domain.volume() / side / side / side - 1.0).abs() <= 8e-16);
        assert_close(domain.barycenter()[1], 2.0 * scale);
    }
}

#[test]
fn an_inward_mesh_is_flipped_with_a_note() {
    let inward = CUBE.map(|[a, b, c]| [a, c, b]);
    let domain = Domain::new(&cube([0.0; 3], [1.0; 3]), &inward).unwrap();
    assert_eq!(domain.volume(), 1.0);
    assert_eq!(domain.barycenter(), [0.5; 3]);
    assert!(domain.notes()[0].contains("flipped"));
    let straight = Domain::new(&cube([0.0; 3], [1.0; 3]), &CUBE).unwrap();
    assert!(straight.notes().is_empty());
    for domain in [domain, straight] {
        let grid = domain.grid(1);
        assert_eq!(grid.winding([0, 1, 2].map(|k| grid.voxel_of(k, 0.5))), 1);
    }
}

#[test]
fn a_soup_is_welded_and_what_is_unused_ignored() {
    let corners = cube([-0.0; 3], [1.0; 3]);
    let mut soup: Vec<[f64; 3]> = CUBE.iter().flatten().map(|&i| corners[i as usize]).collect();
    soup.iter_mut().step_by(5).for_each(|v| v.iter_mut().for_each(|x| *x = if *x == 0.0 { 0.0 } else { *x }));
    let mut triangles: Vec<[u32; 3]> = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    // A far vertex of no triangle, and a needle to another that welding makes disappear.
    soup.extend([[50.0; 3], [-50.0; 3]]);
    triangles.push([0, 1, 0]);
    triangles.push([37, 2, 37]);
    let domain = Domain::new(&soup, &triangles).unwrap();
    assert_eq!((domain.vertices().len(), domain.triangles().len()), (8, 12));
    assert_eq!(domain.bounding_box(), ([0.0; 3], [1.0; 3]));
    assert_eq!(domain.volume(), 1.0);
    assert!(domain.notes()[0].starts_with("2 triangles"));
}

#[test]
fn legal_but_unusual_surfaces() {
    // Two cubes that share an edge: it is met twice each way.
    let mut vertices = cube([0.0; 3], [1.0; 3]);
    vertices.extend(cube([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]));
    let two: Vec<[u32; 3]> = CUBE.into_iter().chain(CUBE.map(|t| t.map(|i| i + 8))).collect();
    assert_eq!(Domain::new(&vertices, &two).unwrap().volume(), 2.0);
    // A cavity: the inner shell is oriented inward.
    vertices.truncate(8);
    vertices.extend(cube([0.25; 3], [0.75; 3]));
    let cavity: Vec<[u32; 3]> = CUBE.into_iter().chain(CUBE.map(|[a, b, c]| [a + 8, c + 8, b + 8])).collect();
    assert_eq!(Domain::new(&vertices, &cavity).unwrap().volume(), 1.0 - 0.125);
    // A triangle of zero area with three different vertices: the edge 1-2 split at its middle on one side only.
    let mut vertices = cube([0.0; 3], [1.0; 3]);
    vertices.push([0.5, 0.5, 0.0]);
    let mut split = CUBE.to_vec();
    split[0] = [0, 2, 8];
    split.extend([[0, 8, 1], [2, 1, 8]]);
    let domain = Domain::new(&vertices, &split).unwrap();
    assert_eq!((domain.triangles().len(), domain.volume()), (14, 1.0));
}

#[test]
fn what_is_wrong_is_named() {
    let vertices = cube([0.0; 3], [1.0; 3]);
    assert!(message(&vertices, &[]).contains("no triangles"));
    let mut bad = CUBE;
    bad[7][1] = 8;
    let text = message(&vertices, &bad);
    assert!(text.contains("triangle 7") && text.contains("index 8"), "{text}");
    for x in [f64::NAN, f64::INFINITY, -2e100] {
        let mut vertices = vertices.clone();
        vertices[3][1] = x;
        assert!(message(&vertices, &CUBE).contains("vertex 3"));
    }
    let open = message(&vertices, &CUBE[..11]);
    assert!(open.contains("open") && open.contains("triangle 3") && open.contains("[1.0, 1.0, 1.0]"), "{open}");
    let mut fin = CUBE.to_vec();
    fin.extend([[0, 1, 7], [1, 0, 7], [0, 1, 7]]);
    let text = message(&vertices, &fin);
    assert!(text.contains("open") && text.contains("belongs to 5 triangles"), "{text}");
    // Nothing enclosed: a flat pillow off the axes, two opposite cubes, and triangles that are all points.
    let flat = [[0.1, 0.2, 0.3], [0.7, 0.9, 1.3], [0.4, -0.8, 2.9]];
    assert!(message(&flat, &[[0, 1, 2], [0, 2, 1]]).contains("volume 0"));
    let both: Vec<[u32; 3]> = CUBE.into_iter().chain(CUBE.map(|[a, b, c]| [a, c, b])).collect();
    assert!(message(&vertices, &both).contains("volume 0"));
    assert!(message(&[[1.0; 3]; 3], &[[0, 1, 2]]).contains("two vertices at one place"));
    let tiny = cube([0.0; 3], [1e-101; 3]);
    assert!(message(&tiny, &CUBE).contains("extent"));
}

/// The same triangles, those that `turn` says the other way round; the first corner stays, so that sums come to the same bits.
fn shuffled(triangles: &[[u32; 3]], turn: impl Fn(usize) -> bool) -> Vec<[u32; 3]> {
    let turned = |(i, &[a, b, c]): (usize, &[u32; 3])| if turn(i) { [a, c, b] } else { [a, b, c] };
    triangles.iter().enumerate().map(turned).collect()
}

/// Both are the same, to the bit, and the second says why it is not as it came.
fn assert_same(given: &Domain, mended: &Domain, name: &str) {
    assert_eq!(given.triangles(), mended.triangles(), "{name}");
    assert_eq!(given.vertices(), mended.vertices(), "{name}");
    assert_eq!(given.volume().to_bits(), mended.volume().to_bits(), "{name}");
    assert_eq!(given.barycenter().map(f64::to_bits), mended.barycenter().map(f64::to_bits), "{name}");
    assert_eq!(mended.notes().len(), 1, "{name}: {:?}", mended.notes());
    assert!(mended.notes()[0].contains("triangles were turned"), "{name}: {:?}", mended.notes());
}

#[test]
fn shuffled_triangles_are_oriented_as_they_were() {
    let shapes = [
        ("swan", crate::shapes::swan()),
        ("torus", crate::shapes::torus(1.0, 0.4, 16, 8)),
        ("double torus", crate::shapes::double_torus()),
        ("cavity", crate::shapes::box_with_cavity(1)),
    ];
    for (name, shape) in shapes {
        let given = Domain::new(&shape.vertices, &shape.triangles).unwrap();
        for turn in [|i: usize| i.wrapping_mul(0x9e37_79b9) >> 7 & 1 == 0, |i| i == 0, |i| i != 5] {
            let mesh = shuffled(&shape.triangles, turn);
            assert_same(&given, &Domain::new(&shape.vertices, &mesh).unwrap(), name);
        }
        // What was right, and what is inside out as a whole, need no help; asked for, it changes nothing or all.
        assert!(Domain::oriented(&shape.vertices, &shape.triangles).unwrap().notes().is_empty(), "{name}");
        assert_same(&given, &Domain::oriented(&shape.vertices, &shuffled(&shape.triangles, |_| true)).unwrap(), name);
    }
}

#[test]
fn parts_are_turned_by_what_they_are_within() {
    // Five cubes, each within the one before; one beside them; and one that touches the second's wall from within, at a corner, where both walls of
    // the touched cube stand along the ray.
    let mut cubes: Vec<([f64; 3], [f64; 3])> = (0..5).map(|i| ([f64::from(i); 3], [20.0 - f64::from(i); 3])).collect();
    cubes.push(([30.0; 3], [31.0; 3]));
    let mut vertices: Vec<[f64; 3]> = cubes.iter().flat_map(|&(lo, hi)| cube(lo, hi)).collect();
    vertices.extend(octahedron([1.5, 10.0, 10.0], 0.5));
    let mut right: Vec<[u32; 3]> = Vec::new();
    for c in 0..6 {
        let inward = c % 2 == 1 && c < 5;
        right.extend(shuffled(&CUBE, |_| inward).into_iter().map(|t| t.map(|i| i + 8 * c)));
    }
    // Between the second cube and the third, which it touches too: a solid within a cavity.
    right.extend(OCTAHEDRON.map(|t| t.map(|i| i + 48)));
    let given = Domain::new(&vertices, &right).unwrap();
    let volume =
        (0..5).map(|i| (20.0_f64 - 2.0 * f64::from(i)).powi(3) * if i % 2 == 0 { 1.0 } else { -1.0 }).sum::<f64>();
    assert!((given.volume() - volume - 1.0 - 4.0 / 3.0 * 0.125).abs() < 1e-11, "{}", given.volume());
    for outward in [true, false] {
        // All outward: consistent, so that only who asks gets cavities.
        let mesh: Vec<[u32; 3]> = (0..7)
            .flat_map(|c| {
                shuffled(&right[12 * c..right.len().min(12 * c + 12)], |_| c % 2 == 1 && c < 5 || !outward && c == 3)
            })
            .collect();
        assert_same(&given, &Domain::oriented(&vertices, &mesh).unwrap(), "nested");
        assert!(Domain::new(&vertices, &mesh).unwrap().volume() > given.volume());
    }
    let mesh = shuffled(&right, |i| i % 3 == 0);
    assert_same(&given, &Domain::new(&vertices, &mesh).unwrap(), "nested");
    // From outside, wherever it touches.
    for axis in 0..3 {
        for side in [-0.5, 1.5] {
            let mut center = [0.5; 3];
            center[axis] = side;
            let mut vertices = cube([0.0; 3], [1.0; 3]);
            vertices.extend(octahedron(center, 0.5));
            let right: Vec<[u32; 3]> = CUBE.into_iter().chain(OCTAHEDRON.map(|t| t.map(|i| i + 8))).collect();
            let given = Domain::new(&vertices, &right).unwrap();
            assert_same(&given, &Domain::new(&vertices, &shuffled(&right, |i| i % 2 == 1)).unwrap(), "touching");
        }
    }
}

/// Of parts that intersect neither lies within the other: where some corners of one do, the first of them or the last; where all do and edges do not, as those of a bar
/// from one leg of a U to the other.
#[test]
fn parts_that_intersect_lie_within_neither() {
    let bar = cube([0.5, 1.5, 0.25], [2.5, 2.5, 0.75]);
    let outline = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [2.0, 3.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    let legs: Vec<[f64; 3]> = [0.0, 1.0].into_iter().flat_map(|z| outline.map(|[x, y]| [x, y, z])).collect();
    let floor = [[0, 1, 4], [0, 4, 5], [1, 2, 4], [2, 3, 4], [0, 5, 7], [5, 6, 7]];
    let mut sides: Vec<[u32; 3]> = floor.iter().flat_map(|&[a, b, c]| [[a, c, b], [a + 8, b + 8, c + 8]]).collect();
    sides.extend((0..8).map(|i| (i, (i + 1) % 8)).flat_map(|(i, j)| [[i, j, j + 8], [i, j + 8, i + 8]]));
    let unit = cube([0.0; 3], [1.0; 3]);
    for (one, mesh, other, volume) in [
        (&unit, &CUBE[..], cube([0.5; 3], [2.0; 3]), 1.0 + 3.375),
        (&unit, &CUBE[..], cube([0.75; 3], [1.75; 3]), 2.0),
        (&unit, &CUBE[..], cube([-0.75; 3], [0.25; 3]), 2.0),
        (&unit, &CUBE[..], cube([0.25, 0.25, -1.0], [0.75, 0.75, 2.0]), 1.75),
        (&legs, &sides[..], bar, 7.0 + 1.0),
    ] {
        for swapped in [false, true] {
            let more = |mesh: &[[u32; 3]], by: usize| -> Vec<[u32; 3]> {
                mesh.iter().map(|t| t.map(|i| i + by as u32)).collect()
            };
            let (vertices, right) = match swapped {
                false => ([&one[..], &other].concat(), [more(mesh, 0), more(&CUBE, one.len())].concat()),
                true => ([&other[..], one].concat(), [more(&CUBE, 0), more(mesh, other.len())].concat()),
            };
            let given = Domain::new(&vertices, &right).unwrap();
            assert!((given.volume() - volume).abs() < 1e-12, "{} {volume}", given.volume());
            assert!(Domain::oriented(&vertices, &right).unwrap().notes().is_empty(), "{volume}");
            for turned in [|i: usize| i.is_multiple_of(2), |i| i % 3 == 1] {
                assert_same(&given, &Domain::new(&vertices, &shuffled(&right, turned)).unwrap(), "intersecting");
            }
        }
    }
}

#[test]
fn where_many_triangles_share_an_edge_they_are_solids_around_it() {
    // Wedges around the z axis, of which any two have one before the other: the axis belongs to two triangles of each.
    let angles = [0.1_f64, 0.6, 0.9, 1.4, 2.0, 3.0, 3.3, 3.9, 4.5, 6.1];
    let mut vertices = vec![[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]];
    vertices.extend(angles.map(|angle| [angle.cos(), angle.sin(), 0.25]));
    let wedge = |p: u32| [[0, p + 1, p], [1, p, p + 1], [0, p, 1], [0, 1, p + 1]];
    let wedges: Vec<[u32; 3]> = [2, 4, 6, 8, 10].into_iter().flat_map(wedge).collect();
    // Not in their order around the axis: first one side of all, then the other.
    let right: Vec<[u32; 3]> = (0..20).map(|i| wedges[4 * (i * 2 % 5) + i / 5]).collect();
    let given = Domain::new(&vertices, &right).unwrap();
    for turn in [|i: usize| i.is_multiple_of(2), |i| i % 3 == 1, |i| i == 7] {
        assert_same(&given, &Domain::new(&vertices, &shuffled(&right, turn)).unwrap(), "wedges");
    }
}

#[test]
fn one_sided_surfaces_are_refused_by_one_line() {
    // The projective plane of six vertices, every two of which share an edge of two triangles.
    let mesh =
        [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5], [0, 5, 1], [1, 2, 4], [2, 3, 5], [3, 4, 1], [4, 5, 2], [5, 1, 3]];
    let text = message(&octahedron([0.0; 3], 1.0), &mesh);
    assert!(
        text.starts_with("the domain's triangles cannot be oriented alike: ") && text.contains("of triangle "),
        "{text}"
    );
    assert!(!text.contains('\n'), "{text}");
    // A Möbius strip is open, which is what is said of it.
    let strip: Vec<[u32; 3]> = (0..5).map(|i| [i, (i + 1) % 5, (i + 2) % 5]).collect();
    assert!(message(&octahedron([0.0; 3], 1.0), &strip).contains("open"));
}
