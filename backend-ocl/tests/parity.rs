//! Every generated function gives the host's bits on a device, the first GPU or else the first device: called by a kernel of its own on
//! random arguments, or, where no other module can see it, by one that is. `LAGUERRE_REQUIRE=ocl` makes a missing device a failure.

use std::collections::BTreeMap;
use std::fmt::Write;

use laguerre_core::DeviceChoice;
use laguerre_core::cell::parity::{self, Calls, Function, World};
use laguerre_core::cell::{SIGN_UNKNOWN, UNCERTAIN};
use laguerre_core::required::if_available;
use laguerre_ocl::parity::{Parity, functions};

/// Calls of each function.
const CALLS: usize = 4096;

/// The host decides what a device cannot; of these arguments, made to be hard, that is at most this many.
const MOST_LEFT_TO_THE_HOST: usize = CALLS / 8;

fn open(world: &World, changed: impl Fn(String) -> String) -> Option<Parity> {
    if_available("ocl", Parity::open(&DeviceChoice::First, world, changed))
}

#[test]
fn every_function_gives_the_hosts_bits() {
    let world = World::new();
    let Some(device) = open(&world, |text| text) else { return };
    let mut report = String::new();
    let mut wrong = 0;
    for function in parity::FUNCTIONS {
        let verdict = compare(&device, function, &world);
        wrong += usize::from(verdict.is_err());
        let (Ok(verdict) | Err(verdict)) = verdict;
        let _ = writeln!(report, "{}: {verdict}", function.name);
    }
    println!("{}:\n{report}", device.device());
    assert!(wrong == 0, "{wrong} functions differ on {}:\n{report}", device.device());
}

/// Contraction alone, in one function, changes bits, and is seen.
#[test]
fn a_function_that_rounds_otherwise_is_seen() {
    let world = World::new();
    let contracted = |text: String| text.replace("(a.y * b.z) - (a.z * b.y)", "fma(a.y, b.z, -(a.z * b.y))");
    assert!(contracted(functions()) != functions());
    let Some(device) = open(&world, contracted) else { return };
    let verdict = |name| compare(&device, parity::FUNCTIONS.iter().find(|f| f.name == name).unwrap(), &world);
    assert!(verdict("cross").unwrap_err().contains("differ"));
    assert!(verdict("integrate_cell").unwrap_err().contains("differ"));
    assert!(verdict("dot").is_ok());
}

/// How the host's and the device's results of a function compare.
fn compare(device: &Parity, function: &Function, world: &World) -> Result<String, String> {
    let calls = function.call(world, CALLS);
    let results = device.run(function.name, &calls).unwrap_or_else(|error| panic!("{error}"));
    let width = calls.output_width;
    let (mut left, mut different, mut first) = (0, 0, String::new());
    for (number, (host, device)) in calls.outputs.chunks(width).zip(results.chunks(width)).enumerate() {
        let is_other = |&i: &usize| {
            let allowed = is_bound(function, i, host[i], device[i]) || is_beyond_numbers(function, host[i]);
            host[i] != device[i] && !allowed
        };
        let Some(at) = (0..width).find(is_other) else {
            continue;
        };
        if is_left_to_the_host(function, device) {
            left += 1;
            continue;
        }
        if different == 0 {
            first = describe(&calls, number, at, host[at], device[at]);
        }
        different += 1;
    }
    match (different, left) {
        (0, 0) => Ok(format!("the same bits in {CALLS} calls")),
        (0, 1..=MOST_LEFT_TO_THE_HOST) => Ok(format!("the same bits in {CALLS} calls but {left} left to the host")),
        (0, _) => Err(format!("{left} of {CALLS} calls left to the host")),
        _ => Err(format!("{different} of {CALLS} calls differ; first {first}")),
    }
}

/// Whether a device could not make the cell, or decide a sign or a position of it.
fn is_left_to_the_host(function: &Function, results: &[u64]) -> bool {
    let is_sign = function.name.contains("sign");
    let unknown = if is_sign { SIGN_UNKNOWN as u64 } else { UNCERTAIN.into() };
    function.on_store && (results[0] == u64::from(UNCERTAIN) || results[1] == unknown)
}

/// A device has the distance to the farthest vertex in single precision, but an upper bound none the less.
fn is_bound(function: &Function, word: usize, host: u64, device: u64) -> bool {
    let [host, device] = [host, device].map(f64::from_bits);
    function.name == "farthest_vertex" && word == 1 && device >= host && device <= host * 1.00001
}

/// Where the host's way to the rest of a product overflows (beyond 10¹⁴⁵; the numbers of planes stay far below), the device's does not.
fn is_beyond_numbers(function: &Function, host: u64) -> bool {
    matches!(function.name, "rest_of_product" | "wide_position") && f64::from_bits(host).is_nan()
}

fn describe(calls: &Calls, number: usize, at: usize, host: u64, device: u64) -> String {
    let arguments = &calls.inputs[number * calls.input_width..][..calls.input_width];
    let arguments: Vec<f64> = arguments.iter().map(|&word| f64::from_bits(word)).collect();
    let [a, b] = [host, device].map(f64::from_bits);
    format!(
        "call {number}, word {at}: {host:#x} ({a:?}) on the host, {device:#x} ({b:?}) on the device, of {arguments:?}"
    )
}

/// A function that no other module can see has no kernel of its own, so it must run in that of another.
#[test]
fn every_function_is_covered() {
    let functions = functions();
    let bodies = bodies(&functions);
    assert!(bodies.len() > 80, "{} functions", bodies.len());
    let mut covered: BTreeMap<&str, String> =
        parity::FUNCTIONS.iter().map(|f| (in_c(f.name), "by its own kernel".to_owned())).collect();
    let mut to_do: Vec<&str> = covered.keys().copied().collect();
    while let Some(caller) = to_do.pop() {
        for &name in bodies.keys() {
            if !covered.contains_key(name) && bodies[caller].contains(&format!("{name}(")) {
                covered.insert(name, format!("by {caller}, which calls it"));
                to_do.push(name);
            }
        }
    }
    let missing: Vec<_> = bodies.keys().filter(|name| !covered.contains_key(*name)).collect();
    assert!(missing.is_empty(), "covered by nothing: {missing:?}");
    for (name, how) in covered {
        println!("{name} is covered {how}");
    }
}

/// Names that are others in C.
fn in_c(name: &str) -> &str {
    match name {
        "dot" => "v3_dot",
        "cross" => "v3_cross",
        name => name,
    }
}

/// The functions of a generated text: names and bodies.
fn bodies(text: &str) -> BTreeMap<&str, &str> {
    let mut bodies = BTreeMap::new();
    let parts = text.split("\nINLINE ").flat_map(|part| part.split("\nOUTLINE ")).flat_map(|part| part.split("\nHOT "));
    for part in parts.skip(1) {
        let Some((head, body)) = part.split_once(" {\n") else { continue };
        let name = head.split('(').next().and_then(|words| words.split(' ').next_back());
        let body = body.split("\n}\n").next();
        if let (Some(name), Some(body), false) = (name, body, head.contains(';')) {
            bodies.insert(name, body);
        }
    }
    bodies
}
