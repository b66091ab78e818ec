//! The kernels of sites and cells in double precision, and their parameters. What they do is said where their text is.

use super::data::{Counters, Params, Range};
use super::table::kernels;
use laguerre_core::assemble::FacetRecord;
use laguerre_core::cell::FacetSecond;
use laguerre_core::power_octree::OctreeBox;
use laguerre_core::site_tree::{Boxes, Slabs, WeightBounds};

kernels! {
    /// Sites and domain.
    group World {
        input params: Params,
        /// Sorted sites: x, y, z, weight.
        input sites: [f64; 4],
        /// Where the sites of each voxel begin and end, where the table of offsets is gone through.
        input voxels: [u32; 2],
        /// The tree over the sites, block by block.
        input boxes: Boxes,
        input slabs: Slabs,
        input weight_bounds: WeightBounds,
        /// What the sites around each block of leaves weigh at most, less its slope, ring by ring, where the table of offsets is gone through and weights differ.
        input around: f64,
        /// The octree over the container: where the parts of each box begin, or the leaves that it lists, and how many these are; these leaves; the box
        /// that each sorted site's cell is in; and the boxes' middles.
        input octree_nodes: [u32; 2],
        input octree_leaves: u32,
        input octree_homes: u32,
        input octree_middles: [f64; 4],
        input domain_vertices: [f64; 3],
        /// Corners, and how often it stands.
        input triangles: [u32; 4],
        input lowest_voxels: [u32; 3],
        input list_offsets: u32,
        input list_entries: u32,
        input windings: i32,
        input surface_table: u32,
        /// Nodes and coefficients of the function to be integrated, if there is one.
        input integrand: f64,
    }

    kernel Cells = cells {
        group world: World,
        /// The table of offsets.
        input shells: [u8; 4],
        /// How near the surface is to each site.
        input abouts: [i32; 2],
        /// The caller's index of each sorted site.
        input order: u32,
        /// The cells of a list, or without one every `stride`th from `first` on: `count` of them, of every `apart`th work-item.
        input list: u32,
        value has_list: u32,
        value first: u32,
        value stride: u32,
        value apart: u32,
        value count: u32,
        value interior_only: u32,
        /// Those of them that are to be computed, where some keep for others what bounds them far off (`leaders.cl`); who these are; and what bounds them,
        /// `MOST_KEPT` numbers a block of leaves.
        value turn_of: u32,
        input leaders: u32,
        output kept: u32,
        /// Results, by the caller's index.
        output outcome: u32,
        output sums: f64,
        output rows: [u64; 2],
        output facets: FacetRecord,
        output facet_moments: [f64; 3],
        output facet_seconds: FacetSecond,
        atomic counters: Counters,
        /// Lists of the cells that did not end: those near the surface, or where lanes share a cell their records; those for the next stage, or pass, with
        /// more room; those for which there was no room for facets, or whose sweep was given up; and those left to another way, or to the host.
        output surface: u32,
        output later: u32,
        output full: u32,
        output left: u32,
        /// Records of finished cells: of those near the surface, or that were swept; where facets are asked for of all.
        output given: [u32; 4],
        /// Records of cells that another stage is to go on with; and of each site where that of its cell begins, from 1 on, or 0.
        output begun: [u32; 4],
        output begun_places: u32,
        /// Where cells live that are too large for local memory.
        output vast: u64,
    }

    kernel EnterSites = enter_sites {
        input params: Params,
        input positions: [f64; 3],
        input weights: f64,
        value has_weights: u32,
        value count: u32,
        output placed: [f64; 4],
        output ranges: Range,
    }

    kernel MarkVoxels = mark_voxels {
        input params: Params,
        input placed: [f64; 4],
        value count: u32,
        output marks: u32,
    }

    kernel RankSites = rank_sites {
        input params: Params,
        input placed: [f64; 4],
        value count: u32,
        /// Of each turn of the curve and octant its rank, and the turn within it.
        input turns: [u8; 2],
        value levels: u32,
        value finer: u32,
        output ranks: u64,
        output slots: u32,
    }

    kernel CountDigits = count_digits {
        input ranks: u64,
        value count: u32,
        value shift: u32,
        output counts: u32,
    }

    kernel PlaceDigits = place_digits {
        input ranks: u64,
        input slots: u32,
        value count: u32,
        value shift: u32,
        input starts: u32,
        output new_ranks: u64,
        output new_slots: u32,
    }

    kernel ScanBlocks = scan_blocks {
        output data: u32,
        value count: u32,
        output sums: u32,
    }

    kernel AddBlocks = add_blocks {
        output data: u32,
        value count: u32,
        input sums: u32,
    }

    kernel SettleRuns = settle_runs {
        input placed: [f64; 4],
        input ranks: u64,
        value count: u32,
        value most: u32,
        output slots: u32,
        output kept: u32,
        output is_long: u32,
    }

    kernel GatherSites = gather_sites {
        input placed: [f64; 4],
        input slots: u32,
        input places: u32,
        value count: u32,
        output sites: [f64; 4],
        output order: u32,
    }

    kernel FindVoxels = find_voxels {
        input params: Params,
        input sites: [f64; 4],
        value count: u32,
        output voxels: [u32; 2],
        output crowded: u32,
    }

    kernel BoundNodes = bound_nodes {
        input params: Params,
        input sites: [f64; 4],
        value level: u32,
        /// Blocks of the level.
        value blocks: u32,
        output boxes: Boxes,
        output slabs: Slabs,
        output weight_bounds: WeightBounds,
    }

    kernel LookAtRings = look_at_rings {
        input params: Params,
        input sites: [f64; 4],
        input boxes: Boxes,
        input weight_bounds: WeightBounds,
        output around: f64,
    }

    kernel TightenSlabs = tighten_slabs {
        input params: Params,
        input sites: [f64; 4],
        value level: u32,
        output slabs: Slabs,
    }

    /// Boxes of the octree over the container that are split, and the leaves that they list.
    group Splitting {
        input params: Params,
        input sites: [f64; 4],
        input boxes: OctreeBox,
        input leaves: u32,
        value margin: f64,
        /// 1 for each leaf of a box that a part keeps, part by part.
        output kept: u8,
    }

    kernel SplitBoxes = split_boxes {
        group splitting: Splitting,
        output counts: u32,
    }

    kernel FindLeasts = find_leasts {
        group splitting: Splitting,
        value slices: u32,
        /// Whether it is by the middles of the faces, and not by that of the box.
        value is_second: u32,
        /// Leaves that each part keeps by the site of least power in its middle.
        input firsts: u32,
        /// Sites of each slice, a place of a box each.
        output leasts: u32,
    }

    kernel MarkSlices = mark_slices {
        group splitting: Splitting,
        value slices: u32,
        value is_second: u32,
        input leasts: u32,
        atomic firsts: u32,
        atomic counts: u32,
    }

    kernel JudgeParts = judge_parts {
        input boxes: OctreeBox,
        input counts: u32,
        value parts: u32,
        value depth: u32,
        /// How many leaves a box lists at most.
        value most: u32,
        /// Of each part whether it is split, and how many leaves it brings to those of such boxes, and to those that are listed; 0 behind the last.
        output splits: u32,
        output wholes: u32,
        output lists: u32,
        /// 1 where a part's leaves are too many to be listed.
        output unlisted: u32,
    }

    kernel PlaceLeaves = place_leaves {
        input boxes: OctreeBox,
        input leaves: u32,
        input kept: u8,
        input counts: u32,
        /// Of each part the sums over those before it.
        input splits: u32,
        input wholes: u32,
        input lists: u32,
        value most: u32,
        /// The number of the first part among all boxes, and how many leaves are listed before.
        value first: u32,
        value before: u32,
        output next_boxes: OctreeBox,
        output next: u32,
        output listed: u32,
        output nodes: [u32; 2],
        output middles: [f64; 4],
    }

    kernel FindHomes = find_homes {
        input params: Params,
        input sites: [f64; 4],
        input nodes: [u32; 2],
        input middles: [f64; 4],
        input listed: u32,
        value is_second: u32,
        atomic ways: u32,
        atomic homes: u32,
    }

    kernel MeasureClearances = measure_clearances {
        input params: Params,
        input surface_table: u32,
        value count: u32,
        output clearances: u8,
    }

    kernel ChooseLeaders = choose_leaders {
        /// The cells of a list, or without one those from `first` on.
        input list: u32,
        value has_list: u32,
        value first: u32,
        value count: u32,
        atomic leaders: u32,
    }

    kernel LookAbout = look_about {
        input params: Params,
        input sites: [f64; 4],
        value first: u32,
        value count: u32,
        input clearances: u8,
        input windings: i32,
        output abouts: [i32; 2],
    }

    kernel CountRows = count_rows {
        value count: u32,
        input outcome: u32,
        input rows: [u64; 2],
        output counts: u32,
    }

    kernel WriteRows = write_rows {
        input params: Params,
        value count: u32,
        input placed: [f64; 4],
        input rows: [u64; 2],
        input records: FacetRecord,
        input moments: [f64; 3],
        value has_seconds: u32,
        input seconds: FacetSecond,
        input offsets: u32,
        value area_unit: f64,
        value second_unit: f64,
        output neighbors: u32,
        output areas: f64,
        output barycenters: [f64; 3],
        output distances: f64,
        output second_moments: [f64; 6],
    }

    kernel CountFacets = count_facets {
        /// The caller's index of the site of each row.
        input order: u32,
        value count: u32,
        input outcome: u32,
        input rows: [u64; 2],
        output place: u32,
        output counts: u32,
        output is_long: u32,
    }

    kernel ListFacets = list_facets {
        input order: u32,
        value count: u32,
        input rows: [u64; 2],
        input records: FacetRecord,
        input place: u32,
        input offsets: u32,
        output listed: u32,
    }

    kernel SortFacets = sort_facets {
        input order: u32,
        value count: u32,
        input rows: [u64; 2],
        input records: FacetRecord,
        input listed: u32,
        input offsets: u32,
        output columns: u32,
        output areas: f64,
    }

    kernel MatchFacets = match_facets {
        input params: Params,
        input sites: [f64; 4],
        value count: u32,
        input offsets: u32,
        input columns: u32,
        input areas: f64,
        /// The values, in the place of areas of records that are not needed any more.
        output records: FacetRecord,
        output counts: u32,
    }

    kernel PackFacets = pack_facets {
        value count: u32,
        input offsets: u32,
        input columns: u32,
        input records: FacetRecord,
        input starts: u32,
        output packed_columns: u32,
        output packed_values: f64,
    }

    kernel FillLaplacian = fill_laplacian {
        value count: u32,
        input starts: u32,
        input packed_columns: u32,
        input packed_values: f64,
        value scale: f64,
        output offsets: u32,
        output columns: u32,
        output values: f64,
    }

    kernel GatherCells = gather_cells {
        input params: Params,
        value count: u32,
        input order: u32,
        input sites: [f64; 4],
        input outcome: u32,
        input sums: f64,
        value per_unit: f64,
        output cells: f64,
    }

    kernel SumCells = sum_cells {
        input params: Params,
        value count: u32,
        /// In the caller's order, as all here.
        input placed: [f64; 4],
        input outcome: u32,
        input sums: f64,
        /// Of each group its sums, and what they have lost.
        output parts: f64,
    }

    kernel MoveSites = move_sites {
        input params: Params,
        value count: u32,
        input placed: [f64; 4],
        input outcome: u32,
        input sums: f64,
        input positions: [f64; 3],
        output moved: [f64; 3],
    }

    kernel TryLanes = try_lanes {
        /// 1 for each work-item for which all is right.
        output right: u32,
    }
}
