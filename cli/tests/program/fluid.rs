//! `laguerre fluid`.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::support::{fails, inputs, json, laguerre, notes, runs};

fn report(folder: &Path, args: &[&str]) -> Value {
    let mut all = vec!["fluid"];
    all.extend_from_slice(args);
    all.push("--json");
    json(&runs(folder, &all))
}

#[test]
fn a_scene_flows_and_is_filmed() {
    let folder = tempfile::tempdir().unwrap();
    let args = [
        "rayleigh-taylor",
        "--particles",
        "300",
        "--steps",
        "4",
        "--every",
        "2",
        "--out-dir",
        "out",
        "--frames",
        "vtu,ply,png",
        "--film",
        "film.gif",
        "--width",
        "200",
    ];
    let found = report(folder.path(), &args);
    assert_eq!((&found["scene"], &found["steps"]), (&"rayleigh-taylor".into(), &4.into()));
    assert!(found["residual"].as_f64().unwrap() <= 1e-6 && found["iterations"].as_u64().unwrap() > 0, "{found}");
    assert!(found["hamiltonian_drift"].as_f64().unwrap() < 0.02 && found["seconds"].as_f64() > Some(0.0), "{found}");
    let rows = found["history"].as_array().unwrap();
    assert_eq!(rows.len(), 4);
    assert!(rows[3]["kinetic"].as_f64() > rows[0]["kinetic"].as_f64());
    let particles = found["particles"].as_u64().unwrap() as usize;
    for step in ["000000", "000002", "000004"] {
        let read = |ending: &str| fs::read(folder.path().join(format!("out/frame-{step}.{ending}"))).unwrap();
        assert!(read("png").starts_with(b"\x89PNG"));
        let ply = read("ply");
        let header = ply.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
        assert_eq!(ply.len() - header, particles * 8 * 8);
        // Eleven numbers, two indices and a byte a particle, and a length before each of seven arrays.
        let vtu = read("vtu");
        let data = vtu.windows(2).position(|w| w == b"\n_").unwrap() + 2;
        let end = "\n</AppendedData>\n</VTKFile>\n".len();
        assert_eq!(vtu.len() - data - end, 7 * 8 + particles * (8 * 8 + 2 * 8 + 1));
    }
    // The times of the frames, for ParaView.
    let series = fs::read_to_string(folder.path().join("out/frames.pvd")).unwrap();
    let times: Vec<f64> =
        series.split("timestep=\"").skip(1).map(|s| s.split('"').next().unwrap().parse().unwrap()).collect();
    assert!(times.len() == 3 && times[0] == 0.0 && times[0] < times[1] && times[1] < times[2], "{series}");
    assert_eq!(Some(times[2]), found["time"].as_f64());
    for step in ["000000", "000002", "000004"] {
        assert!(series.contains(&format!("file=\"frame-{step}.vtu\"/>")), "{series}");
    }
    let film = fs::read(folder.path().join("film.gif")).unwrap();
    let mut film = gif::DecodeOptions::new().read_info(film.as_slice()).unwrap();
    let mut frames = 0;
    while film.read_next_frame().unwrap().is_some() {
        frames += 1;
    }
    assert_eq!((frames, film.width()), (3, 200));
}

#[test]
fn going_on_from_a_checkpoint_gives_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    for (scene, more) in [("taylor-green", "--viscosity=1e-3"), ("snow-globe", "--seed=5")] {
        let run = |args: &[&str]| report(folder.path(), args);
        run(&[scene, more, "--particles", "216", "--steps", "5", "--checkpoint", "whole.fluid"]);
        run(&[scene, more, "--particles", "216", "--steps", "2", "--checkpoint", "half.fluid"]);
        let half = fs::read(folder.path().join("half.fluid")).unwrap();
        let found = run(&["--resume", "half.fluid", "--steps", "5", "--checkpoint", "half.fluid", "--threads", "1"]);
        assert_eq!((&found["steps"], found["history"].as_array().unwrap().len()), (&5.into(), 3));
        let [whole, resumed] = ["whole.fluid", "half.fluid"].map(|name| fs::read(folder.path().join(name)).unwrap());
        assert!(whole == resumed && whole != half, "{scene}");
    }
}

