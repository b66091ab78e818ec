//! Which column of a text is what, as the names in its first line or the caller say.

use std::str::FromStr;

use super::lines::{finite, shown};
use crate::{Error, Result};

/// Names of coordinates, the last two as ParaView writes them into tables.
const AXES: [[&str; 3]; 3] =
    [["x", "points:0", "points_0"], ["y", "points:1", "points_1"], ["z", "points:2", "points_2"]];
const WEIGHTS: [&str; 2] = ["w", "weight"];
const RADII: [&str; 2] = ["r", "radius"];
/// What a fourth column beside x, y and z may be called without being taken for a weight.
const NO_WEIGHTS: [&str; 7] = ["", "id", "index", "site", "name", "type", "element"];

/// What the columns of a text of sites are: made of their names, parted by commas, as `"id,x,y,z,r".parse()`.
///
/// `x`, `y` and `z` are needed; `w` or `weight` is the weight (length²), `r` or `radius` a length whose square is the weight, as voro++ has it.
/// Columns of other names are passed over, whatever is in them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Columns {
    count: usize,
    position: [usize; 3],
    weight: Option<Weight>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Weight {
    column: usize,
    is_radius: bool,
}

impl FromStr for Columns {
    type Err = Error;

    fn from_str(names: &str) -> Result<Self> {
        let names: Vec<&str> = names.split(',').map(str::trim).collect();
        Self::named(&names).map_err(Error::input)
    }
}

impl Columns {
    /// The columns of these names.
    ///
    /// # Errors
    /// What is missing among them, or there twice.
    pub(super) fn named(names: &[&str]) -> std::result::Result<Self, String> {
        let one = |known: &[&str]| {
            let mut found = (0..names.len()).filter(|&k| known.contains(&plain(names[k]).as_str()));
            match (found.next(), found.next()) {
                (_, Some(k)) => Err(format!("'{}' names two columns; one alone can be it", shown(names[k]))),
                (first, None) => Ok(first),
            }
        };
        let axis = |known: &[&str]| {
            let missing =
                || format!("no column '{}' among '{}'; x, y and z are needed", known[0], shown(&names.join(",")));
            one(known)?.ok_or_else(missing)
        };
        let position = [axis(&AXES[0])?, axis(&AXES[1])?, axis(&AXES[2])?];
        let weight = match (one(&WEIGHTS)?, one(&RADII)?) {
            (Some(_), Some(_)) => return Err("both a weight and a radius; one of them is needed".into()),
            (Some(column), None) => Some(Weight { column, is_radius: false }),
            (None, Some(column)) => Some(Weight { column, is_radius: true }),
            (None, None) => None,
        };
        Ok(Self { count: names.len(), position, weight })
    }

    /// The columns of a text whose first line is these names, or `None` where they name none of x, y and z: the order is x, y, z, weight then.
    ///
    /// # Errors
    /// What is missing, there twice, or may be meant or not.
    pub(super) fn of_first_line(names: &[&str]) -> std::result::Result<Option<Self>, String> {
        if !names.iter().any(|name| AXES.iter().flatten().any(|axis| *axis == plain(name))) {
            return Ok(None);
        }
        let columns = Self::named(names)?;
        if let (4, None) = (names.len(), columns.weight) {
            let further = |k: &usize| !columns.position.contains(k) && !NO_WEIGHTS.contains(&plain(names[*k]).as_str());
            if let Some(k) = (0..4).find(further) {
                return Err(format!(
                    "column {} is '{}': no name of a weight (w, weight), a radius (r) or a number of sites (id); rename it",
                    k + 1,
                    shown(names[k])
                ));
            }
        }
        Ok(Some(columns))
    }

    /// How many columns there are.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// How many numbers of a row [`Columns::read`] sets: 3, or 4 with a weight.
    pub(super) fn numbers(&self) -> usize {
        if self.weight.is_some() { 4 } else { 3 }
    }

    /// Position and weight (0 for none) of a row.
    ///
    /// # Errors
    /// Which word is no number, or how many are missing.
    pub(super) fn read<'a>(&self, words: impl Iterator<Item = &'a str>) -> std::result::Result<[f64; 4], String> {
        let mut row = [0.0; 4];
        let mut found = 0;
        for (k, word) in words.enumerate() {
            found += 1;
            if let Some(axis) = self.position.iter().position(|&column| column == k) {
                row[axis] = finite(word)?;
            }
            match self.weight {
                Some(Weight { column, is_radius: false }) if column == k => row[3] = finite(word)?,
                Some(Weight { column, is_radius: true }) if column == k => row[3] = square(word)?,
                _ => {}
            }
        }
        if found == self.count { Ok(row) } else { Err(format!("{found} columns, but {} have names", self.count)) }
    }
}

