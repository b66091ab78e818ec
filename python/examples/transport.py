"""Cells of equal volume: optimal transport, told step by step."""

import numpy as np

import laguerre as lg

points = np.random.default_rng(3).random((2_000, 3))
solved = lg.transport(points, domain=lg.Box(0, 1), callback=lambda told: print(f"step {told['step']:.0f}: residual {told['residual']:.1e}"))
print(f"{solved.end}; cost {solved.cost:.6f}, volumes from {solved.masses.min():.9f} to {solved.masses.max():.9f}")
