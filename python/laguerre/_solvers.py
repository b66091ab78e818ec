"""Lloyd's relaxation and semi-discrete optimal transport."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _laguerre
from ._cells import Box, Cells, Diagram, Domain

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class Relaxation:
    """What :func:`lloyd` came to."""

    points: NDArray[np.float64]
    """The points, (N, 3)."""
    energy: NDArray[np.float64]
    """The energy at the start and after each iteration (length to the fifth)."""
    gradient: NDArray[np.float64]
    """The mean distance of points from centroids, over the mean cell's size, likewise."""
    converged: bool
    """Whether the last gradient is within the tolerance."""
    cells: Cells
    """The cells of these points, with second moments."""


@dataclass(frozen=True, eq=False)
class Transport:
    """What :func:`transport` came to."""

    weights: NDArray[np.float64]
    """The weights, (N,) (length squared)."""
    masses: NDArray[np.float64]
    """The masses of their cells, (N,)."""
    residual: float
    """Largest ``|mass / target - 1|``."""
    residuals: NDArray[np.float64]
    """The same at the start and after each step."""
    cost: float | None
    """The cost: the integral of ``density * |x - p|**2`` over all cells."""
    end: str
    """``"converged"``, ``"iterations"``, ``"stalled"`` (rounding is all that is left) or ``"stopped"`` (by the callback)."""
    cells: Cells
    """The cells of these weights."""

    @property
    def converged(self) -> bool:
        """Whether the residual is within the tolerance."""
        return self.end == "converged"


def lloyd(
    points: ArrayLike,
    domain: Domain | Box | None = None,
    weights: ArrayLike | None = None,
    *,
    method: str = "lbfgs",
    iterations: int = 100,
    tolerance: float = 1e-3,
    callback: Callable[[dict[str, float]], Any] | None = None,
    **options: Any,
) -> Relaxation:
    """Moves points down the energy of centroidal tessellations, by ``"lbfgs"`` or by Lloyd's own steps (``"lloyd"``).

    ``callback`` is given energy, gradient and diagrams so far after each iteration, the start included; a true answer ends it with what there is.
    ``options`` are those of :class:`Diagram`.
    """
    diagram = Diagram(points, weights, domain=domain, **options)
    found = _laguerre.lloyd(
        diagram.backend, diagram.points, diagram.weights, diagram._container, method, iterations, tolerance, callback
    )
    diagram.set(found["points"], diagram.weights)
    cells = Cells(diagram, found.pop("cells"))
    return Relaxation(cells=cells, **found)


def transport(
    points: ArrayLike,
    domain: Domain | Box | None = None,
    masses: ArrayLike | None = None,
    *,
    weights: ArrayLike | None = None,
    density: tuple[float, ArrayLike] | None = None,
    iterations: int = 100,
    tolerance: float = 1e-9,
    callback: Callable[[dict[str, float]], Any] | None = None,
    **options: Any,
) -> Transport:
    """Weights for cells of the ``masses`` asked for (all equal without): semi-discrete optimal transport, by a damped Newton method.

    ``weights`` are where it starts. ``density`` is ``(value, gradient)``: ``value + gradient . x``; without, 1. The masses sum to the domain's.
    ``callback`` is given step, residual and length of the step after each, the start included; a true answer ends it with what there is.
    ``options`` are those of :class:`Diagram`.
    """
    diagram = Diagram(points, weights, domain=domain, **options)
    wanted = None if masses is None else np.ascontiguousarray(masses, dtype=float)
    rho = None if density is None else (float(density[0]), np.asarray(density[1], dtype=float).tolist())
    found = _laguerre.transport(
        diagram.backend, diagram.points, diagram.weights, diagram._container, wanted, rho, iterations, tolerance,
        callback,
    )  # fmt: skip
    diagram.set(diagram.points, found["weights"])
    cells = Cells(diagram, found.pop("cells"))
    return Transport(cells=cells, **found)
