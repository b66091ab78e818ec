//! From Rust text to OpenCL C: the algorithm (design: one source for the GPU too), and what the host and the kernels share.
//!
//! The text of `core/src/cell/` keeps to a dialect that maps to C statement by statement; `translate` does just that mapping,
//! and refuses, with file and line, what the dialect does not have.

mod emit;
mod interface;
mod kernels;
mod parity;
mod source;

use std::fs;
use std::path::Path;

/// The files of the algorithm, each after what it uses by value.
const FILES: [&str; 15] = [
    "vector",
    "status",
    "plane",
    "vertex",
    "store",
    "wide",
    "expansion",
    "clip",
    "quadrature",
    "integrate",
    "facet",
    "cone",
    "near",
    "restrict",
    "cap",
];

/// The files of the search for the sites that cut a cell.
const SEARCH_FILES: [&str; 6] = ["search_store", "quadratic", "bound", "tree", "search", "far"];

/// The file of what either search does with the sites that it finds.
const CANDIDATE_FILES: [&str; 1] = ["candidates"];

/// The file of the search of even sites before it.
const TABLE_FILES: [&str; 1] = ["table"];

/// The files of what bounds the nodes of the tree, which know no cell; the last has types of its own.
const NODE_FILES: [&str; 3] = ["vector", "quadratic", "node"];

/// Generated files: constants and structs, which the store is made of; functions, which use it; and what holds the functions of a device
/// against the host's, on both.
const TYPES: &str = "backend-ocl/src/kernels/cell_types.cl";
const FUNCTIONS: &str = "backend-ocl/src/kernels/cell.cl";
const SEARCH_TYPES: &str = "backend-ocl/src/kernels/tree_types.cl";
const NODES: &str = "backend-ocl/src/kernels/nodes.cl";
const SEARCH: &str = "backend-ocl/src/kernels/tree_search.cl";
const CANDIDATES: &str = "backend-ocl/src/kernels/candidates.cl";
const TABLE: &str = "backend-ocl/src/kernels/table_search.cl";
const KERNELS: &str = "backend-ocl/src/kernels";
const PARITY: &str = "backend-ocl/src/kernels/parity.cl";
const PARITY_TABLE: &str = "core/src/cell/parity/table.rs";

/// What the host and the kernels share: the modules, what they borrow from other files, and the generated file.
const INTERFACES: [Interface; 2] = [
    Interface {
        modules: &["data", "kernels", "parity"],
        borrowed: &[
            ("core/src/site_tree.rs", &["WIDTH", "NOWHERE", "Boxes", "WeightBounds", "Slabs"]),
            ("core/src/assemble.rs", &["FacetRecord"]),
        ],
        target: "backend-ocl/src/kernels/interface.cl",
        real: size_of::<f64>(),
    },
    Interface {
        modules: &["single"],
        borrowed: &[("core/src/site_tree.rs", &["WIDTH", "Boxes", "WeightBounds", "Slabs"])],
        target: "backend-ocl/src/kernels/single_interface.cl",
        real: size_of::<f32>(),
    },
];

struct Interface {
    /// Files of `backend-ocl/src/interface/`.
    modules: &'static [&'static str],
    borrowed: &'static [(&'static str, &'static [&'static str])],
    target: &'static str,
    /// Bytes of a number.
    real: usize,
}

/// What begins a generated file of kernels: where it comes from, and the files that it stands on.
fn header(from: &str, imports: &[&str]) -> String {
    let imports: String = imports.iter().map(|file| format!("#import {file}\n")).collect();
    let gap = if imports.is_empty() { "" } else { "\n" };
    format!("// Generated from {from} by `cargo xtask codegen`; do not edit.\n{gap}{imports}")
}

/// Generates the files, or with `check` only compares them with what is committed.
pub(crate) fn run(check: bool) -> Result<(), String> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    for (name, generated) in generate(root)? {
        let path = root.join(name);
        if !check {
            fs::write(&path, generated).map_err(|error| format!("cannot write {name}: {error}"))?;
            continue;
        }
        let committed = fs::read_to_string(&path).map_err(|error| format!("cannot read {name}: {error}"))?;
        if committed != generated {
            let same = committed.lines().zip(generated.lines()).take_while(|(a, b)| a == b).count();
            let line = same + 1;
            return Err(format!("{name} line {line} is not what its Rust text says: run `cargo xtask codegen`"));
        }
    }
    Ok(())
}

