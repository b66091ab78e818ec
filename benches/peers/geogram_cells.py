"""geogram (PyPI), on all threads: Voronoi cells cut by the tetrahedra of a cube, or of a mesh whose interior it fills first, which is not timed.

Rows of x, y, z; then nothing for the unit cube, or an OBJ file. Says seconds of the second of two runs, the sum of the volumes and that of their squares.
"""

import sys
import time

import geogram
import numpy as np

sites = np.loadtxt(sys.argv[1])
if len(sys.argv) > 2:
    rows = [line.split() for line in open(sys.argv[2], encoding="utf-8")]
    vertices = np.array([row[1:4] for row in rows if row[:1] == ["v"]], float)
    triangles = np.array([[int(corner.split("/")[0]) - 1 for corner in row[1:4]] for row in rows if row[:1] == ["f"]], np.uint32)
    vertices, tetrahedra = geogram.mesh.tetrahedralize(vertices, triangles)[:2]
    vertices, tetrahedra = np.ascontiguousarray(vertices, float), np.ascontiguousarray(tetrahedra, np.uint32)
else:
    vertices = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    tetrahedra = np.array([[0, 3, 1, 7], [0, 2, 3, 7], [0, 6, 2, 7], [0, 4, 6, 7], [0, 5, 4, 7], [0, 1, 5, 7]], np.uint32)
for _ in range(2):
    begin = time.perf_counter()
    found = geogram.Voronoi(sites, None, vertices, tetrahedra)
    seconds = time.perf_counter() - begin
a, b, c, d = (np.asarray(found.q)[np.asarray(found.t)[:, k]] for k in range(4))
pieces = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
volumes = np.bincount(found.tseed, weights=pieces, minlength=len(sites))
print(f"{seconds:.6f} {volumes.sum():.17g} {(volumes**2).sum():.17g}")
