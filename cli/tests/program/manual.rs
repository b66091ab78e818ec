//! What is made of the command line: completions for shells, and pages for `man`.

use std::fs;
use std::process::Command;

use crate::support::{fails, files, runs};

/// A shell that has read the completions completes commands and options, and does not offer what help hides.
#[cfg(unix)]
#[test]
fn bash_completes() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("laguerre.bash"), runs(folder.path(), &["completions", "bash"])).unwrap();
    let completed = |words: &str, last: &str| {
        let script = format!(
            ". ./laguerre.bash; COMP_WORDS=(laguerre {words} {last}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); \
             _laguerre laguerre {last} \"${{COMP_WORDS[COMP_CWORD - 1]}}\"; printf '%s\\n' \"${{COMPREPLY[@]}}\""
        );
        let output = Command::new("bash").current_dir(folder.path()).args(["-c", &script]).output().unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        said.lines().map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(completed("", "integ"), ["integrate"]);
    assert_eq!(completed("", "pap"), [""]);
    assert_eq!(completed("integrate s.xyz", "--sec"), ["--second-moments"]);
    assert_eq!(completed("integrate s.xyz --backend", "c"), ["cpu"]);
}

#[test]
fn every_shell_has_completions() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let text = runs(folder.path(), &["completions", shell]);
        assert!(text.contains("second-moments") && !text.contains("paper"), "{shell}");
    }
    let line = fails(folder.path(), 2, &["completions", "csh"]);
    assert!(line.contains("[possible values: bash, elvish, fish, powershell, zsh]"), "{line}");
}

/// A page for the program and one for each command that its help shows, each with its options and examples, line by line.
#[test]
fn every_command_has_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let said = runs(folder.path(), &["man", "pages/man1"]);
    let pages = files(&folder.path().join("pages/man1"));
    assert_eq!(said, format!("written      {} pages in pages/man1\n", pages.len()));
    let help = runs(folder.path(), &["--help"]);
    let commands = help.split("\nCommands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let commands = commands.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let commands = commands.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help");
    let mut names: Vec<String> = commands.map(|name| format!("laguerre-{name}.1")).collect();
    names.push("laguerre.1".to_owned());
    names.sort();
    let found: Vec<_> = pages.keys().map(|path| path.file_name().unwrap().to_str().unwrap().to_owned()).collect();
    assert_eq!(found, names);
    let page = String::from_utf8(pages[&folder.path().join("pages/man1/laguerre-integrate.1")].clone()).unwrap();
    for part in
        [".TH laguerre-integrate 1", "\\-\\-second\\-moments", ".SH EXAMPLES\n.nf\n", "laguerre integrate sites.xyz"]
    {
        assert!(page.contains(part), "{part}: {page}");
    }
    fs::write(folder.path().join("file"), "").unwrap();
    assert!(fails(folder.path(), 2, &["man", "file"]).starts_with("file: cannot make this folder"));
}
