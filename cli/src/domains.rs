//! The domains that have a name on the command line.

use std::path::Path;

use laguerre::shapes::{self, Mesh};
use laguerre::{Domain, Error, ErrorKind, Result};

/// What the demo and the scenes are shown in.
const SWAN: &str = "swan";
/// The bunny, a scan: not part of the program, for it is not free (`fixtures/meshes/README.md`).
const BUNNY: &str = "bunny";
/// Where it is looked for: benchmarks are compared over the years, and go on with it.
const BUNNY_FILE: &str = "fixtures/meshes/bunny.obj";

type Make = fn() -> Mesh;

/// Closed meshes made by code, of different genus, with one surface or two.
const MADE: [(&str, Make); 6] = [
    (SWAN, shapes::swan),
    ("trefoil", || shapes::trefoil(0.35, 48, 6)),
    ("torus", || shapes::torus(1.0, 0.4, 16, 8)),
    ("double-torus", shapes::double_torus),
    ("sphere", || shapes::icosphere(2)),
    ("cavity", || shapes::box_with_cavity(1)),
];

/// The domains of the paper's Fig. 10: one of each genus that is made by code, and a scan.
pub(crate) const OF_THE_PAPER: [&str; 6] = [BUNNY, "trefoil", "torus", "double-torus", "sphere", "cavity"];

/// The names of all of them.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    MADE.iter().map(|&(name, _)| name).chain([BUNNY])
}

/// The domain of that name, if there is one.
pub(crate) fn named(name: &str) -> Option<Result<Domain>> {
    if name == BUNNY {
        return Some(bunny());
    }
    let (_, make) = MADE.iter().find(|&&(known, _)| known == name)?;
    Some(made(&make()))
}

/// The swan.
pub(crate) fn swan() -> Result<Domain> {
    made(&shapes::swan())
}

fn made(mesh: &Mesh) -> Result<Domain> {
    Domain::new(&mesh.vertices, &mesh.triangles)
}

/// The Stanford bunny, from its file.
///
/// # Errors
/// `Io` where it is not there.
pub(crate) fn bunny() -> Result<Domain> {
    if !Path::new(BUNNY_FILE).exists() {
        return Err(Error::new(
            ErrorKind::Io,
            format!(
                "{BUNNY_FILE} is not here: the bunny is no part of the program; run this in a checkout of its sources"
            ),
        ));
    }
    Domain::load(BUNNY_FILE)
}

/// The same domain moved and scaled, all axes alike, into the middle of the unit cube.
pub(crate) fn in_unit_cube(domain: &Domain) -> Result<Domain> {
    let (lo, hi) = domain.bounding_box();
    let extent = (0..3).map(|k| hi[k] - lo[k]).fold(0.0, f64::max);
    let place = |p: &[f64; 3]| std::array::from_fn(|k| 0.5 + (p[k] - (lo[k] + hi[k]) / 2.0) / extent);
    let vertices: Vec<[f64; 3]> = domain.vertices().iter().map(place).collect();
    Domain::new(&vertices, domain.triangles())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_a_domain_and_fits_into_the_unit_cube() {
        for (name, _) in MADE {
            let domain = in_unit_cube(&named(name).unwrap().unwrap()).unwrap();
            let (lo, hi) = domain.bounding_box();
            assert!((0..3).all(|k| lo[k] > -1e-15 && hi[k] < 1.0 + 1e-15), "{name}: {lo:?} {hi:?}");
            assert!((0..3).any(|k| hi[k] - lo[k] > 1.0 - 1e-15), "{name} is smaller than it may be");
            assert!(domain.notes().is_empty(), "{name}: {:?}", domain.notes());
        }
        assert!(named("hare").is_none());
        assert!(OF_THE_PAPER.iter().all(|name| names().any(|known| known == *name)));
    }

    #[test]
    fn the_bunny_is_not_in_the_program() {
        // Unit tests run in their crate's folder, which has no fixtures.
        let line = named(BUNNY).unwrap().unwrap_err().to_string();
        assert!(line.starts_with("fixtures/meshes/bunny.obj is not here"), "{line}");
    }
}
