//! Heavy fluid that sinks into a light one, its cells in a file for each frame: `cargo run --example fluid_film --features solvers`.

use laguerre::solvers::fluid::{Fluid, Scene, lattice};
use laguerre::{Container, Request, Selection, io};

fn main() -> laguerre::Result<()> {
    let (scene, lo, hi) = (Scene::RayleighTaylor, [0.0; 3], [1.0, 2.0, 0.25]);
    let centers = lattice(hi, 500);
    let densities = scene.densities(&centers, lo, hi);
    let size = (hi.iter().product::<f64>() / centers.len() as f64).cbrt();
    let settings = scene.settings(&densities, lo, hi, size, None);
    let start = scene.start(&centers, densities, &settings);

    let backend = laguerre::open(Selection::Auto)?;
    let mut fluid = Fluid::new(backend.as_ref(), &Container::Box(lo, hi), start, settings)?;
    let folder = std::env::temp_dir();
    for frame in 0..3 {
        for _ in 0..5 {
            fluid.step(backend.as_ref())?;
        }
        // Polygons for ParaView or PyVista; `fluid.state()` has what they are to be coloured by.
        let cells = backend.evaluate(fluid.diagram(), &Request::moments().with_geometry())?;
        let file = folder.join(format!("laguerre-frame-{frame}.vtp"));
        io::write_geometry(&file, fluid.diagram(), &cells)?;
        let energy = fluid.energy();
        println!("time {:.3}: kinetic {:.2e}, drift {:.1e}", fluid.state().time, energy.kinetic, fluid.drift());
        println!("  written {}", file.display());
    }
    Ok(())
}
