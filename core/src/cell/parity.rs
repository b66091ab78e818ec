//! Every function of the algorithm by name, run on random input as flat words: what a device's own functions are held against, bit
//! for bit. The table is generated (`cargo xtask codegen`) beside the kernels that take and give the same words.

/// Tells how a struct's fields become words.
macro_rules! words {
    ($name:ident { $($field:ident),* }) => {
        impl Word for $name {
            fn take(words: &mut Words<'_>) -> Self {
                Self { $($field: words.take()),* }
            }
            fn give(self, words: &mut Vec<u64>) {
                $(self.$field.give(words);)*
            }
        }
    };
}

/// A function that takes its arguments and gives its results as words; where a store is named, on a cell.
macro_rules! host {
    (($($argument:ident: $type:ident $(in $all:ident)?),*) $module:ident::$name:ident $arguments:tt, [$($out:ident),*]) => {
        Function {
            name: stringify!($name),
            on_store: false,
            host: |words| {
                $(#[allow(unused_mut)] let mut $argument: $type = host!(take words $($all)?);)*
                let result = $module::$name $arguments;
                words.give(result);
                $(words.give($out);)*
            },
        }
    };
    ($s:ident, ($($argument:ident: $type:ident $(= $given:ident)? $(in $all:ident)?),*) $module:ident::$name:ident $arguments:tt, [$($out:ident),*]) => {
        Function {
            name: stringify!($name),
            on_store: true,
            host: |words| {
                #[allow(unused_mut)]
                let mut $s = words.store();
                $(#[allow(unused_mut)] let mut $argument: $type = host!(take words $(= $given)? $($all)?);)*
                let result = $module::$name $arguments;
                words.give(result);
                $(words.give($out);)*
                words.dump(&$s);
            },
        }
    };
    (take $words:ident) => { $words.take() };
    (take $words:ident = $given:ident) => { $words.given($given) };
    (take $words:ident $all:ident) => { $words.some_of($all) };
}

#[rustfmt::skip]
mod table;

use super::vertex::place_vertex;
use super::{
    COMPLETE, ClipStore, FACET_AREAS, FACET_SECOND_MOMENTS, FACETS, FacetSecond, FacetSum, INTEGRAL, IntegralStore,
    PlainStore, Plane, Polytope, Real, SECOND_MOMENTS, Triplet, V3, begin, bisector, clip, v3,
};
use crate::domain::Domain;
use crate::domain_grid::DomainGrid;
use crate::integrand::{FramedIntegrand, Integrand};
use crate::shapes;

pub use table::FUNCTIONS;

/// One function of the algorithm.
#[derive(Clone, Copy)]
pub struct Function {
    /// Its name in the Rust text; the kernel is `parity_` and this.
    pub name: &'static str,
    /// Whether it works on a cell: the first word of its results then says that the cell was made (`COMPLETE`), and its own come after.
    pub on_store: bool,
    /// Draws arguments, calls it, and gives results.
    host: fn(&mut Words<'_>),
}

/// Arguments and results of some calls of a function, the words of each call in a row.
#[derive(Clone, Debug, Default)]
pub struct Calls {
    /// Words of one call's arguments.
    pub input_width: usize,
    /// Words of one call's results.
    pub output_width: usize,
    /// Arguments, call after call.
    pub inputs: Vec<u64>,
    /// Results, call after call.
    pub outputs: Vec<u64>,
}

impl Function {
    /// Calls the host's function `count` times on random arguments.
    pub fn call(&self, world: &World, count: usize) -> Calls {
        let mut calls = Calls::default();
        // Other arguments for each function.
        let mut state = self.name.bytes().fold(0, |hash: u64, byte| hash.wrapping_mul(31).wrapping_add(byte.into()));
        for _ in 0..count {
            let mut words =
                Words { random: Random::new(&mut state), world, indices: FEW, input: vec![], output: vec![] };
            (self.host)(&mut words);
            // Each call's words begin where four numbers of double precision may.
            words.input.resize(words.input.len().next_multiple_of(4), 0);
            calls.input_width = words.input.len();
            calls.output_width = words.output.len();
            calls.inputs.append(&mut words.input);
            calls.outputs.append(&mut words.output);
        }
        calls
    }
}

/// The flags that a function may be given.
const FLAGS: u32 = FACETS | SECOND_MOMENTS | FACET_SECOND_MOMENTS | INTEGRAL | FACET_AREAS;

/// Integers where there is no cell.
const FEW: u32 = 4;

/// What cells are cut from: the domain, and its grid as a device takes it.
pub struct World {
    domain: Domain,
    /// Triangles, and voxels along each axis, that there are at least.
    indices: u32,
    /// Minimum and maximum corner of the grid, width and number of its voxels; number of nodes, degree and origin of the integrand.
    pub numbers: Vec<f64>,
    /// A polynomial with all its coefficients.
    pub integrand: FramedIntegrand,
    /// The domain's vertices.
    pub vertices: Vec<[f64; 3]>,
    /// Where each of the six parts begins, and they themselves: triangles, lowest voxels, offsets, entries, winding numbers, surface table.
    pub table: Vec<u32>,
}

impl Default for World {
    fn default() -> Self {
        Self::new()
    }
}

impl World {
    /// A sphere of 80 triangles.
    pub fn new() -> Self {
        let domain = shapes::icosphere(1).domain();
        let grid = domain.grid(0);
        let (lo, hi) = (grid.corner([0; 3]), grid.corner(grid.dims()));
        let mut numbers = [lo, hi].concat();
        numbers.push(grid.voxel_width());
        numbers.extend(grid.dims().map(f64::from));
        let powers = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]).filter(|powers| powers.iter().sum::<u32>() <= 2);
        let terms: Vec<_> = powers.zip(1..).map(|(powers, i)| (powers, 1.0 / f64::from(i))).collect();
        let integrand = Integrand::polynomial([0.1, -0.2, 0.3], &terms).and_then(|f| f.framed(domain.frame())).unwrap();
        numbers.extend([integrand.nodes().len() as f64, f64::from(integrand.degree())]);
        numbers.extend(integrand.origin());
        let windings: Vec<u32> = grid.windings().iter().map(|&winding| winding as u32).collect();
        let (triangles, lowest) = (grid.triangles(), grid.lowest_voxels().as_flattened());
        // Triangles first, aligned to their size.
        let parts = [triangles.as_flattened(), lowest, grid.offsets(), grid.entries(), &windings, grid.surface_table()];
        let mut table = Vec::new();
        let mut begin = parts.len().next_multiple_of(4);
        let gap = begin - parts.len();
        for part in parts {
            table.push(begin as u32);
            begin += part.len();
        }
        table.extend(std::iter::repeat_n(0, gap));
        table.extend(parts.concat());
        let indices = grid.dims().into_iter().fold(grid.triangles().len() as u32, u32::min);
        Self { indices, numbers, integrand, vertices: grid.vertices().to_vec(), table, domain }
    }

    fn grid(&self) -> &DomainGrid {
        self.domain.grid(0)
    }
}

/// Sites that cut a cell before its function is called.
pub const NEIGHBORS: usize = 10;

/// Room that a device has for the cell: the box, the neighbours, the cone's planes, one more, and the caps.
pub const PLANES: u32 = 6 + NEIGHBORS as u32 + 5 + super::MOST_CAPS;
/// The same for vertices: `V = 2F − 4`.
pub const VERTICES: u32 = 2 * PLANES - 4;

/// The arguments of one call, drawn as they are taken, and its results.
struct Words<'a> {
    random: Random,
    world: &'a World,
    /// Integers are below this.
    indices: u32,
    input: Vec<u64>,
    output: Vec<u64>,
}

