//! The command line.

mod polynomial;
mod values;

use std::path::PathBuf;
use std::sync::LazyLock;

use clap::builder::PossibleValue;
use clap::{Args as ClapArgs, Parser, Subcommand, ValueEnum};
use laguerre::io::Columns;
use laguerre::{DeviceChoice, Integrand};

use crate::derivatives::{self, Asked};
use crate::uneven::{self, Uneven};
use polynomial::parse_polynomial;
pub(crate) use values::parse_count;
use values::{MOST_SITES, parse_box, parse_devices, parse_epsilon, parse_percent, parse_threads};

/// Restricted power diagrams: the cells of weighted sites, cut by a domain, and integrals over them.
///
/// The power cell of site i is where ‖x − p_i‖² − w_i is least; a larger weight is a larger cell. Every cell is complete by
/// proof, and every sign exact.
#[derive(Debug, Parser)]
#[command(name = "laguerre", version, after_help = EXAMPLES, arg_required_else_help = true)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) command: Command,
}

const EXAMPLES: &str = "\
Examples:
  laguerre demo                                                      10,000 cells in a swan, with a picture
  laguerre sample white 100000 --domain out/swan.off -o sites.xyz    sites in the swan's box
  laguerre integrate sites.xyz --domain out/swan.off -o cells.csv    volume and barycenter of every cell
  laguerre verify cells.csv sites.xyz --domain out/swan.off          whether they are right
  laguerre bench                                                     how fast, on this machine

Exit codes: 0 done; 2 wrong input or command line, or a file that cannot be read or written; 3 the backend is not there, or has failed;
4 some cell is not certified, or wrong, or lloyd or transport is not within its tolerance; 130 interrupted.";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Integrate(IntegrateArgs),
    Verify(VerifyArgs),
    Sample(SampleArgs),
    Demo(DemoArgs),
    Lloyd(crate::lloyd::LloydArgs),
    Fluid(crate::fluid::FluidArgs),
    Transport(crate::transport::TransportArgs),
    Tune(TuneArgs),
    Bench(BenchArgs),
    Devices(DevicesArgs),
    Completions(CompletionsArgs),
    Man(ManArgs),
    Paper(PaperArgs),
}

/// What can compute on this machine, and why what cannot, cannot.
#[derive(ClapArgs, Debug)]
pub(crate) struct DevicesArgs {
    /// Print one JSON object instead of the list
    #[arg(long)]
    pub(crate) json: bool,
}

/// What a shell completes after `laguerre`, for it to read: printed, to be saved where it looks.
#[derive(ClapArgs, Debug)]
#[command(after_help = COMPLETIONS_EXAMPLES)]
pub(crate) struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL")]
    pub(crate) shell: clap_complete::Shell,
}

const COMPLETIONS_EXAMPLES: &str = "\
Examples:
  laguerre completions bash > ~/.local/share/bash-completion/completions/laguerre
  laguerre completions zsh > ~/.zfunc/_laguerre                      with ~/.zfunc in $fpath
  laguerre completions fish > ~/.config/fish/completions/laguerre.fish";

/// Pages for `man`: laguerre.1, and one for each command, as laguerre-integrate.1.
#[derive(ClapArgs, Debug)]
#[command(after_help = MAN_EXAMPLES)]
pub(crate) struct ManArgs {
    /// Where to write the pages; made if it is not there
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,
}

const MAN_EXAMPLES: &str = "\
Examples:
  laguerre man ~/.local/share/man/man1      then: man laguerre-integrate";

/// Volume and barycenter of the power cell of every site, cut by a domain.
///
/// SITES is .xyz, .txt or .csv (3 or 4 columns, the fourth the weight; the first line may be the count or the columns' names, in any order with x, y
/// and z among them; or as chemists have it: a count, a comment, rows of a name and x y z), .npy (N×3 or N×4), .npz (an array positions, points or sites,
/// N×3, and one weights), .ply (its vertices, with a property w or weight), .vtk or .vtp (the points of PolyData), .dump or .lammpstrj (a snapshot of LAMMPS as text), each
/// but NumPy's also packed, with .gz after it, or - for text on standard input.
/// Without --domain, --image or --box, the cells are cut by the bounding box of the sites.
#[derive(ClapArgs, Debug)]
#[command(after_help = INTEGRATE_EXAMPLES)]
pub(crate) struct IntegrateArgs {
    #[command(flatten)]
    pub(crate) sites: SitesArgs,

    #[command(flatten)]
    pub(crate) container: ContainerArgs,

