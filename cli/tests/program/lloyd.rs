//! `laguerre lloyd`.

use std::fs;

use crate::support::{UNIT_BOX, fails, inputs, json, notes, runs};

#[test]
fn it_lowers_the_energy_and_writes_the_sites() {
    let folder = inputs();
    let run = |more: &[&str]| {
        let mut args = vec!["lloyd", "white.xyz", "--box", UNIT_BOX, "--json"];
        args.extend_from_slice(more);
        json(&runs(folder.path(), &args))
    };
    let lloyd = run(&["--method", "lloyd", "--iterations", "40", "--tolerance", "0"]);
    let lbfgs = run(&["--iterations", "15", "--tolerance", "0", "-o", "even.xyz", "--threads", "1"]);
    assert_eq!(
        (&lloyd["iterations"], &lloyd["evaluations"], &lloyd["converged"]),
        (&40.into(), &41.into(), &false.into())
    );
    assert_eq!(lloyd["history"].as_array().unwrap().len(), 41);
    assert!(lbfgs["energy"].as_f64() < lloyd["energy"].as_f64(), "{lbfgs}");
    assert!(lbfgs["residual"].as_f64() > Some(0.0) && lbfgs["seconds"].as_f64() > Some(0.0), "{lbfgs}");
    // Above that of the best lattice, and not by much.
    let normalized = lbfgs["normalized_energy"].as_f64().unwrap();
    assert!(0.0785 < normalized && normalized < 0.0850, "{normalized}");
    // What was written is what was computed: its energy at the start is that of the end.
    let again = json(&runs(folder.path(), &["lloyd", "even.xyz", "--box", UNIT_BOX, "--json", "--iterations", "0"]));
    assert_eq!((&again["energy"], &again["evaluations"]), (&lbfgs["energy"], &1.into()));
    let first = fs::read(folder.path().join("even.xyz")).unwrap();
    run(&["--iterations", "15", "--tolerance", "0", "-o", "even.xyz", "--threads", "2"]);
    assert!(first == fs::read(folder.path().join("even.xyz")).unwrap(), "the same bits for any number of threads");
}

#[test]
fn it_stops_on_the_bound_and_says_what_it_did() {
    let folder = inputs();
    let args = ["lloyd", "strong.xyz", "--domain", "cube.off", "--tolerance", "0.05", "-o", "even.npy"];
    let text = runs(folder.path(), &args);
    assert!(text.starts_with("iteration  diagrams") && text.contains("the gradient is within its bound"), "{text}");
    let said = notes(folder.path(), &args);
    assert!(said.iter().any(|line| line.ends_with("have empty cells, and stayed where they were")), "{said:?}");
    let said = notes(folder.path(), &["lloyd", "white.xyz", "--iterations", "1"]);
    assert_eq!(said, ["only the energies are printed; name a file with -o to keep the sites"]);
}

#[test]
fn bad_input_is_said_in_one_line() {
    let folder = inputs();
    let wrong = |args: &[&str]| fails(folder.path(), 2, args);
    assert!(wrong(&["lloyd"]).contains("<SITES>"));
    assert!(wrong(&["lloyd", "none.xyz"]).contains("none.xyz: cannot open"));
    assert!(wrong(&["lloyd", "white.xyz", "-o", "a.vtu"]).contains("known here: .xyz, .txt, .csv, .npy, .ply"));
    assert!(wrong(&["lloyd", "white.xyz", "--tolerance", "-1"]).contains("a number from 0 to 1e60 is needed"));
    assert!(wrong(&["lloyd", "white.xyz", "--method", "newton"]).contains("'newton'"));
    assert!(wrong(&["lloyd", "white.xyz", "--iterations", "-1"]).contains("-1"));
    let line = wrong(&["lloyd", "white.xyz", "--box", UNIT_BOX, "-o", "./white.xyz"]);
    assert_eq!(line, "./white.xyz: would be written over, but is read; name another file");
    fs::write(folder.path().join("flat.xyz"), "0 0 0\n1 1 0\n").unwrap();
    assert!(wrong(&["lloyd", "flat.xyz"]).contains("flat.xyz: the bounding box of the 2 sites is flat"));
    fs::write(folder.path().join("far.xyz"), "0 0 0\n1e9 1 0\n").unwrap();
    assert!(wrong(&["lloyd", "far.xyz", "--box", UNIT_BOX]).contains("far.xyz: site 1"));
}
