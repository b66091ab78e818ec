"""Volumes and centroids of restricted cells, and optimal transport, as differentiable functions, for PyTorch."""

from __future__ import annotations

from typing import Any

import torch
from torch.autograd.function import once_differentiable

from ._diagram import Diagram
from ._solvers import refuse_density, solved


class _Function(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, points: torch.Tensor, weights: torch.Tensor | None, options: dict[str, Any]) -> Any:
        # Saved, so that PyTorch refuses a backward pass after they were changed in place.
        ctx.save_for_backward(points, weights)
        wants = points.requires_grad or (weights is not None and weights.requires_grad)
        cells = Diagram(_array(points), None if weights is None else _array(weights), **options).cells(facet_second_moments=wants)
        ctx.cells = cells
        where = _where(points)
        return torch.tensor(cells.volume, **where), torch.tensor(cells.centroid, **where)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, volume: torch.Tensor, centroid: torch.Tensor) -> Any:  # type: ignore[override]
        kept_points, kept_weights = ctx.saved_tensors
        points, weights = ctx.cells.pullback(_array(volume), _array(centroid))
        by_weights = None if kept_weights is None else torch.as_tensor(weights).to(kept_weights)
        return torch.as_tensor(points).to(kept_points), by_weights, None


def cells(
    points: torch.Tensor, weights: torch.Tensor | None = None, **options: Any
) -> tuple[torch.Tensor, torch.Tensor]:
    """Volumes, (N,), and centroids, (N, 3), of the cells of points, (N, 3), with weights, (N,); differentiable, once, with respect to both.

    ``options`` are those of :class:`laguerre.Diagram`. They are computed in double precision on the host or by OpenCL, whatever the tensors' kind
    and device. Centroids of empty cells are NaN, and without a gradient.
    """
    return _Function.apply(points, weights, options)


class _Transport(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, points: torch.Tensor, masses: torch.Tensor | None, options: dict[str, Any]) -> Any:
        ctx.save_for_backward(points, masses)
        found = solved(_array(points), None if masses is None else _array(masses), options)
        ctx.found = found
        where = _where(points)
        return (
            torch.tensor(found.weights, **where),
            torch.tensor(found.cells.centroid, **where),
            torch.tensor(found.cost, **where),
        )

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, weights: torch.Tensor, centroid: torch.Tensor, cost: torch.Tensor) -> Any:  # type: ignore[override]
        kept_points, kept_masses = ctx.saved_tensors
        points, masses = ctx.found.pullback(_array(weights), _array(centroid), cost.item())
        by_masses = None if kept_masses is None else torch.as_tensor(masses).to(kept_masses)
        return torch.as_tensor(points).to(kept_points), by_masses, None


def transport(
    points: torch.Tensor, masses: torch.Tensor | None = None, **options: Any
) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """Weights, (N,), centroids, (N, 3), and cost of the optimal transport to points, (N, 3), with masses, (N,), all equal without; differentiable, once, with
    respect to both, through the solve.

    ``options`` are those of :func:`laguerre.transport`; the density is 1, or the domain's own. Masses change so that their sum stays: their gradient sums to 0 (with
    ``normalize``, they change as they will).
    """
    refuse_density(options)
    return _Transport.apply(points, masses, options)


def _array(tensor: torch.Tensor) -> Any:
    return tensor.detach().to("cpu", torch.float64).numpy()


def _where(points: torch.Tensor) -> dict[str, Any]:
    """The kind and device of results: the points', or where these are whole numbers the default kind."""
    kind = points.dtype if points.is_floating_point() else torch.get_default_dtype()
    return {"dtype": kind, "device": points.device}