    /// Where to write the cells: .csv (site,volume,x,y,z,facets,status, the status 0 complete, 1 empty, 2 not certified; NaN for what there
    /// is not), .npy (N×4: volume, barycenter), .npz (arrays volume, barycenter, status, facets, second_moment, integral) or - for standard output, as .csv;
    /// their geometry, cut by the domain: .vtu (solids: a polyhedron, or the tetrahedra of a cell that the domain cuts or that VTK would lose a part
    /// of), .vtp or .ply (polygons), .glb (triangles, no neighbours of one colour)
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// Where to write a page that shows the cells in 3D, for any browser, all in the one file: .html, or - for standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) html: Option<PathBuf>,

    /// Where to write the facets, each once from each side, neighbor -1 and distance NaN for the boundary: .csv
    /// (site,neighbor,area,x,y,z,distance), .npy (those columns), .npz (arrays offsets, site, neighbor, area, barycenter, distance; those of site
    /// i are offsets[i] to offsets[i + 1]) or - for standard output, as .csv
    #[arg(long, value_name = "FILE")]
    pub(crate) facets: Option<PathBuf>,

    /// Also the integral of a polynomial over every cell, such as "2*x^2*y - z + 1", of a degree up to 31: the sum is printed, and an .npz of
    /// cells has an array integral
    #[arg(long, value_name = "POLYNOMIAL", allow_hyphen_values = true, value_parser = parse_polynomial)]
    pub(crate) integral: Option<Integrand>,

    /// Where to write derivatives, as sparse rows for scipy.sparse.load_npz, once for each matrix: volumes-by-weights=FILE.npz (N×N, half of the
    /// Laplacian: a facet's area over twice the distance, with a minus off the diagonal), volumes-by-positions (N×3N), barycenters-by-weights (3N×N), barycenters-by-positions (3N×3N). A coordinate of site i
    /// is row or column 3 i, 3 i + 1 or 3 i + 2
    #[arg(long, value_name = "NAME=FILE", value_parser = derivatives::parse)]
    pub(crate) derivatives: Vec<Asked>,

    /// Also the second moments of each cell about its barycenter, 3×3, for an .npz of cells
    #[arg(long)]
    pub(crate) second_moments: bool,

    #[command(flatten)]
    pub(crate) backend: BackendArgs,

    /// Stop each cell at the security radius times 1 + E, without proof that it is complete; the check is that the
    /// volumes sum to the domain's
    #[arg(long, value_name = "E", allow_hyphen_values = true, value_parser = parse_epsilon)]
    pub(crate) epsilon: Option<f64>,

    /// Print one JSON object instead of the summary
    #[arg(long)]
    pub(crate) json: bool,
}

const INTEGRATE_EXAMPLES: &str = "\
Examples:
  laguerre integrate sites.xyz --domain out/swan.off -o cells.csv --facets facets.csv
  laguerre integrate sites.npy --weights weights.npy --box 0,0,0,1,1,1 --json
  laguerre integrate sites.npy --domain out/swan.off -o cells.npz --facets facets.npz      NumPy: np.load
  laguerre integrate sites.npy --box 0,0,0,1,1,1 --derivatives volumes-by-weights=jacobian.npz --integral 'x^2 + y^2'
  laguerre integrate sites.npy --domain out/swan.off --html cells.html                      to look at, in a browser
  generate | laguerre integrate - --domain part.stl -o cells.vtu";

/// Whether a result file, whoever wrote it, is right: its sums, its cells, its facets.
///
/// RESULTS is .csv (site,volume,x,y,z and, if known, facets,status, the number of facets held to those of --facets; a row for each site, in their order), .npy (N×4: volume,
/// barycenter) or .npz (arrays volume, barycenter and, if known, facets, status), as integrate writes it. Every cell is computed anew; a sample of them, and those that seem wrong, also without a
/// search, by cutting with all sites. Says which cells and facets are wrong, and exits with 4 if any is.
#[derive(ClapArgs, Debug)]
#[command(after_help = VERIFY_EXAMPLES)]
pub(crate) struct VerifyArgs {
    /// The cells to check: .csv, .npy or .npz
    pub(crate) results: PathBuf,

    #[command(flatten)]
    pub(crate) sites: SitesArgs,

    #[command(flatten)]
    pub(crate) container: ContainerArgs,

    /// The facets to check: .csv (site,neighbor,area,x,y,z,distance), .npy or .npz, as integrate writes them
    #[arg(long, value_name = "FILE")]
    pub(crate) facets: Option<PathBuf>,

    /// Cells of the sample that all sites cut
    #[arg(long, value_name = "N", default_value_t = 200)]
    pub(crate) cells: usize,

    /// Another seed takes another sample
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,

