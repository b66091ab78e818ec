//! The main job: from validated arrays in memory to results in memory, site sorting included, facets off. Distribution × number of
//! sites × container × backend; `laguerre bench` prints the same as a table.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use laguerre::{Backend, Domain, PowerDiagram, Request, Selection};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const BUNNY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures/meshes/bunny.obj");
/// Sites along each axis of a lattice; other distributions have as many.
const SIZES: [usize; 2] = [22, 46];
/// Lloyd steps of blue noise: the volumes then vary by some 10 %.
const LLOYD_STEPS: usize = 15;

fn integrate(c: &mut Criterion) {
    let domain = Domain::load(BUNNY).expect("the bunny is a domain");
    let (lo, hi) = domain.bounding_box();
    let backends = backends();
    let mut group = c.benchmark_group("integrate");
    group.sample_size(10);
    for n in SIZES {
        let white = white(n * n * n);
        let distributions = [
            ("blue", relaxed(white.clone(), backends[0].1.as_ref())),
            ("white", white),
            ("perturbed", lattice(n, 0.5)),
            ("lattice", lattice(n, 0.0)),
        ];
        for (name, sites) in &distributions {
            let placed = |p: &[f64; 3]| std::array::from_fn(|k| lo[k] + (hi[k] - lo[k]) * p[k]);
            let sites: Vec<[f64; 3]> = sites.iter().map(placed).collect();
            let sites = PowerDiagram::new(&sites, &[]).expect("points in a box are sites");
            let boxed = sites.clone().in_box(lo, hi).expect("the bunny's box is a box");
            for (container, diagram) in [("box", boxed), ("bunny", sites.restricted_to(&domain))] {
                let count = diagram.positions().len();
                group.throughput(Throughput::Elements(count as u64));
                for (backend_name, backend) in &backends {
                    let id = BenchmarkId::new(format!("{name}-{container}-{count}"), backend_name);
                    group.bench_with_input(id, &diagram, |b, diagram| {
                        b.iter(|| backend.evaluate(diagram, &Request::moments()).expect("the backend computes"));
                    });
                }
            }
        }
    }
    group.finish();
}

/// The CPU with one thread and with all, and the OpenCL devices where they were built and are there.
fn backends() -> Vec<(String, Box<dyn Backend>)> {
    let cpu = |threads| laguerre::open(Selection::Cpu { threads }).expect("the CPU is there");
    let all = cpu(None);
    let mut backends =
        vec![(format!("cpu-{}-threads", all.info().threads), all), ("cpu-1-thread".to_owned(), cpu(Some(1)))];
    if let Ok(ocl) =
        laguerre::open(Selection::Ocl { devices: laguerre::DeviceChoice::First, precision: laguerre::Precision::F64 })
    {
        backends.push(("ocl".to_owned(), ocl));
    }
    backends
}

/// Random points in the unit cube.
fn white(count: usize) -> Vec<[f64; 3]> {
    let mut unit = random();
    (0..count).map(|_| std::array::from_fn(|_| unit())).collect()
}

/// Points moved to the barycenters of their cells in the unit cube, again and again.
fn relaxed(mut points: Vec<[f64; 3]>, backend: &dyn Backend) -> Vec<[f64; 3]> {
    for _ in 0..LLOYD_STEPS {
        let diagram = PowerDiagram::new(&points, &[]).and_then(|diagram| diagram.in_box([0.0; 3], [1.0; 3]));
        let diagram = diagram.expect("points in a box are sites");
        points =
            backend.evaluate(&diagram, &Request::moments()).expect("the backend computes").into_arrays().barycenter;
    }
    points
}

/// The centers of `n`³ voxels of the unit cube, where every vertex is met by eight cells; each moved by up to half of `jitter` voxels.
fn lattice(n: usize, jitter: f64) -> Vec<[f64; 3]> {
    let mut unit = random();
    let mut at = |i: usize| (i as f64 + 0.5 + jitter * (unit() - 0.5)) / n as f64;
    (0..n * n * n).map(|i| [at(i % n), at(i / n % n), at(i / n / n)]).collect()
}

/// Numbers uniform in [0, 1), the same for all time.
fn random() -> impl FnMut() -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    move || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

criterion_group!(benches, integrate);
criterion_main!(benches);
