//! What is wrong with one cell or facet, and how it is said.

use std::cmp::Ordering;

use laguerre::Output;
use laguerre::io::CellRow;
use serde::Serialize;

/// One cell or facet that is wrong: where, in what, what the file says and what it should be.
#[derive(Debug, Serialize)]
pub(super) struct Wrong {
    site: usize,
    /// For a facet: the other site, −1 for the boundary.
    #[serde(skip_serializing_if = "Option::is_none")]
    neighbor: Option<i64>,
    what: &'static str,
    file: Value,
    expected: Value,
    off: f64,
    bound: f64,
}

#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Value {
    Number(f64),
    Count(u64),
    Place([f64; 3]),
    Cell { volume: f64, barycenter: [f64; 3], status: Option<&'static str> },
}

impl Wrong {
    /// About cell `i`, of which the file says `row`; how far it is off, and its bound.
    pub(super) fn cell(
        row: &CellRow,
        reference: &Output,
        i: usize,
        what: &'static str,
        [off, bound]: [f64; 2],
    ) -> Self {
        let file = match what {
            "order" => Value::Count(row.site),
            _ => {
                let status = row.status.map(|s| s.word());
                Value::Cell { volume: row.volume, barycenter: row.barycenter, status }
            }
        };
        let expected = match what {
            "order" => Value::Count(i as u64),
            _ => {
                let (volume, barycenter) = (reference.volume()[i], reference.barycenter()[i]);
                Value::Cell { volume, barycenter, status: Some(reference.status()[i].word()) }
            }
        };
        Self { site: i, neighbor: None, what, file, expected, off, bound }
    }

    /// About the number of facets of cell `i`: those that the file of facets lists, and as many as the file of cells says.
    pub(super) fn count(i: usize, listed: u64, said: u64) -> Self {
        let (off, bound) = (listed.abs_diff(said) as f64, 0.0);
        let (file, expected) = (Value::Count(listed), Value::Count(said));
        Self { site: i, neighbor: None, what: "number of facets listed", file, expected, off, bound }
    }

    /// About an area or length of a facet: the file's and the expected; how far they are off, and the bound.
    pub(super) fn facet(
        i: usize,
        neighbor: Option<u32>,
        what: &'static str,
        [file, expected]: [f64; 2],
        [off, bound]: [f64; 2],
    ) -> Self {
        let neighbor = Some(neighbor.map_or(-1, i64::from));
        Self { site: i, neighbor, what, file: Value::Number(file), expected: Value::Number(expected), off, bound }
    }

    /// About the barycenter of a facet.
    pub(super) fn facet_place(
        i: usize,
        neighbor: Option<u32>,
        file: [f64; 3],
        expected: [f64; 3],
        [off, bound]: [f64; 2],
    ) -> Self {
        let neighbor = Some(neighbor.map_or(-1, i64::from));
        let (file, expected) = (Value::Place(file), Value::Place(expected));
        Self { site: i, neighbor, what: "barycenter", file, expected, off, bound }
    }

    pub(super) fn site(&self) -> usize {
        self.site
    }

    pub(super) fn is_facet(&self) -> bool {
        self.neighbor.is_some()
    }

    /// Of which cell or facet this is.
    pub(super) fn place(&self) -> (usize, Option<i64>) {
        (self.site, self.neighbor)
    }

    /// The worst is the one most often its bound off; what no number measures comes before all.
    pub(super) fn worst_first(&self, other: &Self) -> Ordering {
        let times = |w: &Self| if w.off.is_nan() { f64::INFINITY } else { w.off / w.bound.max(f64::MIN_POSITIVE) };
        times(other).total_cmp(&times(self)).then(self.place().cmp(&other.place()))
    }

    /// `site 7`, `facet 7-9`.
    pub(super) fn name(&self) -> String {
        match self.neighbor {
            None => format!("site {}", self.site),
            Some(-1) => format!("boundary of site {}", self.site),
            Some(j) => format!("facet {}-{j}", self.site),
        }
    }

    /// One line.
    pub(super) fn line(&self) -> String {
        let Self { what, off, bound, .. } = self;
        let by = if off.is_finite() { format!(" (off by {off:.1e}, bound {bound:.1e})") } else { String::new() };
        let (file, expected) = (self.file.words(), self.expected.words());
        format!("{}: {what}: the file says {file}, it should be {expected}{by}", self.name())
    }
}

impl Value {
    fn words(&self) -> String {
        let place = |[x, y, z]: [f64; 3]| format!("({x}, {y}, {z})");
        match *self {
            Self::Number(x) => x.to_string(),
            Self::Count(n) => n.to_string(),
            Self::Place(p) => place(p),
            Self::Cell { volume, barycenter, status } => {
                let status = status.map(|s| format!(", {s}")).unwrap_or_default();
                format!("volume {volume} at {}{status}", place(barycenter))
            }
        }
    }
}