/// The weight of a radius.
fn square(word: &str) -> std::result::Result<f64, String> {
    let radius = finite(word)?;
    let weight = radius * radius;
    let is_one = radius >= 0.0 && weight.is_finite();
    if is_one { Ok(weight) } else { Err(format!("'{}' is no radius", shown(word))) }
}

/// A name without quotes, in lower case.
pub(super) fn plain(name: &str) -> String {
    name.trim_matches('"').trim().to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::super::{parse_sites, parse_sites_by_columns};

    const POSITIONS: [[f64; 3]; 2] = [[1.0, -2.0, 3e-5], [4.0, 5.0, 6.0]];

    #[test]
    fn names_in_any_order_tell_what_is_what() {
        for (text, weights) in [
            ("w,z,y,x\n9,3e-5,-2,1\n16,6,5,4\n", true),
            ("id;x;y;z;weight\n7;1;-2;3e-5;9\n8;4;5;6;16\n", true),
            ("\"Radius\" \"X\" \"Y\" \"Z\" color\n3 1 -2 3e-5 red\n4 4 5 6 blue\n", true),
            (",x,y,z\n0,1,-2,3e-5\n1,4,5,6\n", false),
            ("2\nid x y z\n0 1 -2 3e-5\n1 4 5 6\n", false),
            ("volume,Points:0,Points:1,Points:2,status\n0.5,1,-2,3e-5,\n,4,5,6,complete\n", false),
        ] {
            let sites = parse_sites(text.as_bytes(), "s.csv").unwrap();
            assert_eq!(sites.positions, POSITIONS, "{text}");
            assert_eq!(sites.weights, if weights { &[9.0, 16.0][..] } else { &[] }, "{text}");
        }
    }

    #[test]
    fn a_caller_says_what_is_what() {
        let read = |text: &str, columns: &str| {
            let sites = parse_sites_by_columns(text.as_bytes(), "s.txt", &columns.parse().unwrap());
            sites.map(|sites| (sites.positions, sites.weights)).map_err(|e| e.to_string().replace("s.txt: ", ""))
        };
        let right = |weights: &[f64]| Ok((POSITIONS.to_vec(), weights.to_vec()));
        // voro++, without radii and with.
        assert_eq!(read("1 1 -2 3e-5\n2 4 5 6\n", "id,x,y,z"), right(&[]));
        assert_eq!(read("1 1 -2 3e-5 3\n2 4 5 6 4\n", "id,x,y,z,r"), right(&[9.0, 16.0]));
        // The file's own names are passed over, and so are what is no number and a count.
        assert_eq!(read("2\na;b;c;d\nFe;1;-2;3e-5\nO;4;5;6\n", "-,x,y,z"), right(&[]));
        assert_eq!(read("1 2 3 4\n1 2 3\n", "id,x,y,z"), Err("line 2: 3 columns, but 4 have names".into()));
        assert_eq!(read("1 2 3 4\n", "x,y,z"), Err("line 1: 4 columns, but 3 have names".into()));
        assert_eq!(read("1 2 o 4\n", "id,x,y,z"), Err("line 1: 'o' is not a number".into()));
        assert_eq!(read("1 2 3 -4\n", "x,y,z,r"), Err("line 1: '-4' is no radius".into()));
        assert_eq!(read("1 2 3 1e300\n", "x,y,z,r"), Err("line 1: '1e300' is no radius".into()));
        let dump = "ITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS x y z\n1 2 3\n";
        assert_eq!(read(dump, "x,y,z"), Err("a dump of LAMMPS names its columns; read it as it is".into()));
        let arrays = parse_sites_by_columns(b"", "s.ply", &"x,y,z".parse().unwrap()).unwrap_err().to_string();
        assert_eq!(arrays, "s.ply: columns have names in text alone (.xyz, .txt, .csv)");
    }

    #[test]
    fn names_that_say_too_little_are_refused() {
        let wrong = |names: &str| {
            parse_sites(format!("{names}\n1,2,3,4\n").as_bytes(), "s.csv")
                .unwrap_err()
                .to_string()
                .replace("s.csv: ", "")
        };
        assert_eq!(wrong("x,y,w,id"), "line 1: no column 'z' among 'x,y,w,id'; x, y and z are needed");
        assert_eq!(wrong("x,y,z,X"), "line 1: 'X' names two columns; one alone can be it");
        assert!(wrong("x,y,z,mass").starts_with("line 1: column 4 is 'mass': no name of a weight (w, weight)"));
        assert_eq!(wrong("x,y,z,w,r"), "line 1: both a weight and a radius; one of them is needed");
        assert_eq!(wrong("x,y,z"), "line 2: 4 columns, but 3 have names");
    }
}
