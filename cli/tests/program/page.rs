//! `--html`: what the page holds is what was computed, whole and safe; what it shows is held by `cargo xtask page`.

use std::collections::HashMap;
use std::fs;
use std::io::Read;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use serde_json::Value;

use crate::support::{UNIT_BOX, fails, inputs, json, laguerre, runs};

/// What stands between two texts.
fn between<'a>(text: &'a str, before: &str, after: &str) -> &'a str {
    let from = text.find(before).unwrap_or_else(|| panic!("no {before}")) + before.len();
    &text[from..from + text[from..].find(after).unwrap()]
}

fn meta(page: &str) -> Value {
    serde_json::from_str(between(page, "<script type=\"application/json\" id=\"meta\">", "</script>")).unwrap()
}

/// A state's cells, as the page's script reads them.
struct Cells {
    site: Vec<u32>,
    position: Vec<[f64; 3]>,
    barycenter: Vec<[f64; 3]>,
    fields: Vec<Vec<f64>>,
    status: Vec<u8>,
    points: Vec<[f64; 3]>,
    faces: Vec<Face>,
}

struct Face {
    cell: usize,
    beyond: Option<usize>,
    corners: Vec<usize>,
    /// Whether the edge from a corner to the next is none between facets.
    soft: Vec<bool>,
}

fn cells(page: &str, meta: &Value, index: usize) -> Cells {
    let text = between(page, &format!("id=\"block-{index}\">"), "</script>");
    let mut bytes = Vec::new();
    ZlibDecoder::new(&STANDARD.decode(text).unwrap()[..]).read_to_end(&mut bytes).unwrap();
    let state = &meta["states"][index];
    let count = |name: &str| state[name].as_u64().unwrap() as usize;
    let n = count("cells");
    let mut rest = &bytes[..];
    let mut take = |length: usize| {
        let (taken, left) = rest.split_at(length);
        rest = left;
        taken.to_vec()
    };
    let floats = |bytes: Vec<u8>| -> Vec<f64> {
        bytes.chunks(4).map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap()))).collect()
    };
    let number = |value: &Value| value.as_f64().unwrap();
    let (lo, size) = ([0, 1, 2].map(|k| number(&meta["lo"][k])), number(&meta["size"]));
    let placed = |x: &[f64]| [0, 1, 2].map(|k| lo[k] + size * x[k]);
    let site = take(4 * n).chunks(4).map(|b| u32::from_le_bytes(b.try_into().unwrap())).collect();
    let position = floats(take(12 * n)).chunks(3).map(placed).collect();
    let barycenter = floats(take(12 * n)).chunks(3).map(placed).collect();
    let scales = meta["fields"].as_array().unwrap().iter().map(|field| number(&field["scale"]));
    let fields = scales.map(|scale| floats(take(4 * n)).iter().map(|x| x * scale).collect()).collect();
    let status = take(n);
    let p = count("points");
    let planes = take(9 * p);
    let step =
        |i: usize, k: usize| (0..3).map(|byte| u32::from(planes[(3 * k + byte) * p + i]) << (8 * byte)).sum::<u32>();
    let points = (0..p).map(|i| placed(&[0, 1, 2].map(|k| f64::from(step(i, k)) / f64::from(0xff_ffff)))).collect();
    let streams = [0, 1, 2, 3].map(|k| take(state["streams"][k].as_u64().unwrap() as usize));
    assert!(rest.is_empty());
    let mut streams = streams.map(|stream| numbers(&stream).into_iter());
    let (mut faces, mut known) = (Vec::new(), 0);
    for cell in 0..n {
        for _ in 0..streams[0].next().unwrap() {
            let beyond = streams[1].next().unwrap();
            let (mut corners, mut soft) = (Vec::new(), Vec::new());
            for _ in 0..streams[2].next().unwrap() {
                let code = streams[3].next().unwrap();
                corners.push(if code < 2 { known } else { known - code / 2 });
                known += usize::from(code < 2);
                soft.push(code % 2 == 1);
            }
            faces.push(Face { cell, beyond: (beyond > 0).then_some(cell + beyond), corners, soft });
        }
    }
    assert!(streams.iter_mut().all(|stream| stream.next().is_none()));
    assert_eq!((faces.len(), known), (count("faces"), p));
    Cells { site, position, barycenter, fields, status, points, faces }
}

/// Whole numbers in seven bits a byte.
fn numbers(stream: &[u8]) -> Vec<usize> {
    let (mut numbers, mut number, mut shift) = (Vec::new(), 0, 0);
    for byte in stream {
        number |= usize::from(byte & 0x7f) << shift;
        shift += 7;
        if byte & 0x80 == 0 {
            numbers.push(number);
            (number, shift) = (0, 0);
        }
    }
    numbers
}

