"""pysdot: weights for cells of equal volume in the unit cube."""

import numpy as np
from pysdot import OptimalTransport
from pysdot.domain_types import ConvexPolyhedraAssembly

points = np.random.default_rng(0).random((1000, 3))
cube = ConvexPolyhedraAssembly()
cube.add_box([0.0, 0.0, 0.0], [1.0, 1.0, 1.0], 1.0, 2**64 - 1)  # (the default of the last, -1, is refused by NumPy 2)
transport = OptimalTransport(positions=points, domain=cube, masses=np.full(1000, 1 / 1000))
transport.adjust_weights()
weights = np.array(transport.get_weights())
print(weights - weights.mean())
