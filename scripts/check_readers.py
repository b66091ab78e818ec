"""Holds the files of the program against who reads them: PyVista (VTK), meshio, trimesh. They must find the same numbers.

`cargo xtask readers` installs those and runs this with the tests' program; by hand, with what its list of packages says:

    python scripts/check_readers.py [PROGRAM]        (default: target/release/laguerre)

It ends with code 1 and the check that failed, or with "all checks passed".
"""

import itertools
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import meshio
import numpy as np
import pyvista as pv
import trimesh
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/release/laguerre").resolve()
BUNNY = ROOT / "fixtures/meshes/bunny.obj"
# What every volume that VTK finds in a .vtu may be off, as a share of the mean.
VTK_BOUND = 1e-12
# Coordinates of .glb have 24 bits of half the size of all.
GLB_BOUND = 1e-5
# VTK's volumes are sums over some twenty tetrahedra of coordinates that are rounded once.
VOLUME_BOUND = 1e-13
# Its volume of a mesh is a plain sum over some thousand triangles; coordinates have 32 bits, and all their digits in text.
MESH_BOUND = 1e-12


def laguerre(*arguments):
    """Runs the program in the current folder and returns its standard output."""
    command = [PROGRAM, *map(str, arguments)]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def check(what, holds, found=""):
    if not holds:
        sys.exit(f"FAIL {what} {found}")
    print(f"ok   {what} {found}")


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


def check_volumes(label, name):
    """Every volume by vtkCellSizeFilter, which is what users ask, against the field. (Of a polyhedron VTK's sign says nothing.)"""
    grid = pv.read(name)
    by_vtk = grid.compute_cell_sizes(length=False, area=False).cell_data["Volume"]
    signed = np.where(grid.celltypes == pv.CellType.TETRA, by_vtk, np.abs(by_vtk))
    first = np.unique(grid.cell_data["site"], return_index=True)[1]
    volumes = grid.cell_data["volume"][first]
    off = np.abs(of_sites(grid, signed)[1] - volumes) / np.mean(np.abs(volumes))
    of = f"{np.sum(off > VTK_BOUND)} of {len(volumes)} off, the largest by {np.max(off):.1e}"
    check(f"{label}: volumes by vtkCellSizeFilter", np.max(off) < VTK_BOUND, of)
    return grid


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
    check_volumes(label, "cells.vtu")
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
    laguerre("integrate", "sites.csv", *container, "-o", "cells.ply")
    check_polygons(label, polygons)
    laguerre("integrate", "sites.csv", *container, "-o", "cells.glb")
    check_glb(label, polygons, cells)
    return grid, report


def check_polygons(label, polygons):
    """No point too many, and the .ply is the .vtp. (VTK reads it with 32 bits. meshio 5.3 reads no binary .ply whose faces have data, and trimesh
    none whose faces have different numbers of corners.)"""
    corners = lambda mesh: pv.convert_array(mesh.GetPolys().GetConnectivityArray())
    check(f"{label}: no point that no polygon has", len(np.unique(corners(polygons))) == polygons.n_points)
    read = pv.read("cells.ply")
    check(f"{label}: VTK's points of the .ply", np.array_equal(read.points, polygons.points.astype(np.float32)))
    check(f"{label}: VTK's polygons of the .ply", np.array_equal(corners(read), corners(polygons)), read.n_cells)


