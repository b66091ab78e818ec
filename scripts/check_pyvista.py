"""Holds the files of the program against PyVista (VTK): what one writes the other must read to the same numbers.

Not part of `cargo xtask test`, which needs nothing but Rust. To run it (some ten seconds):

    cargo build --release
    python3 -m venv .venv && .venv/bin/pip install "pyvista==0.49.*"
    .venv/bin/python scripts/check_pyvista.py [PROGRAM]        (default: target/release/laguerre)

It ends with code 1 and the check that failed, or with "all checks passed".
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pyvista as pv

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/release/laguerre").resolve()
BUNNY = ROOT / "fixtures/meshes/bunny.obj"
# VTK's volumes are sums over some twenty tetrahedra of coordinates that are rounded once.
VOLUME_BOUND = 1e-13
# Its volume of a mesh is a plain sum over some thousand triangles; coordinates have 32 bits, and all their digits in text.
MESH_BOUND = 1e-12


def laguerre(*arguments):
    """Runs the program in the current folder and returns its standard output."""
    command = [PROGRAM, *map(str, arguments)]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def check(what, holds, found=""):
    print(f"{'ok  ' if holds else 'FAIL'} {what} {found}")
    if not holds:
        sys.exit(1)


def worst(found, expected):
    """The largest difference, over the largest number expected."""
    return float(np.max(np.abs(np.asarray(found) - expected)) / np.max(np.abs(expected)))


def convex_volumes(grid):
    """The volume of every cell from its faces alone: fans of triangles about the cell's first corner, seen from outside."""
    volumes = np.zeros(grid.n_cells)
    for i in range(grid.n_cells):
        cell = grid.get_cell(i)
        corner = cell.points[0]
        for face in cell.faces:
            points = face.points - corner
            a, b = points[1:-1], points[2:]
            volumes[i] += np.sum(np.cross(a, b) @ points[0]) / 6
    return volumes


def read_cells(name):
    rows = np.genfromtxt(name, delimiter=",", names=True)
    return rows[rows["status"] != 1]


def check_results(container, label):
    """Cells with weights, and facets so that their number is there too."""
    laguerre("integrate", "sites.csv", *container, "-o", "cells.csv", "--facets", "facets.csv")
    report = json.loads(laguerre("integrate", "sites.csv", *container, "-o", "cells.vtu", "--facets", "facets.csv", "--json"))
    cells = read_cells("cells.csv")
    grid = pv.read("cells.vtu")
    check(f"{label}: an unstructured grid", isinstance(grid, pv.UnstructuredGrid))
    check(f"{label}: a cell for each that is not empty", grid.n_cells == report["cells"] == len(cells), grid.n_cells)
    check(f"{label}: all polyhedra", bool(np.all(grid.celltypes == pv.CellType.POLYHEDRON)))
    names = {"site", "volume", "barycenter", "status", "facets"}
    check(f"{label}: the data arrays", set(grid.cell_data.keys()) == names, sorted(grid.cell_data.keys()))
    for name in ("site", "volume", "facets"):
        check(f"{label}: {name} to the last bit", np.array_equal(grid.cell_data[name], cells[name]))
    barycenters = np.stack([cells["x"], cells["y"], cells["z"]], axis=1)
    check(f"{label}: barycenter to the last bit", np.array_equal(grid.cell_data["barycenter"], barycenters))
    check(f"{label}: status complete", not np.any(grid.cell_data["status"]))
    check(f"{label}: no point is outside every cell", len(np.unique(grid.cell_connectivity)) == grid.n_points)
    return grid, report


def check_box():
    grid, report = check_results(["--box", "0,0,0,1,1,1"], "box")
    by_faces = convex_volumes(grid)
    found = worst(by_faces, grid.cell_data["volume"])
    check("box: volumes by the faces", found < VOLUME_BOUND, f"{found:.1e}")
    by_vtk = grid.compute_cell_sizes(length=False, area=False).cell_data["Volume"]
    found = worst(np.abs(by_vtk), grid.cell_data["volume"])
    check("box: volumes by vtkCellSizeFilter", found < VOLUME_BOUND, f"{found:.1e}")
    check("box: the cells fill it", abs(by_faces.sum() - 1) < VOLUME_BOUND and report["domain_volume"] == 1)
    # Not by `find_containing_cell`: VTK 9.7 takes the first polyhedron whose bounding box holds the point.
    centers = grid.cell_data["barycenter"]
    inside = [[j for j, p in enumerate(centers[:20]) if grid.GetCell(i).IsInside(p, 1e-9)] for i in range(20)]
    check("box: VTK finds a cell's barycenter in that cell alone", inside == [[i] for i in range(20)])


def check_domain():
    bunny = pv.read(BUNNY)
    laguerre("sample", "white", 200, "--domain", BUNNY, "-o", "sites.csv")
    grid, report = check_results(["--domain", BUNNY], "bunny")
    found = abs(report["domain_volume"] / bunny.volume - 1)
    check("bunny: VTK's volume of the mesh", found < MESH_BOUND, f"{found:.1e}")
    convex = convex_volumes(grid)
    check("bunny: no restricted cell is larger than its convex cell", bool(np.all(grid.cell_data["volume"] <= convex * (1 + 1e-12))))


def check_meshes():
    sphere = pv.Sphere(radius=2, theta_resolution=24, phi_resolution=16).triangulate()
    sphere.clear_data()
    for name, options in [
        ("text.ply", {"binary": False}),
        ("binary.ply", {"binary": True}),
        ("text.stl", {"binary": False}),
        ("binary.stl", {"binary": True}),
        ("mesh.obj", {}),
    ]:
        sphere.save(name, **options)
        report = json.loads(laguerre("integrate", "sites.csv", "--domain", name, "--json"))
        found = abs(report["domain_volume"] / sphere.volume - 1)
        check(f"VTK's {name}", found < MESH_BOUND and report["relative_error"] < 1e-14, f"{found:.1e}")


def check_points():
    points = pv.PolyData(np.random.default_rng(1).random((50, 3)))
    expected = None
    for name, options in [("p.ply", {"binary": True}), ("t.ply", {"binary": False}), ("p.npy", None)]:
        np.save(name, points.points) if options is None else points.save(name, **options)
        laguerre("integrate", name, "--box", "0,0,0,1,1,1", "-o", "p.csv")
        volumes = read_cells("p.csv")["volume"]
        expected = volumes if expected is None else expected
        check(f"sites from {name}", len(volumes) == 50 and worst(volumes, expected) < 1e-4)
    laguerre("sample", "white", 50, "-o", "own.ply")
    check("own .ply read by VTK", pv.read("own.ply").n_points == 50)
    laguerre("integrate", "own.ply", "--box", "0,0,0,1,1,1", "-o", "own.npy")
    check("own .npy read by NumPy", abs(np.load("own.npy")[:, 0].sum() - 1) < VOLUME_BOUND)


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        sites = np.random.default_rng(7).random((300, 4)) * [1, 1, 1, 0.03]
        np.savetxt("sites.csv", sites, fmt="%.17g", delimiter=",", header="x,y,z,weight", comments="")
        check_box()
        check_domain()
        check_meshes()
        check_points()
        os.chdir(ROOT)
    print("all checks passed")


if __name__ == "__main__":
    main()
