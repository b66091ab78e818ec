"""Volumes and centroids of restricted cells as differentiable functions, for PyTorch."""

from __future__ import annotations

from typing import Any

import torch

from ._cells import Cells, Diagram


class _Function(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, points: torch.Tensor, weights: torch.Tensor, options: dict[str, Any]) -> Any:
        where = {"dtype": points.dtype, "device": points.device}
        diagram = Diagram(_array(points), _array(weights), **options)
        wants = points.requires_grad or weights.requires_grad
        ctx.cells = cells = diagram.cells(facet_second_moments=wants)
        return torch.as_tensor(cells.volume, **where), torch.as_tensor(cells.centroid, **where)

    @staticmethod
    def backward(ctx: Any, volume: torch.Tensor, centroid: torch.Tensor) -> Any:  # type: ignore[override]
        cells: Cells = ctx.cells
        where = {"dtype": volume.dtype, "device": volume.device}
        points, weights = cells.pullback(_array(volume), _array(centroid))
        return torch.as_tensor(points, **where), torch.as_tensor(weights, **where), None


def cells(
    points: torch.Tensor, weights: torch.Tensor | None = None, **options: Any
) -> tuple[torch.Tensor, torch.Tensor]:
    """Volumes, (N,), and centroids, (N, 3), of the cells of points, (N, 3), with weights, (N,); differentiable with respect to both.

    ``options`` are those of :class:`laguerre.Diagram`. They are computed in double precision on the host or by OpenCL, whatever the tensors' kind
    and device. Centroids of empty cells are NaN, and without a gradient.
    """
    if weights is None:
        weights = torch.zeros(len(points), dtype=points.dtype, device=points.device)
    return _Function.apply(points, weights, options)


def _array(tensor: torch.Tensor) -> Any:
    return tensor.detach().to("cpu", torch.float64).numpy()
