//! The table of checks, and the checks by area.

pub mod closure;
pub mod containers;
pub mod epsilon;
pub mod errors;
pub mod facets;
pub mod invariance;
pub mod large;
pub mod lattice;
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

/// Every check, by its name `area::check`.
pub const CHECKS: &[(&str, Check)] = &[
    law!(sums::volume),
    law!(sums::first_moment),
    law!(sums::second_moment),
    law!(sums::boundary_area),
    law!(oracle::every_cell),
    law!(facets::mutual),
    law!(facets::distance),
    law!(facets::positive),
    law!(closure::areas),
    law!(closure::volume),
    law!(places::cell_barycenters),
    law!(places::facet_barycenters),
    law!(places::random_points),
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
    given!(reproducible::any_number_of_threads),
    given!(epsilon::zero_is_seen),
    given!(lattice::equal_volumes),
    given!(lattice::duplicated),
    given!(lattice::turned),
    given!(lattice::second_moments),
    given!(large::hiding_weights),
    given!(large::one_heavy_site),
    given!(large::many_sites_in_a_mesh),
    given!(errors::sites),
    given!(errors::containers),
    given!(errors::ranges),
];
