//! What the library is without its features, and with each alone: how many crates it brings, that it compiles, and what its default ones test.

use std::collections::BTreeSet;

use crate::run::{cargo, command, succeed};

/// Crates that the library with its solvers may bring besides its own. (It brings 29; it brought 55 with npyz and `ahash` in its tree.)
const MOST_CRATES: usize = 35;

/// Counts the crates that a user of the library compiles into a program, and compiles it with every choice of one feature.
pub(crate) fn run() -> Result<(), String> {
    let tree = ["tree", "--locked", "-p", "laguerre", "--features", "solvers", "-e", "normal", "--prefix", "none"];
    let crates = others(&succeed(&mut command(&tree, &[]))?);
    if crates.len() > MOST_CRATES {
        let all: Vec<&str> = crates.iter().map(String::as_str).collect();
        return Err(format!(
            "the library brings {} crates, at most {MOST_CRATES} are wanted: {}",
            crates.len(),
            all.join(", ")
        ));
    }
    println!("the library brings {} crates, of at most {MOST_CRATES}", crates.len());
    for features in ["", "cpu", "ocl", "solvers", "npy", "oracle", "packed", "shapes"] {
        let line = ["clippy", "--locked", "--quiet", "-p", "laguerre", "--no-default-features", "--features", features];
        cargo(&[&line[..], &["--", "-D", "warnings"]].concat(), &[])?;
    }
    // Its default features, which `cargo xtask test` does not run for all that it turns on: the tests, the examples, what the documentation shows.
    cargo(&["test", "--locked", "--quiet", "-p", "laguerre"], &[])?;
    cargo(&["clippy", "--locked", "--quiet", "-p", "laguerre-cli", "--", "-D", "warnings"], &[])
}

/// The crates of a tree, a line each, but for the project's own.
fn others(tree: &str) -> BTreeSet<String> {
    let crates = tree.lines().map(|line| line.split(' ').take(2).collect::<Vec<_>>().join(" "));
    crates.filter(|name| !name.is_empty() && !name.starts_with("laguerre")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crate_is_counted_once_and_the_projects_own_are_not() {
        let tree = "laguerre v0.1.0 (/here)\nlaguerre-core v0.1.0 (/here/core)\nrayon v1.12.0\neither v1.19.0\nrayon v1.12.0 (*)\n\nsyn v2.0.1\nsyn v3.0.0\n";
        assert_eq!(
            others(tree).into_iter().collect::<Vec<_>>(),
            ["either v1.19.0", "rayon v1.12.0", "syn v2.0.1", "syn v3.0.0"]
        );
    }
}