    /// What numbers may be off, relative to themselves and to the mean volume, area or size, and sums relative to the whole: for
    /// results of fewer digits. Unless given, 1e-12, and 1e-14 for sums; what rounding adds is allowed for besides
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = parse_epsilon)]
    pub(crate) tolerance: Option<f64>,

    /// Print one JSON object instead of the findings in words
    #[arg(long)]
    pub(crate) json: bool,
}

const VERIFY_EXAMPLES: &str = "\
Examples:
  laguerre verify cells.csv sites.xyz --domain out/swan.off --facets facets.csv
  laguerre verify theirs.npy sites.npy --box 0,0,0,1,1,1 --tolerance 1e-6 --cells 1000";

/// Sites to compute with: they fill the box of the domain, or are one of the uneven inputs of `bench --uneven`.
///
/// Uneven inputs are in the unit cube, or stretched to --box; those with weights have them in the fourth column.
#[derive(ClapArgs, Debug)]
#[command(after_help = SAMPLE_EXAMPLES)]
pub(crate) struct SampleArgs {
    /// How the sites are spread
    #[arg(value_name = "DIST")]
    pub(crate) distribution: Spread,

    /// Number of sites, such as 100000, 100_000 or 1e5 (lattice, perturbed and mirrored come as near as they can)
    #[arg(value_name = "N", value_parser = parse_count::<1, MOST_SITES>)]
    pub(crate) count: u32,

    #[command(flatten)]
    pub(crate) container: ContainerArgs,

    /// Keep the sites inside the domain only: N of them
    #[arg(long, requires = "domain", conflicts_with_all = ["box", "image"])]
    pub(crate) inside: bool,

    /// Another seed makes other sites; the same makes the same
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,

    /// Where to write the sites: .xyz, .txt, .csv, .npy or .ply; - for standard output, as .csv
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,

    /// Print one JSON object that says what was made
    #[arg(long)]
    pub(crate) json: bool,
}

const SAMPLE_EXAMPLES: &str = "\
Examples:
  laguerre sample white 100000 --domain out/swan.off -o sites.xyz
  laguerre sample blue 10000 --domain out/swan.off --inside --seed 7 -o sites.npy
  laguerre sample lattice 64000 --box 0,0,0,1,1,1 -o lattice.xyz
  laguerre sample plummer 100000 -o halo.npy";

/// What `sample` knows: sites that fill a box, and uneven inputs.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Spread {
    Filling(Distribution),
    Uneven(&'static Uneven),
}

impl ValueEnum for Spread {
    fn value_variants<'a>() -> &'a [Self] {
        static ALL: LazyLock<Vec<Spread>> = LazyLock::new(|| {
            let filling = Distribution::value_variants().iter().copied().map(Spread::Filling);
            filling.chain(uneven::INPUTS.iter().map(Spread::Uneven)).collect()
        });
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self {
            Self::Filling(distribution) => distribution.to_possible_value(),
            Self::Uneven(input) => Some(PossibleValue::new(input.name).help(input.about)),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ValueEnum)]
pub(crate) enum Distribution {
    /// Independent and uniform
    White,
    /// A lattice, each site moved at random within the half-sized voxel about it
    Perturbed,
    /// White, moved by Lloyd's algorithm until the volumes of the cells vary by less than 10 %
    Blue,
    /// The centres of the voxels of a grid
    Lattice,
    /// A blue tile, mirrored in planes to 5×5×5 tiles: cells that meet in symmetric, degenerate vertices
    Mirrored,
}

/// The main job on built-in input: the cells of 10,000 sites in a swan.
///
/// Prints the summary and writes swan.off (the domain), cells.csv, cells.vtu (for ParaView), cells.html (for a browser) and cells.png, a slice
/// through the swan.
#[derive(ClapArgs, Debug)]
pub(crate) struct DemoArgs {
    /// Where to write the files; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub(crate) out_dir: PathBuf,

    /// Number of sites
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = parse_count::<1, 10_000_000>)]
    pub(crate) sites: u32,

    /// Print one JSON object instead of the summary, as integrate does
    #[arg(long)]
    pub(crate) json: bool,
}

/// What the cells of SITES need: histograms of neighbours visited, half-spaces, vertices and triangles, and capacities for 95 % of them.
///
/// K: sites visited before a cell is complete. P and V: the most half-spaces and vertices at once. T: triangles of the domain tried.
#[derive(ClapArgs, Debug)]
#[command(after_help = TUNE_EXAMPLES)]
pub(crate) struct TuneArgs {
    #[command(flatten)]
    pub(crate) sites: SitesArgs,

    #[command(flatten)]
    pub(crate) container: ContainerArgs,

