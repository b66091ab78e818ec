//! Where the sites of a case stand: everywhere that has made a diagram code fail.

use glam::{DMat3, DVec3};

use crate::domains::Room;

/// An arrangement of sites in the bounding box of a room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sites {
    /// Uniform and independent.
    White,
    /// A lattice with as many sites along each axis, at the middles of its boxes: all vertices are shared by eight cells.
    Lattice,
    /// The same with sites at the corners, so on the faces, edges and corners of the box.
    CornerLattice,
    /// A lattice with different numbers along the axes.
    FlatLattice,
    /// A cubic lattice turned by a random matrix: as degenerate as a lattice, but only up to rounding.
    TurnedLattice,
    /// White, mirrored in the three middle planes.
    Mirrored,
    /// On spheres about the middle, exactly: integer points of the spheres of squared radius 9 and 81.
    Cospherical,
    /// On a sphere about the middle, up to rounding.
    NearlyCospherical,
    /// White, where many stand at the position of another.
    Duplicated,
    /// In one plane along the axes.
    Coplanar,
    /// In one skew plane, up to rounding.
    NearlyCoplanar,
    /// On one line along an axis.
    Collinear,
    /// On one skew line, up to rounding.
    NearlyCollinear,
    /// At the points of a coarse lattice, at random: ties and duplicates everywhere.
    Snapped,
    /// On the vertices, edges and faces of the room's surface, and a few within.
    OnSurface,
    /// In a box three times as large.
    Outside,
    /// Most of them in a thousandth of the box.
    Clustered,
    /// In a plane's two sides, mirrored in a face of the room's surface: a bisector lies in that face.
    MirroredInFace,
}

impl Sites {
    /// All arrangements, the simplest first.
    pub const ALL: [Self; 18] = [
        Self::White,
        Self::Lattice,
        Self::CornerLattice,
        Self::FlatLattice,
        Self::TurnedLattice,
        Self::Mirrored,
        Self::Cospherical,
        Self::NearlyCospherical,
        Self::Duplicated,
        Self::Coplanar,
        Self::NearlyCoplanar,
        Self::Collinear,
        Self::NearlyCollinear,
        Self::Snapped,
        Self::OnSurface,
        Self::Outside,
        Self::Clustered,
        Self::MirroredInFace,
    ];
}

