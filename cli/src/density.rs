//! The density of `transport` and `lloyd`, as the command line says it.

use std::path::PathBuf;

use clap::Args as ClapArgs;
use laguerre::limits::LARGEST_DEGREE;
use laguerre::solvers::density::{Density, Gaussian, is_of_density};
use laguerre::{Backend, Container, Error, ErrorKind, Result, io};

use crate::solver::parse_from_zero;

#[derive(ClapArgs, Debug)]
pub(crate) struct DensityArgs {
    /// The density c + gx·x + gy·y + gz·z; 1 unless given
    #[arg(long, value_name = "c,gx,gy,gz", allow_hyphen_values = true, value_parser = parse_density, conflicts_with = "gaussians")]
    density: Option<Density>,

    /// The density is a sum of Gaussians, integrated on the CPU by quadrature: .txt or .csv (one a line, a first line may name the columns) or .npy, rows of
    /// x,y,z,deviation,mass, or x,y,z,xx,yy,zz,xy,xz,yz,mass with a covariance; the mass of each is that over all of space
    #[arg(long, value_name = "FILE")]
    gaussians: Option<PathBuf>,

    /// What is added to the Gaussians everywhere: they are 0 from some 38 deviations on, and a density must be positive
    #[arg(long, value_name = "C", requires = "gaussians", default_value_t = 0.0, allow_hyphen_values = true, value_parser = parse_from_zero)]
    constant: f64,

    /// The degree of the quadrature: cells are to be no larger than the deviations, or it is to be high
    #[arg(long, value_name = "D", requires = "gaussians", default_value_t = 5,
          value_parser = clap::value_parser!(u32).range(0..=i64::from(LARGEST_DEGREE)))]
    degree: u32,
}

/// The columns of a file of Gaussians.
const FORMS: &[&[&str]] =
    &[&["x", "y", "z", "deviation", "mass"], &["x", "y", "z", "xx", "yy", "zz", "xy", "xz", "yz", "mass"]];

/// The density, and what is said of it.
#[derive(Debug)]
pub(crate) struct Given {
    pub(crate) density: Density,
    /// What a person calls it; `None` where none was asked for.
    pub(crate) words: Option<String>,
    /// What errors of it begin with.
    name: String,
}

impl DensityArgs {
    /// The file that it is read from.
    pub(crate) fn file(&self) -> Option<&PathBuf> {
        self.gaussians.as_ref()
    }

    /// Reads it, and checks what can be known of it before the work.
    pub(crate) fn read(&self, backend: &dyn Backend, container: &Container) -> Result<Given> {
        let given = match (&self.density, &self.gaussians) {
            (_, Some(path)) => {
                let gaussians = read_gaussians(path)?;
                let name = path.display().to_string();
                if !backend.info().capabilities.functions {
                    return Err(
                        Error::input("a device cannot call a function, as Gaussians are; give --backend cpu").at(name)
                    );
                }
                let density = Density::gaussians(self.degree, self.constant, &gaussians).map_err(|e| e.at(&name))?;
                let plural = if gaussians.len() == 1 { "" } else { "s" };
                let words =
                    format!("{} Gaussian{plural} on {:?}, by degree {}", gaussians.len(), self.constant, self.degree);
                Given { density, words: Some(words), name }
            }
            (density, None) => {
                let density = density.clone().unwrap_or_default();
                let words = match density {
                    Density::Linear { value, gradient } => {
                        let terms = gradient.iter().zip(["x", "y", "z"]).filter(|(slope, _)| **slope != 0.0);
                        Some(terms.fold(format!("{value:?}"), |sum, (slope, axis)| format!("{sum} + {slope:?}·{axis}")))
                    }
                    _ => None,
                };
                Given { density, words, name: "--density".into() }
            }
        };
        given.density.check(container).map_err(|e| e.at(&given.name))?;
        Ok(given)
    }
}

impl Given {
    /// An error of a solver with what it is of before it: the density, or else what `other` is about.
    pub(crate) fn place(&self, error: Error, other: impl std::fmt::Display) -> Error {
        match error.kind() {
            ErrorKind::Input if is_of_density(&error) => error.at(&self.name),
            ErrorKind::Input => error.at(other),
            _ => error,
        }
    }
}

fn read_gaussians(path: &PathBuf) -> Result<Vec<Gaussian>> {
    let (form, numbers) = io::read_table(path, FORMS)?;
    let rows = numbers.chunks_exact(FORMS[form].len()).enumerate();
    let gaussian = |(i, row): (usize, &[f64])| match *row {
        [x, y, z, deviation, mass] if deviation > 0.0 => Ok(Gaussian::round([x, y, z], deviation, mass)),
        [_, _, _, deviation, _] => {
            let what = format!("the deviation of Gaussian {i} is {deviation:?}: a positive length is needed");
            Err(Error::input(what).at(path.display()))
        }
        _ => {
            let [xx, yy, zz, xy, xz, yz] = std::array::from_fn(|k| row[3 + k]);
            let covariance = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
            Ok(Gaussian { mean: [row[0], row[1], row[2]], covariance, mass: row[9] })
        }
    };
    rows.map(gaussian).collect()
}

fn parse_density(text: &str) -> std::result::Result<Density, String> {
    let number = |word: &str| match word.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("'{}' is not a finite number", word.trim())),
    };
    match *text.split(',').map(number).collect::<std::result::Result<Vec<_>, _>>()?.as_slice() {
        [value, x, y, z] => Ok(Density::Linear { value, gradient: [x, y, z] }),
        ref numbers => Err(format!("{} numbers; 4 are needed: c,gx,gy,gz", numbers.len())),
    }
}