impl Cells {
    /// The volume that the faces of each cell enclose.
    fn enclosed(&self) -> Vec<f64> {
        let mut volumes = vec![0.0; self.site.len()];
        for Face { cell, beyond, corners, .. } in &self.faces {
            for pair in corners[1..].windows(2) {
                let [a, b, c] = [corners[0], pair[0], pair[1]].map(|corner| self.points[corner]);
                let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
                let volume = (a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1)) / 6.0;
                volumes[*cell] += volume;
                // From the other side it is turned.
                beyond.iter().for_each(|&other| volumes[other] -= volume);
            }
        }
        volumes
    }
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

/// Rows of numbers of a CSV file.
fn rows(text: &str) -> Vec<Vec<f64>> {
    text.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect()
}

#[test]
fn the_page_has_the_cells_that_were_computed() {
    let folder = inputs();
    let folder = folder.path();
    for (sites, domain) in [("white.xyz", "--box"), ("strong.xyz", "--box"), ("strong.xyz", "--domain")] {
        let container = if domain == "--box" { UNIT_BOX } else { "cube.off" };
        runs(folder, &["integrate", sites, domain, container, "-o", "c.csv", "--html", "c.html", "--facets", "f.csv"]);
        let page = read(folder, "c.html");
        let meta = meta(&page);
        let cells = cells(&page, &meta, 0);
        let rows = rows(&read(folder, "c.csv"));
        let given: Vec<Vec<f64>> = read(folder, sites)
            .lines()
            .map(|line| line.split_whitespace().map(|x| x.parse().unwrap()).collect())
            .collect();
        assert_eq!(cells.site.len(), rows.iter().filter(|row| row[1] > 0.0).count());
        let enclosed = cells.enclosed();
        for (c, &site) in cells.site.iter().enumerate() {
            let (row, given) = (&rows[site as usize], &given[site as usize]);
            let close = |x: f64, y: f64, off: f64| assert!((x - y).abs() <= off, "{sites} {domain} {site}: {x} {y}");
            close(cells.fields[0][c], row[1], 1e-7 * row[1]);
            close(cells.fields[1][c], given.get(3).copied().unwrap_or(0.0), 1e-8);
            // Corners are as near as a 24-bit step of the unit cube, on a surface of some hundredths.
            close(enclosed[c], row[1], 1e-8);
            (0..3).for_each(|k| close(cells.position[c][k], given[k], 1e-7));
            (0..3).for_each(|k| close(cells.barycenter[c][k], row[2 + k], 1e-7));
            assert_eq!(f64::from(cells.status[c]), row[6]);
        }
        // Neighbours are those of the facets.
        let mut pairs: Vec<[u32; 2]> = cells
            .faces
            .iter()
            .filter_map(|face| Some([cells.site[face.cell], cells.site[face.beyond?]]))
            .flat_map(|[a, b]| [[a, b], [b, a]])
            .collect();
        pairs.sort_unstable();
        pairs.dedup();
        let facets = self::rows(&read(folder, "f.csv"));
        // What has no area to speak of may be a point in either.
        let has_area =
            facets.iter().filter(|row| row[1] >= 0.0 && row[2] > 1e-12).map(|row| [row[0] as u32, row[1] as u32]);
        has_area.for_each(|pair| assert!(pairs.binary_search(&pair).is_ok(), "{pair:?}"));
        assert!(pairs.len() <= facets.iter().filter(|row| row[1] >= 0.0).count());
    }
}

#[test]
fn edges_within_a_facet_are_not_drawn() {
    let folder = inputs();
    let folder = folder.path();
    fs::write(folder.join("two.csv"), "0.25,0.5,0.5\n0.75,0.5,0.5\n").unwrap();
    runs(folder, &["integrate", "two.csv", "--domain", "cube.off", "--html", "c.html"]);
    let page = read(folder, "c.html");
    let cells = cells(&page, &meta(&page), 0);
    // Each edge of a cell that is drawn is one where its two faces are not both of the surface.
    let mut beyond: HashMap<(usize, usize, usize), Vec<Option<usize>>> = HashMap::new();
    let edge = |cell: usize, a: usize, b: usize| (cell, a.min(b), a.max(b));
    for Face { cell, beyond: other, corners, .. } in &cells.faces {
        for owner in [Some(*cell), *other].into_iter().flatten() {
            for (k, &a) in corners.iter().enumerate() {
                beyond.entry(edge(owner, a, corners[(k + 1) % corners.len()])).or_default().push(*other);
            }
        }
    }
    let mut drawn = 0;
    for Face { cell, corners, soft, .. } in &cells.faces {
        for (k, &a) in corners.iter().enumerate() {
            let others = &beyond[&edge(*cell, a, corners[(k + 1) % corners.len()])];
            assert_eq!((others.len(), others[0] == others[1]), (2, soft[k]), "{cell}");
            drawn += usize::from(!soft[k]);
        }
    }
    // The square between the cells (once), and on each side the same edges of the surface.
    assert!(drawn >= 12, "{drawn}");
}

