//! Cases that once broke a law, by name. They are tried in every run, as `backend::regressions::name`.
//!
//! A law that fails prints the line to add here; the name says what was wrong.

use crate::checks::{closure, facets, invariance, sums};
use crate::{Case, Given, domains::Pose, domains::Shape, law::Law, sites::Sites, weights::Weights};

/// Name, law and case.
pub const CASES: &[(&str, Law, Case)] = &[
    (
        "rounding_is_not_a_facet",
        facets::positive,
        Case {
            seed: 328301,
            count: 13,
            sites: Sites::Clustered,
            weights: Weights::Mild,
            shape: Shape::LongBox,
            pose: Pose::Turned,
        },
    ),
    (
        "rounding_is_not_a_volume",
        sums::volume,
        Case {
            seed: 3894,
            count: 14,
            sites: Sites::OnSurface,
            weights: Weights::Concurrent,
            shape: Shape::TouchingInPartOfFace,
            pose: Pose::Turned,
        },
    ),
    (
        "apex_near_a_triangles_plane",
        closure::volume,
        Case {
            seed: 684303,
            count: 1,
            sites: Sites::Clustered,
            weights: Weights::None,
            shape: Shape::Sphere,
            pose: Pose::Turned,
        },
    ),
    (
        "apex_near_a_triangles_plane_in_a_knot",
        sums::boundary_area,
        Case {
            seed: 237327,
            count: 3,
            sites: Sites::TurnedLattice,
            weights: Weights::None,
            shape: Shape::Trefoil,
            pose: Pose::Plain,
        },
    ),
    (
        "apex_near_a_triangles_plane_after_a_move",
        invariance::translation,
        Case {
            seed: 598765,
            count: 1,
            sites: Sites::Clustered,
            weights: Weights::None,
            shape: Shape::Sphere,
            pose: Pose::Turned,
        },
    ),
    (
        "apex_near_a_triangles_plane_after_a_turn",
        invariance::rotation,
        Case {
            seed: 591321,
            count: 10,
            sites: Sites::OnSurface,
            weights: Weights::Strong,
            shape: Shape::Trefoil,
            pose: Pose::Plain,
        },
    ),
];

/// Name and scene of what fuzzing found (`fuzz/`); each is held to all laws of one output and to the oracle.
pub const SCENES: &[(&str, Given)] = &[];
