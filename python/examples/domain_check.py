"""What is wrong with a mesh, and what was put right on the way in."""

import numpy as np

import laguerre as lg

vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
triangles = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
print(lg.Domain(vertices, triangles[:, ::-1]).notes)  # inside out
try:
    lg.Domain(vertices, triangles[:3])  # a triangle is missing
except ValueError as error:
    print(error)
