//! The stages of cells that several work-items compute together, and how each is built.

use laguerre_core::cell::FACETS;

/// What cells that are computed together are built for. Each stage is left some of the cells of the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Stage {
    /// All of them, with numbers in single precision; those are given up whose signs it leaves open, or whose volumes it does not tell well, or which may
    /// meet the surface.
    Single,
    /// All of them; those are given up that need exact signs, or may meet the surface. By the table of offsets or by the tree; or where weights differ by the table, and what that leaves, if it is much, by the tree.
    First,
    /// The same, with signs that double precision or double-double settles: where the table of offsets is gone through and weights differ, of sites most of which
    /// have one open, as particles that were a lattice.
    Close,
    /// Those that may meet the surface, finished; those are given up that need exact signs. With facets those that do, with exact signs.
    Surface,
    /// The integrals of what `Sweep` has finished, and where facets are asked for of all that the stages before have; those that the surface cuts are `Surface`'s.
    Integrals,
    /// Those that are completed by their vertices, where the tree is searched or weights differ, and those that reach far outside the domain, where they are many (`WORTH_GIVING`); those are
    /// given up that double-double does not decide.
    Far,
    /// Of them, where their weights are equal, those that end with one look at all that can still cut them; some begin with what bounds their neighbours far off. Those are given up
    /// for which that tells too little. What it finishes it gives as records, so that its text has nothing of integrals.
    Sweep,
    /// Those that need exact signs, or where equal weights go through the table of offsets sites beyond it, or that then reach far outside the domain, where they are few.
    Exact,
    /// Those that need more room, where the tree is searched; those are given up that double-double does not decide.
    Large,
    /// The same, for those that need exact signs.
    Wide,
    /// Those that need more room than local memory has.
    Vast,
}

/// How a stage is built.
pub(super) struct Shape {
    /// Cells of a group. In the first stages as many as fit into 48 KiB, so that they go through the same instructions at about the same time, which are
    /// more than the nearest cache holds (of 2 million cells, 5 instead of 4 save 1 %, 2 cost 8 %; with a
    /// domain and weights, whose text is longer, Fig. 11's cells take 7.3 ms so, and 8.0, 9.3, 11.8 and 19.5 with 4, 3, 2 and 1; one NVIDIA H200); but no more than let registers be
    /// used up. Of cells that are completed by their vertices some take a hundred times as long as others, and a group ends with its last (with 1
    /// instead of 4 sites on a jittered sphere take 20 % less time, on a Lévy flight 7).
    pub(super) cells: u32,
    /// More registers for each work-item, and fewer cells are computed at a time (measured; an option of NVIDIA's alone).
    pub(super) registers: Option<u32>,
    /// `SHORT`, where nothing but volumes, barycenters and facets is asked for (`prelude.cl`; [`Stage::is_short`]).
    pub(super) short: bool,
    /// `WITH_CLOSE`.
    pub(super) close: bool,
    pub(super) far: bool,
    /// `WITH_SWEEP`.
    pub(super) sweep: bool,
    pub(super) exact: bool,
    pub(super) surface: bool,
    /// `TAKES_CELLS`.
    pub(super) takes: bool,
    /// `WITH_ROOM`.
    pub(super) room: u32,
    /// Teams of lanes that a cell has: each asks for another vertex of it at the same time (`kernels/README.md`).
    pub(super) teams: u32,
}

impl Stage {
    #[cfg(any(test, feature = "test-util"))]
    pub(crate) const ALL: [Self; 11] = [
        Self::Single,
        Self::First,
        Self::Close,
        Self::Surface,
        Self::Integrals,
        Self::Far,
        Self::Sweep,
        Self::Exact,
        Self::Large,
        Self::Wide,
        Self::Vast,
    ];

    pub(super) const fn shape(self) -> Shape {
        const FIRST: Shape = Shape {
            cells: 5,
            registers: Some(96),
            short: true,
            close: false,
            far: false,
            sweep: false,
            exact: false,
            surface: false,
            takes: false,
            room: 0,
            teams: 1,
        };
        const EXACT: Shape = Shape {
            cells: 4,
            registers: Some(128),
            short: false,
            close: false,
            far: true,
            sweep: false,
            exact: true,
            surface: true,
            takes: false,
            room: 0,
            teams: 1,
        };
        match self {
            Self::Single | Self::First => FIRST,
            Self::Close => Shape { short: false, close: true, ..FIRST },
            // (`Far` with 96: a Lévy flight 0.162 instead of 0.156 s; 80, 112 and 152 take 2 to 16 % longer. `Sweep`, of whose cells a processor's local memory holds 30, takes 1 to 3 %
            // longer with 72, 6 to 8 with 96. Cells that need more room take 20 % longer with 168. `First` by the tree with 80, 112 or 128: 3 to 18 %.)
            Self::Far => Shape { cells: 1, registers: Some(128), short: false, far: true, ..FIRST },
            Self::Sweep => Shape { cells: 1, registers: Some(64), short: false, sweep: true, ..FIRST },
            Self::Surface => Shape { cells: 4, registers: Some(168), surface: true, takes: true, ..FIRST },
            Self::Integrals => Shape { cells: 4, registers: Some(128), takes: true, ..FIRST },
            Self::Exact => EXACT,
            Self::Large => Shape { exact: false, ..Self::Wide.shape() },
            Self::Wide => Shape { cells: 1, registers: Some(128), room: 1, teams: 4, ..EXACT },
            Self::Vast => Shape { cells: 1, registers: Some(128), room: 2, teams: 8, ..EXACT },
        }
    }

    /// Whether its text may be short where so much is asked for: where signs are exact it has calls.
    pub(super) const fn is_short(self, flags: u32) -> bool {
        self.shape().short && !(matches!(self, Self::Surface) && flags & FACETS != 0)
    }

    /// Whether what it finishes may be given to another stage: to `Surface`, or where facets are asked for, and of `Sweep`, to `Integrals`.
    pub(crate) const fn gives(self) -> bool {
        matches!(self, Self::Single | Self::First | Self::Close | Self::Far | Self::Sweep)
    }
}
