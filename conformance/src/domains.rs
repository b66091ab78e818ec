//! The containers of cases.

use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex};

use glam::{DMat3, DVec3};
use laguerre_core::Domain;
use laguerre_core::diagram::bounding_box;
use laguerre_core::shapes::{self, Contact, Mesh, Section};

/// What the cells are restricted to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the names of `laguerre_core::shapes`")]
pub enum Shape {
    /// The box [0, 1]³ given as a box.
    Box,
    /// The same box as a mesh.
    BoxMesh,
    /// The box [0, 4] × [0, 1] × [0, 1/2] given as a box.
    FlatBox,
    Tetrahedron,
    Sphere,
    Torus,
    Trefoil,
    NestedSpheres,
    Cavity,
    TwoComponents,
    TouchingInFace,
    TouchingInPartOfFace,
    TouchingInEdge,
    TouchingInVertex,
    Plate,
    LongBox,
    DoubleTorus,
    /// A prism with caps that fold over themselves, so many powers of ten below 1 off their planes; its section a star.
    FoldedStar(u8),
    /// The same with an L as section.
    FoldedCorner(u8),
    /// The same with a comb.
    FoldedComb(u8),
}

impl Shape {
    /// All shapes, the simplest first; of those that fold over themselves two.
    pub const ALL: [Self; 19] = [
        Self::Box,
        Self::BoxMesh,
        Self::FlatBox,
        Self::Tetrahedron,
        Self::Sphere,
        Self::Torus,
        Self::Trefoil,
        Self::NestedSpheres,
        Self::Cavity,
        Self::TwoComponents,
        Self::TouchingInFace,
        Self::TouchingInPartOfFace,
        Self::TouchingInEdge,
        Self::TouchingInVertex,
        Self::Plate,
        Self::LongBox,
        Self::DoubleTorus,
        Self::FoldedStar(9),
        Self::FoldedComb(4),
    ];

    fn mesh(self) -> Mesh {
        match self {
            Self::Box | Self::BoxMesh => shapes::cuboid([0.0; 3], [1.0; 3]),
            Self::FlatBox => shapes::cuboid([0.0; 3], [4.0, 1.0, 0.5]),
            Self::Tetrahedron => shapes::tetrahedron(),
            Self::Sphere => shapes::icosphere(2),
            Self::Torus => shapes::torus(1.0, 0.4, 16, 8),
            Self::Trefoil => shapes::trefoil(0.35, 48, 6),
            Self::NestedSpheres => shapes::nested_spheres(1),
            Self::Cavity => shapes::box_with_cavity(1),
            Self::TwoComponents => shapes::two_components(1),
            Self::TouchingInFace => shapes::touching_boxes(Contact::Face),
            Self::TouchingInPartOfFace => shapes::touching_boxes(Contact::PartOfFace),
            Self::TouchingInEdge => shapes::touching_boxes(Contact::Edge),
            Self::TouchingInVertex => shapes::touching_boxes(Contact::Vertex),
            Self::Plate => shapes::plate(),
            Self::LongBox => shapes::long_box(),
            Self::DoubleTorus => shapes::double_torus(),
            Self::FoldedStar(powers) => folded(Section::Star, powers),
            Self::FoldedCorner(powers) => folded(Section::Corner, powers),
            Self::FoldedComb(powers) => folded(Section::Comb, powers),
        }
    }
}

fn folded(section: Section, powers: u8) -> Mesh {
    shapes::folded_prism(section, 10_f64.powi(-i32::from(powers)))
}

/// How a shape is turned. Boxes that are given as boxes stay.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pose {
    /// As it was made: along the axes, around the origin.
    Plain,
    /// Turned about a skew axis and moved off the origin.
    Turned,
}

impl Pose {
    /// Both poses.
    pub const ALL: [Self; 2] = [Self::Plain, Self::Turned];

    /// The matrix and the shift of `x ↦ matrix · x + shift`, which takes a shape as it was made to this pose.
    pub fn motion(self) -> (DMat3, DVec3) {
        match self {
            Self::Plain => (DMat3::IDENTITY, DVec3::ZERO),
            Self::Turned => {
                let turn = DMat3::from_axis_angle(DVec3::new(2.0, -1.0, 3.0).normalize(), 1.1);
                (turn, DVec3::new(0.7, -5.3, 11.9))
            }
        }
    }
}

