//! `-` as an output: results on standard output, and nothing else there.

use std::fs;
use std::process::{Command, Stdio};

use crate::support::{PROGRAM, UNIT_BOX, fails, inputs, laguerre, laguerre_with, runs};

#[test]
fn results_on_standard_output_are_those_of_a_file() {
    let folder = inputs();
    let folder = folder.path();
    let integrate = ["integrate", "strong.xyz", "--box", UNIT_BOX];
    let lloyd = ["lloyd", "white.xyz", "--box", UNIT_BOX, "--tolerance", "0.1"];
    let transport = ["transport", "white.xyz", "--box", UNIT_BOX];
    let sample = ["sample", "plummer", "100"];
    for (args, option) in [
        (&integrate[..], "-o"),
        (&integrate[..], "--facets"),
        (&lloyd[..], "-o"),
        (&transport[..], "-o"),
        (&transport[..], "--cells"),
        (&sample[..], "-o"),
    ] {
        let output = laguerre(folder, &[args, &[option, "-"]].concat());
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{args:?}: {said}");
        // What would have been printed there is beside it.
        let printed = runs(folder, &[args, &[option, "file.csv"]].concat());
        assert_eq!(said.lines().filter(|line| !line.starts_with("laguerre: ")).count(), printed.lines().count());
        assert!(output.stdout == fs::read(folder.join("file.csv")).unwrap(), "{args:?} {option}");
    }
    assert!(!folder.join("-").exists());
}

#[test]
fn what_is_printed_can_be_read_again() {
    let folder = inputs();
    let folder = folder.path();
    let sites = runs(folder, &["sample", "blue", "500", "-o", "-"]);
    runs(folder, &["sample", "blue", "500", "-o", "blue.csv"]);
    let cells = laguerre_with(folder, &["integrate", "-", "--box", UNIT_BOX, "-o", "-"], sites.as_bytes());
    assert_eq!(cells.status.code(), Some(0));
    fs::write(folder.join("cells.csv"), cells.stdout).unwrap();
    runs(folder, &["verify", "cells.csv", "blue.csv", "--box", UNIT_BOX]);
}

#[test]
fn standard_output_is_for_one_thing() {
    let folder = inputs();
    let wrong = |args: &[&str]| fails(folder.path(), 2, args);
    let json = "-: --json prints to standard output, too; name a file for the results";
    for args in [
        &["integrate", "white.xyz", "--json", "-o", "-"][..],
        &["integrate", "white.xyz", "--json", "--facets", "-"],
        &["lloyd", "white.xyz", "--json", "-o", "-"],
        &["transport", "white.xyz", "--json", "-o", "-"],
        &["sample", "white", "9", "--json", "-o", "-"],
    ] {
        assert_eq!(wrong(args), json);
    }
    assert_eq!(
        wrong(&["integrate", "white.xyz", "-o", "-", "--facets", "-"]),
        "-: named for cells and for facets; give two files"
    );
    // A picture is no text.
    assert_eq!(wrong(&["tune", "white.xyz", "-o", "-"]), "-: no ending; known here: .svg");
}

#[cfg(unix)]
#[test]
fn a_reader_that_leaves_ends_it_well() {
    let folder = inputs();
    for arguments in [
        "integrate white.xyz -o -",
        "integrate white.xyz --facets -",
        "sample white 1e5 -o -",
        "lloyd white.xyz -o - --iterations 1",
    ] {
        let pipe = format!("{{ '{PROGRAM}' {arguments} 2> said; echo $? > code; }} | head -c 1 > one");
        let mut command = Command::new("sh");
        assert!(
            command.current_dir(folder.path()).args(["-c", &pipe]).stdin(Stdio::null()).status().unwrap().success()
        );
        let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
        let code = if arguments.starts_with("lloyd") { "4\n" } else { "0\n" };
        assert!(read("code") == code && !read("said").contains("panicked"), "{arguments}: {}", read("said"));
        assert_eq!(read("one").len(), 1);
    }
}
