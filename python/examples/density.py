"""Points that share a density of an image evenly."""

import numpy as np

import laguerre as lg

x, y, z = np.mgrid[0:8, 0:8, 0:8] / 8 - 0.4375
image = lg.Domain.image(np.exp(-8 * (x**2 + y**2 + z**2)), lo=-0.5, hi=0.5)
points = np.random.default_rng(1).random((200, 3)) - 0.5
found = lg.transport(points, domain=image)
print(f"mass of each: {image.volume / 200:.6f}, largest relative error {found.residual:.0e}")
