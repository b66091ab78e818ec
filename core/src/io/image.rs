//! Images: densities of voxels, as NumPy writes them.

use std::path::Path;

use super::npy::Array;
use super::{ending, open};
use crate::{Domain, Error, Result};

impl Domain {
    /// Reads the density of voxels from an array of shape (n_x, n_y, n_z), see [`Domain::of_image`]. `place` is the box that it fills: its minimum and its maximum corner;
    /// without one each voxel is a unit cube, the first from the origin on.
    ///
    /// # Errors
    /// `Io` where the file cannot be read; `Input` where it is no such array, and as [`Domain::of_image`].
    pub fn load_image(path: impl AsRef<Path>, place: Option<([f64; 3], [f64; 3])>) -> Result<Self> {
        let path = path.as_ref();
        ending(path, &[".npy"])?;
        let (reader, length) = open(path)?;
        let read = || {
            let mut shape = [0; 3];
            let flat = |found: &[u64]| match *found {
                [x, y, z] => Some((x, y.checked_mul(z)?)),
                _ => None,
            };
            let array = Array::open(reader, length, "an image (n_x, n_y, n_z)", flat)?;
            for (own, found) in shape.iter_mut().zip(array.shape()) {
                *own = usize::try_from(*found).unwrap_or(usize::MAX);
            }
            let [_, ny, nz] = shape;
            let is_fortran = array.is_fortran();
            let mut values = vec![0.0; array.rows * array.columns];
            array.for_each(|i, column, value| {
                // (The first index is the fastest there, then the second.)
                let (j, k) = if is_fortran { (column % ny, column / ny) } else { (column / nz, column % nz) };
                values[(i * ny + j) * nz + k] = value;
            })?;
            let (lo, hi) = place.unwrap_or(([0.0; 3], shape.map(|n| n as f64)));
            Self::of_image(&values, shape, lo, hi)
        };
        read().map_err(|e: Error| e.in_file(path))
    }
}

#[cfg(test)]
mod tests {
    use super::super::scratch;

    #[test]
    fn arrays_are_read_in_either_order() {
        let folder = scratch("image");
        let file = |name: &str, fortran: &str, values: &[f64]| {
            let mut header = format!("{{'descr': '<f8', 'fortran_order': {fortran}, 'shape': (2, 3, 1), }}");
            while (header.len() + 11) % 64 != 0 {
                header.push(' ');
            }
            header.push('\n');
            let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
            bytes.extend((header.len() as u16).to_le_bytes());
            bytes.extend(header.as_bytes());
            values.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
            let path = folder.join(name);
            std::fs::write(&path, bytes).unwrap();
            path
        };
        let c = crate::Domain::load_image(file("c.npy", "False", &[1.0, 0.0, 0.0, 0.0, 0.0, 3.0]), None).unwrap();
        let f = crate::Domain::load_image(file("f.npy", "True", &[1.0, 0.0, 0.0, 0.0, 0.0, 3.0]), None).unwrap();
        let other = crate::Domain::load_image(file("o.npy", "True", &[1.0, 0.0, 3.0, 0.0, 0.0, 0.0]), None).unwrap();
        assert_eq!((c.volume(), f.volume()), (4.0, 4.0));
        assert_eq!((c.barycenter(), f.barycenter()), ([1.25, 2.0, 0.5], [1.25, 2.0, 0.5]));
        assert_eq!(other.barycenter(), [0.5, 1.25, 0.5]);
        let moved = crate::Domain::load_image(folder.join("c.npy"), Some(([1.0; 3], [2.0; 3]))).unwrap();
        assert!((moved.volume() - 4.0 / 6.0).abs() < 1e-15);
        let said = crate::Domain::load_image(file("n.npy", "False", &[-1.0; 6]), None).unwrap_err().to_string();
        assert!(said.contains("n.npy: the density of voxel [0, 0, 0] of the image is -1"), "{said}");
        let said = crate::Domain::load_image(folder.join("c.raw"), None).unwrap_err().to_string();
        assert!(said.contains("c.raw"), "{said}");
    }
}
