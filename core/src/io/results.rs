//! Results: cells and facets, each `.csv` or `.npy`.

use std::io::{self, Write};
use std::path::Path;

use super::{CELLS_ENDINGS, FACETS_ENDINGS, atomic, npy, output_ending};
use crate::{Boundary, Error, Facet, Observer, Output, PowerDiagram, Result};

/// Writes one row for each site, in the caller's order, by the file's ending.
///
/// * `.csv`: header `site,volume,x,y,z,facets,status`: the volume and barycenter of the restricted cell, the number of its
///   facets (with other sites and with the boundary; `NaN` where facets were not asked for), and the number of its
///   [`CellStatus`](crate::CellStatus): 0 complete, 1 empty, 2 not certified. Numbers read back to the same bits; the barycenter of an empty
///   cell is `NaN`.
/// * `.npy`: shape (N, 4), 64-bit floats: volume and barycenter; an empty cell is volume 0 and NaN barycenter.
///
/// Below the header all are numbers, for `np.loadtxt(file, delimiter=",", skiprows=1)`. `-` is standard output, as `.csv`. The file appears whole
/// or not at all.
///
/// # Errors
/// `Input` for an unknown ending or an output of another diagram; `Io` where writing failed.
pub fn write_cells(path: impl AsRef<Path>, diagram: &PowerDiagram, output: &Output) -> Result<()> {
    write_cells_watched(path, diagram, output, &())
}

/// The same, watched by `observer`.
///
/// # Errors
/// As [`write_cells`]; `Interrupted` where the observer ends it, which leaves nothing.
pub fn write_cells_watched(
    path: impl AsRef<Path>,
    diagram: &PowerDiagram,
    output: &Output,
    observer: &dyn Observer,
) -> Result<()> {
    let path = path.as_ref();
    let format = output_ending(path, CELLS_ENDINGS)?;
    check_fit(diagram, output)?;
    match format {
        ".npy" => {
            let rows = output.volume().iter().zip(output.barycenter()).flat_map(|(&v, &[x, y, z])| [v, x, y, z]);
            atomic::write_whole_watched(path, observer, |w| npy::write(w, &[output.volume().len() as u64, 4], rows))
        }
        _ => atomic::write_whole_watched(path, observer, |w| cells_csv(w, output)),
    }
}

/// Writes one row for each facet and direction, sorted by site and then neighbour: seven columns
/// `site,neighbor,area,x,y,z,distance`, with area and barycenter of the facet within the domain, and the distance between the
/// two sites. An interior facet stands once in each direction. Neighbour −1 is the boundary of the domain or box: the
/// area and barycenter of the piece of it that lies in the cell, the distance being `NaN`, since there is no second site.
///
/// * `.csv`: with those names as its header. `-` is standard output in this form.
/// * `.npy`: shape (M, 7), 64-bit floats, which hold every number of a site.
///
/// The file appears whole or not at all.
///
/// # Errors
/// `Input` for an unknown ending, an output of another diagram, or one without facets; `Io` where writing failed.
pub fn write_facets(path: impl AsRef<Path>, diagram: &PowerDiagram, output: &Output) -> Result<()> {
    write_facets_watched(path, diagram, output, &())
}

/// The same, watched by `observer`.
///
/// # Errors
/// As [`write_facets`]; `Interrupted` where the observer ends it, which leaves nothing.
pub fn write_facets_watched(
    path: impl AsRef<Path>,
    diagram: &PowerDiagram,
    output: &Output,
    observer: &dyn Observer,
) -> Result<()> {
    let path = path.as_ref();
    let format = output_ending(path, FACETS_ENDINGS)?;
    check_fit(diagram, output)?;
    if output.facets().is_none() {
        return Err(Error::input("this output has no facets: ask for them with Request::with_facets"));
    }
    let rows = || facet_rows(output);
    atomic::write_whole_watched(path, observer, |w| match format {
        ".npy" => npy::write(w, &[rows().count() as u64, 7], rows().flat_map(FacetValues::numbers)),
        _ => facets_csv(w, rows()),
    })
}

