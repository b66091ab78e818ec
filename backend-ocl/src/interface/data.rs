//! Constants and structs of the kernels in double precision.
#![allow(dead_code, reason = "the kernels use all of it")]

/// Voxels to each side, along each axis, that the table of offsets (`shells.rs`) holds.
pub(crate) const SHELL_RADIUS: u32 = 6;

/// Entries of the table of offsets, and how many of them are about the own voxel.
pub(crate) const SHELLS: u32 = 2197;
pub(crate) const INNER_SHELLS: u32 = 27;

/// A voxel with more sites than this is crowded: the table is blind inside it, and the tree over all sites is searched alone.
pub(crate) const CROWDED: u32 = 64;

/// Sites from all over that a cell is cut by where it reaches to other parts of the domain.
pub(crate) const SAMPLE: u32 = 512;

/// Room for a cell that is too large for local memory, in units of 8 bytes.
pub(crate) const VAST_WORDS: u32 = 77_000;

/// Room for the sites that bound a cell far off, kept for others of its block of leaves, and for their number.
pub(crate) const MOST_KEPT: u32 = 32;

/// The turns of cells where some keep these sites for others: 0 is theirs, 1 that of the others. Where none does all have this one.
pub(crate) const ALL_TURNS: u32 = 2;

/// Work-items that go over the leaves of a box of the octree over the container: a box lists some sixty where it is split last.
pub(crate) const OCTREE_GROUP: u32 = 64;

/// The home of a site that is not known, and that of one that no box lists.
pub(crate) const NO_BOX: u32 = 0xffff_fffe;
pub(crate) const NO_HOME: u32 = 0xffff_ffff;

/// Levels of the tree at most.
pub(crate) const MOST_TREE_LEVELS: usize = 12;

/// Work-items of a group where sites are sorted, and the elements that each of them scans.
pub(crate) const GRID_GROUP: u32 = 256;
pub(crate) const SCAN_EACH: u32 = 8;
/// Work-items of a group that bounds nodes of the tree: as many as sites of a sample.
pub(crate) const NODES_GROUP: u32 = 64;
/// Work-items of a group that looks around a block of leaves.
pub(crate) const RINGS_GROUP: u32 = 64;

/// Numbers of a cell, of those that tell how far a facet may go.
pub(crate) const CELL_NUMBERS: u32 = 8;

/// The numbers that each of them adds up.
pub(crate) const SUM_EACH: u32 = 16;

/// Sums over all cells (`totals.cl`): cells that are not empty; those not certified; volumes; of those below 0; their squares; the energy; the displacement.
pub(crate) const TOTALS: u32 = 7;

/// The elements that each of them sorts at a time; bits of a digit, and how many values it has.
pub(crate) const SORT_EACH: u32 = 8;
pub(crate) const DIGIT_BITS: u32 = 4;
pub(crate) const DIGITS: u32 = 16;

/// Sums that are written for each cell: volume and first moment; the second moments; all; and last the integral.
pub(crate) const FEW_SUMS: u32 = 4;
pub(crate) const MOMENT_SUMS: u32 = 10;
pub(crate) const ALL_SUMS: u32 = 18;

/// The outcome of a cell that this device did not compute: a coincident site's, or another device's.
pub(crate) const NOT_COMPUTED: u32 = 0xffff_ffff;

/// A row of the Laplacian with more facets is long: its work-items would take too long to sort it.
pub(crate) const LONG_ROW: u32 = 512;

/// Work-items that share out the facets of a row: it has 15.5 where sites are white. (By one, neighboring work-items read and wrote far apart.)
pub(crate) const PER_ROW: u32 = 16;

/// Work-items of a group that makes a row of a product of matrices.
pub(crate) const ROW_GROUP: u32 = 32;

/// The outcome of a cell: its status, and beside it whether exact arithmetic was needed, and whether it is uncertified.
pub(crate) const OUTCOME_STATUS: u32 = 0xff;
pub(crate) const OUTCOME_EXACT: u32 = 0x100;
pub(crate) const OUTCOME_UNCERTIFIED: u32 = 0x200;

