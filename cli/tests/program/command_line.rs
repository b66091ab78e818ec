//! The command line itself, and what is printed for it.

use std::process::{Command, Stdio};

use crate::support::{PROGRAM, UNIT_BOX, failed, fails, inputs, json, laguerre, notes, runs};

#[test]
fn help_and_version_are_no_errors() {
    let folder = tempfile::tempdir().unwrap();
    assert!(runs(folder.path(), &["--version"]).starts_with("laguerre 0."));
    for command in [
        &["--help"][..],
        &["integrate", "--help"],
        &["sample", "--help"],
        &["demo", "--help"],
        &["tune", "--help"],
        &["bench", "--help"],
        // Who says nothing asks what there is to say.
        &[],
    ] {
        assert!(runs(folder.path(), command).contains("Usage: laguerre"));
    }
}

#[test]
fn a_wrong_command_line_is_said_in_one_line() {
    let folder = inputs();
    let wrong = |args: &[&str]| fails(folder.path(), 2, args);
    let line = wrong(&["integrate"]);
    assert!(line.contains("<SITES>") && line.ends_with("; see laguerre integrate --help"), "{line}");
    let line = wrong(&["fly"]);
    assert!(line.contains("'fly'") && line.ends_with("; see laguerre --help"), "{line}");
    assert!(wrong(&["integrate", "white.xyz", "--box", UNIT_BOX, "--orient"]).contains("cannot be used with"));
    assert!(
        wrong(&["sample", "white", "9", "-o", "a.xyz", "--box", UNIT_BOX, "--inside"]).contains("cannot be used with")
    );
    #[cfg(unix)]
    for bytes in [&b"\xff"[..], b"--\xff"] {
        let argument = std::os::unix::ffi::OsStrExt::from_bytes(bytes);
        let output = Command::new(PROGRAM).arg::<&std::ffi::OsStr>(argument).output().unwrap();
        assert!(failed(&output, 2, &[]).ends_with("; see laguerre --help"));
    }
    assert!(wrong(&["integrate", "none.xyz"]).contains("none.xyz: cannot open"));
    assert!(wrong(&["integrate", "white.pdf"]).contains("known here: .xyz, .txt, .csv, .npy, .ply"));
    assert!(
        wrong(&["integrate", "white.xyz", "--box", UNIT_BOX, "--domain", "cube.off"]).contains("cannot be used with")
    );
    assert!(wrong(&["integrate", "white.xyz", "--epsilon", "-1"]).contains("0 or larger"));
    assert!(wrong(&["integrate", "white.xyz", "--threads", "0"]).contains("from 1 to"));
    let of_devices = wrong(&["integrate", "white.xyz", "--backend", "ocl", "--threads", "2"]);
    assert!(of_devices.contains("--threads: they are of backend cpu alone"), "{of_devices}");
    assert!(wrong(&["integrate", "white.xyz", "-o", "cells.xls"]).contains("known here: .csv, .npy, .npz, .vtu"));
    assert!(wrong(&["integrate", "white.xyz", "-o", "a.csv", "--facets", "a.csv"]).contains("give two files"));
    assert!(wrong(&["integrate", "white.xyz", "-o", "a.csv", "--facets", "./a.csv"]).contains("give two files"));
    let count = |text: &str| wrong(&["sample", "white", text, "-o", "a.xyz"]);
    for text in ["0", "1e3.5", "1,000", "3e9", "many"] {
        let needed = "a whole number from 1 to 2147483648 is needed, such as 100000, 100_000 or 1e5";
        assert_eq!(count(text), format!("invalid value '{text}' for '<N>': {needed}; see laguerre sample --help"));
    }
    let line = wrong(&["integrate", "white.xyz", "--second-moments", "-o", "a.csv"]);
    assert_eq!(line, "--second-moments: only .npz has room for them; name one with -o");
    let line = wrong(&["fluid", "dam-break", "--checkpoint", "x.ck"]);
    assert_eq!(line, "x.ck: unknown ending '.ck'; known here: .fluid");
    assert!(wrong(&["sample", "white", "9", "--inside", "-o", "a.xyz"]).contains("--domain"));
}