def check_glb(label, polygons, cells):
    """Of each site the triangles, by trimesh: closed, of its volume, and of a colour that no neighbour has."""
    scene = trimesh.load("cells.glb", process=False)
    check(f"{label}: one mesh in the .glb", len(scene.geometry) == 1)
    mesh = scene.to_geometry()
    only = next(iter(scene.geometry.values()))
    extras = only.metadata
    listed = {name: np.array(column) for name, column in extras["cells"].items()}
    check(f"{label}: the units and what a status means, by trimesh", (extras["units"]["volume"], extras["status"]["0"]) == ("length^3", "complete"))
    for name in ("site", "volume"):
        check(f"{label}: {name} in the .glb's extras to the last bit", np.array_equal(listed[name], cells[name]))
    check(f"{label}: status in the .glb's extras", not np.any(listed["status"]) and len(listed["status"]) == len(listed["weight"]))
    sites = only.vertex_attributes["_SITE"].ravel().astype(int)[mesh.faces]
    check(f"{label}: a triangle is of one site", np.all(sites == sites[:, :1]))
    check(f"{label}: the triangles of each cell", np.array_equal(np.repeat(listed["site"], listed["triangles"]), sites[:, 0]))
    a, b, c = np.moveaxis(np.asarray(mesh.vertices, float)[mesh.faces] - np.mean(polygons.points, axis=0), 1, 0)
    volumes = np.bincount(sites[:, 0], weights=np.einsum("ij,ij->i", a, np.cross(b, c)) / 6, minlength=len(cells))
    found = np.max(np.abs(volumes[cells["site"].astype(int)] - cells["volume"])) / np.mean(cells["volume"])
    check(f"{label}: volumes by the triangles of the .glb", found < GLB_BOUND, f"{found:.1e}")
    colors = np.zeros((int(np.max(cells["site"])) + 1, 4))
    colors[sites[:, 0]] = only.visual.vertex_attributes["color"][mesh.faces[:, 0]]
    site, beyond = polygons.cell_data["site"], polygons.cell_data["beyond"]
    pairs = np.stack([site, beyond])[:, beyond >= 0]
    check(f"{label}: neighbours have different colours", np.all(np.any(colors[pairs[0]] != colors[pairs[1]], axis=1)))


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


def write_obj(name, *shells):
    """A mesh of shells; each is turned inside out where its flag says so."""
    with open(name, "w") as file:
        begin = 1
        for mesh, turned in shells:
            file.writelines("v {!r} {!r} {!r}\n".format(*map(float, point)) for point in mesh.points)
            for corners in mesh.regular_faces[:, ::-1] if turned else mesh.regular_faces:
                file.write("f {} {} {}\n".format(*(corners + begin)))
            begin += mesh.n_points


def check_shells():
    """Meshes of several shells; and the demo's 10,000 cells in the swan."""
    sphere = lambda radius, x=0: pv.Icosphere(radius=radius, center=(x, 0, 0), nsub=2).clean(tolerance=1e-6)
    write_obj("cavity.obj", (pv.Box().triangulate(), False), (sphere(0.6), True))
    write_obj("components.obj", (sphere(1, -1.2), False), (sphere(0.8, 1.2), False))
    write_obj("nested.obj", (sphere(1), False), (sphere(0.7), True), (sphere(0.4), False))
    points = np.random.default_rng(5).random((2000, 3)) * [4.4, 2, 2] - [2.2, 1, 1]
    np.savetxt("points.csv", points, fmt="%.17g", delimiter=",", header="x,y,z", comments="")
    # A ball turned inside out, of which a part is in a box: winding numbers 1, 0 and −1.
    write_obj("turned.obj", (pv.Box().triangulate(), False), (sphere(0.8, 1), True))
    for name in ("cavity", "components", "nested", "turned"):
        report = json.loads(laguerre("integrate", "points.csv", "--domain", f"{name}.obj", "-o", f"{name}.vtu", "--json"))
        grid = check_volumes(name, f"{name}.vtu")
        check(f"{name}: as many cells", len(np.unique(grid.cell_data["site"])) == report["cells"])
    laguerre("demo", "--out-dir", "demo")
    check_volumes("demo", "demo/cells.vtu")
    # meshio reads no polyhedra. In a sphere, two cells meet its surface both.
    np.savetxt("two.csv", [[-0.5, 0, 0], [0.5, 0.1, 0]], delimiter=",", header="x,y,z", comments="")
    write_obj("sphere.obj", (sphere(1), False))
    laguerre("integrate", "two.csv", "--domain", "sphere.obj", "-o", "two.vtu")
    ours, theirs = pv.read("two.vtu"), meshio.read("two.vtu")
    check("two: meshio's points of the .vtu", np.array_equal(theirs.points, ours.points))
    check("two: meshio's tetrahedra", np.array_equal(theirs.cells_dict["tetra"], ours.cells_dict[pv.CellType.TETRA]))
    check("two: meshio's volumes", np.array_equal(theirs.cell_data["volume"][0], ours.cell_data["volume"]))


