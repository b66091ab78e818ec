//! Writes the inputs of the CGAL fixtures: `fixture_inputs FOLDER` puts `sites/NAME.xyz` and `meshes/SHAPE.off` into a folder that
//! has these two and `meshes/bunny.obj`, and prints a line `NAME CONTAINER` for each. `cargo xtask fixtures` runs it.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use laguerre_conformance::domains::{self, Pose, Room, Shape};
use laguerre_conformance::sites::{self, Random, Sites};
use laguerre_conformance::weights::{self, Weights};
use laguerre_core::io::{read_mesh, write_sites};
use laguerre_core::shapes::Mesh;

/// What the cells of a fixture are restricted to.
#[derive(Clone, Copy)]
enum Container {
    Shape(Shape, Pose),
    Bunny,
}

/// How its sites are weighted.
#[derive(Clone, Copy)]
enum Weighting {
    As(Weights),
    /// Squared radii, evenly spread in their logarithm over 10⁻³ to 1 times twice the spacing (volume per site)^⅓.
    Radii,
}

use Container::Bunny;
use Pose::{Plain, Turned};
use Weighting::{As, Radii};

const fn plain(shape: Shape) -> Container {
    Container::Shape(shape, Plain)
}

const fn turned(shape: Shape) -> Container {
    Container::Shape(shape, Turned)
}

/// Every fixture: name, container, number and arrangement of its sites, weights. The seed is its place in the list, from 1,
/// so new ones are added at the end.
const FIXTURES: &[(&str, Container, usize, Sites, Weighting)] = &[
    ("box_one", plain(Shape::Box), 1, Sites::White, As(Weights::None)),
    ("box_voronoi", plain(Shape::Box), 1000, Sites::White, As(Weights::None)),
    ("box_mild", plain(Shape::Box), 300, Sites::White, As(Weights::Mild)),
    ("box_strong", plain(Shape::Box), 300, Sites::White, As(Weights::Strong)),
    ("box_hiding", plain(Shape::Box), 500, Sites::White, As(Weights::Hiding)),
    ("box_radii", plain(Shape::Box), 300, Sites::White, Radii),
    ("box_lattice", plain(Shape::Box), 216, Sites::Lattice, As(Weights::None)),
    ("box_corner_lattice", plain(Shape::Box), 125, Sites::CornerLattice, As(Weights::None)),
    ("box_duplicated", plain(Shape::Box), 200, Sites::Duplicated, As(Weights::Ties)),
    ("box_cospherical", plain(Shape::Box), 100, Sites::Cospherical, As(Weights::None)),
    ("box_mirrored", plain(Shape::Box), 160, Sites::Mirrored, As(Weights::None)),
    ("flat_box_collinear", plain(Shape::FlatBox), 20, Sites::Collinear, As(Weights::Mild)),
    ("flat_box_coplanar", plain(Shape::FlatBox), 60, Sites::Coplanar, As(Weights::None)),
    ("cube_voronoi", plain(Shape::BoxMesh), 200, Sites::White, As(Weights::None)),
    ("cube_lattice", plain(Shape::BoxMesh), 125, Sites::Lattice, As(Weights::None)),
    ("cube_outside", turned(Shape::BoxMesh), 150, Sites::Outside, As(Weights::Mild)),
    ("sphere_voronoi", turned(Shape::Sphere), 200, Sites::White, As(Weights::None)),
    ("sphere_strong", plain(Shape::Sphere), 200, Sites::White, As(Weights::Strong)),
    ("sphere_one", plain(Shape::Sphere), 1, Sites::Outside, As(Weights::None)),
    ("torus_voronoi", plain(Shape::Torus), 250, Sites::White, As(Weights::None)),
    ("torus_hiding", turned(Shape::Torus), 250, Sites::White, As(Weights::Hiding)),
    ("torus_few", turned(Shape::Torus), 3, Sites::White, As(Weights::Mild)),
    ("trefoil_voronoi", turned(Shape::Trefoil), 200, Sites::White, As(Weights::None)),
    ("trefoil_radii", plain(Shape::Trefoil), 200, Sites::White, Radii),
    ("genus2_mild", turned(Shape::DoubleTorus), 200, Sites::White, As(Weights::Mild)),
    ("genus2_lattice", plain(Shape::DoubleTorus), 64, Sites::TurnedLattice, As(Weights::None)),
    ("cavity_voronoi", turned(Shape::Cavity), 150, Sites::White, As(Weights::None)),
    ("cavity_strong", plain(Shape::Cavity), 150, Sites::White, As(Weights::Strong)),
    ("components_mild", plain(Shape::TwoComponents), 150, Sites::White, As(Weights::Mild)),
    ("components_duplicated", turned(Shape::TwoComponents), 80, Sites::Duplicated, As(Weights::None)),
    ("plate_voronoi", plain(Shape::Plate), 400, Sites::White, As(Weights::None)),
    ("plate_outside", turned(Shape::Plate), 300, Sites::Outside, Radii),
    ("bunny_voronoi", Bunny, 1000, Sites::White, As(Weights::None)),
    ("bunny_strong", Bunny, 300, Sites::White, As(Weights::Strong)),
    ("bunny_heavy", Bunny, 100, Sites::White, As(Weights::OneHeavy)),
    ("bunny_lattice", Bunny, 64, Sites::Lattice, As(Weights::None)),
];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: fixture_inputs FOLDER")?;
    let folder = Path::new(&folder);
    for (seed, &(name, container, count, sites, weighting)) in (1..).zip(FIXTURES) {
        let (room, words) = match container {
            Container::Shape(shape, pose) => named(folder, shape, pose)?,
            Bunny => (bunny(&folder.join("meshes/bunny.obj"))?, "meshes/bunny.obj".to_owned()),
        };
        let mut random = Random::new(seed);
        let positions = sites::place(sites, count, &room, &mut random);
        let weights = match weighting {
            As(weights) => weights::weigh(weights, &positions, &room, &mut random),
            Radii => radii(positions.len(), &room, &mut random),
        };
        write_sites(folder.join(format!("sites/{name}.xyz")), &positions, &weights)?;
        println!("{name} {words}");
    }
    Ok(())
}

