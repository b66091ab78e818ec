//! The tree that the device makes over the sites, held to its sites; builds that are made ahead; memory that is given back.

use super::Device;
#[cfg(feature = "test-util")]
use super::cells::Todo;
#[cfg(feature = "test-util")]
use crate::builds::{Lanes, Stage, Way};
use crate::evaluate::Ocl;
#[cfg(feature = "test-util")]
use crate::interface::data::{ALL_TURNS, Counters, FEW_SUMS, MOST_KEPT, OUTCOME_STATUS};
#[cfg(feature = "test-util")]
use crate::platform::DeviceId;
use crate::platform::choose;
use laguerre_core::algebra::Algebra as _;
#[cfg(feature = "test-util")]
use laguerre_core::cell::COMPLETE;
#[cfg(feature = "test-util")]
use laguerre_core::cell::ring::{RINGS, end_of_ring};
#[cfg(feature = "test-util")]
use laguerre_core::cell::search_store::{HAS_PARTS, MOST_LEAVES, OctreeStore as _};
#[cfg(feature = "test-util")]
use laguerre_core::passes::{Capacities, Cells as _};
#[cfg(feature = "test-util")]
use laguerre_core::power_octree::{Home, PowerOctree};
use laguerre_core::required::if_available;
#[cfg(feature = "test-util")]
use laguerre_core::shapes::icosphere;
use laguerre_core::site_tree::{MadeTree, SiteTree, WIDTH};
use laguerre_core::{Backend as _, DeviceChoice, PowerDiagram, Precision, Request, Watched};

type Place = fn([f64; 3]) -> [f64; 3];
type Weight = fn([f64; 3]) -> f64;

const SITES: u32 = 9000;

/// Sites of each kind, with weights of each: spread evenly, with rough weights, on a surface, of four scales, and with a few at one place.
const INPUTS: [(&str, Place, Weight); 6] = [
    ("even", |p| p, |_| 0.0),
    ("affine", |p| p, |[x, y, z]| 0.7 * x - 0.4 * y + 0.1 * z),
    ("rough", |p| p, |[x, y, z]| 0.002 * (1e4 * x).fract() + 0.1 * (7.0 * y).sin() + 0.2 * z),
    ("on a surface", |[x, y, _]| [x, y, 0.2 * x * x + 0.1 * y], |[x, y, _]| 0.3 * x * x - 0.25 * y * y),
    ("of four scales", |p| p.map(|x| 0.3 + x * 10_f64.powi(-((1e4 * p[0]) as i32 % 4))), |p| (1e4 * p[1]).fract()),
    ("coincident", |p| p.map(|x| (20.0 * x).floor() / 20.0), |p| if p[0] < 0.01 { 0.01 } else { 0.0 }),
];

#[test]
fn what_bounds_a_node_holds_for_its_sites() {
    let Some(mut device) = open() else { return };
    for (name, place, weight) in INPUTS {
        let positions: Vec<[f64; 3]> = spread(SITES).into_iter().map(place).collect();
        let weights: Vec<f64> = positions.iter().map(|&p| weight(p)).collect();
        let diagram = PowerDiagram::new(&positions, &weights).unwrap().in_box([0.0; 3], [2.0; 3]).unwrap();
        let container = diagram.framed_container().unwrap();
        device.bring_sites(&diagram).unwrap();
        device.load(&container, &Request::moments(), None).unwrap();
        let count = device.sort(&|| Ok(false)).unwrap().unwrap();

        let mut places: Vec<[u64; 3]> = positions.iter().map(|p| p.map(f64::to_bits)).collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(count, places.len(), "{name}");
        let MadeTree { sites, order, boxes, slabs, weights: bounds, .. } =
            device.sites.read_tree(&device.queue, &device.shared.params).unwrap();
        let frame = &container.frame;
        for (site, &i) in sites.iter().zip(&order) {
            assert_eq!(site[..3], frame.enter(positions[i as usize]), "{name}");
        }
        let mut once = order.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!(once.len(), count, "{name}");

        let params = device.shared.params;
        for (i, &[x, y, z, w]) in sites.iter().enumerate() {
            let (at, more) = ([x, y, z], w - params.smallest_weight);
            for level in 0..=params.tree_top as usize {
                let node = i / WIDTH.pow(level as u32 + 1);
                let (block, k) = (params.tree_begin[level] as usize + node / WIDTH, node % WIDTH);
                let (its_box, slab) = (&boxes[block], &slabs[block]);
                assert!((0..3).all(|axis| its_box.lo[axis][k] <= at[axis] && at[axis] <= its_box.hi[axis][k]));
                let height: f64 = (0..3).map(|axis| slab.normal[axis][k] * at[axis]).sum();
                assert!(slab.lo[k] <= height && height <= slab.hi[k], "{name}, level {level}");
                assert!(more <= slab.largest_weight[k], "{name}, level {level}");
                if params.equal_weights == 0 {
                    let (bound, middle) = (&bounds[block], its_box.middle(k));
                    let term = |axis: usize| {
                        let u = at[axis] - middle[axis];
                        (bound.g[axis][k] + bound.q[axis][k] * u) * u
                    };
                    assert!(more <= bound.c[k] + (term(0) + term(1) + term(2)), "{name}, level {level}");
                }
            }
        }
    }
}