#[test]
fn a_mesh_may_hold_the_fluid() {
    let folder = inputs();
    let args = ["dam-break", "--domain", "cube.off", "--particles", "100", "--steps", "1", "--out-dir", "out"];
    assert!(report(folder.path(), &args)["residual"].as_f64().unwrap() <= 1e-6);
    assert!(folder.path().join("out/frame-000000.png").exists());
    let said = notes(folder.path(), &["fluid", "beltrami", "--particles", "30", "--steps", "0"]);
    assert_eq!(
        said,
        [
            "27 particles, as near to 30 as a lattice comes in this box",
            "only energies are printed; name --film, --html, --out-dir or --checkpoint to keep the motion"
        ]
    );
}

#[cfg(target_os = "linux")]
#[test]
fn an_interrupt_ends_the_step_and_can_be_gone_on_from() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let checkpoint = || folder.join("b.fluid").exists();
    let scene = ["fluid", "beltrami", "--particles", "216", "--every", "1"];
    let args = [&scene[..], &["--steps", "100000", "--film", "b.gif", "--checkpoint", "b.fluid"]].concat();
    let output = crate::outputs::interrupted(folder, "-INT", &args, checkpoint);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{errors}");
    let line = errors.lines().last().unwrap();
    assert!(
        line.starts_with("laguerre: interrupted after step ") && line.ends_with("--resume b.fluid goes on"),
        "{line}"
    );
    let steps: u64 = line.split_whitespace().nth(4).unwrap().trim_end_matches(';').parse().unwrap();
    assert!(fs::read(folder.join("b.gif")).unwrap().starts_with(b"GIF89a"));
    let names: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names.len(), 2, "{names:?}");
    let end = (steps + 2).to_string();
    let on = report(folder, &["--resume", "b.fluid", "--steps", &end, "--checkpoint", "b.fluid"]);
    assert_eq!(on["steps"], steps + 2);
    // As if there had been no interrupt.
    report(folder, &[&scene[1..], &["--steps", &end, "--checkpoint", "a.fluid"]].concat());
    let [a, b] = ["a.fluid", "b.fluid"].map(|name| fs::read(folder.join(name)).unwrap());
    assert!(a == b);
}

#[test]
fn bad_input_is_said_in_one_line() {
    let folder = inputs();
    let wrong = |args: &[&str]| fails(folder.path(), 2, &[&["fluid"], args].concat());
    assert!(wrong(&[]).contains("<SCENE>"));
    assert!(wrong(&["ocean"]).contains("'ocean'"));
    assert!(wrong(&["beltrami", "--particles", "1"]).contains('1'));
    assert!(wrong(&["beltrami", "--dt", "0"]).contains("above 0"));
    assert!(wrong(&["beltrami", "--epsilon", "-1"]).contains("above 0"));
    assert!(wrong(&["beltrami", "--viscosity", "-1"]).contains("from 0 to 1e60 is needed"));
    assert!(wrong(&["beltrami", "--epsilon", "1e300"]).contains("from 1e-60 to 1e60, is needed"));
    assert!(wrong(&["beltrami", "--gravity", "nan"]).contains("a number within ±1e60"));
    assert!(wrong(&["beltrami", "--gravity", "1e61"]).contains("a number within ±1e60"));
    assert!(wrong(&["beltrami", "--every", "0"]).contains('0'));
    let said = notes(folder.path(), &["fluid", "beltrami", "--particles", "27", "--steps", "0", "--gravity", "2"]);
    assert!(said.contains(&"beltrami has one density: gravity moves nothing there".into()), "{said:?}");
    assert!(wrong(&["beltrami", "--frames", "png"]).contains("--out-dir"));
    assert!(wrong(&["beltrami", "--film", "film.mp4"]).contains("known here: .gif"));
    assert!(wrong(&["beltrami", "--checkpoint", "a.bin"]).contains("known here: .fluid"));
    assert!(wrong(&["beltrami", "--domain", "cube.off"]).contains("beltrami is a flow in the unit cube"));
    assert!(wrong(&["snow-globe", "--domain", "none.off"]).contains("none.off: cannot open"));
    assert!(wrong(&["beltrami", "--resume", "a.fluid"]).contains("cannot be used with"));
    assert!(wrong(&["--resume", "a.fluid", "--epsilon", "1"]).contains("cannot be used with"));
    assert!(wrong(&["--resume", "none.fluid"]).contains("none.fluid: cannot read"));
    assert!(wrong(&["--resume", "white.xyz"]).contains("white.xyz: is no checkpoint of laguerre fluid"));
    assert!(wrong(&["beltrami", "--out-dir", "white.xyz"]).contains("white.xyz: cannot make this folder"));
    // Cells that are far apart after one step.
    let line = wrong(&["beltrami", "--particles", "27", "--dt", "1e9", "--json"]);
    assert!(line.starts_with("step 1: "), "{line}");
    let line = wrong(&["beltrami", "--particles", "27", "--dt", "1e60", "--film", "a.gif", "--json"]);
    assert!(line.starts_with("step 1: particle 0 is thrown far out of the container: take smaller"), "{line}");
    assert!(
        wrong(&["beltrami", "--particles", "27", "--epsilon", "1e60", "--json"]).starts_with("particle 0 is thrown")
    );
}

