//! The text of the kernels: files, and how they import each other.
//!
//! A line `#import "name.cl"` stands for that file where it is first imported, and for nothing from then on. `#import <prelude>` and
//! `#import <store>` stand for the files that a [`Text`] chooses: what `real` is, and where a cell lives.

use laguerre_core::{Error, ErrorKind, Result};

macro_rules! files {
    ($($name:literal)*) => { &[$(($name, include_str!(concat!("kernels/", $name)))),*] };
}

const FILES: &[(&str, &str)] = files![
    "aggregation.cl" "algebra.cl" "bound_nodes.cl" "clearance.cl" "evaluate.cl" "facets.cl" "further.cl" "grid.cl" "laplacian.cl" "lanes_cap.cl" "lanes_clip.cl" "lanes_evaluate.cl"
    "lanes_exact.cl" "lanes_integrate.cl" "lanes_records.cl" "lanes_reach.cl" "lanes_search.cl" "lanes_store.cl" "lanes_sums.cl"
    "lanes_surface.cl" "lanes_table.cl" "lanes_talk.cl" "lanes_tree.cl" "leaders.cl" "marks.cl" "node_source.cl" "octree_store.cl" "one_lane.cl" "order.cl" "output.cl"
    "params.cl" "power_octree.cl" "prelude.cl" "rough.cl" "search.cl" "single.cl" "single_prelude.cl" "single_store.cl" "sites.cl" "store.cl"
    "surface_table.cl" "table_store.cl" "ties.cl" "totals.cl" "tree_alone.cl" "tree_store.cl" "world.cl"
    "generated/around.cl" "generated/bound.cl" "generated/boxes.cl" "generated/candidate_search.cl" "generated/candidates.cl" "generated/cap.cl" "generated/cell.cl" "generated/cell_alone.cl"
    "generated/cell_types.cl" "generated/clip.cl" "generated/cone.cl" "generated/expansion.cl" "generated/facet.cl"
    "generated/far.cl" "generated/first.cl" "generated/integrate.cl" "generated/interface.cl" "generated/near.cl" "generated/node.cl"
    "generated/nodes.cl" "generated/octree.cl" "generated/part.cl" "generated/plane.cl" "generated/quadratic.cl" "generated/quadrature.cl" "generated/restrict.cl" "generated/ring.cl"
    "generated/search.cl" "generated/settle.cl" "generated/single_interface.cl" "generated/sweep.cl" "generated/table.cl" "generated/table_search.cl" "generated/tree.cl"
    "generated/tree_search.cl" "generated/tree_types.cl" "generated/vector.cl" "generated/vertex.cl" "generated/wide.cl"
];

/// Those of tests alone.
#[cfg(any(test, feature = "test-util"))]
const TEST_FILES: &[(&str, &str)] = files!["lanes_trial.cl" "generated/parity.cl" "parity_state.cl"];
#[cfg(not(any(test, feature = "test-util")))]
const TEST_FILES: &[(&str, &str)] = &[];

/// The text of a program.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Text {
    /// The files that have its kernels.
    pub(crate) entries: &'static [&'static str],
    pub(crate) prelude: &'static str,
    /// None where no cell is computed.
    pub(crate) store: Option<&'static str>,
}

impl Text {
    /// The whole of it.
    pub(crate) fn whole(&self) -> Result<String> {
        self.whole_with(&[])
    }

    /// The same, with other texts for some files.
    pub(crate) fn whole_with(&self, others: &[(&str, &str)]) -> Result<String> {
        let mut reader = Reader { text: self, others, begun: Vec::new(), open: Vec::new(), whole: String::new() };
        let read = self.entries.iter().try_for_each(|name| reader.read(name));
        read.map_err(|what| Error::new(ErrorKind::Device, format!("the OpenCL kernels are incomplete: {what}")))?;
        Ok(reader.whole)
    }
}

/// A generated file with the generated files that it imports, for tests.
#[cfg(any(test, feature = "test-util"))]
pub(crate) fn generated(name: &str) -> String {
    let text = FILES.iter().find(|(file, _)| *file == name).map_or("", |(_, text)| *text);
    let with_imports =
        |line: &str| match line.strip_prefix("#import \"").and_then(|rest| rest.trim_end().strip_suffix('"')) {
            Some(import) if import.starts_with("generated/") => generated(import),
            _ => line.to_owned(),
        };
    text.split_inclusive('\n').map(with_imports).collect()
}

