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


def volumes_by_faces(grid):
    """The volume of every VTK cell from its faces alone: fans of triangles about the cell's first corner, seen from outside."""
    volumes = np.zeros(grid.n_cells)
    for i in range(grid.n_cells):
        cell = grid.get_cell(i)
        corner = cell.points[0]
        for face in cell.faces:
            points = face.points - corner
            a, b = points[1:-1], points[2:]
            volumes[i] += np.sum(np.cross(a, b) @ points[0]) / 6
    return volumes


def of_sites(grid, values):
    """Sums over the VTK cells of each site, in the order of the sites that have some."""
    sites, rows = np.unique(grid.cell_data["site"], return_inverse=True)
    return sites, np.bincount(rows, weights=values)


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
    sites, first = np.unique(grid.cell_data["site"], return_index=True)
    check(f"{label}: solids for each cell that is not empty", len(sites) == report["cells"] == len(cells), grid.n_cells)
    kinds = [pv.CellType.POLYHEDRON, pv.CellType.TETRA]
    check(f"{label}: polyhedra and tetrahedra", bool(np.all(np.isin(grid.celltypes, kinds))))
    names = {"site", "volume", "weight", "barycenter", "status", "facets", "solid"}
    check(f"{label}: the data arrays", set(grid.cell_data.keys()) == names, sorted(grid.cell_data.keys()))
    for name in ("site", "volume", "facets"):
        check(f"{label}: {name} to the last bit", np.array_equal(grid.cell_data[name][first], cells[name]))
    barycenters = np.stack([cells["x"], cells["y"], cells["z"]], axis=1)
    check(f"{label}: barycenter to the last bit", np.array_equal(grid.cell_data["barycenter"][first], barycenters))
    check(f"{label}: status complete", not np.any(grid.cell_data["status"]))
    by_faces = of_sites(grid, volumes_by_faces(grid))[1]
    found = np.max(np.abs(by_faces - cells["volume"])) / np.mean(cells["volume"])
    check(f"{label}: volumes by the faces", found < VOLUME_BOUND, f"{found:.1e}")
    # VTK makes Delaunay tetrahedra of a polyhedron's points, and loses some of one in a hundred; tetrahedra it takes as they are.
    by_vtk = grid.compute_cell_sizes(length=False, area=False).cell_data["Volume"]
    by_vtk = of_sites(grid, np.abs(by_vtk))[1]
    off = np.abs(by_vtk - cells["volume"]) / np.mean(cells["volume"])
    check(f"{label}: volumes by vtkCellSizeFilter, of 98 in 100", np.quantile(off, 0.98) < VOLUME_BOUND, f"{np.sum(off > VOLUME_BOUND)} off")
    laguerre("integrate", "sites.csv", *container, "-o", "cells.vtp")
    polygons = pv.read("cells.vtp")
    areas = polygons.compute_cell_sizes(length=False, volume=False).cell_data["Area"]
    facets = np.genfromtxt("facets.csv", delimiter=",", names=True)
    for what, of_file, of_csv in [
        ("the boundary", polygons.cell_data["beyond"] < 0, np.isnan(facets["distance"])),
        ("facets", polygons.cell_data["beyond"] >= 0, ~np.isnan(facets["distance"])),
    ]:
        found = abs(areas[of_file].sum() / facets["area"][of_csv].sum() - 1)
        check(f"{label}: the polygons' area of {what}", found < MESH_BOUND, f"{found:.1e}")
    return grid, report


def check_box():
    grid, report = check_results(["--box", "0,0,0,1,1,1"], "box")
    check("box: the cells fill it", abs(volumes_by_faces(grid).sum() - 1) < VOLUME_BOUND and report["domain_volume"] == 1)
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
