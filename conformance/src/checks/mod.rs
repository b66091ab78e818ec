//! The table of checks, and the checks by area.

pub mod cgal;
pub mod closure;
pub mod concurrent;
pub mod containers;
pub mod density;
pub mod epsilon;
pub mod errors;
pub mod facet_moments;
pub mod facets;
pub mod folds;
pub mod geometry;
pub mod integrals;
pub mod invariance;
pub mod large;
pub mod lattice;
pub mod near_degenerate;
pub mod oracle;
pub mod places;
pub mod reproducible;
pub mod status;
pub mod sums;

use laguerre_core::Backend;

use crate::{Check, law};

/// A law, tried on generated cases.
macro_rules! law {
    ($area:ident :: $name:ident) => {
        (concat!(stringify!($area), "::", stringify!($name)), |backend: &dyn Backend| {
            let file = concat!("conformance/src/checks/", stringify!($area), ".rs");
            law::hold(file, concat!(stringify!($area), "::", stringify!($name)), backend, $area::$name)
        })
    };
}

/// A check of one or a few given inputs.
macro_rules! given {
    ($area:ident :: $name:ident) => {
        (concat!(stringify!($area), "::", stringify!($name)), $area::$name)
    };
}

/// A fixture made by CGAL.
macro_rules! fixture {
    ($name:ident) => {
        (concat!("cgal::", stringify!($name)), |backend: &dyn Backend| cgal::hold(backend, stringify!($name)))
    };
}

/// Every check, by its name `area::check`.
pub const CHECKS: &[(&str, Check)] = &[
    law!(sums::volume),
    law!(sums::first_moment),
    law!(sums::barycenter),
    law!(sums::second_moment),
    law!(sums::boundary_area),
    law!(oracle::every_cell),
    law!(facets::mutual),
    law!(facets::distance),
    law!(facets::positive),
    law!(facets::laplacian),
    law!(facet_moments::mutual),
    law!(facet_moments::like_the_oracle),
    law!(facet_moments::flat),
    law!(facet_moments::closure),
    law!(integrals::sum),
    law!(integrals::moments),
    law!(integrals::like_the_oracle),
    law!(integrals::translation),
    law!(integrals::functions),
    law!(closure::areas),
    law!(closure::volume),
    law!(geometry::closed),
    law!(geometry::volume),
    law!(geometry::areas),
    law!(places::cell_barycenters),
    law!(places::facet_barycenters),
    law!(places::random_points),
    law!(invariance::request),
    law!(invariance::shift_of_weights),
    law!(invariance::permutation),
    law!(invariance::rotation),
    law!(invariance::translation),
    law!(invariance::scaling),
    law!(invariance::scaling_by_a_power_of_two),
    law!(invariance::equal_weights),
    law!(status::duplicates),
    law!(status::one_site_has_everything),
    law!(containers::box_as_mesh),
    law!(containers::components),
    law!(containers::cavity),
    law!(containers::nested),
    law!(containers::inward),
    law!(containers::touching),
    law!(epsilon::generous),
    law!(reproducible::again),
    given!(facet_moments::rectangle),
    given!(facet_moments::only_where_asked_for),
    given!(integrals::converges),
    given!(integrals::not_finite),
    given!(reproducible::any_number_of_threads),
    given!(concurrent::tasks_of_a_pool),
    given!(epsilon::zero_is_seen),
    given!(density::parts),
    given!(density::contrast),
    given!(lattice::equal_volumes),
    given!(lattice::duplicated),
    given!(lattice::turned),
    given!(lattice::second_moments),
    given!(sums::thin),
    given!(folds::prisms),
    given!(large::hiding_weights),
    given!(large::one_heavy_site),
    given!(large::heavy_laplacian),
    given!(facets::laplacian_where_one_side_sees),
    given!(large::many_at_one_place),
    given!(large::cells_far_from_their_sites),
    given!(large::hollow),
    given!(large::surfaces_in_a_corner),
    given!(large::heavy_site_in_a_lattice),
    given!(large::many_sites_in_a_mesh),
    given!(large::moved_lattice),
    given!(large::clouds),
    given!(near_degenerate::vertices_lie_on_their_planes),
    given!(near_degenerate::exact_positions_are_rounded_once),
    given!(near_degenerate::signs_are_exact),
    given!(near_degenerate::no_false_proof),
    given!(near_degenerate::integrals_are_of_the_polygons),
    given!(near_degenerate::untouched_cells_are_whole),
    given!(near_degenerate::face_in_line_with_corners),
    given!(near_degenerate::vertices_in_line_with_corners),
    given!(status::told_apart_or_said),
    given!(errors::sites),
    given!(errors::containers),
    given!(errors::ranges),
    fixture!(box_one),
    fixture!(box_voronoi),
    fixture!(box_mild),
    fixture!(box_strong),
    fixture!(box_hiding),
    fixture!(box_radii),
    fixture!(box_lattice),
    fixture!(box_corner_lattice),
    fixture!(box_duplicated),
    fixture!(box_cospherical),
    fixture!(box_mirrored),
    fixture!(flat_box_collinear),
    fixture!(flat_box_coplanar),
    fixture!(cube_voronoi),
    fixture!(cube_lattice),
    fixture!(cube_outside),
    fixture!(sphere_voronoi),
    fixture!(sphere_strong),
    fixture!(sphere_one),
    fixture!(torus_voronoi),
    fixture!(torus_hiding),
    fixture!(torus_few),
    fixture!(trefoil_voronoi),
    fixture!(trefoil_radii),
    fixture!(genus2_mild),
    fixture!(genus2_lattice),
    fixture!(cavity_voronoi),
    fixture!(cavity_strong),
    fixture!(components_mild),
    fixture!(components_duplicated),
    fixture!(plate_voronoi),
    fixture!(plate_outside),
    fixture!(bunny_voronoi),
    fixture!(bunny_strong),
    fixture!(bunny_heavy),
    fixture!(bunny_lattice),
];