/// The room of a shape, and how it is named: a box by its corners, a mesh by the file into which it is written here.
fn named(folder: &Path, shape: Shape, pose: Pose) -> Result<(Room, String), Box<dyn Error>> {
    let room = domains::room(shape, pose);
    if let Room::Box(lo, hi) = room {
        let corners: Vec<String> = lo.iter().chain(&hi).map(f64::to_string).collect();
        return Ok((room, corners.join(",")));
    }
    let words = match pose {
        Plain => format!("meshes/{}.off", snake(&format!("{shape:?}"))),
        Turned => format!("meshes/{}_turned.off", snake(&format!("{shape:?}"))),
    };
    std::fs::write(folder.join(&words), off(&room.mesh()))?;
    Ok((room, words))
}

/// `TwoComponents` as `two_components`.
fn snake(name: &str) -> String {
    let mut snake = String::new();
    for (i, letter) in name.char_indices() {
        if letter.is_uppercase() && i > 0 {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
    }
    snake
}

fn bunny(path: &Path) -> laguerre_core::Result<Room> {
    let mesh = read_mesh(path)?;
    Ok(Room::of(Mesh { vertices: mesh.vertices, triangles: mesh.triangles }))
}

fn radii(count: usize, room: &Room, random: &mut Random) -> Vec<f64> {
    let (lo, hi) = room.bounding_box();
    let spacing = ((0..3).map(|k| hi[k] - lo[k]).product::<f64>() / count as f64).cbrt();
    let radius = |u: f64| 2.0 * spacing * 10.0_f64.powf(-3.0 * u);
    (0..count).map(|_| radius(random.unit()).powi(2)).collect()
}

/// A mesh as the text of an OFF file; `{:?}` is the shortest text that reads back to the same number.
fn off(mesh: &Mesh) -> String {
    let mut text = format!("OFF\n{} {} 0\n", mesh.vertices.len(), mesh.triangles.len());
    for [x, y, z] in &mesh.vertices {
        let _ = writeln!(text, "{x:?} {y:?} {z:?}");
    }
    for [a, b, c] in &mesh.triangles {
        let _ = writeln!(text, "3 {a} {b} {c}");
    }
    text
}