/// What a scene's cells are restricted to.
#[derive(Clone, Debug)]
pub enum Room {
    /// A box, by its corners.
    Box([f64; 3], [f64; 3]),
    /// A mesh, and the domain made of it.
    Mesh(Arc<Mesh>, Domain),
}

impl Room {
    /// The room of a mesh.
    pub fn of(mesh: Mesh) -> Self {
        let domain = mesh.domain();
        Self::Mesh(Arc::new(mesh), domain)
    }

    /// Its surface; a box's as twelve triangles.
    pub fn mesh(&self) -> Arc<Mesh> {
        match self {
            Self::Box(lo, hi) => Arc::new(shapes::cuboid(*lo, *hi)),
            Self::Mesh(mesh, _) => Arc::clone(mesh),
        }
    }

    /// Volume (length³), counted by winding number.
    pub fn volume(&self) -> f64 {
        match self {
            Self::Box(lo, hi) => (hi[0] - lo[0]) * (hi[1] - lo[1]) * (hi[2] - lo[2]),
            Self::Mesh(_, domain) => domain.volume(),
        }
    }

    /// Barycenter, counted by winding number.
    pub fn barycenter(&self) -> [f64; 3] {
        match self {
            Self::Box(lo, hi) => std::array::from_fn(|k| 0.5 * (lo[k] + hi[k])),
            Self::Mesh(_, domain) => domain.barycenter(),
        }
    }

    /// Area of its surface (length²).
    pub fn area(&self) -> f64 {
        match self {
            Self::Box(lo, hi) => {
                let [a, b, c]: [f64; 3] = std::array::from_fn(|k| hi[k] - lo[k]);
                2.0 * (a * b + b * c + c * a)
            }
            Self::Mesh(_, domain) => domain.area(),
        }
    }

    /// Volume of the grid that encloses a mesh (length³) for so many sites; of a box, which has none, 0.
    pub fn grid_volume(&self, sites: usize) -> f64 {
        match self {
            Self::Box(..) => 0.0,
            Self::Mesh(_, domain) => domain.grid_volume(sites),
        }
    }

    /// That grid as a box, by its corners, where there is one.
    pub fn grid_box(&self, sites: usize) -> Option<Self> {
        let Self::Mesh(_, domain) = self else { return None };
        let grid = domain.grid(sites);
        let [lo, hi] = [[0; 3], grid.dims()].map(|voxel| domain.frame().leave(grid.corner(voxel)));
        Some(Self::Box(lo, hi))
    }

    /// Its bounding box.
    pub fn bounding_box(&self) -> ([f64; 3], [f64; 3]) {
        match self {
            Self::Box(lo, hi) => (*lo, *hi),
            Self::Mesh(mesh, _) => bounding_box(&mesh.vertices),
        }
    }

    /// Extents of its bounding box.
    pub fn extents(&self) -> DVec3 {
        let (lo, hi) = self.bounding_box();
        DVec3::from(hi) - DVec3::from(lo)
    }
}

/// The room of a shape. Domains and their grids are made once for each and kept.
pub fn room(shape: Shape, pose: Pose) -> Room {
    static MADE: LazyLock<Mutex<HashMap<(Shape, Pose), Room>>> = LazyLock::new(Mutex::default);
    match shape {
        Shape::Box | Shape::FlatBox => {
            let (lo, hi) = bounding_box(&shape.mesh().vertices);
            Room::Box(lo, hi)
        }
        _ => {
            let mut made = MADE.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            made.entry((shape, pose)).or_insert_with(|| Room::of(posed(shape.mesh(), pose))).clone()
        }
    }
}

fn posed(mesh: Mesh, pose: Pose) -> Mesh {
    match pose {
        Pose::Plain => mesh,
        Pose::Turned => {
            let (turn, shift) = pose.motion();
            mesh.transformed(turn, shift)
        }
    }
}