impl<'a> Words<'a> {
    /// The next argument.
    fn take<T: Word>(&mut self) -> T {
        T::take(self)
    }

    /// An argument that is always the same.
    fn given(&mut self, value: u32) -> u32 {
        self.input.push(value.into());
        value
    }

    /// Some of the bits of a number.
    fn some_of(&mut self, all: u32) -> u32 {
        let some = self.random.below(all + 1);
        self.given(some & all)
    }

    /// The next result.
    fn give<T: Word>(&mut self, value: T) {
        value.give(&mut self.output);
    }

    /// A cell in the middle of its life: clipped by the bisectors with some sites, and by the next one marked. `store.cl`'s twin
    /// is in `parity_state.cl`.
    fn store(&mut self) -> PlainStore<'a> {
        // Sites of a lattice, so that many of their bisectors meet in one point, or any; of one weight, or not.
        let (tame, weighted) = (self.random.below(2) == 0, self.random.below(2) == 0);
        let mut site = || {
            let mut place = || match tame {
                true => Real::from(self.random.below(9)) * 0.125 - 0.5,
                false => self.random.unit() * 0.55,
            };
            let [x, y, z] = [place(), place(), place()];
            let weight = if weighted { Real::from(self.random.below(3)) / 8.0 } else { 0.0 };
            [x, y, z, weight]
        };
        let sites: Vec<[Real; 4]> = (0..=NEIGHBORS).map(|_| site()).collect();
        self.input.extend(sites.as_flattened().iter().map(|number| number.to_bits()));
        let [x, y, z, weight] = sites[0];
        let grid = self.world.grid();
        let mut s = PlainStore::new([x, y, z], Some(grid)).with_integrand(Some(&self.world.integrand));
        let relative = |[cx, cy, cz]: [Real; 3]| v3(cx - x, cy - y, cz - z);
        begin(&mut s, relative(grid.corner([0; 3])), relative(grid.corner(grid.dims())));
        let mut plane = Plane::default();
        for (i, &[jx, jy, jz, other]) in sites.iter().enumerate().skip(1) {
            plane = bisector(relative([jx, jy, jz]), weight - other);
            if i < NEIGHBORS {
                clip(&mut s, plane, i as u32);
            }
        }
        // A work-item computes all vertices anew once it has its cell, the corners of the box among them.
        for v in 0..s.vertices() {
            place_vertex(&mut s, v);
        }
        for f in 0..PLANES {
            let x = Real::from(f);
            s.set_facet(f, FacetSum { area: x, moment: v3(x, x, x), rounding: x });
            s.set_facet_second(f, FacetSecond { diagonal: v3(x, x, x), mixed: v3(x, x, x) });
        }
        let k = s.planes();
        s.set_plane(k, plane);
        s.mark_conflicts(k);
        s.save();
        self.indices = s.planes().min(s.vertices()).min(self.world.indices);
        self.give(COMPLETE);
        s
    }

    /// The cell afterwards, in words whose number does not depend on it. Marks are scratch, and left out.
    fn dump(&mut self, s: &PlainStore<'_>) {
        self.give(s.planes());
        self.give(s.vertices());
        for f in 0..PLANES {
            let is_there = f < s.planes();
            self.give(if is_there { s.plane(f) } else { Plane::default() });
            self.give(if is_there { s.tag(f) } else { 0 });
            self.give(if is_there { s.link(f) } else { 0 });
            self.give(if is_there { s.facet(f) } else { FacetSum::default() });
            let second = if is_there { s.facet_second(f) } else { FacetSecond::default() };
            self.give(second.diagonal);
            self.give(second.mixed);
        }
        for v in 0..VERTICES {
            let is_there = v < s.vertices();
            self.give(if is_there { s.triplet(v) } else { Triplet::default() });
            self.give(if is_there { s.position(v) } else { V3::default() });
            self.give(if is_there { s.radius(v) } else { 0.0 });
        }
    }
}