/// `count` sites in the bounding box of `room`, in the given arrangement.
pub fn place(sites: Sites, count: usize, room: &Room, random: &mut Random) -> Vec<[f64; 3]> {
    let (lo, hi) = room.bounding_box();
    let (lo, hi) = (DVec3::from(lo), DVec3::from(hi));
    let (extents, middle) = (hi - lo, 0.5 * (lo + hi));
    let side = (1..).find(|m| m * m * m >= count).unwrap_or(1);
    let white = |random: &mut Random| lo + extents * random.point();
    let mut placed: Vec<DVec3> = Vec::with_capacity(count);
    match sites {
        Sites::White => placed.extend((0..count).map(|_| white(random))),
        Sites::Lattice => placed = lattice([side; 3], lo, extents, 0.5),
        Sites::CornerLattice => {
            placed = lattice([side.max(2); 3], lo, extents * (side.max(2) as f64 / (side.max(2) - 1) as f64), 0.0)
        }
        Sites::FlatLattice => {
            let (a, b) = (1 + random.below(2), 1 + random.below(3));
            placed = lattice([count.div_ceil(a * b), a, b], lo, extents, 0.5);
        }
        Sites::TurnedLattice => {
            let turn = random.rotation();
            let size = extents.max_element();
            placed = lattice([side; 3], DVec3::splat(-0.5 * size), DVec3::splat(size), 0.5);
            placed.iter_mut().for_each(|x| *x = middle + turn * *x);
        }
        Sites::Mirrored => {
            for _ in 0..count.div_ceil(8) {
                let offset = white(random) - middle;
                placed.extend((0..8).map(|mirror| middle + signed(offset, mirror)));
            }
        }
        Sites::Cospherical => {
            // 3² = 1 + 4 + 4 and 9² = 1 + 16 + 64 = 16 + 16 + 49 = 9 + 36 + 36; a power of two as scale keeps them exact.
            let scale = 2.0_f64.powf((extents.min_element() / 32.0).log2().floor());
            let middle = (middle / scale).round() * scale;
            let forms = [[1, 2, 2], [0, 0, 3], [1, 4, 8], [4, 4, 7], [3, 6, 6]];
            for _ in 0..count {
                let form = forms[random.below(forms.len())].map(f64::from);
                let turn = random.below(3);
                let point = DVec3::new(form[turn], form[(turn + 1) % 3], form[(turn + 2) % 3]);
                placed.push(middle + scale * signed(point, random.below(8)));
            }
        }
        Sites::NearlyCospherical => {
            placed.extend((0..count).map(|_| middle + 0.3 * extents.min_element() * random.direction()));
        }
        Sites::Duplicated => {
            for i in 0..count {
                let fresh = i == 0 || random.below(2) == 0;
                placed.push(if fresh { white(random) } else { placed[random.below(i)] });
            }
        }
        Sites::Coplanar | Sites::Collinear => {
            let (axis, other) = (random.below(3), white(random));
            for _ in 0..count {
                let mut x = white(random);
                x[axis] = other[axis];
                if sites == Sites::Collinear {
                    x[(axis + 1) % 3] = other[(axis + 1) % 3];
                }
                placed.push(x);
            }
        }
        Sites::NearlyCoplanar | Sites::NearlyCollinear => {
            let turn = random.rotation();
            let rank = if sites == Sites::NearlyCoplanar { DVec3::new(1.0, 1.0, 0.0) } else { DVec3::X };
            placed.extend((0..count).map(|_| middle + turn * (rank * extents * (random.point() - 0.5))));
        }
        Sites::Snapped => placed.extend((0..count).map(|_| lo + extents * (random.point() * 4.0).round() / 4.0)),
        Sites::OnSurface => {
            let mesh = room.mesh();
            for _ in 0..count {
                let triangle = mesh.triangles[random.below(mesh.triangles.len())];
                let [a, b, c] = triangle.map(|v| DVec3::from(mesh.vertices[v as usize]));
                placed.push(match random.below(4) {
                    0 => a,
                    1 => 0.5 * (a + b),
                    2 => (a + b + c) / 3.0,
                    _ => white(random),
                });
            }
        }
        Sites::Outside => placed.extend((0..count).map(|_| middle + 3.0 * extents * (random.point() - 0.5))),
        Sites::Clustered => {
            let center = white(random);
            for _ in 0..count {
                let spread = if random.below(5) == 0 { 1.0 } else { 1e-3 };
                placed.push(center + spread * (white(random) - center));
            }
        }
        Sites::MirroredInFace => {
            let mesh = room.mesh();
            let triangle = mesh.triangles[random.below(mesh.triangles.len())];
            let [a, b, c] = triangle.map(|v| DVec3::from(mesh.vertices[v as usize]));
            let normal = (b - a).cross(c - a).normalize();
            for _ in 0..count.div_ceil(2) {
                let x = white(random);
                placed.extend([x, x - 2.0 * (x - a).dot(normal) * normal]);
            }
        }
    }
    placed.truncate(count);
    placed.into_iter().map(Into::into).collect()
}

/// Splitmix64 (Steele, Lea, Flood 2014): a stream of random numbers that is the same everywhere.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x2545_f491_4f6c_dd1d))
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in 0..n.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// Uniform in the unit cube.
    pub fn point(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit())
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let x = 2.0 * self.point() - 1.0;
            if (0.01..=1.0).contains(&x.length_squared()) {
                return x.normalize();
            }
        }
    }

    /// A rotation about a random axis by a random angle.
    pub fn rotation(&mut self) -> DMat3 {
        DMat3::from_axis_angle(self.direction(), self.unit() * std::f64::consts::TAU)
    }
}

/// `dims` sites, each at the fraction `place` of its box of a lattice that fills `extents` from `lo`.
fn lattice(dims: [usize; 3], lo: DVec3, extents: DVec3, place: f64) -> Vec<DVec3> {
    let at = |i: usize, k: usize| (i as f64 + place) / dims[k] as f64;
    let [a, b, c] = dims;
    let indices = (0..a).flat_map(|i| (0..b).flat_map(move |j| (0..c).map(move |k| (i, j, k))));
    indices.map(|(i, j, k)| lo + extents * DVec3::new(at(i, 0), at(j, 1), at(k, 2))).collect()
}

/// `x` with the signs of those coordinates flipped whose bit is set in `mirror`.
fn signed(x: DVec3, mirror: usize) -> DVec3 {
    let sign = |bit: usize| if mirror >> bit & 1 == 1 { -1.0 } else { 1.0 };
    x * DVec3::new(sign(0), sign(1), sign(2))
}