#[test]
fn the_page_is_one_file_that_asks_for_nothing() {
    let folder = inputs();
    let folder = folder.path();
    runs(folder, &["integrate", "white.xyz", "--box", UNIT_BOX, "--html", "c.html"]);
    let page = read(folder, "c.html");
    assert!(page.contains("default-src 'none'") && page.contains("Permission is hereby granted, free of charge"));
    // three.js can load files, if it is asked to.
    let own = page.replace(include_str!("../../../page/src/three.min.js"), "");
    assert!(own.len() + 500_000 < page.len());
    for asks in ["src=", "@import", "url(", "import(", "fetch(", "XMLHttpRequest", "href=\"http"] {
        assert!(!own.contains(asks), "{asks}");
    }
    for piece in ["@title", "@style", "@licence", "@three", "@script", "@meta", "@blocks"] {
        assert!(!own.lines().any(|line| line.trim() == piece), "{piece}");
    }
    let output = laguerre(folder, &["integrate", "white.xyz", "--box", UNIT_BOX, "--html", "-"]);
    let printed = String::from_utf8(output.stdout).unwrap();
    assert_eq!(between(&printed, "id=\"block-0\">", "<"), between(&page, "id=\"block-0\">", "<"));
    assert!(printed.ends_with("</html>\n") && String::from_utf8_lossy(&output.stderr).contains("relative error"));
    // The figures are those of --json.
    let report = json(&runs(folder, &["integrate", "white.xyz", "--box", UNIT_BOX, "--html", "c.html", "--json"]));
    let facts = meta(&read(folder, "c.html"))["facts"].to_string();
    assert!(facts.contains(&report["volume_sum"].to_string()) && facts.contains("2,000"), "{facts}");
    assert!(facts.contains("laguerre integrate white.xyz --box 0,0,0,1,1,1 --html c.html --json"), "{facts}");
}

/// Cells of a density have no geometry: said before anything is computed.
#[test]
fn a_page_of_a_density_is_refused_at_once() {
    let folder = inputs();
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 1, 1), }\n";
    let length = (header.len() as u16).to_le_bytes();
    let image = [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), &1.0_f64.to_le_bytes()].concat();
    fs::write(folder.path().join("image.npy"), image).unwrap();
    for command in ["integrate", "transport", "lloyd"] {
        let given = ["white.xyz", "--image", "image.npy", "--box", UNIT_BOX, "-o", "out.csv", "--html", "c.html"];
        let line = fails(folder.path(), 2, &[&[command][..], &given].concat());
        assert!(line.starts_with("--html: the cells of a domain with a density"), "{line}");
    }
}

#[cfg(unix)]
#[test]
fn names_of_files_are_no_markup() {
    let folder = inputs();
    let folder = folder.path();
    let name = "<!--<script>&\"'.xyz";
    fs::copy(folder.join("white.xyz"), folder.join(name)).unwrap();
    runs(folder, &["integrate", name, "--box", UNIT_BOX, "--html", "c.html"]);
    let page = read(folder, "c.html");
    assert!(!page.contains("<!--<"));
    assert!(page.contains("Cells of &lt;!--&lt;script&gt;&amp;&quot;'.xyz"));
    let meta = meta(&page);
    assert_eq!(meta["title"], format!("Cells of {name}"));
    let facts = meta["facts"].as_array().unwrap();
    let command = facts.iter().find(|fact| fact[0] == "command").unwrap()[1].as_str().unwrap();
    assert!(command.starts_with("laguerre integrate '<!--<script>&\"'\\''.xyz' --box 0"), "{command}");
}

