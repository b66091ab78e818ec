//! The main job on the CPU: from validated arrays in memory to results in memory, site sorting included. Facets off.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use laguerre::{Domain, PowerDiagram, Request, Selection};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const BUNNY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures/meshes/bunny.obj");
const SITES: usize = 100_000;

fn integrate(c: &mut Criterion) {
    let domain = Domain::load(BUNNY).expect("the bunny is a domain");
    domain.grid();
    let (lo, hi) = domain.bounding_box();
    let sites = PowerDiagram::new(&white(lo, hi), &[]).expect("random points are sites");
    let boxed = sites.clone().in_box(lo, hi).expect("the bunny's box is a box");
    let lattice = PowerDiagram::new(&lattice_points(46), &[]).expect("a lattice is sites");
    let lattice = lattice.in_box([0.0; 3], [1.0; 3]).expect("the unit box is a box");
    let inputs = [("white-bunny", sites.restricted_to(&domain)), ("white-box", boxed), ("lattice-box", lattice)];

    let mut group = c.benchmark_group("integrate");
    group.sample_size(10);
    for (name, diagram) in &inputs {
        group.throughput(Throughput::Elements(diagram.positions().len() as u64));
        for threads in [1, 2] {
            let backend = laguerre::open(Selection::Cpu { threads: Some(threads) }).expect("the CPU is there");
            let id = BenchmarkId::new(*name, format!("cpu-{threads}-threads"));
            group.bench_with_input(id, diagram, |b, diagram| {
                b.iter(|| backend.evaluate(diagram, &Request::moments()).expect("the CPU computes"));
            });
        }
    }
    group.finish();
}

/// `SITES` random points in a box.
fn white(lo: [f64; 3], hi: [f64; 3]) -> Vec<[f64; 3]> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut uniform = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    (0..SITES).map(|_| std::array::from_fn(|k| lo[k] + (hi[k] - lo[k]) * uniform())).collect()
}

/// The centers of `n`³ voxels of the unit cube: every vertex is met by eight cells.
fn lattice_points(n: usize) -> Vec<[f64; 3]> {
    let at = |i: usize| (i as f64 + 0.5) / n as f64;
    (0..n * n * n).map(|i| [at(i % n), at(i / n % n), at(i / n / n)]).collect()
}

criterion_group!(benches, integrate);
criterion_main!(benches);