    /// Where to draw the histograms: .svg
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// The share of the cells, in percent, that the proposed capacities are to suffice for
    #[arg(long, value_name = "PERCENT", default_value_t = 95.0, value_parser = parse_percent)]
    pub(crate) share: f64,

    /// Print one JSON object instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}

const TUNE_EXAMPLES: &str = "\
Examples:
  laguerre tune sites.xyz --domain out/swan.off -o counts.svg
  laguerre tune sites.npy --weights weights.npy --box 0,0,0,1,1,1 --share 99 --json";

/// How fast the backends are on this machine: backend × distribution × number of sites × domain.
///
/// Each input is made in memory as `sample` makes it. One evaluation to warm up, then some whose median and spread are shown: the whole
/// call, from arrays in memory to results in memory, and of that what a device computed. Volumes and barycenters, no facets.
///
/// With --uneven: what a site of each uneven input takes over one of white noise, in one run, as a table in Markdown.
#[derive(ClapArgs, Debug)]
#[command(after_help = BENCH_EXAMPLES)]
pub(crate) struct BenchArgs {
    /// Numbers of sites (each distribution comes as near as it can)
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [10_000, 100_000],
          value_parser = parse_count::<1, MOST_SITES>)]
    pub(crate) sites: Vec<u32>,

    /// Distributions, as `sample` knows them
    #[arg(long, value_name = "DIST,…", value_delimiter = ',', default_values = ["white", "perturbed", "blue", "lattice"])]
    pub(crate) distributions: Vec<Distribution>,

    /// What cuts the cells: box, the domains swan, trefoil, torus, double-torus, sphere, cavity, bunny (in a checkout of the sources), or mesh
    /// files
    #[arg(long, value_name = "NAME|MESH,…", value_delimiter = ',', default_values = ["box", "swan"])]
    pub(crate) domains: Vec<String>,

    /// What is asked for beside volumes and barycenters
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', default_values = ["moments"])]
    pub(crate) requests: Vec<BenchRequest>,

    /// Uneven inputs in the unit cube, as `sample` knows them, instead: all unless named (--uneven=plummer,line). The time of a site
    /// over white noise's is that of the fastest calls, and in bold where it is beyond the limit that is set for the input
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', num_args = 0.., require_equals = true,
          value_parser = uneven::named, conflicts_with_all = ["distributions", "domains", "requests"])]
    pub(crate) uneven: Option<Vec<&'static Uneven>>,

    /// Hold 500 cells of each uneven input to the naive oracle, which all sites cut (slow), and exit with 4 if any is wrong
    #[arg(long, requires = "uneven")]
    pub(crate) check: bool,

    /// Backends; those that are there unless given
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub(crate) backends: Vec<BenchBackend>,

    /// Evaluations after the one that warms up
    #[arg(long, value_name = "R", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) repetitions: u32,

    /// OpenCL devices: their numbers, separated by commas, or all; the first GPU unless given
    #[arg(long, value_name = "N|all", value_parser = parse_devices)]
    pub(crate) device: Option<DeviceChoice>,

    /// Threads of the CPU; unless given one for each core, or fewer where a limit of memory has no room for them
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub(crate) threads: Option<usize>,

    /// Print one JSON object instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}

const BENCH_EXAMPLES: &str = "\
Examples:
  laguerre bench
  laguerre bench --backends ocl --device 0 --sites 1000000,10000000 --distributions white --repetitions 5
  laguerre bench --domains part.stl --json
  laguerre bench --requests moments,facets --threads 1
  laguerre bench --uneven --sites 100000 --backends cpu";

/// What computes, where more than one may be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BenchBackend {
    /// All cores, with SIMD
    Cpu,
    /// OpenCL devices
    Ocl,
}

/// What an evaluation is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BenchRequest {
    /// Volumes and barycenters
    Moments,
    /// Facets too
    Facets,
    /// The Laplacian too
    Laplacian,
    /// The Laplacian too, which stays on a device, as in a solver's loop
    LaplacianKept,
}

