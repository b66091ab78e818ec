"""sdot: weights for cells of equal volume in the unit cube."""

import numpy as np
from sdot import Box, Iterative, OtProblem, SumOfDiracs

points = np.random.default_rng(0).random((1000, 3))
plan = OtProblem(SumOfDiracs(points), Box()).solve(Iterative(tol=1e-10))  # plan(SumOfDiracs(points), Box()) to 2e-6
weights = np.array(plan.weights)
print(weights - weights.mean())
