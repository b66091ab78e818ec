//! The builds of the kernels: their texts, and the flags that they are compiled with.

mod stage;

use crate::interface::data::Params;
use crate::sources::Text;
use laguerre_core::cell::{FACET_AREAS, FACET_SECOND_MOMENTS, FACETS, INTEGRAL, SECOND_MOMENTS};
use laguerre_core::passes::Capacities;
use stage::Shape;

pub(crate) use stage::Stage;

/// The kernels that sort sites and make the tree, and those that find how near the surface is to them.
const GRID: Text = without_cells(&["grid.cl", "order.cl", "bound_nodes.cl", "clearance.cl", "leaders.cl"]);

/// Those of the octree over the container; of rows of facets and of the Laplacian; of sites that stay; and linear algebra.
const OCTREE: Text = without_cells(&["power_octree.cl"]);
const ROWS: Text = without_cells(&["facets.cl", "laplacian.cl"]);
const TOTALS: Text = without_cells(&["totals.cl"]);
const ALGEBRA: Text = without_cells(&["algebra.cl", "aggregation.cl"]);

/// A text that computes no cells.
const fn without_cells(entries: &'static [&'static str]) -> Text {
    Text { entries, prelude: "prelude.cl", store: None }
}

/// A cell by one work-item, and by several.
const ALONE: Text = Text { entries: &["evaluate.cl"], prelude: "prelude.cl", store: Some("store.cl") };
const TOGETHER: Text = Text { entries: &["lanes_evaluate.cl"], prelude: "prelude.cl", store: Some("lanes_store.cl") };

/// How lanes talk, by itself.
const TRIAL: Text = without_cells(&["lanes_trial.cl"]);

/// A cell in single precision.
const SINGLE: Text = Text { entries: &["single.cl"], prelude: "single_prelude.cl", store: Some("single_store.cl") };

/// The functions of a cell, one by one.
#[cfg(any(test, feature = "test-util"))]
const PARITY: Text = Text { entries: &["generated/parity.cl"], prelude: "prelude.cl", store: Some("store.cl") };

/// A build.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Build {
    Grid,
    Octree,
    Rows,
    Totals,
    Algebra,
    Cells(Way, Asked),
    Trial(Lanes),
    Single(Capacities),
    /// With the numbers of half-spaces, vertices and neighbors that calls are made for.
    #[cfg(any(test, feature = "test-util"))]
    Parity(Capacities, u32),
}

/// Who computes a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Way {
    /// One work-item, with so much room.
    Alone(Capacities),
    /// Several.
    Together(Lanes, Stage),
}

/// Work-items that compute a cell together (`lanes_talk.cl`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Lanes {
    /// A warp of NVIDIA's.
    Warp,
    /// One, in the way of several.
    #[cfg(any(test, feature = "test-util"))]
    One,
    /// A sub-group of so many.
    SubGroup(u32),
    /// The same, by a compiler that does not optimise: a CPU's, which takes minutes where it does, in tests.
    #[cfg(any(test, feature = "test-util"))]
    SubGroupAsWritten(u32),
}

impl Lanes {
    pub(crate) const fn count(self) -> usize {
        match self {
            Self::Warp => 32,
            #[cfg(any(test, feature = "test-util"))]
            Self::One => 1,
            Self::SubGroup(count) => count as usize,
            #[cfg(any(test, feature = "test-util"))]
            Self::SubGroupAsWritten(count) => count as usize,
        }
    }

    /// Of so many teams that a cell may have, those that it has.
    const fn teams(self, most: u32) -> u32 {
        match self {
            // (Barriers that stand in loops are more than PoCL compiles in minutes.)
            #[cfg(any(test, feature = "test-util"))]
            Self::One => 1,
            _ => most,
        }
    }

    /// Options of the compiler.
    const fn options(self) -> &'static str {
        match self {
            Self::SubGroup(_) => " -D WITH_SUBGROUPS=1 -cl-std=CL3.0",
            #[cfg(any(test, feature = "test-util"))]
            Self::SubGroupAsWritten(_) => " -D WITH_SUBGROUPS=1 -cl-std=CL3.0 -cl-opt-disable",
            _ => "",
        }
    }
}

impl Way {
    /// Work-items of a group, at most, and those that compute one cell.
    pub(crate) const fn group(self) -> (usize, usize) {
        match self {
            // They share nothing; a multiple of what any GPU runs in step.
            Self::Alone(_) => (64, 1),
            Self::Together(lanes, stage) => {
                let shape = stage.shape();
                let per_cell = lanes.count() * lanes.teams(shape.teams) as usize;
                (per_cell * shape.cells as usize, per_cell)
            }
        }
    }
}

/// What cells are computed for, and no more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Asked {
    /// The flags of `integrate_cell` that the text is built for: of second moments no stage but those whose text is short without; that of
    /// facets no more than areas are asked for none, which leaves their moments out when it runs. Stages that give all cells to `Integrals` are built for nothing of it.
    flags: u32,
    /// Whether there is a domain, and whether weights differ, where cells are shared: those kernels are faster if they know that there is
    /// none, or that they do not (by 3 % and by 8 %, one NVIDIA H200).
    domain: bool,
    weights: bool,
    /// Whether the table of offsets is gone through before the tree over all sites is searched. (Of stages that search nothing, whether weights are equal.)
    table: bool,
}

