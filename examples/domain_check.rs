//! What is wrong with a mesh, and what was put right on the way in: `cargo run --example domain_check [MESH]`.

use laguerre::Domain;

fn main() {
    if let Some(path) = std::env::args().nth(1) {
        return tell(Domain::load(path));
    }
    let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    tell(Domain::new(&vertices, &triangles));
    // A hole: three edges have a triangle on one side alone.
    tell(Domain::new(&vertices, &triangles[..3]));
    // One triangle turned over: which way they face is found anew.
    tell(Domain::new(&vertices, &[[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]]));
    // All turned over: inside out, which can be put right.
    tell(Domain::new(&vertices, &triangles.map(|[a, b, c]| [a, c, b])));
}

fn tell(domain: laguerre::Result<Domain>) {
    match domain {
        Ok(domain) => {
            println!("right: volume {:.6}, area {:.6}", domain.volume(), domain.area());
            domain.notes().iter().for_each(|note| println!("  note: {note}"));
        }
        Err(error) => {
            println!("wrong: {error}");
            error.place().triangle.iter().for_each(|triangle| println!("  place: triangle {triangle}"));
        }
    }
}