/// A facet as files of facets have it, seen from one side.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FacetValues {
    /// The site on this side.
    pub site: usize,
    /// The site beyond it; `None` for the boundary.
    pub neighbor: Option<usize>,
    /// Area (length²).
    pub area: f64,
    /// Barycenter.
    pub barycenter: [f64; 3],
    /// Distance between the two sites; NaN at the boundary.
    pub distance: f64,
}

impl FacetValues {
    /// The number of the site beyond it, −1 for the boundary.
    pub fn neighbor_number(&self) -> i64 {
        self.neighbor.map_or(-1, |neighbor| neighbor as i64)
    }

    fn numbers(self) -> [f64; 7] {
        let [x, y, z] = self.barycenter;
        [self.site as f64, self.neighbor_number() as f64, self.area, x, y, z, self.distance]
    }
}

/// The facets of an output in the order of files: site by site, the piece of the boundary before the facets with other sites. None where
/// facets were not asked for.
pub fn facet_rows(output: &Output) -> impl Iterator<Item = FacetValues> {
    let facets = output.facets().into_iter();
    facets.flat_map(move |facets| {
        facets.boundary().iter().enumerate().flat_map(move |(site, piece)| {
            let boundary = (piece.area > 0.0).then(|| {
                let Boundary { area, barycenter, .. } = *piece;
                FacetValues { site, neighbor: None, area, barycenter, distance: f64::NAN }
            });
            boundary.into_iter().chain(facets.of(site).map(move |facet| {
                let Facet { neighbor, area, barycenter, distance, .. } = facet;
                FacetValues { site, neighbor: Some(neighbor), area, barycenter, distance }
            }))
        })
    })
}

/// Number of facets of the cell of site `i`, its piece of the boundary counting as one; `None` where not asked for.
pub fn facet_count(output: &Output, i: usize) -> Option<usize> {
    let facets = output.facets()?;
    Some(facets.row(i).len() + usize::from(facets.boundary()[i].area > 0.0))
}

/// Refuses the output of another diagram.
fn check_fit(diagram: &PowerDiagram, output: &Output) -> Result<()> {
    let n = diagram.positions().len();
    if output.sites() == n {
        Ok(())
    } else {
        Err(Error::input(format!("this output is not that of a diagram of {n} sites")))
    }
}

fn cells_csv(w: &mut dyn Write, output: &Output) -> io::Result<()> {
    writeln!(w, "site,volume,x,y,z,facets,status")?;
    for (i, (volume, [x, y, z])) in output.volume().iter().zip(output.barycenter()).enumerate() {
        // `{:?}` is the shortest text that reads back to the same number.
        write!(w, "{i},{volume:?},{x:?},{y:?},{z:?},")?;
        match facet_count(output, i) {
            Some(count) => write!(w, "{count}")?,
            None => write!(w, "NaN")?,
        }
        writeln!(w, ",{}", output.status()[i].number())?;
    }
    Ok(())
}

fn facets_csv(w: &mut dyn Write, mut rows: impl Iterator<Item = FacetValues>) -> io::Result<()> {
    writeln!(w, "site,neighbor,area,x,y,z,distance")?;
    rows.try_for_each(|row| {
        let FacetValues { site, area, barycenter: [x, y, z], distance, .. } = row;
        writeln!(w, "{site},{},{area:?},{x:?},{y:?},{z:?},{distance:?}", row.neighbor_number())
    })
}

#[cfg(test)]
mod tests {
    use super::super::scratch;
    use super::*;
    use crate::{CellStatus, FacetArrays, Facets, OutputArrays};

    /// Two sites with a facet between them, and a third that is hidden.
    fn three() -> (PowerDiagram, Output) {
        let positions = [[0.25, 0.5, 0.5], [0.75, 0.5, 0.5], [0.75, 0.5, 0.5]];
        let diagram = PowerDiagram::new(&positions, &[]).unwrap();
        let facets = FacetArrays {
            offsets: vec![0, 1, 2, 2],
            neighbor: vec![1, 0],
            area: vec![0.7, 0.7],
            barycenter: vec![[0.5; 3]; 2],
            distance: vec![0.5, 0.5],
            second_moment: None,
            boundary: vec![
                Boundary { area: 3.0, barycenter: [0.125, 0.5, 0.5], ..Boundary::default() },
                Boundary::default(),
                Boundary::default(),
            ],
        };
        let output = OutputArrays {
            status: vec![CellStatus::Complete, CellStatus::Uncertified, CellStatus::Empty],
            volume: vec![1.0 / 3.0, 1e-300, 0.0],
            barycenter: vec![[0.1, -0.2, 1e17], [0.75, 0.5, 0.5], [f64::NAN; 3]],
            facets: Some(Facets::new(facets).unwrap()),
            ..OutputArrays::default()
        };
        (diagram, Output::new(output).unwrap())
    }

