//! From Rust text to OpenCL C: the algorithm (design: one source for the GPU too), and what the host and the kernels share.
//!
//! The text of `core/src/cell/` keeps to a dialect that maps to C statement by statement; `translate` does just that mapping,
//! and refuses, with file and line, what the dialect does not have.

mod emit;
mod interface;
mod kernels;
mod parity;
mod source;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// The files of a cell, whoever computes it, each after what it uses by value.
const FILES: [&str; 16] = [
    "vector",
    "status",
    "plane",
    "vertex",
    "store",
    "wide",
    "expansion",
    "first",
    "quadrature",
    "integrate",
    "facet",
    "near",
    "cone",
    "settle",
    "part",
    "cap",
];

/// The files of what goes over all of a cell's vertices one after the other: of a cell by one work-item.
const ALONE_FILES: [&str; 2] = ["clip", "restrict"];

/// The files of the search for the sites that cut a cell.
const SEARCH_FILES: [&str; 9] =
    ["search_store", "quadratic", "bound", "octree", "tree", "search", "sweep", "far", "boxes"];

/// The files of what either search asks and does with the sites that it finds; the last two have types of their own.
const CANDIDATE_FILES: [&str; 4] = ["quadratic", "bound", "ring", "candidates"];

/// The file of the search of even sites before it.
const TABLE_FILES: [&str; 1] = ["table"];

/// The files of what bounds the nodes of the tree, and of what is around some, which know no cell; the last two have types of their own.
const NODE_FILES: [&str; 7] = ["vector", "quadratic", "bound", "octree", "ring", "around", "node"];

/// Generated files, besides one for each module's functions: constants and structs, which the store is made of; the functions of several modules, as their
/// prototypes and imports; and what holds the functions of a device against the host's, on both.
const TYPES: &str = "cell_types.cl";
const FUNCTIONS: &str = "cell.cl";
const ALONE: &str = "cell_alone.cl";
const SEARCH_TYPES: &str = "tree_types.cl";
const NODES: &str = "nodes.cl";
const SEARCH: &str = "tree_search.cl";
const CANDIDATES: &str = "candidate_search.cl";
const TABLE: &str = "table_search.cl";
const PARITY: &str = "parity.cl";
const PARITY_TABLE: &str = "core/src/cell/parity/table.rs";

/// Where the kernels are, and of them the generated ones.
const KERNELS: &str = "backend-ocl/src/kernels";
const GENERATED: &str = "backend-ocl/src/kernels/generated";

/// What the host and the kernels share: the modules, what they borrow from other files, and the generated file.
const INTERFACES: [Interface; 2] = [
    Interface {
        modules: &["data", "kernels", "algebra", "parity"],
        borrowed: &[
            ("core/src/site_tree.rs", &["WIDTH", "NOWHERE", "Boxes", "WeightBounds", "Slabs"]),
            ("core/src/assemble/facets.rs", &["FacetRecord"]),
            ("core/src/power_octree.rs", &["OctreeBox"]),
        ],
        target: "interface.cl",
        real: "double",
    },
    Interface {
        modules: &["single"],
        borrowed: &[("core/src/site_tree.rs", &["WIDTH", "Boxes", "WeightBounds", "Slabs"])],
        target: "single_interface.cl",
        real: "float",
    },
];

