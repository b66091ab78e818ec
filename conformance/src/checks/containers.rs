//! Integrals are additive over the domain: its parts give the parts of every cell.

use glam::{DMat3, DVec3};
use laguerre_core::Backend;
use laguerre_core::shapes::{self, Contact, Mesh};

use crate::bounds::{Bounds, Planes};
use crate::compare::same;
use crate::domains::{Room, Shape};
use crate::{Case, Scene, Verdict};

/// A box is the same box given as a mesh.
pub fn box_as_mesh(backend: &dyn Backend, case: &Case) -> Verdict {
    for shape in [Shape::Box, Shape::FlatBox] {
        let scene = case.within(shape).scene();
        same(&scene, &scene.with_facets(backend)?, &scene.meshed().with_facets(backend)?, Planes::Same)
            .map_err(|reason| format!("{shape:?}: {reason}"))?;
    }
    Ok(())
}

/// Two components: each cell is the sum of its parts in each.
pub fn components(backend: &dyn Backend, case: &Case) -> Verdict {
    let [first, second] = shapes::components(1);
    adds_up(backend, case, Shape::TwoComponents, &[(1.0, first), (1.0, second)])
}

/// A box with a cavity: each cell is its part of the box less its part of the cavity.
pub fn cavity(backend: &dyn Backend, case: &Case) -> Verdict {
    let outer = shapes::cuboid([-1.0; 3], [1.0; 3]);
    adds_up(backend, case, Shape::Cavity, &[(1.0, outer), (-1.0, shapes::cavity(1))])
}

/// A shell within a shell, both outward: what is within both counts twice.
pub fn nested(backend: &dyn Backend, case: &Case) -> Verdict {
    let outer = shapes::icosphere(1);
    let inner = outer.transformed(DMat3::from_diagonal(DVec3::splat(0.5)), DVec3::ZERO);
    adds_up(backend, case, Shape::NestedSpheres, &[(1.0, outer), (1.0, inner)])
}

/// Two boxes that touch: the contact belongs to neither.
pub fn touching(backend: &dyn Backend, case: &Case) -> Verdict {
    for (shape, shift) in [
        (Shape::TouchingInFace, [1.0, 0.0, 0.0]),
        (Shape::TouchingInPartOfFace, [1.0, 0.25, 0.5]),
        (Shape::TouchingInEdge, [1.0, 1.0, 0.0]),
        (Shape::TouchingInVertex, [1.0; 3]),
    ] {
        let first = shapes::cuboid([0.0; 3], [1.0; 3]);
        let second = first.transformed(DMat3::IDENTITY, DVec3::from(shift));
        adds_up(backend, case, shape, &[(1.0, first), (1.0, second)])
            .map_err(|reason| format!("{shape:?}: {reason}"))?;
    }
    Ok(())
}

/// A component that is turned inward counts −1, whatever it does to the sign of a cell.
pub fn inward(backend: &dyn Backend, case: &Case) -> Verdict {
    let large = shapes::touching_boxes(Contact::Face);
    let small = shapes::cuboid([0.0, 1.5, 0.0], [1.0, 2.0, 0.5]);
    let mut scene = case.within(Shape::TouchingInFace).plain().scene();
    scene.room = Room::of(large.clone().merged(&small.clone().flipped()));
    sums_to(backend, &scene, &[(1.0, large), (-1.0, small)])
}

fn adds_up(backend: &dyn Backend, case: &Case, shape: Shape, parts: &[(f64, Mesh)]) -> Verdict {
    sums_to(backend, &case.within(shape).plain().scene(), parts)
}

/// The volume and the first moment of each cell of `scene` are the sum of those in `parts`, each times its sign.
fn sums_to(backend: &dyn Backend, scene: &Scene, parts: &[(f64, Mesh)]) -> Verdict {
    let whole = scene.with_facets(backend)?;
    let bounds = Bounds::new(scene, &whole, Planes::Same);
    let mut volume = vec![0.0; scene.len()];
    let mut moment = vec![DVec3::ZERO; scene.len()];
    let mut add = |sign: f64, output: &laguerre_core::Output| {
        for i in (0..scene.len()).filter(|&i| output.volume()[i] != 0.0) {
            volume[i] += sign * output.volume()[i];
            moment[i] += sign * output.volume()[i] * (DVec3::from(output.barycenter()[i]) - scene.site(i));
        }
    };
    for (sign, mesh) in parts {
        let part = Scene { room: Room::of(mesh.clone()), ..scene.clone() };
        add(*sign, &part.with_facets(backend)?);
    }
    add(-1.0, &whole);
    for i in 0..scene.len() {
        // One evaluation for each part and one for the whole.
        let times = 1.0 + parts.len() as f64;
        let (off, bound) = (volume[i].abs(), times * bounds.volume(i));
        ensure!(off <= bound, "site {i}: volume {:e}, its parts differ by {off:e}, bound {bound:e}", whole.volume()[i]);
        // A cell whose parts cancel has no barycenter to compare.
        if whole.volume()[i] == 0.0 {
            continue;
        }
        let (off, bound) = (moment[i].length(), times * bounds.first_moment(i));
        ensure!(off <= bound, "site {i}: the parts' first moments differ by {off:e}, bound {bound:e}");
    }
    Ok(())
}
