//! Wrong input is refused with one line that says what is wrong.

use laguerre_core::shapes::{self, Mesh};
use laguerre_core::{Backend, Domain, Error, ErrorKind, PowerDiagram, Request};

use crate::Verdict;

/// Sites and weights that are no input.
pub fn sites(_: &dyn Backend) -> Verdict {
    let p = [0.25; 3];
    refused("no sites", PowerDiagram::new(&[], &[]))?;
    refused("one weight for two sites", PowerDiagram::new(&[p, p], &[0.0]))?;
    for bad in [f64::NAN, f64::INFINITY, -1e101] {
        refused("a bad coordinate", PowerDiagram::new(&[p, [0.0, bad, 0.0]], &[]))?;
        refused("a bad weight", PowerDiagram::new(&[p, p], &[0.0, bad * 1e101]))?;
    }
    Ok(())
}

/// Boxes and meshes that contain nothing, or cannot tell what they contain.
pub fn containers(backend: &dyn Backend) -> Verdict {
    let diagram = || PowerDiagram::new(&[[0.25; 3], [0.5, 0.25, 0.25]], &[]).map_err(|error| error.to_string());
    refused("an inverted box", diagram()?.in_box([0.0; 3], [1.0, -1.0, 1.0]))?;
    refused("a flat box", diagram()?.in_box([0.0; 3], [1.0, 0.0, 1.0]))?;
    refused("a box with NaN", diagram()?.in_box([0.0, f64::NAN, 0.0], [1.0; 3]))?;
    refused("an infinite box", diagram()?.in_box([0.0; 3], [1.0, f64::INFINITY, 1.0]))?;
    refused("sites in a line and no container", backend.evaluate(&diagram()?, &Request::moments()))?;

    let good = shapes::tetrahedron();
    let refused_mesh = |what: &str, change: &dyn Fn(&mut Mesh)| {
        let mut mesh = good.clone();
        change(&mut mesh);
        refused(what, Domain::new(&mesh.vertices, &mesh.triangles))
    };
    refused_mesh("no triangle", &|mesh| mesh.triangles.clear())?;
    refused_mesh("an open mesh", &|mesh| mesh.triangles.truncate(3))?;
    refused_mesh("a one-sided mesh", &|mesh| {
        // The projective plane of six vertices.
        mesh.vertices = (0..6).map(|i| [f64::from(i), f64::from(i * i % 5), f64::from(i * i * i % 7)]).collect();
        mesh.triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5], [0, 5, 1]];
        mesh.triangles.extend([[1, 2, 4], [2, 3, 5], [3, 4, 1], [4, 5, 2], [5, 1, 3]]);
    })?;
    refused_mesh("an unknown vertex", &|mesh| mesh.triangles[0][0] = 7)?;
    refused_mesh("a vertex that is not finite", &|mesh| mesh.vertices[1][1] = f64::NAN)?;
    refused_mesh("a mesh without volume", &|mesh| mesh.vertices[3] = [0.25, 0.25, 0.0])?;
    turned_over(backend)
}

/// A mesh some of whose triangles are turned over is oriented: the cells are those of the mesh as it was, to the bit.
fn turned_over(backend: &dyn Backend) -> Verdict {
    let good = shapes::box_with_cavity(1);
    let mut turned = good.clone();
    turned.triangles.iter_mut().step_by(3).for_each(|triangle| triangle.swap(1, 2));
    let volumes = |mesh: &Mesh| {
        let domain = Domain::new(&mesh.vertices, &mesh.triangles)?;
        let (lo, hi) = domain.bounding_box();
        let site = |i: u32| {
            std::array::from_fn(|k| lo[k] + (hi[k] - lo[k]) * (f64::from(i) * [0.618, 0.414, 0.732][k]).fract())
        };
        let sites: Vec<[f64; 3]> = (1..30).map(site).collect();
        let output = backend.evaluate(&PowerDiagram::new(&sites, &[])?.restricted_to(&domain), &Request::moments())?;
        Ok(output.volume().iter().map(|volume| volume.to_bits()).collect::<Vec<_>>())
    };
    let [good, turned] = [&good, &turned].map(|mesh| volumes(mesh).map_err(|error: Error| error.to_string()));
    ensure!(good? == turned?, "cells of a mesh whose triangles were turned over");
    Ok(())
}

/// A search that is to end by a number that is none.
fn epsilons(backend: &dyn Backend) -> Verdict {
    let diagram = PowerDiagram::new(&[[0.25; 3], [0.75; 3]], &[]).and_then(|d| d.in_box([0.0; 3], [1.0; 3]));
    let diagram = diagram.map_err(|error| error.to_string())?;
    for bad in [f64::NAN, -1.0] {
        refused("a bad epsilon", backend.evaluate(&diagram, &Request::moments().with_epsilon(bad)))?;
    }
    Ok(())
}

/// Sites and weights that are out of range of their container, and requests of what no number says.
pub fn ranges(backend: &dyn Backend) -> Verdict {
    let evaluate = |positions: &[[f64; 3]], weights: &[f64]| {
        let diagram = PowerDiagram::new(positions, weights)?;
        backend.evaluate(&diagram.clone().restricted_to(&shapes::icosphere(0).domain()), &Request::moments())?;
        backend.evaluate(&diagram.in_box([0.0; 3], [1.0; 3])?, &Request::moments())
    };
    epsilons(backend)?;
    let (here, near, far) = ([0.25; 3], [900.0, 0.0, 0.0], [0.0, 5000.0, 0.0]);
    refused("a site far off", evaluate(&[here, far], &[]))?;
    refused("a weight far off", evaluate(&[here, near], &[0.0, 1e8]))?;
    evaluate(&[here, near], &[0.0, 1e5]).map(|_| ()).map_err(|error| format!("within range, but refused: {error}"))
}

/// That an input was refused as such, in one line.
fn refused<T>(what: &str, result: Result<T, Error>) -> Verdict {
    let Err(error) = result else { return Err(format!("{what} was accepted")) };
    ensure!(error.kind() == ErrorKind::Input, "{what} was refused as {:?}: {error}", error.kind());
    let message = error.to_string();
    ensure!(!message.is_empty() && !message.contains('\n'), "{what} was refused in other than one line: {message}");
    Ok(())
}
