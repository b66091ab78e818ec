//! A page of Markdown: its blocks of code and its links.

use std::fs;
use std::path::{Path, PathBuf};

use super::SHOWN;
use crate::run::root;

/// A page.
pub(crate) struct Page {
    path: PathBuf,
    text: String,
}

/// A fenced block of code.
pub(crate) struct Block {
    /// Of its fence, from 1.
    pub(crate) line: usize,
    language: String,
    pub(crate) text: String,
}

impl Page {
    pub(crate) fn read(path: &Path) -> Result<Self, String> {
        let text = fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(Self { path: path.to_path_buf(), text })
    }

    /// Its path from the root of the workspace.
    pub(super) fn name(&self) -> String {
        self.path.strip_prefix(root()).unwrap_or(&self.path).display().to_string()
    }

    /// The blocks of a language.
    pub(crate) fn blocks(&self, language: &str) -> Vec<Block> {
        let mut all = blocks(&self.text);
        all.retain(|block| block.language == language);
        all
    }

    /// Links lead to files, and to headings within them; in the guide Rust and Python are included files.
    pub(super) fn check(&self) -> Result<(), String> {
        let folder = self.path.parent().unwrap_or(&self.path);
        for (line, link) in links(&self.text) {
            let wrong = |what: &str| format!("{}, line {line}: the link to {link}: {what}", self.name());
            let (file, heading) = link.split_once('#').unwrap_or((&link, ""));
            let to = folder.join(file);
            let there = match (file.is_empty(), heading.is_empty()) {
                (_, true) => to.exists(),
                (true, _) => has_heading(&self.text, heading),
                _ => has_heading(&fs::read_to_string(&to).map_err(|e| wrong(&e.to_string()))?, heading),
            };
            if !there {
                return Err(wrong("there is no such file or heading"));
            }
        }
        let is_guide = self.path.starts_with(root().join("guide"));
        let code = ["rust", "python", "cpp"].into_iter().flat_map(|language| self.blocks(language));
        for block in code.filter(|_| is_guide) {
            let wrong = |what: &str| format!("{}, line {}: {what}", self.name(), block.line);
            let file = block.text.trim().strip_prefix("{{#include ").and_then(|rest| rest.strip_suffix("}}"));
            let file = file.ok_or_else(|| wrong("code that nobody runs: include a file of examples/"))?;
            let path = folder.join(file).canonicalize().map_err(|_| wrong(&format!("{file} is not there")))?;
            let shown = path.parent().is_some_and(|home| SHOWN.iter().any(|folder| home.ends_with(folder)));
            if !shown {
                return Err(wrong(&format!("{file} is not in {}, which are run", SHOWN.join(", "))));
            }
        }
        Ok(())
    }
}

/// All fenced blocks.
fn blocks(text: &str) -> Vec<Block> {
    let mut found = Vec::new();
    let mut open: Option<Block> = None;
    for (number, line) in text.lines().enumerate() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(_), Some(_)) => found.extend(open.take()),
            (Some(language), None) => {
                open = Some(Block { line: number + 1, language: language.trim().to_owned(), text: String::new() });
            }
            (None, Some(block)) => block.text.extend([line, "\n"]),
            (None, None) => {}
        }
    }
    found
}

/// The lines that are not code.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_code = false;
    text.lines().enumerate().map(|(number, line)| (number + 1, line)).filter(move |(_, line)| {
        let is_fence = line.starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    })
}

/// Links to files beside the page, with their lines.
fn links(text: &str) -> Vec<(usize, String)> {
    let of_line = |(number, line): (usize, &str)| {
        let targets = line.split("](").skip(1).filter_map(|rest| rest.split_once(')').map(|(to, _)| to.to_owned()));
        targets.map(|to| (number, to)).collect::<Vec<_>>()
    };
    let is_file = |to: &str| !to.contains("://") && !to.starts_with('<');
    prose(text).flat_map(of_line).filter(|(_, to)| is_file(to)).collect()
}

/// Whether a text has a heading that links call so.
fn has_heading(text: &str, heading: &str) -> bool {
    headings(text).iter().any(|known| known == heading)
}

/// What headings are called in links.
fn headings(text: &str) -> Vec<String> {
    let name = |title: &str| {
        let kept = title.trim().to_lowercase().replace(' ', "-");
        kept.chars().filter(|c| c.is_alphanumeric() || ['-', '_'].contains(c)).collect()
    };
    prose(text).filter(|(_, line)| line.starts_with('#')).map(|(_, line)| name(line.trim_start_matches('#'))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# The first, of two\n[a](b.md#c-d) [web](https://x.y)\n```sh\necho [no](link)\n# no heading\n```\n## Signs\n[](../e.rs)\n";

    #[test]
    fn code_is_not_prose() {
        let found = blocks(TEXT);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].line, found[0].language.as_str()), (3, "sh"));
        assert_eq!(found[0].text, "echo [no](link)\n# no heading\n");
        assert_eq!(headings(TEXT), ["the-first-of-two", "signs"]);
        assert_eq!(links(TEXT), [(2, "b.md#c-d".to_owned()), (8, "../e.rs".to_owned())]);
    }

    #[test]
    fn a_page_is_refused_for_what_leads_nowhere_and_what_nobody_runs() {
        let said =
            |text: &str| Page { path: root().join("guide/src/page.md"), text: text.to_owned() }.check().unwrap_err();
        assert!(said("\n[x](nowhere.md)").starts_with("guide/src/page.md, line 2: the link to nowhere.md"));
        assert!(said("# There\n[x](#here)").contains("no such file or heading"));
        assert!(said("```rust\nfn main() {}\n```").contains("line 1: code that nobody runs"));
        assert!(said("```python\n{{#include ../../python/examples/none.py}}\n```").contains("none.py is not there"));
    }
}