    #[test]
    fn cells_read_back_exactly() {
        let (diagram, output) = three();
        let folder = scratch("cells");
        let csv = folder.join("cells.csv");
        write_cells(&csv, &diagram, &output).unwrap();
        let text = std::fs::read_to_string(&csv).unwrap();
        assert_eq!(
            text,
            "site,volume,x,y,z,facets,status\n0,0.3333333333333333,0.1,-0.2,1e17,2,0\n\
             1,1e-300,0.75,0.5,0.5,1,2\n2,0.0,NaN,NaN,NaN,0,1\n"
        );
        let volume: f64 = text.lines().nth(1).unwrap().split(',').nth(1).unwrap().parse().unwrap();
        assert_eq!(volume, output.volume()[0]);
        let output = Output::new(OutputArrays { facets: None, ..output.into_arrays() }).unwrap();
        write_cells(&csv, &diagram, &output).unwrap();
        assert!(std::fs::read_to_string(&csv).unwrap().contains("\n2,0.0,NaN,NaN,NaN,NaN,1\n"));
    }

    #[cfg(feature = "npy")]
    #[test]
    fn cells_are_an_array() {
        let (diagram, output) = three();
        let path = scratch("cells-array").join("cells.npy");
        write_cells(&path, &diagram, &output).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let npy = npyz::NpyFile::new(&bytes[..]).unwrap();
        assert_eq!(npy.shape(), [3, 4]);
        let back: Vec<f64> = npy.into_vec().unwrap();
        assert_eq!(back[..8], [1.0 / 3.0, 0.1, -0.2, 1e17, 1e-300, 0.75, 0.5, 0.5]);
        assert!(back[8] == 0.0 && back[9..].iter().all(|x| x.is_nan()));
    }

    #[test]
    fn facets_stand_in_both_directions_and_the_boundary_as_minus_one() {
        let (diagram, output) = three();
        let path = scratch("facets").join("facets.csv");
        write_facets(&path, &diagram, &output).unwrap();
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            "site,neighbor,area,x,y,z,distance\n0,-1,3.0,0.125,0.5,0.5,NaN\n0,1,0.7,0.5,0.5,0.5,0.5\n\
             1,0,0.7,0.5,0.5,0.5,0.5\n"
        );
        let output = Output::new(OutputArrays { facets: None, ..output.into_arrays() }).unwrap();
        assert_eq!(facet_rows(&output).count(), 0);
        assert!(write_facets(&path, &diagram, &output).unwrap_err().to_string().contains("has no facets"));
    }

    #[cfg(feature = "npy")]
    #[test]
    fn facets_are_an_array() {
        let (diagram, output) = three();
        let array = scratch("facets-array").join("facets.npy");
        write_facets(&array, &diagram, &output).unwrap();
        let npy = npyz::NpyFile::new(std::io::BufReader::new(std::fs::File::open(array).unwrap())).unwrap();
        assert_eq!(npy.shape(), [3, 7]);
        let numbers: Vec<f64> = npy.into_vec().unwrap();
        assert_eq!(numbers[..6], [0.0, -1.0, 3.0, 0.125, 0.5, 0.5]);
        assert!(numbers[6].is_nan());
        assert_eq!(numbers[7..14], [0.0, 1.0, 0.7, 0.5, 0.5, 0.5, 0.5]);
    }

    #[test]
    fn what_does_not_fit_leaves_nothing() {
        let (diagram, output) = three();
        let folder = scratch("misfit");
        assert!(write_cells(folder.join("cells.vtk"), &diagram, &output).is_err());
        let other = PowerDiagram::new(&[[0.5; 3]], &[]).unwrap();
        assert!(write_cells(folder.join("cells.csv"), &other, &output).is_err());
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
    }
}