/// What the rings about a block of leaves hold is at least what any site in them weighs less the block's slope; and just that in the first of
/// most blocks of even sites, where these are looked at one by one.
#[cfg(feature = "test-util")]
#[test]
fn what_the_rings_hold_is_not_exceeded() {
    let Some(mut device) = open() else { return };
    device.share_cells();
    for (name, place, weight) in INPUTS {
        let positions: Vec<[f64; 3]> = spread(SITES).into_iter().map(place).collect();
        let weights: Vec<f64> = positions.iter().map(|&p| weight(p)).collect();
        let diagram = PowerDiagram::new(&positions, &weights).unwrap().in_box([0.0; 3], [2.0; 3]).unwrap();
        device.bring_sites(&diagram).unwrap();
        device.load(&diagram.framed_container().unwrap(), &Request::moments(), None).unwrap();
        device.sort(&|| Ok(false)).unwrap().unwrap();
        let params = device.shared.params;
        if params.has_table == 0 || params.equal_weights != 0 {
            continue;
        }
        let MadeTree { sites, boxes, weights: bounds, .. } =
            device.sites.read_tree(&device.queue, &device.shared.params).unwrap();
        let mut around = Vec::new();
        device.sites.around.read(&device.queue, usize::MAX, &mut around).unwrap();
        let level = usize::from(params.tree_top > 0);
        let (mut blocks, mut exact) = (0, 0);
        for node in 0..sites.len().div_ceil(WIDTH.pow(level as u32 + 1)) {
            let (block, k) = (params.tree_begin[level] as usize + node / WIDTH, node % WIDTH);
            let (its_box, middle) = (&boxes[block], boxes[block].middle(k));
            let slope = [0, 1, 2].map(|axis| bounds[block].g[axis][k]);
            for ring in 0..RINGS {
                let end = f64::from(end_of_ring(ring)) * params.grid_width;
                let found = around[node * RINGS as usize + ring as usize];
                let (mut largest, mut size) = (f64::NEG_INFINITY, 0.0_f64);
                for &[x, y, z, w] in &sites {
                    let at = [x, y, z];
                    let gap =
                        |axis: usize| (its_box.lo[axis][k] - at[axis]).max(at[axis] - its_box.hi[axis][k]).max(0.0);
                    let square: f64 = (0..3).map(|axis| gap(axis) * gap(axis)).sum();
                    if ring + 1 == RINGS || square < end * end {
                        let along: f64 = (0..3).map(|axis| slope[axis] * (at[axis] - middle[axis])).sum();
                        largest = largest.max(w - params.smallest_weight - along);
                        size = size.max(w.abs() + along.abs());
                    }
                }
                assert!(largest <= found, "{name}, block {node}, ring {ring}: {largest} is more than {found}");
                blocks += u32::from(ring == 0);
                exact += u32::from(ring == 0 && found <= largest + 1e-12 * size);
            }
        }
        let is_even = matches!(name, "affine" | "rough");
        assert!(!is_even || 2 * exact > blocks, "{name}: {exact} of {blocks} first rings are what their sites are");
    }
}