impl Asked {
    pub(crate) fn of(params: &Params, way: Way) -> Self {
        let stage = match way {
            Way::Alone(_) => None,
            Way::Together(_, stage) => Some(stage),
        };
        let has = |is_so: fn(Stage) -> bool| stage.is_some_and(is_so);
        let (is_shared, equal_weights) = (stage.is_some(), params.equal_weights != 0);
        let flags = match params.flags {
            flags if has(Stage::gives) && (flags & FACETS != 0 || has(|stage| stage == Stage::Sweep)) => 0,
            flags if stage.is_some_and(|stage| stage.is_short(flags)) => flags & !FACET_AREAS,
            flags => flags & !(FACET_AREAS | SECOND_MOMENTS),
        };
        let table = match has(|stage| stage.shape().takes) {
            true => equal_weights,
            // (Where weights differ what it does not complete is found by the tree alone.)
            false if is_shared && !equal_weights => {
                params.has_table != 0 && has(|stage| matches!(stage, Stage::First | Stage::Close))
            }
            // (`Far` goes through it for what reaches far outside a domain alone.)
            false => {
                params.has_table != 0
                    && equal_weights
                    && !has(|stage| matches!(stage, Stage::Sweep | Stage::Large))
                    && (params.has_domain != 0 || !has(|stage| stage == Stage::Far))
            }
        };
        Self { flags, domain: is_shared && params.has_domain != 0, weights: is_shared && !equal_weights, table }
    }
}

/// What the text of the kernels asks for.
#[derive(Clone, Copy, Debug)]
enum Flag {
    /// Room of a cell.
    Planes(u32),
    Vertices(u32),
    Single(bool),
    Lanes(u32),
    CellsOfGroup(u32),
    Teams(u32),
    Short(bool),
    RollsAll(bool),
    /// What is asked for (`integrate_cell`), by parts.
    Facets(bool),
    FacetSecond(bool),
    Integral(bool),
    Domain(bool),
    Weights(bool),
    Table(bool),
    Close(bool),
    Far(bool),
    Sweep(bool),
    Exact(bool),
    Surface(bool),
    Takes(bool),
    Room(u32),
    #[cfg(any(test, feature = "test-util"))]
    Neighbors(u32),
}

impl Flag {
    /// Its name in the text, and its value.
    fn in_c(self) -> (&'static str, String) {
        let set = |name, is_set| (name, u32::from(is_set).to_string());
        match self {
            Self::Planes(count) => ("CAP_P", count.to_string()),
            Self::Vertices(count) => ("CAP_V", count.to_string()),
            Self::Single(is_set) => set("SINGLE", is_set),
            Self::Lanes(count) => ("LANES", format!("{count}u")),
            Self::CellsOfGroup(count) => ("CELLS", count.to_string()),
            Self::Teams(count) => ("TEAMS", format!("{count}u")),
            Self::Short(is_set) => set("SHORT", is_set),
            Self::RollsAll(is_set) => set("ROLLS_ALL", is_set),
            Self::Facets(is_set) => set("WITH_FACETS", is_set),
            Self::FacetSecond(is_set) => set("WITH_FACET_SECOND", is_set),
            Self::Integral(is_set) => set("WITH_INTEGRAL", is_set),
            Self::Domain(is_set) => set("WITH_DOMAIN", is_set),
            Self::Weights(is_set) => set("WITH_WEIGHTS", is_set),
            Self::Table(is_set) => set("WITH_TABLE", is_set),
            Self::Close(is_set) => set("WITH_CLOSE", is_set),
            Self::Far(is_set) => set("WITH_FAR", is_set),
            Self::Sweep(is_set) => set("WITH_SWEEP", is_set),
            Self::Exact(is_set) => set("WITH_EXACT", is_set),
            Self::Surface(is_set) => set("WITH_SURFACE", is_set),
            Self::Takes(is_set) => set("TAKES_CELLS", is_set),
            Self::Room(room) => ("WITH_ROOM", room.to_string()),
            #[cfg(any(test, feature = "test-util"))]
            Self::Neighbors(count) => ("NEIGHBORS", count.to_string()),
        }
    }
}

impl Build {
    pub(crate) const fn text(&self) -> Text {
        match self {
            Self::Grid => GRID,
            Self::Octree => OCTREE,
            Self::Rows => ROWS,
            Self::Totals => TOTALS,
            Self::Algebra => ALGEBRA,
            Self::Cells(Way::Alone(_), _) => ALONE,
            Self::Cells(Way::Together(..), _) => TOGETHER,
            Self::Trial(_) => TRIAL,
            Self::Single(_) => SINGLE,
            #[cfg(any(test, feature = "test-util"))]
            Self::Parity(..) => PARITY,
        }
    }

