//! The domains that are part of the program.

use laguerre::{Domain, Result, io};

/// Closed meshes of different genus, with one surface or two: names, files and their bytes.
const BUILT_IN: [(&str, &str, &[u8]); 6] = [
    ("bunny", "bunny.obj", include_bytes!("../../fixtures/meshes/bunny.obj")),
    ("trefoil", "trefoil.off", include_bytes!("../../fixtures/meshes/trefoil.off")),
    ("torus", "torus.off", include_bytes!("../../fixtures/meshes/torus.off")),
    ("double-torus", "double_torus.off", include_bytes!("../../fixtures/meshes/double_torus.off")),
    ("sphere", "sphere.off", include_bytes!("../../fixtures/meshes/sphere.off")),
    ("cavity", "cavity.off", include_bytes!("../../fixtures/meshes/cavity.off")),
];

/// The names of all of them.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    BUILT_IN.iter().map(|&(name, ..)| name)
}

/// The domain of that name, if there is one.
pub(crate) fn named(name: &str) -> Option<Result<Domain>> {
    let (_, file, bytes) = BUILT_IN.iter().find(|&&(known, ..)| known == name)?;
    Some(io::parse_mesh(bytes, file).and_then(|mesh| Domain::new(&mesh.vertices, &mesh.triangles)))
}

/// The Stanford bunny.
pub(crate) fn bunny() -> Result<Domain> {
    Domain::from_obj(BUILT_IN[0].2)
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
        for name in names() {
            let domain = in_unit_cube(&named(name).unwrap().unwrap()).unwrap();
            let (lo, hi) = domain.bounding_box();
            assert!((0..3).all(|k| lo[k] > -1e-15 && hi[k] < 1.0 + 1e-15), "{name}: {lo:?} {hi:?}");
            assert!((0..3).any(|k| hi[k] - lo[k] > 1.0 - 1e-15), "{name} is smaller than it may be");
            assert!(domain.notes().is_empty(), "{name}: {:?}", domain.notes());
        }
        assert!(named("hare").is_none());
    }
}