/// The octree over the container that the device makes is the host's, and the cells that it leads to are those that are found without.
#[cfg(feature = "test-util")]
#[test]
fn an_octree_leads_to_the_same_cells() {
    let Some(mut device) = open() else { return };
    device.share_cells();
    // Sites `∇φ(x)` of a convex `φ = |x|⁴` at even points, each with about the weight with which that point is in its cell.
    let (mut positions, mut weights) = (Vec::new(), Vec::new());
    for (i, x) in spread(600).into_iter().enumerate() {
        let x = x.map(|c| c - 0.5);
        let square: f64 = x.iter().map(|x| x * x).sum();
        let p = x.map(|x| 4.0 * square * x);
        let along: f64 = p.iter().zip(x).map(|(p, x)| p * x).sum();
        let own: f64 = p.iter().map(|p| p * p).sum();
        weights.push(own - 2.0 * (along - square * square) + 1e-4 * (i as f64 * 0.618).fract());
        positions.push(p.map(|p| p + 0.5));
    }
    let diagram = PowerDiagram::new(&positions, &weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let container = diagram.framed_container().unwrap();
    let (request, count) = (Request::moments(), positions.len());
    let watched = Watched::new(&request, &());
    let mut cells = |with_octree: bool| {
        device.bring_sites(&diagram).unwrap();
        device.load(&container, &request, None).unwrap();
        device.sort(&|| Ok(false)).unwrap().unwrap();
        if with_octree {
            device.make_octree(&watched).unwrap();
            assert!(device.shared.params.octree_off > 0.0);
            let made = device.sites.read_tree(&device.queue, &device.shared.params).unwrap();
            let tree = SiteTree::from_device(made, count);
            let most = MOST_LEAVES as usize - 1;
            let octree = PowerOctree::new(&tree, [container.lo, container.hi], most, &|| Ok(())).unwrap().unwrap();
            let (mut nodes, mut middles, mut listed, mut homes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
            device.octree.nodes.read(&device.queue, usize::MAX, &mut nodes).unwrap();
            device.octree.middles.read(&device.queue, usize::MAX, &mut middles).unwrap();
            device.octree.listed.read(&device.queue, usize::MAX, &mut listed).unwrap();
            device.octree.homes.read(&device.queue, count, &mut homes).unwrap();
            for (site, &home) in homes.iter().enumerate() {
                assert_eq!(octree.home(site as u32), Home::At(octree.middle(home)), "{site}");
            }
            let mut open = vec![0];
            while let Some(i) = open.pop() {
                let node = octree.octree_node(i);
                assert_eq!(nodes[i as usize], [node.begin, node.count], "{i}");
                if node.count == HAS_PARTS {
                    open.extend(node.begin..node.begin + WIDTH as u32);
                    continue;
                }
                assert_eq!(middles[i as usize][..3], octree.middle(i), "{i}");
                let leaves = octree.leaves_of(node);
                assert_eq!(leaves, &listed[node.begin as usize..][..leaves.len()], "{i}");
            }
        }
        device.clear(&watched, count, count).unwrap();
        device.look_about(count, 0..0).unwrap();
        // (The stage in which cells begin where there is one.)
        device.shared.params.has_table = 0;
        let far = Way::Together(Lanes::One, Stage::Far);
        assert!(device.run(far, &Todo::Sorted(0..count), 1, 0..count, false).unwrap().is_none());
        let Counters { full, later, left, .. } = device.counters;
        assert_eq!([full, later, left], [0; 3]);
        device.read_results(&request, count).unwrap();
        (device.results.outcomes.clone(), device.results.sums.clone())
    };
    let ((outcomes, sums), (with, sums_with)) = (cells(false), cells(true));
    let mean = container.lo.iter().zip(&container.hi).map(|(lo, hi)| hi - lo).product::<f64>() / count as f64;
    for i in 0..count {
        assert_eq!(outcomes[i] & OUTCOME_STATUS, with[i] & OUTCOME_STATUS, "{i}");
        let (own, other) = (sums[i * FEW_SUMS as usize], sums_with[i * FEW_SUMS as usize]);
        assert!((own - other).abs() < 1e-12 * mean, "{i}: {own} {other}");
    }
}

/// Of cells that reach far on a bumpy surface the first of each block show the others what bounds them there, and the others are swept, so many at a time: they are the cells that all are by
/// their vertices.
#[cfg(feature = "test-util")]
#[test]
fn cells_on_a_surface_are_swept() {
    let Some(mut device) = open() else { return };
    device.share_cells();
    let bump = |[x, y, _]: [f64; 3]| [x, y, 0.5 + 0.1 * (9.0 * x).sin() * (7.0 * y).cos()];
    let sites: Vec<[f64; 3]> = spread(2000).into_iter().map(bump).collect();
    let diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let (request, count) = (Request::moments(), sites.len());
    let watched = Watched::new(&request, &());
    let mut cells = |is_swept: bool| {
        device.bring_sites(&diagram).unwrap();
        let container = diagram.framed_container().unwrap();
        device.load(&container, &request, None).unwrap();
        device.sort(&|| Ok(false)).unwrap().unwrap();
        device.clear(&watched, count, count).unwrap();
        device.look_about(count, 0..0).unwrap();
        device.shared.params.has_table = 0;
        let (far, all) = (Way::Together(Lanes::One, Stage::Far), Todo::Sorted(0..count));
        let ran = match is_swept {
            true => device.run(far, &all, 1, 0..count, false),
            false => device.launch(far, &all, 1, 0..count, false, ALL_TURNS),
        };
        assert!(ran.unwrap().is_none());
        device.read_results(&request, count).unwrap();
        let mean = container.lo.iter().zip(&container.hi).map(|(lo, hi)| hi - lo).product::<f64>() / count as f64;
        let Counters { full, later, left, .. } = device.counters;
        (device.results.outcomes.clone(), device.results.sums.clone(), (full + later + left) as usize, mean)
    };
    let ((with, sums_with, given_up, mean), (outcomes, sums, left, _)) = (cells(true), cells(false));
    let mut kept = Vec::new();
    device.memory.kept.read(&device.queue, usize::MAX, &mut kept).unwrap();
    let show = kept.iter().step_by(MOST_KEPT as usize).filter(|&&sites| sites > 0).count();
    assert!(show > 10 && given_up + left < count / 4, "{show}, {given_up} and {left} of {count}");
    let mut compared = 0;
    for i in 0..count {
        let [status, its] = [outcomes[i], with[i]].map(|outcome| outcome & OUTCOME_STATUS);
        if its == COMPLETE && status == COMPLETE {
            let (own, other) = (sums[i * FEW_SUMS as usize], sums_with[i * FEW_SUMS as usize]);
            assert!((own - other).abs() < 1e-12 * mean, "{i}: {own} {other}");
            compared += 1;
        }
    }
    assert!(compared + given_up + left >= count, "{compared}, {given_up} and {left} of {count}");
}

/// What the first stage has begun of cells that reach far is swept, and what is given up by `Far`, after what the first stage has left for other reasons: they are the cells that all are by
/// their vertices. Where not all have room for their record all are begun anew, for the same bits each time.
#[cfg(feature = "test-util")]
#[test]
fn cells_that_are_begun_are_swept() {
    let Some(mut device) = open() else { return };
    device.share_cells();
    let bump = |[x, y, z]: [f64; 3]| [x, y, 0.5 + 0.1 * (9.0 * x).sin() * (7.0 * y).cos() + 1e-3 * z];
    let sites: Vec<[f64; 3]> = spread(2000).into_iter().map(bump).collect();
    let diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let (request, count) = (Request::moments(), sites.len());
    let watched = Watched::new(&request, &());
    let mut cells = |stage: Stage, room: usize| {
        device.bring_sites(&diagram).unwrap();
        let container = diagram.framed_container().unwrap();
        device.load(&container, &request, None).unwrap();
        device.sort(&|| Ok(false)).unwrap().unwrap();
        device.most_cells = count;
        device.clear(&watched, count, count).unwrap();
        device.look_about(count, 0..0).unwrap();
        (device.shared.params.has_table, device.was_swept) = (0, true);
        device.make_room_for_begun(room).unwrap();
        let (all, together) = (Todo::Sorted(0..count), Some((Lanes::One, stage)));
        let mut for_host = Vec::new();
        let passed = device.pass(&watched, Capacities::FIRST, &all, true, together, &mut for_host).unwrap();
        assert_eq!((passed.failed.count(), for_host.len()), (0, 0));
        device.read_results(&request, count).unwrap();
        let begun = (device.counters.begun, device.shared.params.begun_room);
        (device.results.outcomes.clone(), device.results.sums.clone(), begun)
    };
    let ((outcomes, sums, _), (with, sums_with, (begun, room))) =
        (cells(Stage::Far, 0), cells(Stage::First, 2 * count));
    assert!(begun > 10_000 && begun <= room, "{begun} of {room}");
    let (in_part, again) = (cells(Stage::First, count / 4), cells(Stage::First, count / 4));
    assert!(in_part.2.0 > 10_000 && in_part.2.1 == 0, "{:?}", in_part.2);
    assert_eq!(in_part.1, again.1);
    for i in 0..count {
        let (own, other) = (sums[i * FEW_SUMS as usize], in_part.1[i * FEW_SUMS as usize]);
        assert!((own - other).abs() < 1e-12 / count as f64, "{i}: {own} {other}");
    }
    let mean = 1.0 / count as f64;
    for i in 0..count {
        assert_eq!([outcomes[i], with[i]].map(|outcome| outcome & OUTCOME_STATUS), [COMPLETE; 2], "{i}");
        let (own, other) = (sums[i * FEW_SUMS as usize], sums_with[i * FEW_SUMS as usize]);
        assert!((own - other).abs() < 1e-12 * mean, "{i}: {own} {other}");
    }
}

/// Points spread evenly, but not regularly.
pub(super) fn spread(count: u32) -> Vec<[f64; 3]> {
    let steps = [0.819_172_513_396_164_5, 0.671_043_606_703_789_2, 0.549_700_477_901_970_2];
    (1..=count).map(|i| steps.map(|step| (f64::from(i) * step).fract())).collect()
}

fn open() -> Option<Device> {
    if_available(
        "ocl",
        choose(&DeviceChoice::First, Precision::F64).and_then(|found| Device::open(&found[0], Precision::F64)),
    )
}

/// What the rings about each block of leaves weigh has room where sites coincide, too: of 100 sites two blocks would be enough, of the 60 that are left eight leaves are a block each.
#[cfg(feature = "test-util")]
#[test]
fn rings_have_room_where_sites_coincide() {
    let Some(mut device) = open() else { return };
    device.share_cells();
    let sites: Vec<[f64; 3]> = spread(60).into_iter().chain(spread(40)).collect();
    let weights: Vec<f64> = sites.iter().map(|p| 0.01 * p[0] * p[1]).collect();
    let diagram = PowerDiagram::new(&sites, &weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    device.bring_sites(&diagram).unwrap();
    device.load(&diagram.framed_container().unwrap(), &Request::moments(), None).unwrap();
    assert_eq!(device.sort(&|| Ok(false)).unwrap(), Some(60));
    assert!(device.shared.params.has_table != 0);
    assert!(device.sites.around.length() >= 60_usize.div_ceil(WIDTH) * RINGS as usize);
}

/// Builds that are made ahead are given to whoever asks for them, in any order, and what is left of them is kept.
#[cfg(feature = "test-util")]
#[test]
fn builds_made_ahead_are_taken() {
    let Some(mut device) = open() else { return };
    device.share_cells();
    let diagram = PowerDiagram::new(&spread(100), &[]).unwrap().in_box([0.0; 3], [2.0; 3]).unwrap();
    device.bring_sites(&diagram).unwrap();
    device.load(&diagram.framed_container().unwrap(), &Request::moments(), None).unwrap();
    device.sort(&|| Ok(false)).unwrap().unwrap();
    let Device { programs, context, shared, id, .. } = &mut device;
    let [first, surface, far] =
        [Stage::First, Stage::Surface, Stage::Far].map(|stage| Way::Together(Lanes::One, stage));
    programs.build_ahead(context, DeviceId(*id), &[first, surface, far], &shared.params);
    for way in [surface, first, surface] {
        assert_eq!(programs.get(context, *id, way, &shared.params).unwrap().per_cell, 1);
    }
    programs.settle();
    // (The last has been begun, or not.)
    assert_eq!(programs.get(context, *id, far, &shared.params).unwrap().per_cell, 1);
}

/// Cells of a lattice that has moved a little, with weights, begin where signs are settled closely; of a lattice without weights they do not.
#[cfg(feature = "test-util")]
#[test]
fn open_signs_of_a_moved_lattice_are_settled_at_once() {
    let Some(mut device) = open() else { return };
    device.share_cells();
    let at = |n: usize| (n as f64 + 0.5) / 41.0;
    let sites: Vec<[f64; 3]> = (0..41_usize.pow(3)).map(|n| [n % 41, n / 41 % 41, n / 41 / 41].map(at)).collect();
    let flow = |p: [f64; 3]| [p[0] + 1e-5 * (5.0 * p[1]).sin(), p[1], p[2]];
    let moved: Vec<[f64; 3]> = sites.iter().map(|p| flow(*p)).collect();
    // (What is exactly a tie not even double-double tells.)
    let noise = |n: usize| (n as f64 * n as f64 * 0.618_033_988_749_894_9).fract();
    let weights: Vec<f64> = sites.iter().enumerate().map(|(n, p)| 1e-6 * p[0] + 1e-12 * noise(n)).collect();
    for (sites, weights, right) in [(&moved, &weights[..], Stage::Close), (&sites, &[], Stage::First)] {
        let diagram = PowerDiagram::new(sites, weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
        let request = Request::moments().with_laplacian();
        let request = Watched::new(&request, &());
        device.bring_sites(&diagram).unwrap();
        device.load(&diagram.framed_container().unwrap(), &request, None).unwrap();
        let count = device.sort(&|| Ok(false)).unwrap().unwrap();
        device.clear(&request, count, count).unwrap();
        device.look_about(count, 0..0).unwrap();
        assert_eq!(device.choose_table(Lanes::One, 0..count).unwrap(), (right, false));
        assert_eq!(device.shared.params.has_table, 1, "{right:?}");
    }
}

/// What only a diagram with its Laplacian needs is given back where it is much of a device's memory, and the next diagram has it again; what the solver needs stays.
#[test]
fn scratch_of_a_laplacian_is_given_back() {
    let Some(mut backend) = if_available("ocl", Ocl::new(&DeviceChoice::First, Precision::F64)) else { return };
    let sites = spread(3000);
    let request = Request::moments().with_laplacian_kept();
    let mut found_in = |weights: &[f64], memory: Option<u64>| {
        let diagram = PowerDiagram::new(&sites, weights).unwrap().in_box([0.0; 3], [2.0; 3]).unwrap();
        let all = backend.devices.get_mut()[0].memory_size;
        backend.devices.get_mut()[0].memory_size = memory.unwrap_or(all);
        let output = backend.evaluate(&diagram, &request).unwrap();
        backend.devices.get_mut()[0].memory_size = all;
        let kept = output.kept().unwrap();
        let matrix = backend.laplacian(kept, 0.5).unwrap().unwrap();
        let found = (backend.read_laplacian(kept).unwrap().unwrap(), backend.rows(&matrix).unwrap());
        (found, backend.devices.get_mut()[0].memory.facets.is_made())
    };
    let weights: Vec<f64> = sites.iter().map(|p| 1e-3 * p[0]).collect();
    // (A fourth of 4 MB is enough for all facets, and they are more than an eighth.)
    for weights in [&[][..], &weights] {
        let (right, stays) = found_in(weights, None);
        let (found, stays_in_little) = found_in(weights, Some(4 << 20));
        assert!(stays && !stays_in_little);
        assert!(found.0.values().len() > 20_000);
        assert_eq!(found, right);
    }
}

/// Cells whose facets have no room are finished again once those of the others are with the host: nothing is lost, nor other. (Three batches of a thousand cells of 15 facets each, and room for 18 each of one batch.)
#[cfg(feature = "test-util")]
#[test]
fn facets_without_room_are_not_lost() {
    let Some(mut backend) = if_available("ocl", Ocl::new(&DeviceChoice::First, Precision::F64)) else { return };
    backend.devices.get_mut()[0].share_cells();
    let diagram = PowerDiagram::new(&spread(3072), &[]).unwrap();
    let diagrams = [diagram.clone().restricted_to(&icosphere(2).domain()), diagram.in_box([0.0; 3], [1.0; 3]).unwrap()];
    for diagram in &diagrams {
        let mut found_in = |memory: Option<u64>| {
            let all = backend.devices.get_mut()[0].memory_size;
            backend.devices.get_mut()[0].memory_size = memory.unwrap_or(all);
            let output = backend.evaluate(diagram, &Request::moments().with_facets()).unwrap();
            backend.devices.get_mut()[0].memory_size = all;
            let is_kept = backend.devices.get_mut()[0].facets_are_kept;
            (output.facets().unwrap().clone(), output.volume().to_vec(), is_kept)
        };
        let ((right, volumes, stays), (found, same, stays_in_little)) = (found_in(None), found_in(Some(2 << 20)));
        assert!(stays && !stays_in_little);
        assert!(found == right && volumes == same);
    }
}
