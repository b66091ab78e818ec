//! What must not matter does not matter.

use glam::{DMat3, DVec3};
use laguerre_core::{Backend, Facet, FacetArrays, Facets, Output, Request};

use crate::bounds::{Bounds, Planes, of_digits};
use crate::compare::{identical, moved_back, same, same_within};
use crate::weights::Weights;
use crate::{Case, Scene, Verdict};

/// What else is asked for changes nothing, though a backend may compute a cell of which no facets are asked for in another way.
pub fn request(backend: &dyn Backend, case: &Case) -> Verdict {
    let scene = case.scene();
    let all = scene.evaluate(backend, &Request::moments().with_facets().with_second_moments())?;
    let cells: Vec<usize> = (0..scene.len()).collect();
    for request in [Request::moments(), Request::moments().with_second_moments()] {
        let bounds = Bounds::new(&scene, &all, Planes::Same).in_digits(of_digits(backend));
        same_within(&bounds, &scene, &all, &scene.evaluate(backend, &request)?, &cells)?;
    }
    Ok(())
}

/// A common shift of all weights changes nothing.
pub fn shift_of_weights(backend: &dyn Backend, case: &Case) -> Verdict {
    let scene = case.scene();
    let mut shifted = scene.clone();
    let shift = scene.room.extents().length_squared() * (case.random(2).unit() - 0.5);
    shifted.weights = (0..scene.len()).map(|i| scene.weight(i) + shift).collect();
    same(&scene, &scene.with_facets(backend)?, &shifted.with_facets(backend)?, Planes::Rounded)
}

/// The order of the sites changes nothing, but which of several equal sites at one position has the cell.
pub fn permutation(backend: &dyn Backend, case: &Case) -> Verdict {
    let mut scene = case.scene();
    // Which of several equal sites at one position wins depends on the order, as it should: keep one of them.
    let twins = scene.twins();
    let keep: Vec<usize> = (0..scene.len()).filter(|&i| twins[i] == i).collect();
    scene.positions = keep.iter().map(|&i| scene.positions[i]).collect();
    if !scene.weights.is_empty() {
        scene.weights = keep.iter().map(|&i| scene.weights[i]).collect();
    }
    let mut random = case.random(3);
    let mut order: Vec<usize> = (0..scene.len()).collect();
    (1..order.len()).for_each(|i| order.swap(i, random.below(i + 1)));
    let mut permuted = scene.clone();
    permuted.positions = order.iter().map(|&i| scene.positions[i]).collect();
    if !scene.weights.is_empty() {
        permuted.weights = order.iter().map(|&i| scene.weights[i]).collect();
    }
    let back = unpermuted(&permuted.with_facets(backend)?, &order);
    same(&scene, &scene.with_facets(backend)?, &back, Planes::Same)
}

/// A rotation of everything rotates the answer.
pub fn rotation(backend: &dyn Backend, case: &Case) -> Verdict {
    moving(backend, &case.scene().meshed(), case.random(4).rotation(), 1.0, DVec3::ZERO)
}

/// A translation of everything translates the answer.
pub fn translation(backend: &dyn Backend, case: &Case) -> Verdict {
    let scene = case.scene();
    let shift = scene.room.extents() * (4.0 * case.random(5).point() - 2.0);
    moving(backend, &scene, DMat3::IDENTITY, 1.0, shift)
}

/// A scaling of everything by 3.7 scales the answer.
pub fn scaling(backend: &dyn Backend, case: &Case) -> Verdict {
    moving(backend, &case.scene(), DMat3::IDENTITY, 3.7, DVec3::ZERO)
}

/// A scaling by a power of two, which rounds nothing, changes no bit.
pub fn scaling_by_a_power_of_two(backend: &dyn Backend, case: &Case) -> Verdict {
    let scene = case.scene();
    let scale = 2.0_f64.powi(case.random(6).below(61) as i32 - 30);
    let scaled = scene.moved(DMat3::IDENTITY, scale, DVec3::ZERO).with_facets(backend)?;
    let back = moved_back(&scaled, DMat3::IDENTITY, scale, DVec3::ZERO);
    identical(&scene.with_facets(backend)?, &back).map_err(|reason| format!("scaled by {scale:e}: {reason}"))
}

/// With all weights equal the power diagram is the Voronoi diagram, to the last bit.
pub fn equal_weights(backend: &dyn Backend, case: &Case) -> Verdict {
    let voronoi = Case { weights: Weights::None, ..*case }.scene();
    let mut equal = voronoi.clone();
    // A power of two or not: the weights' differences are exact either way.
    equal.weights = vec![case.random(7).unit() - 0.5; equal.len()];
    identical(&voronoi.with_facets(backend)?, &equal.with_facets(backend)?)
}

fn moving(backend: &dyn Backend, scene: &Scene, turn: DMat3, scale: f64, shift: DVec3) -> Verdict {
    let moved = scene.moved(turn, scale, shift).with_facets(backend)?;
    let back = moved_back(&moved, turn, scale, shift);
    same(scene, &scene.with_facets(backend)?, &back, Planes::Rounded)
}

/// The output for sites `order[0], order[1], …` in the order of the sites themselves.
fn unpermuted(output: &Output, order: &[usize]) -> Output {
    let mut back = output.clone().into_arrays();
    let mut place = vec![0; order.len()];
    for (k, &i) in order.iter().enumerate() {
        place[i] = k;
        back.status[i] = output.status()[k];
        back.volume[i] = output.volume()[k];
        back.barycenter[i] = output.barycenter()[k];
    }
    back.facets = output.facets().map(|from| {
        let mut offsets = vec![0];
        let mut taken = Vec::new();
        for &k in &place {
            let mut row: Vec<Facet> = from.of(k).collect();
            row.sort_by_key(|facet| order[facet.neighbor]);
            taken.extend(row);
            offsets.push(taken.len());
        }
        let mut facets = FacetArrays::default();
        facets.offsets = offsets;
        facets.neighbor = taken.iter().map(|facet| order[facet.neighbor] as u32).collect();
        facets.area = taken.iter().map(|facet| facet.area).collect();
        facets.barycenter = taken.iter().map(|facet| facet.barycenter).collect();
        facets.distance = taken.iter().map(|facet| facet.distance).collect();
        facets.boundary = place.iter().map(|&k| from.boundary()[k]).collect();
        Facets::new(facets).expect("rows of facets")
    });
    Output::new(back).expect("an output")
}