struct Interface {
    /// Files of `backend-ocl/src/interface/`.
    modules: &'static [&'static str],
    borrowed: &'static [(&'static str, &'static [&'static str])],
    target: &'static str,
    /// What a `Real` is in C: the host's number.
    real: &'static str,
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
    let files = generate(root)?;
    let folder = fs::read_dir(root.join(GENERATED)).map_err(|error| format!("cannot read {GENERATED}: {error}"))?;
    for entry in folder.filter_map(Result::ok) {
        let name = format!("{GENERATED}/{}", entry.file_name().display());
        if !files.contains_key(&name) {
            if check {
                return Err(format!("{name} is not made any more: run `cargo xtask codegen`"));
            }
            fs::remove_file(entry.path()).map_err(|error| format!("cannot remove {name}: {error}"))?;
        }
    }
    for (name, generated) in files {
        let path = root.join(&name);
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

/// All generated files by their names.
fn generate(root: &Path) -> Result<BTreeMap<String, String>, String> {
    let group_of = |names: &[&str]| -> Result<Group, String> {
        let units = names.iter().map(|name| read(root, &format!("core/src/cell/{name}.rs")));
        let units = units.collect::<Result<Vec<_>, _>>()?;
        refuse_second_names(root, &units)?;
        translate(units)
    };
    let cell = group_of(&FILES)?;
    let alone = group_of(&ALONE_FILES)?;
    let search = group_of(&SEARCH_FILES)?;
    let candidates = group_of(&CANDIDATE_FILES)?;
    let table = group_of(&TABLE_FILES)?;
    let nodes = group_of(&NODE_FILES)?;
    let [of_node, of_around, of_candidates] = [&["node"][..], &["around"], &["ring", "candidates"]].map(group_of);
    let parity::Parity { kernels, table: parity_table } =
        parity::parity(&cell.units.iter().chain(&alone.units).collect::<Vec<_>>())?;
    let search_types =
        [&search, &of_candidates?, &table, &of_node?, &of_around?].map(|group| group.types.as_str()).concat();

    let mut files =
        BTreeMap::from([(PARITY_TABLE.to_owned(), format!("{}{parity_table}", header("core/src/cell/", &[])))]);
    let mut put = |name: &str, from: &str, imports: &[&str], text: &str| {
        files.insert(format!("{GENERATED}/{name}"), format!("{}{text}", header(from, imports)));
    };
    put(TYPES, "core/src/cell/", &["<prelude>"], &[cell.types.as_str(), &alone.types].concat());
    put(SEARCH_TYPES, "core/src/cell/", &["\"generated/cell_types.cl\""], &search_types);
    put(PARITY, "core/src/cell/", &["\"parity_state.cl\""], &kernels);
    let groups: [(_, &[&str], _); 6] = [
        (FUNCTIONS, &["<store>", "\"world.cl\"", "\"further.cl\""], &cell),
        (ALONE, &["\"generated/cell.cl\""], &alone),
        (CANDIDATES, &["\"generated/cell.cl\"", "\"generated/tree_types.cl\""], &candidates),
        (SEARCH, &["\"tree_store.cl\"", "\"generated/candidate_search.cl\""], &search),
        (TABLE, &["\"generated/candidate_search.cl\""], &table),
        (NODES, &["\"generated/tree_types.cl\"", "\"node_source.cl\""], &nodes),
    ];
    for (name, imports, group) in groups {
        let mut text = format!("\n{}\n", group.prototypes);
        for (unit, functions) in group.units.iter().zip(&group.functions).filter(|(_, functions)| !functions.is_empty())
        {
            let file = format!("{}.cl", unit.module());
            put(&file, &unit.name, &[], functions);
            text.push_str(&format!("#import \"generated/{file}\"\n"));
        }
        put(name, "core/src/cell/", imports, &text);
    }
    for Interface { modules, borrowed, target, real } in INTERFACES {
        let borrowed = borrowed.iter().map(|(path, names)| interface::only(read(root, path)?, names));
        let borrowed = borrowed.collect::<Result<Vec<_>, _>>()?;
        let modules = modules.iter().map(|name| read(root, &format!("backend-ocl/src/interface/{name}.rs")));
        let text = interface::interface(borrowed, modules.collect::<Result<Vec<_>, _>>()?, real)?;
        put(target, "backend-ocl/src/interface/", &["\"generated/cell_types.cl\""], &text);
    }
    Ok(files)
}

/// Refuses a name that a kernel written by hand defines as a macro: the macro would silently take its place, or it the macro's.
fn refuse_second_names(root: &Path, units: &[source::Unit]) -> Result<(), String> {
    let folder = root.join(KERNELS);
    let failed = |error: std::io::Error| format!("cannot read {KERNELS}: {error}");
    for entry in fs::read_dir(&folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_none_or(|ending| ending != "cl") {
            continue;
        }
        let text = fs::read_to_string(&path).map_err(failed)?;
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

/// The C of some modules: constants and structs, prototypes, and the functions of each.
struct Group {
    units: Vec<source::Unit>,
    types: String,
    prototypes: String,
    functions: Vec<String>,
}

fn translate(units: Vec<source::Unit>) -> Result<Group, String> {
    let (mut types, mut prototypes, mut functions) = (String::new(), String::new(), Vec::new());
    // C has one space of names for all files.
    let mut names = std::collections::HashSet::new();
    for unit in &units {
        for name in unit.items.iter().filter_map(source::name_of) {
            if !names.insert(name.to_string()) {
                return unit.error(name.span(), &format!("second `{name}`"));
            }
        }
        types.push_str(&format!("\n// {}\n", unit.name));
        let parts = emit::unit(unit)?;
        types.push_str(&parts.types);
        prototypes.push_str(&parts.prototypes);
        functions.push(parts.functions);
    }
    Ok(Group { units, types, prototypes, functions })
}

#[cfg(test)]
mod tests;