struct Reader<'a> {
    text: &'a Text,
    others: &'a [(&'a str, &'a str)],
    begun: Vec<&'a str>,
    /// Files that import one another, the last of which is read.
    open: Vec<&'a str>,
    whole: String,
}

impl<'a> Reader<'a> {
    fn read(&mut self, name: &'a str) -> std::result::Result<(), String> {
        if self.open.contains(&name) {
            return Err(format!("{name} imports itself through {}", self.open.join(", ")));
        }
        if self.begun.contains(&name) {
            return Ok(());
        }
        let mut files = self.others.iter().chain(FILES).chain(TEST_FILES);
        let Some((_, text)) = files.find(|(file, _)| *file == name) else { return Err(format!("there is no {name}")) };
        self.begun.push(name);
        self.open.push(name);
        for line in text.split_inclusive('\n') {
            match line.strip_prefix("#import ") {
                None => self.whole.push_str(line),
                Some(import) => {
                    let import =
                        self.chosen(import.trim_end()).ok_or_else(|| format!("{name} has `{}`", line.trim_end()))?;
                    self.read(import)?;
                }
            }
        }
        self.open.pop();
        Ok(())
    }

    /// The file that an import stands for.
    fn chosen(&self, import: &'a str) -> Option<&'a str> {
        match import {
            "<prelude>" => Some(self.text.prelude),
            "<store>" => self.text.store,
            _ => import.strip_prefix('"')?.strip_suffix('"'),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builds::Build;
    use std::collections::BTreeSet;

    /// In C the one that comes last would be all of them.
    #[test]
    fn generated_constants_of_one_name_are_the_same() {
        use std::collections::BTreeMap;
        let mut values = BTreeMap::<&str, BTreeSet<Vec<&str>>>::new();
        for (_, text) in FILES.iter().filter(|(file, _)| file.starts_with("generated/")) {
            let mut here = BTreeMap::<&str, Vec<&str>>::new();
            for line in text.lines().filter_map(|line| line.strip_prefix("#define ")) {
                here.entry(line.split([' ', '(']).next().unwrap_or_default()).or_default().push(line);
            }
            here.into_iter().for_each(|(name, lines)| {
                values.entry(name).or_default().insert(lines);
            });
        }
        let differ: Vec<_> = values.iter().filter(|(_, values)| values.len() > 1).collect();
        assert!(differ.is_empty(), "{differ:?}");
    }

    #[test]
    fn every_file_is_in_a_build_and_none_imports_itself() {
        let mut used = BTreeSet::new();
        let texts: Vec<Text> = Build::all().map(|build| build.text()).collect();
        for text in &texts {
            let mut reader = Reader { text, others: &[], begun: Vec::new(), open: Vec::new(), whole: String::new() };
            text.entries.iter().for_each(|name| reader.read(name).unwrap());
            assert!(!reader.whole.contains("#import"));
            used.extend(reader.begun);
        }
        let there = ["", "generated/"].iter().flat_map(|part| {
            let folder = format!("{}/src/kernels/{part}", env!("CARGO_MANIFEST_DIR"));
            let names = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
            names.filter(|name| name.ends_with(".cl")).map(move |name| format!("{part}{name}"))
        });
        assert_eq!(used.into_iter().map(str::to_owned).collect::<BTreeSet<_>>(), there.collect());
    }

    #[test]
    fn an_import_that_leads_nowhere_or_back_is_an_error() {
        let text = Text { entries: &["a.cl"], prelude: "p.cl", store: None };
        let whole = |others: &[(&str, &str)]| text.whole_with(others).map_err(|error| error.to_string());
        let files =
            [("a.cl", "#import \"b.cl\"\n#import <prelude>\na\n"), ("b.cl", "#import <prelude>\nb\n"), ("p.cl", "p\n")];
        assert_eq!(whole(&files).unwrap(), "p\nb\na\n");
        for (b, what) in [
            ("#import \"a.cl\"\n", "a.cl imports itself through a.cl, b.cl"),
            ("#import \"c.cl\"\n", "there is no c.cl"),
            ("#import <store>\n", "b.cl has `#import <store>`"),
        ] {
            let error = whole(&[files[0], ("b.cl", b), files[2]]).unwrap_err();
            assert!(error.contains(what), "{error}");
        }
    }
}
