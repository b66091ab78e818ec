//! The geometry of convex cells, made again from their neighbours: what pictures need, and integrals do not.

use super::CellMesh;
use crate::cell::{self, PlainStore, Polytope, bisector, v3};
use crate::{CellStatus, Error, ErrorKind, Output, PowerDiagram, Result};

/// The power cells of the sites that `wanted` chooses (by the caller's index), within the box of a diagram that is restricted to
/// a box; `output` is its output with facets. Empty cells are left out.
///
/// Each cell is the box cut by the bisectors with its neighbours alone, so the cost is that of some 15 cuts a cell. A facet that
/// the output leaves out, being below its rounding bound, is missing here too.
///
/// # Errors
/// `Input` where the diagram is restricted to a domain, or the output is not its own or has no facets.
pub fn cell_meshes(diagram: &PowerDiagram, output: &Output, wanted: impl Fn(usize) -> bool) -> Result<Vec<CellMesh>> {
    if diagram.domain().is_some() {
        return Err(Error::input(
            "cells cut by a domain are not convex: restrict the diagram to a box for their geometry",
        ));
    }
    let Some(facets) = output.facets.as_ref().filter(|f| f.offsets.len() == diagram.positions().len() + 1) else {
        return Err(Error::input("this output has no facets of this diagram: ask for them with Request::with_facets"));
    };
    if output.status.len() != diagram.positions().len() {
        return Err(Error::input("this output is not that of this diagram"));
    }
    let prepared = diagram.prepare()?;
    let mut sorted_of = vec![None; diagram.positions().len()];
    for (site, &i) in prepared.sites.sites().zip(prepared.sites.order()) {
        sorted_of[i as usize] = Some(site);
    }
    let mut meshes = Vec::new();
    for (i, site) in sorted_of.iter().enumerate() {
        let Some([x, y, z, w]) = site.filter(|_| output.status[i] != CellStatus::Empty && wanted(i)) else { continue };
        let mut store = PlainStore::new([x, y, z], None);
        let corner = |c: [f64; 3]| v3(c[0] - x, c[1] - y, c[2] - z);
        let mut status = cell::begin(&mut store, corner(prepared.container.lo), corner(prepared.container.hi));
        for neighbor in &facets.neighbor[facets.offsets[i]..facets.offsets[i + 1]] {
            let Some([nx, ny, nz, nw]) = sorted_of.get(neighbor.site as usize).copied().flatten() else { continue };
            if status != cell::EMPTY {
                status = cell::clip(&mut store, bisector(v3(nx - x, ny - y, nz - z), w - nw), neighbor.site);
            }
        }
        match status {
            cell::EMPTY => {}
            cell::COMPLETE | cell::CUT | cell::UNTOUCHED => {
                let place = |v: u32| {
                    let p = store.position(v);
                    prepared.container.frame.leave([x + p.x, y + p.y, z + p.z])
                };
                let points = (0..store.vertices()).map(place).collect();
                meshes.push(CellMesh { site: i as u32, points, faces: faces(&store) });
            }
            other => return Err(Error::new(ErrorKind::Device, format!("cell {i} ended with status {other}"))),
        }
    }
    Ok(meshes)
}

/// The faces of a cell as cycles of vertices, counterclockwise from outside.
fn faces(store: &impl Polytope) -> Vec<Vec<u32>> {
    // Of each plane, its vertices as (the plane before, the plane after, vertex): vertex (f, g, h) ends the edge (f, g) and
    // begins the edge (f, h), walking clockwise around f, as the triplet stands.
    let mut around: Vec<Vec<(u32, u32, u32)>> = vec![Vec::new(); store.planes() as usize];
    for v in 0..store.vertices() {
        let t = store.triplet(v);
        for (f, g, h) in [(t.a, t.b, t.c), (t.b, t.c, t.a), (t.c, t.a, t.b)] {
            around[f as usize].push((g, h, v));
        }
    }
    let mut faces = Vec::new();
    for mut corners in around {
        for i in 1..corners.len() {
            let after = corners[i - 1].1;
            if let Some(next) = corners[i..].iter().position(|c| c.0 == after) {
                corners.swap(i, i + next);
            }
        }
        if !corners.is_empty() {
            faces.push(corners.iter().rev().map(|c| c.2).collect());
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::Naive;
    use crate::{Backend, Request};

    /// Volume enclosed by the faces, positive if they are counterclockwise from outside.
    fn volume(mesh: &CellMesh) -> f64 {
        let fans = mesh.faces.iter().flat_map(|f| (2..f.len()).map(move |k| [f[0], f[k - 1], f[k]]));
        fans.map(|t| {
            let [a, b, c] = t.map(|i| glam::DVec3::from(mesh.points[i as usize]) - glam::DVec3::from(mesh.points[0]));
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
    }

    #[test]
    fn the_geometry_encloses_the_volume() {
        // A lattice, most of whose cells meet in degenerate vertices, with weights that hide some; one site twice.
        let mut positions: Vec<[f64; 3]> =
            (0..64).map(|i| [i % 4, i / 4 % 4, i / 16].map(|k| f64::from(k) + 0.5)).collect();
        positions.push(positions[21]);
        let weights: Vec<f64> = (0..65).map(|i| if i % 7 == 0 { 3.0 } else { 0.0 }).collect();
        let diagram = PowerDiagram::new(&positions, &weights).unwrap().in_box([0.0; 3], [4.0, 4.0, 4.5]).unwrap();
        let output = Naive::default().evaluate(&diagram, &Request::moments().with_facets()).unwrap();
        let meshes = cell_meshes(&diagram, &output, |_| true).unwrap();
        assert_eq!(meshes.len(), output.status.iter().filter(|&&s| s != CellStatus::Empty).count());
        assert!(meshes.len() < 64, "some are hidden");
        for mesh in &meshes {
            // Of the order of the roundings of 100 products of numbers up to 2.
            let expected = output.volume[mesh.site as usize];
            assert!((volume(mesh) - expected).abs() < 1e-13, "site {}: {} for {expected}", mesh.site, volume(mesh));
            let edges: usize = mesh.faces.iter().map(Vec::len).sum();
            assert_eq!(mesh.points.len() + mesh.faces.len(), edges / 2 + 2, "Euler");
        }
        assert_eq!(cell_meshes(&diagram, &output, |i| i == 7).unwrap().len(), 1);
        let plain = Naive::default().evaluate(&diagram, &Request::moments()).unwrap();
        assert!(cell_meshes(&diagram, &plain, |_| true).is_err());
    }
}