def check_meshes():
    sphere = pv.Sphere(radius=2, theta_resolution=24, phi_resolution=16).triangulate()
    sphere.clear_data()
    for name, options in [
        ("text.ply", {"binary": False}),
        ("binary.ply", {"binary": True}),
        ("text.stl", {"binary": False}),
        ("binary.stl", {"binary": True}),
        ("mesh.obj", {}),
        ("text.vtk", {"binary": False}),
        ("binary.vtk", {"binary": True}),
        ("text.vtp", {"binary": False}),
        ("binary.vtp", {"binary": True}),
    ]:
        sphere.save(name, **options)
        report = json.loads(laguerre("integrate", "sites.csv", "--domain", name, "--json"))
        found = abs(report["domain_volume"] / sphere.volume - 1)
        # Of text in a .vtk, VTK writes six digits.
        bound = 1e-5 if name == "text.vtk" else MESH_BOUND
        check(f"VTK's {name}", found < bound and report["relative_error"] < 1e-14, f"{found:.1e}")


def check_vtp():
    """VTK's own ways to write a .vtp, ParaView's among them, and a shuffled one."""
    sphere = pv.Sphere(theta_resolution=24, phi_resolution=16).triangulate()
    volume = lambda name: json.loads(laguerre("integrate", "sites.csv", "--domain", name, "--json"))["domain_volume"]
    sphere.points = sphere.points.astype(float)
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(sphere)
    for mode, encoded, packed in itertools.product(range(3), range(2), range(2)):
        name = f"{mode}{encoded}{packed}.vtp"
        writer.SetFileName(name)
        writer.SetDataMode(mode)
        writer.SetEncodeAppendedData(encoded)
        writer.SetCompressorTypeToZLib() if packed else writer.SetCompressorTypeToNone()
        writer.Write()
        found = abs(volume(name) / sphere.volume - 1)
        check(f"VTK's .vtp, mode {mode}, base64 {encoded}, zlib {packed}", found < MESH_BOUND, f"{found:.1e}")
    faces = sphere.regular_faces.copy()
    turned = np.random.default_rng(3).random(len(faces)) < 0.5
    faces[turned] = faces[turned][:, [0, 2, 1]]
    pv.PolyData.from_regular_faces(sphere.points, faces).save("shuffled.vtp")
    check("a shuffled mesh has the volume to the bit", volume("shuffled.vtp") == volume("200.vtp"))


def check_points():
    points = pv.PolyData(np.random.default_rng(1).random((50, 3)))
    expected = None
    for name, options in [("p.ply", {"binary": True}), ("t.ply", {"binary": False}), ("p.npy", None)]:
        np.save(name, points.points) if options is None else points.save(name, **options)
        laguerre("integrate", name, "--box", "0,0,0,1,1,1", "-o", "p.csv")
        volumes = read_cells("p.csv")["volume"]
        expected = volumes if expected is None else expected
        check(f"sites from {name}", len(volumes) == 50 and worst(volumes, expected) < 1e-4)
    weights = np.linspace(0, 0.01, 50)
    np.savetxt("w.csv", np.c_[points.points, weights], fmt="%.17g", delimiter=",", header="x,y,z,w", comments="")
    np.savez_compressed("packed.npz", points=points.points.astype(float), weights=weights)
    np.savetxt("p.csv.gz", np.c_[weights, points.points], fmt="%.17g", delimiter=";", header="w;x;y;z", comments="")
    for name in ("w.csv", "packed.npz", "p.csv.gz"):
        laguerre("integrate", name, "--box", "0,0,0,1,1,1", "-o", "weighted.csv")
        volumes = read_cells("weighted.csv")["volume"]
        expected = volumes if name == "w.csv" else expected
        check(f"weighted sites from {name}", np.array_equal(volumes, expected))
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
        check_shells()
        check_meshes()
        check_vtp()
        check_points()
        os.chdir(ROOT)
    print("all checks passed")


if __name__ == "__main__":
    main()
