//! What form an input has: by its name's ending, and a `.gz` after it.

use std::io::BufRead;
use std::path::Path;

use super::find_ending;
use crate::{Error, Result};

/// The form of an input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Form {
    /// Its ending, without `.gz`.
    pub(super) ending: &'static str,
    /// Whether it is packed by gzip.
    is_packed: bool,
}

impl Form {
    /// The form of a file of that name, if its ending is one of `known`.
    ///
    /// # Errors
    /// `Input`, listing what is known; or saying which feature the name takes.
    pub(super) fn of(path: &Path, known: &[&'static str]) -> Result<Self> {
        let is_packed = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("gz"));
        let name = if is_packed { path.with_extension("") } else { path.to_path_buf() };
        let form = Self { ending: find_ending(&name, known, true)?, is_packed };
        if cfg!(not(feature = "packed")) && (is_packed || form.ending == ".vtp") {
            return Err(Error::input(format!(
                "{}: packed files and .vtp are not part of this build: build with the feature `packed`",
                path.display()
            )));
        }
        if is_packed && [".npy", ".npz"].contains(&form.ending) {
            let (name, ending) = (path.display(), form.ending);
            return Err(Error::input(format!("{name}: {ending} is not read packed; unpack it by gunzip")));
        }
        Ok(form)
    }

    /// The bytes of the file itself.
    pub(super) fn unpacked<'a>(self, reader: impl BufRead + 'a) -> Box<dyn BufRead + 'a> {
        #[cfg(feature = "packed")]
        if self.is_packed {
            return Box::new(std::io::BufReader::new(flate2::bufread::MultiGzDecoder::new(reader)));
        }
        Box::new(reader)
    }
}

#[cfg(all(test, feature = "packed"))]
mod tests {
    use std::io::Write;

    use super::super::{parse_mesh, parse_sites, parse_weights, read_sites, scratch};

    fn packed(text: &[u8]) -> Vec<u8> {
        let mut writer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        writer.write_all(text).unwrap();
        writer.finish().unwrap()
    }

    #[test]
    fn packed_files_are_read_as_what_is_in_them() {
        let mesh = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        assert_eq!(parse_mesh(&packed(mesh), "m.obj.gz").unwrap(), parse_mesh(mesh, "m.obj").unwrap());
        let sites = parse_sites(&packed(b"1 2 3 4\n"), "a.b/s.XYZ.GZ").unwrap();
        assert_eq!((sites.positions, sites.weights), (vec![[1.0, 2.0, 3.0]], vec![4.0]));
        assert_eq!(parse_weights(&packed(b"7\n"), "w.txt.gz").unwrap(), [7.0]);
        // Of several members, as bgzip and `cat` make them, all.
        let two = [packed(b"1 2 3\n"), packed(b"4 5 6\n")].concat();
        let path = scratch("packed").join("s.csv.gz");
        std::fs::write(&path, two).unwrap();
        assert_eq!(read_sites(path).unwrap().positions, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    }

    #[test]
    fn what_is_not_packed_or_not_whole_is_said() {
        let said = |bytes: &[u8], name: &str| parse_sites(bytes, name).unwrap_err().to_string();
        assert!(said(b"1 2 3\n", "s.xyz.gz").starts_with("s.xyz.gz: line 1: cannot read: "));
        let whole = packed("1 2 3\n".repeat(1000).as_bytes());
        let cut = &whole[..whole.len() / 2];
        assert_eq!(parse_sites(cut, "s.xyz.gz").unwrap_err().kind(), crate::ErrorKind::Input);
        let half = said(cut, "s.xyz.gz");
        assert!(half.contains("cannot read: ") && !half.contains('\n'), "{half}");
        assert!(said(b"", "s.gz").starts_with("s: no ending; known here: .xyz"), "{}", said(b"", "s.gz"));
        assert_eq!(said(b"", "s.npy.gz"), "s.npy.gz: .npy is not read packed; unpack it by gunzip");
    }
}
