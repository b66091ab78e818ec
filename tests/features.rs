//! What a build without a feature says where the feature would be needed.

/// Without the feature `npy` an array is neither read nor written, and the line names the feature.
#[cfg(not(feature = "npy"))]
#[test]
fn arrays_take_a_feature() {
    use laguerre::io;
    let said = |error: laguerre::Error| {
        assert_eq!(error.to_string(), "w.npy: NumPy's files are not part of this build: build with the feature `npy`");
        assert_eq!(error.kind(), laguerre::ErrorKind::Input);
    };
    said(io::read_sites("w.npy").unwrap_err());
    said(io::read_weights("w.npy").unwrap_err());
    said(io::write_weights("w.npy", &[1.0]).unwrap_err());
    said(io::write_sites("w.npy", &[[0.0; 3]], &[]).unwrap_err());
    said(io::read_cells("w.npy").unwrap_err());
    said(io::read_facets("w.npy").unwrap_err());
    said(io::parse_weights(b"", "w.npy").unwrap_err());
    assert!(!std::path::Path::new("w.npy").exists());
}

/// With it, it is.
#[cfg(feature = "npy")]
#[test]
fn arrays_are_read() {
    assert_eq!(
        laguerre::io::parse_weights(b"", "w.npy").unwrap_err().to_string(),
        "w.npy: not a .npy file: its first bytes are not NumPy's"
    );
}

/// Without the feature `packed` packed files are not read, and the line names the feature.
#[cfg(not(feature = "packed"))]
#[test]
fn packed_files_take_a_feature() {
    use laguerre::io;
    for (name, error) in [
        ("m.obj.gz", io::read_mesh("m.obj.gz").unwrap_err()),
        ("m.vtp", io::parse_mesh(b"", "m.vtp").unwrap_err()),
        ("s.xyz.GZ", io::read_sites("s.xyz.GZ").unwrap_err()),
    ] {
        let line = format!("{name}: packed files and .vtp are not part of this build: build with the feature `packed`");
        assert_eq!((error.to_string(), error.kind()), (line, laguerre::ErrorKind::Input));
    }
}