/// An error is alone, whatever a success would add.
#[test]
fn what_is_wrong_comes_without_a_note() {
    let folder = inputs();
    std::fs::write(folder.path().join("one.xyz"), "1 2 3\n").unwrap();
    for command in ["integrate", "lloyd", "transport"] {
        for (sites, line) in [
            ("gone.xyz", "gone.xyz: cannot open: "),
            (
                "one.xyz",
                "one.xyz: the bounding box of one site is flat: give a box or a domain to restrict its cell to",
            ),
        ] {
            let output = laguerre(folder.path(), &[command, sites]);
            let said = String::from_utf8(output.stderr).unwrap();
            assert_eq!((output.status.code(), said.lines().count()), (Some(2), 1), "{command}: {said}");
            assert!(said.starts_with(&format!("laguerre: {line}")), "{command}: {said}");
        }
    }
    let output = laguerre(folder.path(), &["fluid", "snow-globe", "--domain", "gone.off"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.starts_with("laguerre: gone.off: cannot open: ") && said.lines().count() == 1, "{said}");
    let said = notes(folder.path(), &["integrate", "white.xyz"]);
    assert_eq!(said, ["only the summary is printed; name a file with -o to keep the cells"]);
}

#[test]
fn counts_are_written_as_people_do() {
    let folder = inputs();
    let made = |text: &str| json(&runs(folder.path(), &["sample", "white", text, "-o", "a.xyz", "--json"]));
    for text in ["1000", "1e3", "1_000"] {
        let made = made(text);
        assert_eq!((&made["sites"], &made["asked"], &made["file"]), (&1000.into(), &1000.into(), &"a.xyz".into()));
        assert_eq!((&made["distribution"], &made["weights"]), (&"white".into(), &false.into()));
    }
}

#[test]
fn devices_are_an_object_too() {
    let folder = tempfile::tempdir().unwrap();
    let (lines, object) = (runs(folder.path(), &["devices"]), json(&runs(folder.path(), &["devices", "--json"])));
    assert!(lines.contains(object["cpu"]["name"].as_str().unwrap()), "{lines}");
    let devices = object["ocl"]["devices"].as_array().unwrap();
    assert_eq!(devices.is_empty(), object["ocl"]["unusable"].is_string(), "{object}");
    for (i, device) in devices.iter().enumerate() {
        assert_eq!(device["number"], i);
        assert!(lines.contains(device["name"].as_str().unwrap()), "{lines}");
    }
}

#[test]
fn boxes_are_six_numbers_in_order_within_range() {
    let folder = inputs();
    let wrong = |corners: &str| fails(folder.path(), 2, &["integrate", "white.xyz", "--box", corners, "-o", "a.csv"]);
    let empty = "range is empty: give the minimum corner, then the maximum corner; see laguerre integrate --help";
    assert!(wrong("1,0,0,0,1,1").ends_with(&format!("its x {empty}")));
    assert!(wrong("0,0,0.5,1,1,0.5").ends_with(&format!("its z {empty}")));
    assert!(wrong("0,0,0,1,1,1e-70").contains("its z range 0e0..1e-70 is no wider than 1e-60; choose another unit"));
    assert!(wrong("0,0,0,1,1").contains("5 numbers; 6 are needed: x0,y0,z0,x1,y1,z1"));
    assert!(wrong("0,0,0,1,nan,1").contains("'nan' is not a number within ±1e60"));
    assert!(wrong("0,0,0,1,1e61,1").contains("'1e61' is not a number within ±1e60"));
}

#[test]
fn a_backend_that_is_not_there_is_code_3() {
    let folder = inputs();
    let args = ["integrate", "white.xyz", "--backend", "ocl", "-o", "a.csv", "--json"];
    let mut command = Command::new(PROGRAM);
    // Where it was built, the loader is told of a place without any platform.
    command.current_dir(folder.path()).args(args).env("OCL_ICD_VENDORS", "/nowhere");
    let line = failed(&command.output().unwrap(), 3, &args);
    assert!(["ocl", "OpenCL"].iter().any(|name| line.contains(name)) && line.contains("--backend cpu"), "{line}");
    assert!(!folder.path().join("a.csv").exists());
}

#[test]
fn a_precision_that_the_backend_lacks_is_code_2() {
    let folder = inputs();
    let args = ["integrate", "white.xyz", "--precision", "f32", "--backend", "cpu", "-o", "a.csv"];
    assert_eq!(
        fails(folder.path(), 2, &args),
        "--precision f32: backend cpu computes in f64 only; give --precision f64"
    );
}

/// Of one device, asked for or not, where there is one.
#[test]
fn single_precision_is_opencl_and_says_so() {
    let folder = inputs();
    let run = |more: &[&str]| {
        let mut args = vec!["integrate", "white.xyz", "--domain", "cube.off", "--precision", "f32"];
        args.extend_from_slice(more);
        let mut command = Command::new(PROGRAM);
        (command.current_dir(folder.path()).args(&args).output().unwrap(), args.join(" "))
    };
    let (output, _) = run(&["--json"]);
    if output.status.code() == Some(3) {
        let required = std::env::var("LAGUERRE_REQUIRE").unwrap_or_default();
        assert!(!required.split(',').any(|name| name.trim() == "ocl"), "{}", String::from_utf8_lossy(&output.stderr));
        return;
    }
    let report = json(std::str::from_utf8(&output.stdout).unwrap());
    assert_eq!((&report["backend"], &report["precision"]), (&"ocl".into(), &"f32".into()));
    assert_eq!((&report["cells"], &report["uncertified"]), (&2000.into(), &0.into()));
    let host = report["host_cells"].as_u64().unwrap();
    assert!(0 < host && host < 2000, "{report}");
    assert!(report["relative_error"].as_f64().unwrap() < 1e-6, "{report}");
    let (output, args) = run(&["-o", "a.csv", "--facets", "f.csv"]);
    let line = failed(&output, 2, &[args.as_str()]);
    assert!(
        line.contains("in f32 there are volumes, barycenters and geometry only") && line.ends_with("(--precision f64)"),
        "{line}"
    );
    assert!(!folder.path().join("a.csv").exists() && !folder.path().join("f.csv").exists());
}

#[test]
fn the_json_object_has_its_fields_in_their_order() {
    let folder = inputs();
    let args = ["integrate", "white.xyz", "--domain", "cube.off", "--threads", "2", "--json"];
    let text = runs(folder.path(), &args);
    let fields = [
        "sites",
        "cells",
        "empty",
        "uncertified",
        "volume_sum",
        "domain_volume",
        "relative_error",
        "barycenter_error",
        "exact_cells",
        "host_cells",
        "backend",
        "device",
        "precision",
        "threads",
        "seconds",
        "read",
        "domain_grid",
        "compute",
        "device",
        "write",
        "passes",
        "K",
        "P",
        "V",
        "T",
        "cells",
        "failed",
        "seconds",
    ];
    let mut from = 0;
    for field in fields {
        let key = format!("\"{field}\":");
        from += text[from..].find(&key).unwrap_or_else(|| panic!("{field} is not where it should be in {text}"))
            + key.len();
    }
    let report = json(&text);
    assert_eq!(report.as_object().unwrap().len(), 16);
    assert_eq!((&report["sites"], &report["cells"], &report["empty"]), (&2000.into(), &2000.into(), &0.into()));
    assert_eq!(
        (&report["backend"], &report["precision"], &report["threads"]),
        (&"cpu".into(), &"f64".into(), &2.into())
    );
    assert_eq!(report["domain_volume"], 1.0);
    // The bound of the design for the sums over all cells.
    assert!(report["relative_error"].as_f64().unwrap() <= 1e-14, "{text}");
    assert!(report["barycenter_error"].as_f64().unwrap() <= 1e-14, "{text}");
    assert!(report["passes"].as_array().unwrap().iter().any(|pass| pass["cells"] == 2000));
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let folder = inputs();
    let mut command = Command::new(PROGRAM);
    command.current_dir(folder.path()).args(["integrate", "white.xyz", "--json", "-o", "cells.csv"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty());
    assert!(folder.path().join("cells.csv").exists());
}

#[cfg(unix)]
#[test]
fn a_pipe_that_closes_early_shows_no_panic() {
    let folder = inputs();
    for arguments in ["integrate white.xyz --json", "integrate white.xyz", "--help", "integrate --help"] {
        let pipe = format!("'{PROGRAM}' {arguments} | head -c 1 > one");
        let output = Command::new("sh").current_dir(folder.path()).args(["-c", &pipe]).output().unwrap();
        let errors = String::from_utf8(output.stderr).unwrap();
        assert!(errors.lines().all(|line| line.starts_with("laguerre: note: ")), "{arguments}: {errors}");
        assert_eq!(std::fs::read(folder.path().join("one")).unwrap().len(), 1);
    }
}