#[test]
fn what_was_before_a_step_that_failed_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // Steps beyond 2ε are not stable.
    let started = ["fluid", "beltrami", "--particles", "64", "--epsilon", "0.02", "--dt", "0.05", "--steps", "40"];
    let output = laguerre(folder, &[&started[..], &["--checkpoint", "a.fluid", "--film", "a.gif", "--json"]].concat());
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(output.stdout.is_empty());
    let line = errors.lines().last().unwrap();
    let failed: u64 = line.split(&[' ', ':']).find_map(|word| word.parse().ok()).unwrap();
    assert!(line.starts_with(&format!("laguerre: step {failed}: ")) && failed > 1, "{errors}");
    assert!(fs::read(folder.join("a.gif")).unwrap().starts_with(b"GIF89a"));
    let on = notes(folder, &["fluid", "--resume", "a.fluid", "--steps", "0"]);
    assert!(
        on.contains(&format!("a.fluid is at step {} already; give --steps beyond that to go on", failed - 1)),
        "{on:?}"
    );
}

#[test]
fn damaged_checkpoints_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    report(folder.path(), &["snow-globe", "--particles", "30", "--steps", "0", "--checkpoint", "a.fluid"]);
    let whole = fs::read(folder.path().join("a.fluid")).unwrap();
    let refused = |bytes: &[u8]| {
        fs::write(folder.path().join("b.fluid"), bytes).unwrap();
        fails(folder.path(), 2, &["fluid", "--resume", "b.fluid", "--steps", "0", "--json"])
    };
    assert!(refused(&whole[..whole.len() - 1]).contains("b.fluid: is damaged: it has "));
    assert!(refused(b"").contains("is no checkpoint"));
    let end = whole.iter().position(|&b| b == b'\n').unwrap();
    let text = |from: &str, to: &str| {
        let header = String::from_utf8(whole[..end].to_vec()).unwrap();
        assert!(header.contains(from), "{header}");
        [header.replace(from, to).as_bytes(), &whole[end..]].concat()
    };
    assert!(refused(&text("\"laguerre_fluid\":1", "\"laguerre_fluid\":2")).contains("form 2"));
    assert!(refused(&text("snow-globe", "soup")).contains("is no checkpoint"));
    assert!(refused(&text("\"particles\":30", "\"particles\":18446744073709551615")).contains("is damaged"));
    assert!(refused(&text("\"steps\":0", "\"steps\":7")).contains("is damaged: its checksum is wrong"));
    // Bits of numbers, of the mesh's indices and of the checksum itself.
    for at in [end + 1, end + 8 * 23, (end + whole.len()) / 2, whole.len() - 20, whole.len() - 1] {
        let mut damaged = whole.clone();
        damaged[at] ^= 1;
        assert!(refused(&damaged).contains("b.fluid: is damaged: its checksum is wrong; go on from another"), "{at}");
    }
    assert_eq!(laguerre(folder.path(), &["fluid", "--resume", "a.fluid", "--steps", "0"]).status.code(), Some(0));
}