fn generate(root: &Path) -> Result<Vec<(&'static str, String)>, String> {
    let units_of = |names: &[&str]| -> Result<Vec<source::Unit>, String> {
        names.iter().map(|name| read(root, &format!("core/src/cell/{name}.rs"))).collect()
    };
    let units = units_of(&FILES)?;
    let [types, functions] = translate(&units)?;
    let [search_types, search] = translate(&units_of(&SEARCH_FILES)?)?;
    let [candidate_types, candidates] = translate(&units_of(&CANDIDATE_FILES)?)?;
    let [table_types, table_search] = translate(&units_of(&TABLE_FILES)?)?;
    let [_, nodes] = translate(&units_of(&NODE_FILES)?)?;
    let [node_types, _] = translate(&units_of(&["node"])?)?;
    let parity::Parity { kernels, table } = parity::parity(&units)?;
    let files: [(_, &[&str], _); 9] = [
        (TYPES, &["<prelude>"], types),
        (FUNCTIONS, &["<store>", "\"world.cl\"", "\"further.cl\""], functions),
        (SEARCH_TYPES, &["\"cell_types.cl\""], format!("{search_types}{candidate_types}{table_types}{node_types}")),
        (CANDIDATES, &["\"cell.cl\"", "\"tree_types.cl\""], candidates),
        (SEARCH, &["\"tree_store.cl\"", "\"candidates.cl\""], search),
        (TABLE, &["\"candidates.cl\""], table_search),
        (NODES, &["\"tree_types.cl\"", "\"node_source.cl\""], nodes),
        (PARITY, &["\"parity_state.cl\""], kernels),
        (PARITY_TABLE, &[], table),
    ];
    let cell = |imports: &[&str], text| format!("{}{text}", header("core/src/cell/", imports));
    let mut files = files.map(|(name, imports, text)| (name, cell(imports, text))).to_vec();
    refuse_second_names(root, &units_of(&FILES)?)?;
    refuse_second_names(root, &units_of(&SEARCH_FILES)?)?;
    refuse_second_names(root, &units_of(&CANDIDATE_FILES)?)?;
    refuse_second_names(root, &units_of(&TABLE_FILES)?)?;
    refuse_second_names(root, &units_of(&NODE_FILES)?)?;
    for Interface { modules, borrowed, target, real } in INTERFACES {
        let borrowed = borrowed.iter().map(|(path, names)| interface::only(read(root, path)?, names));
        let borrowed = borrowed.collect::<Result<Vec<_>, _>>()?;
        let modules = modules.iter().map(|name| read(root, &format!("backend-ocl/src/interface/{name}.rs")));
        let text = interface::interface(&borrowed, &modules.collect::<Result<Vec<_>, _>>()?, real)?;
        files.push((target, format!("{}{text}", header("backend-ocl/src/interface/", &["\"cell_types.cl\""]))));
    }
    Ok(files)
}

/// Refuses a name that a kernel written by hand defines as a macro: the macro would silently take its place, or it the macro's.
fn refuse_second_names(root: &Path, units: &[source::Unit]) -> Result<(), String> {
    let folder = root.join(KERNELS);
    let failed = |error: std::io::Error| format!("cannot read {KERNELS}: {error}");
    for entry in fs::read_dir(&folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let text = fs::read_to_string(&path).map_err(failed)?;
        if text.starts_with("// Generated") {
            continue;
        }
        let defined = |line: &str| -> Option<String> {
            let rest = line.trim_start().strip_prefix("#define ")?;
            Some(rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect())
        };
        let macros: std::collections::HashSet<String> = text.lines().filter_map(defined).collect();
        for unit in units {
            for name in unit.items.iter().filter_map(source::name_of) {
                if macros.contains(&name.to_string()) {
                    let file = path.file_name().unwrap_or_default().display();
                    return unit.error(name.span(), &format!("name `{name}`: it is a macro of {file}"));
                }
            }
        }
    }
    Ok(())
}

fn read(root: &Path, path: &str) -> Result<source::Unit, String> {
    let text = fs::read_to_string(root.join(path)).map_err(|error| format!("cannot read {path}: {error}"))?;
    source::Unit::parse(path, &text)
}

/// The C of some files: constants and structs; prototypes and functions.
fn translate(units: &[source::Unit]) -> Result<[String; 2], String> {
    let mut types = String::new();
    let mut prototypes = String::new();
    let mut functions = String::new();
    // C has one space of names for all files.
    let mut names = std::collections::HashSet::new();
    for unit in units {
        for name in unit.items.iter().filter_map(source::name_of) {
            if !names.insert(name.to_string()) {
                return unit.error(name.span(), &format!("second `{name}`"));
            }
        }
        types.push_str(&format!("\n// {}\n", unit.name));
        functions.push_str(&format!("\n// {}\n", unit.name));
        let parts = emit::unit(unit)?;
        types.push_str(&parts.types);
        prototypes.push_str(&parts.prototypes);
        functions.push_str(&parts.functions);
    }
    Ok([types, format!("\n{prototypes}{functions}")])
}

#[cfg(test)]
mod tests;