/// What is an argument or a result: words.
trait Word {
    /// Draws a value.
    fn take(words: &mut Words<'_>) -> Self;
    /// Appends the value's words.
    fn give(self, words: &mut Vec<u64>);
}

impl Word for Real {
    fn take(words: &mut Words<'_>) -> Self {
        let value = words.random.real();
        words.input.push(value.to_bits());
        value
    }
    fn give(self, words: &mut Vec<u64>) {
        // Which bits a NaN has is nobody's promise.
        words.push(if self.is_nan() { NAN } else { self.to_bits() });
    }
}

/// The bits given for any NaN.
const NAN: u64 = 0x7ff8_0000_0000_0000;

impl Word for u32 {
    /// Flags, of which each bit is often not set; numbers of half-spaces, vertices, voxels or triangles.
    fn take(words: &mut Words<'_>) -> Self {
        let end = if words.random.below(2) == 0 { 2 } else { words.indices };
        let value = words.random.below(end);
        words.given(value)
    }
    fn give(self, words: &mut Vec<u64>) {
        words.push(self.into());
    }
}

impl Word for bool {
    fn take(words: &mut Words<'_>) -> Self {
        let value = words.random.below(2);
        words.given(value) != 0
    }
    fn give(self, words: &mut Vec<u64>) {
        words.push(self.into());
    }
}

impl Word for i32 {
    fn take(words: &mut Words<'_>) -> Self {
        u32::take(words) as i32
    }
    fn give(self, words: &mut Vec<u64>) {
        (self as u32).give(words);
    }
}

impl<T: Word, const N: usize> Word for [T; N] {
    fn take(words: &mut Words<'_>) -> Self {
        [(); N].map(|()| T::take(words))
    }
    fn give(self, words: &mut Vec<u64>) {
        self.into_iter().for_each(|value| value.give(words));
    }
}

impl Word for () {
    fn take(_: &mut Words<'_>) -> Self {}
    fn give(self, _: &mut Vec<u64>) {}
}

/// A generator of numbers that favour trouble.
struct Random {
    state: u64,
    /// Only small numbers and those that came before.
    tame: bool,
    seen: [Real; 4],
}

impl Random {
    /// One for the next call.
    fn new(state: &mut u64) -> Self {
        let mut random = Self { state: *state, tame: false, seen: [1.0, 2.0, 0.5, 0.0] };
        random.next();
        *state = random.state;
        random.tame = random.below(2) == 0;
        random
    }

    /// SplitMix64 (Steele, Lea, Flood 2014).
    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.state ^ self.state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ x >> 31
    }

    fn below(&mut self, end: u32) -> u32 {
        (self.next() >> 32) as u32 % end
    }

    /// From −1 to 1.
    fn unit(&mut self) -> Real {
        (self.next() >> 11) as Real / (1_u64 << 52) as Real - 1.0
    }

    /// Small integers and their quarters, zeros, what came before, and last places; else any magnitude, at times one whose
    /// products overflow or vanish.
    fn real(&mut self) -> Real {
        let kind = self.below(if self.tame { 4 } else { 8 });
        let value = match kind {
            0 => self.seen[self.below(4) as usize],
            1 => -self.seen[self.below(4) as usize],
            2 => Real::from(self.below(5)) - 2.0,
            3 => 0.25 * Real::from(self.below(9)) - 1.0,
            4 | 5 => self.unit(),
            6 => self.unit() * 2.0_f64.powi(self.below(81) as i32 - 40),
            _ if self.below(16) == 0 => self.unit() * 2.0_f64.powi(self.below(1601) as i32 - 800),
            _ => 1.0 + self.unit() * 2.0_f64.powi(-48),
        };
        self.seen[self.below(4) as usize] = value;
        value
    }
}
