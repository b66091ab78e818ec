//! `cargo xtask paper`: the paper's experiments, and their text in BENCHMARKS.md.

use std::fs;
use std::path::PathBuf;

use crate::run::cargo;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
const BEGIN: &str = "<!-- paper: begin -->";
const END: &str = "<!-- paper: end -->";

/// Runs `laguerre paper` with the given arguments (see its `--help`), and puts what it writes into BENCHMARKS.md in place of what the
/// same backend and experiments wrote before. With `--from FILE` the text is one that was made on another machine.
pub(crate) fn run(arguments: &[&str]) -> Result<(), String> {
    let made = match arguments {
        ["--from", file] => PathBuf::from(file),
        arguments => make(arguments)?,
    };
    let read = |path: &PathBuf| fs::read_to_string(path).map_err(|e| format!("{}: cannot read: {e}", path.display()));
    let page = PathBuf::from(ROOT).join("BENCHMARKS.md");
    let text = with_block(&read(&page)?, &read(&made)?)?;
    fs::write(&page, text).map_err(|e| format!("{}: cannot write: {e}", page.display()))
}

fn make(arguments: &[&str]) -> Result<PathBuf, String> {
    let target = PathBuf::from(std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()));
    let made = PathBuf::from(ROOT).join(target).join("paper.md");
    let path = made.to_str().ok_or("the target folder's name is not UTF-8")?;
    let mut line = vec!["run", "--locked", "--release", "--package", "laguerre-cli"];
    if arguments.iter().any(|word| word.contains("ocl") || word.starts_with("--device")) {
        line.extend(["--features", "ocl"]);
    }
    line.extend(["--", "paper", "--markdown", path, "--picture", "docs/counts.svg"]);
    line.extend(arguments);
    cargo(&line, &[])?;
    Ok(made)
}

/// The page with `block` (from one marker comment to the other) in place of that with the same markers, or at the end of the paper's
/// part.
fn with_block(page: &str, block: &str) -> Result<String, String> {
    let block = block.trim_end();
    let (first, last) = (block.lines().next().unwrap_or_default(), block.lines().last().unwrap_or_default());
    let is_marker =
        |line: &str, what: &str| line.starts_with("<!-- paper ") && line.ends_with(&format!(": {what} -->"));
    if !is_marker(first, "begin") || !is_marker(last, "end") {
        return Err("the text of `laguerre paper` is not between its marker comments".to_owned());
    }
    if let Some(text) = replaced(page, [first, last], block) {
        return Ok(text);
    }
    match page.find(END) {
        Some(end) if page[..end].contains(BEGIN) => Ok(format!("{}{block}\n\n{}", &page[..end], &page[end..])),
        _ => Err(format!("BENCHMARKS.md has no {BEGIN} and {END} to put the text between")),
    }
}

/// The page with `block` in place of what stands from the first marker to the last; `None` where it has no such markers.
pub(crate) fn replaced(page: &str, [first, last]: [&str; 2], block: &str) -> Option<String> {
    let (begin, end) = (page.find(first)?, page.find(last)?);
    (begin < end).then(|| format!("{}{block}{}", &page[..begin], &page[end + last.len()..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "# Page\n\n<!-- paper: begin -->\n\n<!-- paper: end -->\n\n## After\n";

    #[test]
    fn blocks_of_a_backend_are_replaced_and_others_kept() {
        let block =
            |name: &str, text: &str| format!("<!-- paper {name}: begin -->\n{text}\n<!-- paper {name}: end -->\n");
        let one = with_block(PAGE, &block("cpu", "old")).unwrap();
        let two = with_block(&one, &block("ocl", "device")).unwrap();
        let three = with_block(&two, &block("cpu", "new")).unwrap();
        assert!(three.contains("new") && three.contains("device") && !three.contains("old"), "{three}");
        assert!(three.starts_with("# Page\n\n<!-- paper: begin -->\n") && three.ends_with("\n## After\n"), "{three}");
        assert_eq!(with_block(&three, &block("cpu", "new")).unwrap(), three);
    }

    #[test]
    fn a_block_is_put_in_its_place() {
        let page = "# Page\nbegin\nold\nend\nafter\n";
        let made = replaced(page, ["begin", "end"], "begin\nnew\nend");
        assert_eq!(made.as_deref(), Some("# Page\nbegin\nnew\nend\nafter\n"));
        assert_eq!(replaced("# Page\n", ["begin", "end"], ""), None);
        assert_eq!(replaced(page, ["end", "begin"], ""), None);
    }

    #[test]
    fn text_without_markers_is_refused() {
        assert!(with_block(PAGE, "text").is_err());
        assert!(with_block("# Page\n", "<!-- paper cpu: begin -->\n<!-- paper cpu: end -->\n").is_err());
    }
}
