//! The texts of the builds for which the lanes of an NVIDIA warp compute a cell, for `cargo xtask nvptx`.

use crate::builds::{Asked, Build, Lanes, Stage, Way};
use crate::interface::data::Params;
use laguerre_core::Result;
use laguerre_core::cell::FACETS;

/// A build.
#[derive(Clone, Debug)]
pub struct WarpText {
    /// Its stage, and what its cells have.
    pub name: String,
    /// OpenCL C.
    pub text: String,
    /// The compiler's.
    pub options: String,
}

/// The builds of all stages for diagrams without a domain and weights, and with both; and that of cells which reach far outside a domain by the table of offsets.
pub fn all() -> Result<Vec<WarpText>> {
    let mut texts = Vec::new();
    for (has_domain, equal_weights) in [(0, 1), (1, 1), (1, 0)] {
        for stage in Stage::ALL {
            let is_built = match stage {
                _ if (has_domain, equal_weights) == (1, 1) => stage == Stage::Far,
                Stage::Single | Stage::Sweep => equal_weights == 1,
                Stage::Close => equal_weights == 0,
                Stage::Surface => has_domain == 1,
                _ => true,
            };
            if !is_built {
                continue;
            }
            let (all, what): (&[u32], _) = match (stage, has_domain) {
                (Stage::Integrals, 0) => (&[0, FACETS], ""),
                (Stage::Integrals, _) => (&[FACETS], ", domain and weights"),
                (_, 0) => (&[0], ""),
                _ if equal_weights == 1 => (&[0], ", domain"),
                _ => (&[0], ", domain and weights"),
            };
            for &flags in all {
                let params = Params { has_domain, equal_weights, has_table: 1, flags, ..Params::default() };
                let way = Way::Together(Lanes::Warp, stage);
                let build = Build::Cells(way, Asked::of(&params, way));
                let facets = if flags == FACETS { ", facets" } else { "" };
                let (name, text) = (format!("{stage:?}{facets}{what}"), build.text().whole()?);
                texts.push(WarpText { name, text, options: build.options() });
            }
        }
    }
    Ok(texts)
}