#[test]
fn runs_have_their_states_and_their_curve() {
    let folder = inputs();
    let folder = folder.path();
    let of_run = |args: &[&str]| {
        let report = json(&runs(folder, &[args, &["--box", UNIT_BOX, "--html", "r.html", "--json"]].concat()));
        let page = read(folder, "r.html");
        let meta = meta(&page);
        let states = meta["states"].as_array().unwrap().len();
        let history = report["history"].as_array().unwrap().clone();
        assert_eq!(meta["plot"]["values"].as_array().unwrap().len(), history.len());
        assert_eq!(meta["states"][states - 1]["row"], history.len() - 1);
        let cells: Vec<(usize, Cells)> = (0..states)
            .map(|k| (meta["states"][k]["row"].as_u64().unwrap() as usize, cells(&page, &meta, k)))
            .collect();
        (meta, history, cells)
    };
    let (meta, history, cells) = of_run(&["transport", "white.xyz"]);
    for (row, cells) in cells {
        // The state is that of the row: its volumes are as far from equal as the residual says, but for digits of 32 bits.
        let worst = cells.fields[0].iter().map(|volume| (2000.0 * volume - 1.0).abs()).fold(0.0, f64::max);
        let residual = history[row]["residual"].as_f64().unwrap();
        assert!((worst - residual).abs() < 1e-6 * (1.0 + residual), "{row}: {worst} {residual}");
        assert_eq!(meta["plot"]["values"][row], history[row]["residual"]);
    }
    for method in ["lbfgs", "lloyd"] {
        let (_, history, cells) = of_run(&["lloyd", "white.xyz", "--method", method, "--tolerance", "0.06"]);
        for (row, cells) in cells {
            let distance2 =
                |c: usize| (0..3).map(|k| (cells.position[c][k] - cells.barycenter[c][k]).powi(2)).sum::<f64>();
            let sum: f64 = (0..2000).map(|c| cells.fields[0][c] * distance2(c)).sum();
            let gradient = sum.sqrt() / 2000_f64.powf(-1.0 / 3.0);
            let expected = history[row]["gradient"].as_f64().unwrap();
            assert!((gradient - expected).abs() < 1e-4, "{method} {row}: {gradient} {expected}");
        }
    }
}

#[test]
fn a_fluid_has_the_times_of_its_frames() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let run = ["fluid", "rayleigh-taylor", "--particles", "300", "--steps", "7", "--every", "3"];
    let report = json(&runs(folder, &[&run[..], &["--html", "f.html", "--json", "--checkpoint", "f.fluid"]].concat()));
    let page = read(folder, "f.html");
    let meta = meta(&page);
    let rows: Vec<u64> =
        meta["states"].as_array().unwrap().iter().map(|state| state["row"].as_u64().unwrap()).collect();
    assert_eq!(rows, [0, 3, 6, 7], "every third step, and the last");
    for step in 1..=7 {
        assert_eq!(meta["plot"]["values"][step], report["history"][step - 1]["kinetic"]);
    }
    assert_eq!(meta["first"], "density");
    for k in 0..4 {
        let cells = cells(&page, &meta, k);
        let mean = cells.fields[0].iter().sum::<f64>() / cells.site.len() as f64;
        assert!(cells.fields[0].iter().all(|volume| (volume / mean - 1.0).abs() < 2e-6));
        assert!(cells.fields[3].iter().all(|density| [1.0, 3.0].contains(density)));
    }
    runs(folder, &["fluid", "--resume", "f.fluid", "--steps", "9", "--html", "g.html"]);
    let label = self::meta(&read(folder, "g.html"))["states"][0]["label"].as_str().unwrap().to_owned();
    assert!(label.starts_with("step 7, time "), "{label}");
}

#[test]
fn what_cannot_be_a_page_is_said_before_the_work() {
    let folder = inputs();
    let wrong = |args: &[&str]| fails(folder.path(), 2, args);
    for command in ["integrate", "lloyd", "transport"] {
        let run = |args: &[&str]| wrong(&[&[command, "white.xyz", "--box", UNIT_BOX], args].concat());
        assert_eq!(run(&["--html", "c.pdf"]), "c.pdf: unknown ending '.pdf'; known here: .html, .htm");
        assert_eq!(
            run(&["--html", "-", "--json"]),
            "-: --json prints to standard output, too; name a file for the results"
        );
        assert_eq!(
            run(&["--html", "-", "-o", "-"]),
            "-: named for two outputs, but standard output is one; name a file"
        );
        assert!(run(&["--html", "no/c.html"]).contains("there is no folder 'no'"));
    }
    assert_eq!(
        wrong(&["fluid", "beltrami", "--html", "-", "--json"]),
        "-: --json prints to standard output, too; name a file for the results"
    );
    assert!(wrong(&["fluid", "beltrami", "--html", "a.gif"]).contains("known here: .html, .htm"));
    let many = "0,0,0\n1,1,1\n".repeat(500_001);
    fs::write(folder.path().join("many.csv"), many).unwrap();
    assert_eq!(
        wrong(&["integrate", "many.csv", "--html", "c.html"]),
        "--html: 1,000,002 sites, and a browser opens a page of 1,000,000 at most; write .vtu for ParaView with integrate -o"
    );
}