/// Scalars of an evaluation.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Params {
    /// Initial cell: the box, or the domain's grid.
    pub(crate) box_lo: [f64; 3],
    pub(crate) box_hi: [f64; 3],
    /// Site grid: minimum corner, width of the voxels and its inverse; largest and smallest weight of all.
    pub(crate) grid_lo: [f64; 3],
    pub(crate) grid_width: f64,
    pub(crate) grid_per_width: f64,
    pub(crate) largest_weight: f64,
    pub(crate) smallest_weight: f64,
    /// Domain grid: minimum corner, width of the voxels and its inverse.
    pub(crate) domain_lo: [f64; 3],
    pub(crate) domain_width: f64,
    pub(crate) domain_per_width: f64,
    /// 1 + ε of the paper's security radius, or 0 for a proof.
    pub(crate) enlarged: f64,
    /// `Frame`: x' = (x − shift) / unit, and what is taken as zero.
    pub(crate) frame_shift: [f64; 3],
    pub(crate) frame_unit: f64,
    pub(crate) frame_smallest: f64,
    /// What the monomials of the polynomial to be integrated are about.
    pub(crate) origin: [f64; 3],
    /// What the Laplacian is in units of.
    pub(crate) laplacian_unit: f64,
    /// How far a place may be off where the octree over the container tells the sites of least power; 0 where there is no octree.
    pub(crate) octree_off: f64,
    /// Where the records of this batch will stand among all.
    pub(crate) facet_base: u64,
    /// How many sums are written for each cell.
    pub(crate) sums_width: u64,
    pub(crate) grid_dims: [u32; 3],
    pub(crate) domain_dims: [u32; 3],
    pub(crate) has_domain: u32,
    /// The tree over the sites (`SiteTree`): where the blocks of each level begin, the root's level, the number of sites.
    pub(crate) tree_begin: [u32; MOST_TREE_LEVELS],
    pub(crate) tree_top: u32,
    pub(crate) tree_sites: u32,
    /// 1: the table of offsets is gone through first.
    pub(crate) has_table: u32,
    /// What to compute: the flags of `integrate_cell`.
    pub(crate) flags: u32,
    /// 1: all weights are the same; 0 also where they will differ soon.
    pub(crate) equal_weights: u32,
    /// Room for facet records.
    pub(crate) facet_room: u32,
    /// Nodes of the quadrature rule, and the polynomial's degree.
    pub(crate) nodes: u32,
    pub(crate) degree: u32,
    /// Room for records of finished cells.
    pub(crate) given_room: u32,
    /// Room for those of cells that have been begun.
    pub(crate) begun_room: u32,
    /// Leaves that are looked at for a cell that reaches far, before it is completed by its vertices: where weights differ, and else in stages that do that.
    pub(crate) leaves_if_far: u32,
}

/// Range of the sites of one group, or of all.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range {
    pub(crate) lo: [f64; 3],
    pub(crate) hi: [f64; 3],
    pub(crate) smallest_weight: f64,
    pub(crate) largest_weight: f64,
}

/// What the cells of a run count.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Counters {
    /// Lengths of the lists of cells that did not end.
    pub(crate) surface: u32,
    pub(crate) later: u32,
    pub(crate) full: u32,
    pub(crate) left: u32,
    /// The most sites that a cell visited.
    pub(crate) visited: u32,
    /// Facet records.
    pub(crate) facets: u32,
    /// The most triangles that a cell tried.
    pub(crate) tried: u32,
    /// Length of the records of finished cells.
    pub(crate) given: u32,
    /// Of those for later, those that reach beyond what was searched, or have more half-spaces than there is room for.
    pub(crate) beyond: u32,
    /// Length of the records of cells that have been begun; more than there is room for where some had none.
    pub(crate) begun: u32,
}
