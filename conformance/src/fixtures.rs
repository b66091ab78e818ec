//! The CGAL fixtures: inputs, and exact answers that share nothing with this project's code. `fixtures/README.md` says how they
//! were made.

use std::fs;
use std::path::{Path, PathBuf};

use laguerre_core::io::{read_mesh, read_sites};
use laguerre_core::shapes::Mesh;

use crate::Scene;
use crate::domains::Room;

/// A scene and the exact integrals of its cells, each rounded once.
#[derive(Clone, Debug)]
pub struct Fixture {
    /// Sites, weights, container.
    pub scene: Scene,
    /// What the container measures.
    pub volume: f64,
    /// Area of the container's surface (length²).
    pub area: f64,
    /// For each site its cell; `None` where it is hidden or does not meet the container.
    pub cells: Vec<Option<Cell>>,
}

/// A restricted power cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Volume (length³).
    pub volume: f64,
    /// Barycenter.
    pub barycenter: [f64; 3],
    /// Area of its piece of the container's surface (length²).
    pub boundary: f64,
    /// Neighbours and areas (length²) of the facets within the container.
    pub facets: Vec<(usize, f64)>,
}

impl Fixture {
    /// Reads the fixture of the given name.
    ///
    /// # Errors
    /// What cannot be read, with its file, and the line where there is one.
    pub fn load(name: &str) -> Result<Self, String> {
        let path = folder().join(format!("answers/{name}.txt"));
        let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let sites = read_sites(folder().join(format!("sites/{name}.xyz"))).map_err(|error| error.to_string())?;
        let Answers { container, volume, area, cells } =
            parse(&text).map_err(|reason| format!("{}: {reason}", path.display()))?;
        if cells.len() != sites.positions.len() {
            return Err(format!(
                "{}: {} sites, but {} in the input",
                path.display(),
                cells.len(),
                sites.positions.len()
            ));
        }
        let scene = Scene { positions: sites.positions, weights: sites.weights, room: room(&container)? };
        Ok(Self { scene, volume, area, cells })
    }
}

/// The names of all fixtures that are there, sorted.
///
/// # Errors
/// Where the folder cannot be read.
pub fn names() -> Result<Vec<String>, String> {
    let folder = folder().join("answers");
    let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
    let mut names = Vec::new();
    for entry in fs::read_dir(&folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        names.extend(path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
    }
    names.sort();
    Ok(names)
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures")
}

/// A box by its six coordinates, or the mesh of a file in the fixtures' folder.
fn room(container: &str) -> Result<Room, String> {
    if container.contains(',') {
        let numbers: Result<Vec<f64>, _> = container.split(',').map(str::parse).collect();
        return match numbers.as_deref() {
            Ok(&[a, b, c, d, e, f]) => Ok(Room::Box([a, b, c], [d, e, f])),
            _ => Err(format!("'{container}' is not a box")),
        };
    }
    let mesh = read_mesh(folder().join(container)).map_err(|error| error.to_string())?;
    Ok(Room::of(Mesh { vertices: mesh.vertices, triangles: mesh.triangles }))
}

/// What a file of answers says.
#[derive(Debug, PartialEq)]
struct Answers {
    container: String,
    volume: f64,
    area: f64,
    cells: Vec<Option<Cell>>,
}

/// Reads a file of answers: every site has its one line `cell`, `hidden` or `outside`, in order, and every facet stands after the
/// cell of its first site.
fn parse(text: &str) -> Result<Answers, String> {
    let mut answers = Answers { container: String::new(), volume: f64::NAN, area: f64::NAN, cells: Vec::new() };
    let mut sites = 0;
    // (i, j, area) of each facet.
    let mut facets: Vec<(usize, usize, f64)> = Vec::new();
    for (number, line) in (1..).zip(text.lines()).filter(|(_, line)| !line.starts_with('#')) {
        let wrong = |what: &str| format!("line {number}: {what}: '{line}'");
        let (word, rest) = line.split_once(' ').ok_or_else(|| wrong("no value"))?;
        if word == "container" {
            rest.clone_into(&mut answers.container);
            continue;
        }
        let numbers: Result<Vec<f64>, _> = rest.split(' ').map(str::parse).collect();
        let numbers = numbers.map_err(|_| wrong("not a number"))?;
        let next = answers.cells.len() as f64;
        match (word, &numbers[..]) {
            ("sites", &[n]) => sites = n as usize,
            ("volume", &[x]) => answers.volume = x,
            ("area", &[x]) => answers.area = x,
            ("hidden" | "outside", &[i]) if i == next => answers.cells.push(None),
            ("cell", &[i, volume, x, y, z, boundary]) if i == next => {
                let cell = Cell { volume, barycenter: [x, y, z], boundary, facets: Vec::new() };
                answers.cells.push(Some(cell));
            }
            ("facet", &[i, j, area]) if i == next - 1.0 && j > i => facets.push((i as usize, j as usize, area)),
            _ => return Err(wrong("out of order")),
        }
    }
    if answers.cells.len() != sites || sites == 0 {
        return Err(format!("{} of {sites} sites", answers.cells.len()));
    }
    for (i, j, area) in facets {
        for (from, to) in [(i, j), (j, i)] {
            match answers.cells.get_mut(from) {
                Some(Some(cell)) => cell.facets.push((to, area)),
                _ => return Err(format!("facet {i} {j}: site {from} has no cell")),
            }
        }
    }
    Ok(answers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facets_are_seen_from_both_sides() {
        let text = "# laguerre\nsites 3\ncontainer 0,0,0,1,1,1\nvolume 1\narea 6\n\
                    cell 0 0.5 0.25 0.5 0.5 3\nfacet 0 2 1\nhidden 1\ncell 2 0.5 0.75 0.5 0.5 3\n";
        let answers = parse(text).unwrap();
        assert_eq!((answers.container.as_str(), answers.volume, answers.area), ("0,0,0,1,1,1", 1.0, 6.0));
        let half = |x: f64, other: usize| {
            Some(Cell { volume: 0.5, barycenter: [x, 0.5, 0.5], boundary: 3.0, facets: vec![(other, 1.0)] })
        };
        assert_eq!(answers.cells, [half(0.25, 2), None, half(0.75, 0)]);
    }

    #[test]
    fn a_lost_or_garbled_line_is_seen() {
        let header = "sites 2\ncontainer 0,0,0,1,1,1\nvolume 1\narea 6\n";
        let wrong = |text: &str| parse(&format!("{header}{text}")).unwrap_err();
        assert_eq!(wrong("hidden 0\n"), "1 of 2 sites");
        assert_eq!(wrong("hidden 1\n"), "line 5: out of order: 'hidden 1'");
        assert_eq!(wrong("cell 0 1 2 3\n"), "line 5: out of order: 'cell 0 1 2 3'");
        assert_eq!(wrong("hidden 0\noutside x\n"), "line 6: not a number: 'outside x'");
        assert_eq!(wrong("cell 0 1 0 0 0 1\nfacet 0 1 1\nhidden 1\n"), "facet 0 1: site 1 has no cell");
    }
}
