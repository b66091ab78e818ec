//! The loop of every user: evaluating again with sites that moved a little. From the second evaluation on nothing is allocated or compiled,
//! and no more than the sites is brought to the device. A test program of its own, as its OpenCL loader is one that notes each
//! call (`backend-ocl/faults`).
#![cfg(feature = "test-util")]

mod loader;

use std::fs;
use std::path::Path;

use laguerre_core::required::is_required;
use laguerre_core::shapes::icosphere;
use laguerre_core::{Backend, DeviceChoice, Domain, ErrorKind, PowerDiagram, Precision, Request, Session};
use laguerre_ocl::Ocl;

const SITES: usize = 3000;

/// Evaluations of each loop.
const STEPS: usize = 8;

/// A write of more bytes is of sites, else of parameters and counters.
const PARAMETERS: usize = 1024;

/// What must not be called again.
const NOT_AGAIN: [&str; 8] = [
    "clCreateContext",
    "clCreateCommandQueue",
    "clCreateCommandQueueWithProperties",
    "clCreateBuffer",
    "clCreateProgramWithSource",
    "clCreateProgramWithBinary",
    "clBuildProgram",
    "clCreateKernel",
];

/// Sites and weights of a step, and what is asked for.
struct Case {
    name: &'static str,
    domain: Option<Domain>,
    sites: fn(usize) -> Vec<[f64; 3]>,
    weights: fn(usize) -> Vec<f64>,
    request: fn() -> Request,
    /// Whether the host sorts, which brings them sorted, too.
    is_crowded: bool,
}

impl Case {
    fn diagram(&self, step: usize) -> PowerDiagram {
        let diagram = PowerDiagram::new(&(self.sites)(step), &(self.weights)(step)).unwrap();
        match &self.domain {
            Some(domain) => diagram.restricted_to(domain),
            None => diagram.in_box([-1.0; 3], [1.0; 3]).unwrap(),
        }
    }

    /// Bytes of the sites, write by write.
    fn bytes(&self) -> Vec<usize> {
        if (self.weights)(0).is_empty() { vec![24 * SITES] } else { vec![24 * SITES, 8 * SITES] }
    }
}

/// Sites that fill a box of this extent, each moved on its own way by this much.
fn sites(extent: [f64; 3], moved: f64) -> Vec<[f64; 3]> {
    let part = |x: f64| 2.0 * x.fract() - 1.0;
    let site = |i: usize| {
        let at = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3];
        let way = [0.380_966_118_717_1, 0.145_138_117_1, 0.724_491_1];
        [0, 1, 2].map(|k| extent[k] * part(0.5 + i as f64 * at[k]) + moved * part(i as f64 * way[k]))
    };
    (0..SITES).map(site).collect()
}

fn no_weights(_: usize) -> Vec<f64> {
    Vec::new()
}

fn moving_weights(step: usize) -> Vec<f64> {
    (0..SITES).map(|i| 1e-3 * (i as f64 * 0.618 + 0.05 * step as f64).fract()).collect()
}

fn everything() -> Request {
    Request::moments().with_facets().with_second_moments()
}

/// The loops: from fluids to optimal transport.
fn cases() -> [Case; 8] {
    let ball = Some(icosphere(3).domain());
    let moving = |step| sites([0.8; 3], 0.02 * step as f64);
    [
        Case {
            name: "a box",
            domain: None,
            sites: moving,
            weights: no_weights,
            request: Request::moments,
            is_crowded: false,
        },
        Case {
            name: "a domain",
            domain: ball.clone(),
            sites: moving,
            weights: no_weights,
            request: everything,
            is_crowded: false,
        },
        Case {
            name: "other weights",
            domain: ball.clone(),
            sites: |_| sites([0.8; 3], 0.0),
            weights: moving_weights,
            request: Request::moments,
            is_crowded: false,
        },
        Case {
            name: "other weights, the Laplacian stays",
            domain: ball,
            sites: |_| sites([0.8; 3], 0.0),
            weights: moving_weights,
            request: || Request::moments().with_laplacian_kept(),
            is_crowded: false,
        },
        Case {
            name: "a box that gets flat",
            domain: None,
            sites: |step| sites([0.8, 0.8, 0.8 - 0.08 * step as f64], 0.01),
            weights: no_weights,
            request: everything,
            is_crowded: false,
        },
        Case {
            name: "coincident at first",
            domain: None,
            sites: |step| {
                let mut sites = sites([0.8; 3], 0.0);
                (step..300).for_each(|i| sites[2 * i] = sites[2 * i + 1]);
                sites
            },
            weights: no_weights,
            request: everything,
            is_crowded: false,
        },
        Case {
            name: "clusters",
            domain: None,
            sites: |step| {
                let mut sites = sites([0.8; 3], 0.001 * step as f64);
                sites[..1000].iter_mut().flatten().for_each(|x| *x = 0.3 + 1e-4 * *x);
                sites
            },
            weights: no_weights,
            request: everything,
            is_crowded: false,
        },
        Case {
            name: "a thousand sites nearer to each other than the device tells",
            domain: None,
            sites: |step| {
                let mut sites = sites([0.8; 3], 0.001 * step as f64);
                sites[..1000].iter_mut().flatten().for_each(|x| *x = 0.3 + 1e-9 * *x);
                sites
            },
            weights: no_weights,
            request: everything,
            is_crowded: true,
        },
    ]
}

/// The calls since the last look: function and bytes.
fn calls(log: &Path) -> Vec<(String, usize)> {
    let text = fs::read_to_string(log).unwrap();
    fs::write(log, "").unwrap();
    let call = |line: &str| line.split_once(' ').map(|(name, bytes)| (name.to_owned(), bytes.parse().unwrap()));
    text.lines().map(|line| call(line).unwrap()).collect()
}