    fn flags(&self) -> Vec<Flag> {
        let parts = |flags: u32| {
            let has = |flag| flags & flag != 0;
            [Flag::Facets(has(FACETS)), Flag::FacetSecond(has(FACET_SECOND_MOMENTS)), Flag::Integral(has(INTEGRAL))]
        };
        let room_of = |room: &Capacities| vec![Flag::Planes(room.planes), Flag::Vertices(room.vertices)];
        match self {
            Self::Grid | Self::Octree | Self::Rows | Self::Totals | Self::Algebra => Vec::new(),
            Self::Cells(way, Asked { flags: asked, domain, weights, table }) => {
                let mut flags = match *way {
                    Way::Alone(room) => room_of(&room),
                    Way::Together(lanes, stage) => {
                        let Shape { cells, close, far, sweep, exact, surface, takes, room, teams, .. } = stage.shape();
                        // (What of facets is asked for may leave signs open: a cell is to end in the same stage whatever that is, and have the same bits.)
                        let exact = exact || (stage == Stage::Surface && *asked & FACETS != 0);
                        vec![
                            Flag::Single(stage == Stage::Single),
                            Flag::Short(stage.is_short(*asked) && *asked & !FACETS == 0),
                            Flag::RollsAll(exact && *domain),
                            Flag::Lanes(lanes.count() as u32),
                            Flag::CellsOfGroup(cells),
                            Flag::Teams(lanes.teams(teams)),
                            Flag::Domain(*domain),
                            Flag::Weights(*weights),
                            Flag::Close(close),
                            Flag::Far(far),
                            Flag::Sweep(sweep),
                            Flag::Exact(exact),
                            Flag::Surface(surface && *domain),
                            Flag::Takes(takes),
                            Flag::Room(room),
                        ]
                    }
                };
                flags.push(Flag::Table(*table));
                flags.extend(parts(*asked));
                flags
            }
            Self::Trial(lanes) => vec![Flag::Lanes(lanes.count() as u32)],
            Self::Single(room) => room_of(room),
            #[cfg(any(test, feature = "test-util"))]
            Self::Parity(room, neighbors) => {
                [room_of(room), parts(!0).to_vec(), vec![Flag::Neighbors(*neighbors)]].concat()
            }
        }
    }

    /// The compiler's options.
    pub(crate) fn options(&self) -> String {
        let (lanes, registers) = match self {
            Self::Cells(Way::Together(lanes, stage), _) => (Some(lanes), stage.shape().registers),
            Self::Trial(lanes) => (Some(lanes), None),
            _ => (None, None),
        };
        let registers = registers.filter(|_| lanes == Some(&Lanes::Warp));
        let defined = self.flags().into_iter().map(Flag::in_c).map(|(name, value)| format!("-D {name}={value}"));
        let registers = registers.map(|count| format!("-cl-nv-maxrregcount={count}"));
        let options = defined.chain(registers).collect::<Vec<_>>().join(" ");
        options + lanes.map_or("", |lanes| lanes.options())
    }

    /// One of each text and stage.
    #[cfg(test)]
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        let asked = Asked { flags: !0, domain: true, weights: false, table: true };
        let room = Capacities { planes: 64, vertices: 128 };
        let together = Stage::ALL.map(|stage| Self::Cells(Way::Together(Lanes::Warp, stage), asked));
        let others = [
            Self::Grid,
            Self::Octree,
            Self::Rows,
            Self::Totals,
            Self::Algebra,
            Self::Trial(Lanes::Warp),
            Self::Cells(Way::Alone(room), asked),
            Self::Single(room),
            Self::Parity(room, 10),
        ];
        others.into_iter().chain(together)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flag_is_asked_for_by_the_text() {
        for build in Build::all() {
            let whole = build.text().whole().unwrap();
            let words: Vec<&str> = whole.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
            for (name, _) in build.flags().into_iter().map(Flag::in_c) {
                assert!(words.contains(&name), "{name} of {build:?}");
            }
        }
    }

    /// A device without doubles must be able to build it.
    #[test]
    fn single_precision_has_no_doubles() {
        let source = SINGLE.whole().unwrap();
        let text: Vec<&str> = source.lines().map(|line| line.split("//").next().unwrap_or_default()).collect();
        let text = text.join("\n");
        assert!(!text.contains("double") && !text.contains("fp64"));
        // A literal with a point or an exponent is double unless it ends with an f, or stands in `REAL(…)`, which adds one.
        for (at, _) in text.match_indices('.') {
            let before = &text[..at];
            let digits = before.trim_end_matches(|c: char| c.is_ascii_digit());
            let after = text[at + 1..].trim_start_matches(|c: char| c.is_ascii_digit() || matches!(c, 'e' | '-'));
            if digits.len() < before.len()
                && !digits.ends_with(|c: char| c.is_alphanumeric() || c == '_')
                && !after.starts_with('f')
            {
                assert!(
                    digits.trim_end_matches('-').ends_with("REAL("),
                    "{}",
                    &text[digits.len().saturating_sub(60)..at + 10]
                );
            }
        }
    }
}
