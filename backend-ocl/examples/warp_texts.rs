//! Writes the texts of the builds for an NVIDIA warp into a folder, and their options: `cargo xtask nvptx`.

use std::path::Path;
use std::{env, error, fs};

fn main() -> Result<(), Box<dyn error::Error>> {
    let folder = env::args().nth(1).ok_or("which folder?")?;
    for (i, build) in laguerre_ocl::warp_texts::all()?.iter().enumerate() {
        let path = Path::new(&folder).join(format!("{i:02}"));
        fs::write(path.with_extension("cl"), &build.text)?;
        fs::write(path.with_extension("txt"), format!("{}\n{}\n", build.name, build.options))?;
    }
    Ok(())
}