/// What is wrong with a loop whose sites stay on the device: from its second step on no more than parameters, counters and the marks of voxels, of which there
/// are a few sites to each, is brought there or back; and nothing is made from the third on (the second is the first that moves).
fn what_a_loop_moves(log: &Path) -> Vec<String> {
    let backend = Ocl::new(&DeviceChoice::First, Precision::F64).unwrap();
    let mut wrong = Vec::new();
    let ball = icosphere(3).domain();
    let diagram = PowerDiagram::new(&sites([0.8; 3], 0.02), &moving_weights(1)).unwrap();
    for mut diagram in [diagram.clone().restricted_to(&ball), diagram.in_box([-1.0; 3], [1.0; 3]).unwrap()] {
        let mut session = Session::new(&backend, &mut diagram, Request::moments().with_second_moments()).unwrap();
        for step in 0..STEPS {
            assert!(session.evaluate().unwrap().volume > 4.0);
            session.move_to_barycenters().unwrap();
            let calls = calls(log);
            let is_large = |name: &str, bytes: usize| match name {
                "clEnqueueWriteBuffer" => bytes > PARAMETERS,
                "clEnqueueReadBuffer" => bytes > 4 * SITES,
                _ => step > 1 && NOT_AGAIN.contains(&name),
            };
            let large: Vec<_> = calls.iter().filter(|(name, bytes)| is_large(name, *bytes)).collect();
            if step > 0 && !large.is_empty() {
                wrong.push(format!("sites that stay, step {step}: {large:?}"));
            }
        }
    }
    wrong
}

/// What is wrong where weights alone are others: positions that were brought last are not brought again, nor put in order, nor those of another diagram taken for them; and cells are those of a backend that
/// has not seen any before, also of coincident sites, where weights say which has one.
fn what_other_weights_bring(log: &Path) -> Vec<String> {
    let open = || Ocl::new(&DeviceChoice::First, Precision::F64).unwrap();
    let (backend, plain) = (open(), open());
    let of = |positions: &[[f64; 3]], step| {
        PowerDiagram::new(positions, &moving_weights(step)).unwrap().in_box([-1.0; 3], [1.0; 3]).unwrap()
    };
    let mut coincident = sites([0.8; 3], 0.01);
    (0..100).for_each(|i| coincident[2 * i] = coincident[2 * i + 1]);
    let mut diagrams = [sites([0.8; 3], 0.0), sites([0.8; 3], 0.02), coincident].map(|sites| of(&sites, 0));
    let mut launches = Vec::new();
    let mut wrong = Vec::new();
    let (all, weights) = (&[24 * SITES, 8 * SITES][..], &[8 * SITES][..]);
    let steps = [(0, all), (0, weights), (1, all), (0, all), (0, weights), (2, all), (2, weights)];
    for (step, (which, expected)) in steps.into_iter().enumerate() {
        let diagram = &mut diagrams[which];
        diagram.set_weights(&moving_weights(step)).unwrap();
        calls(log);
        let found = backend.evaluate(diagram, &Request::moments()).unwrap();
        let calls = calls(log);
        launches.push(calls.iter().filter(|(name, _)| name == "clEnqueueNDRangeKernel").count());
        let writes = calls.into_iter().filter(|(name, bytes)| name == "clEnqueueWriteBuffer" && *bytes > PARAMETERS);
        let writes: Vec<usize> = writes.map(|(_, bytes)| bytes).collect();
        let same = plain.evaluate(&of(diagram.positions(), step), &Request::moments()).unwrap();
        // (A backend that has just been opened brings its tables, too.)
        if found.volume() != same.volume() || (step > 0 && writes != expected) {
            wrong.push(format!("other weights, step {step}: writes {writes:?}"));
        }
    }
    // (Ordering sites takes more than ten launches; those of cells are as many, or nearly.)
    if [1, 4].iter().any(|&step| launches[step] + 10 > launches[3]) || launches[6] + 10 < launches[5] {
        wrong.push(format!("other weights: launches {launches:?}"));
    }
    wrong
}

#[test]
fn nothing_is_made_or_brought_twice() {
    let Some(log) = loader::begin("calls", "") else { return };
    let mut wrong = Vec::new();
    for case in cases() {
        let backend = match Ocl::new(&DeviceChoice::First, Precision::F64) {
            Err(error) if error.kind() == ErrorKind::Unavailable && !is_required("ocl") => {
                eprintln!("not run: {error}");
                return;
            }
            opened => opened.unwrap(),
        };
        for step in 0..STEPS {
            let output = backend.evaluate(&case.diagram(step), &(case.request)()).unwrap();
            assert!(output.volume().iter().sum::<f64>() > 4.0);
            let calls = calls(&log);
            let writes = calls.iter().filter(|(name, bytes)| name == "clEnqueueWriteBuffer" && *bytes > PARAMETERS);
            let writes: Vec<usize> = writes.map(|&(_, bytes)| bytes).collect();
            let made: Vec<_> = calls.iter().filter(|(name, _)| NOT_AGAIN.contains(&name.as_str())).collect();
            if step == 0 {
                // That the calls are noted at all.
                assert!(made.iter().any(|(name, bytes)| name == "clCreateBuffer" && *bytes >= 24 * SITES), "{made:?}");
                assert!(case.domain.is_none() || writes.len() > case.bytes().len() + 1, "{writes:?}");
            } else if !made.is_empty() || (writes != case.bytes() && !case.is_crowded) {
                wrong.push(format!("{}, step {step}: calls {made:?}, writes {writes:?}", case.name));
            }
        }
    }
    wrong.extend(what_a_loop_moves(&log));
    wrong.extend(what_other_weights_bring(&log));
    let _ = fs::remove_file(&log);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