/// The experiments of the paper (Basselin et al., "Restricted Power Diagrams on the GPU", 2021), as text for BENCHMARKS.md.
///
/// Fig. 9: what cells need, by distribution, Voronoi and power. Fig. 10: three distributions, no domain and six domains, per pass.
/// Fig. 11: Voronoi against power diagrams of cells of equal volume. The precision paragraph of §6.3: the sums against the domain's,
/// and each cell against another computation. `cargo xtask paper` runs this and puts the text in its place.
#[derive(ClapArgs, Debug)]
#[command(hide = true)]
pub(crate) struct PaperArgs {
    /// Number of sites
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = parse_count::<100, MOST_SITES>)]
    pub(crate) sites: u32,

    #[command(flatten)]
    pub(crate) backend: BackendArgs,

    /// Evaluations after the one that warms up
    #[arg(long, value_name = "R", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) repetitions: u32,

    /// Which experiments
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', default_values = ["fig9", "fig10", "fig11", "precision"])]
    pub(crate) only: Vec<Experiment>,

    /// Where to write the text, between marker comments; standard output unless given
    #[arg(long, value_name = "FILE")]
    pub(crate) markdown: Option<PathBuf>,

    /// Where to draw the histograms of Fig. 9: .svg
    #[arg(long, value_name = "FILE")]
    pub(crate) picture: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Experiment {
    /// What cells need
    Fig9,
    /// Timings by distribution and domain
    Fig10,
    /// Voronoi against power
    Fig11,
    /// The precision paragraph
    Precision,
}

#[derive(ClapArgs, Debug)]
pub(crate) struct SitesArgs {
    /// Sites, with weights in a fourth column: .xyz, .txt, .csv, .npy, .npz, .ply, .vtk, .vtp, .dump, .lammpstrj, or - for text on standard input
    #[arg(value_name = "SITES")]
    pub(crate) path: PathBuf,

    /// What the columns of text are, such as id,x,y,z,r (voro++): x, y, z; w or weight; r or radius, whose square is the weight; others are passed over.
    /// Without this the first line may name them
    #[arg(long, value_name = "NAMES")]
    pub(crate) columns: Option<Columns>,

    /// Weights in a file of their own, one for each site: .txt or .csv (one a line) or .npy
    #[arg(long, value_name = "FILE")]
    pub(crate) weights: Option<PathBuf>,
}

#[derive(ClapArgs, Debug)]
pub(crate) struct ContainerArgs {
    /// A closed triangle mesh: .obj, .off, .ply, .stl, .vtk or .vtp, or with .gz after that
    #[arg(long, value_name = "MESH", conflicts_with = "box")]
    pub(crate) domain: Option<PathBuf>,

    /// Turn every part of the mesh's surface outward, or inward where it lies within an odd number of others, so that a shell within a shell is a cavity; without
    /// this only a mesh whose triangles do not agree is turned so
    #[arg(long, requires = "domain", conflicts_with_all = ["box", "image"])]
    pub(crate) orient: bool,

    /// A density, constant in each voxel: .npy of shape (nx, ny, nz), which fills --box, or without it has unit cubes. Volumes are then masses, barycenters those of mass
    #[arg(long, value_name = "IMAGE", conflicts_with = "domain")]
    pub(crate) image: Option<PathBuf>,

    /// An axis-aligned box: minimum corner, maximum corner
    #[arg(long, value_name = "x0,y0,z0,x1,y1,z1", allow_hyphen_values = true, value_parser = parse_box)]
    pub(crate) r#box: Option<Corners>,
}

impl ContainerArgs {
    /// The file that it is read from.
    pub(crate) fn file(&self) -> Option<&PathBuf> {
        self.domain.as_ref().or(self.image.as_ref())
    }
}

/// Minimum and maximum corner of a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corners {
    pub(crate) lo: [f64; 3],
    pub(crate) hi: [f64; 3],
}

impl Corners {
    /// What sites fill unless something else is given.
    pub(crate) const UNIT_CUBE: Self = Self { lo: [0.0; 3], hi: [1.0; 3] };
}

#[derive(ClapArgs, Debug)]
pub(crate) struct BackendArgs {
    /// What computes
    #[arg(long, value_name = "NAME", default_value = "auto")]
    pub(crate) backend: BackendChoice,

    /// OpenCL devices: their numbers, separated by commas, or all; the first GPU unless given (`laguerre devices` lists them)
    #[arg(long, value_name = "N|all", value_parser = parse_devices)]
    pub(crate) device: Option<DeviceChoice>,

    /// Number type of the devices
    #[arg(long, value_name = "TYPE", default_value = "f64")]
    pub(crate) precision: Precision,

    /// Threads of the CPU; unless given one for each core, or fewer where a limit of memory has no room for them
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub(crate) threads: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BackendChoice {
    /// The fastest that is there: a GPU if this build has OpenCL and one can be used, else the CPU; the CPU with --threads
    Auto,
    /// All cores, with SIMD
    Cpu,
    /// OpenCL devices
    Ocl,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Precision {
    /// 64-bit floats
    F64,
    /// 32-bit floats, on OpenCL devices, for volumes, barycenters and geometry
    F32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Args::command().debug_assert();
    }
}
