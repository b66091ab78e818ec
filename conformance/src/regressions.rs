//! Cases that once broke a law, by name. They are tried in every run, as `backend::regressions::name`.
//!
//! A law that fails prints the line to add here; the name says what was wrong.

#[allow(unused_imports, reason = "what the lines of the table are written with")]
use crate::{Case, checks::*, domains::Pose, domains::Shape, law::Law, sites::Sites, weights::Weights};

/// Name, law and case.
pub const CASES: &[(&str, Law, Case)] = &[];
