"""Volumes and centroids of restricted cells as differentiable functions, for JAX."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ._cells import Diagram


def cells(points: jax.Array, weights: jax.Array | None = None, **options: Any) -> tuple[jax.Array, jax.Array]:
    """Volumes, (N,), and centroids, (N, 3), of the cells of points, (N, 3), with weights, (N,); differentiable (backwards) with respect to both,
    and under ``jit``.

    ``options`` are those of :class:`laguerre.Diagram`. They are computed in double precision on the host or by OpenCL, whatever the arrays' kind.
    Centroids of empty cells are NaN, and without a gradient.
    """
    if weights is None:
        weights = jnp.zeros(points.shape[0], points.dtype)

    def shapes(n: int) -> tuple[jax.ShapeDtypeStruct, jax.ShapeDtypeStruct]:
        return jax.ShapeDtypeStruct((n,), points.dtype), jax.ShapeDtypeStruct((n, 3), points.dtype)

    def evaluated(p: Any, w: Any, **what: bool) -> Any:
        return Diagram(np.asarray(p, dtype=float), np.asarray(w, dtype=float), **options).cells(**what)

    def host(p: Any, w: Any) -> Any:
        found = evaluated(p, w)
        return found.volume.astype(points.dtype), found.centroid.astype(points.dtype)

    def host_back(p: Any, w: Any, volume: Any, centroid: Any) -> Any:
        by_points, by_weights = evaluated(p, w, facet_second_moments=True).pullback(
            np.asarray(volume, dtype=float), np.asarray(centroid, dtype=float)
        )
        return by_weights.astype(points.dtype), by_points.astype(points.dtype)

    @jax.custom_vjp
    def function(p: jax.Array, w: jax.Array) -> Any:
        return jax.pure_callback(host, shapes(p.shape[0]), p, w)

    def forward(p: jax.Array, w: jax.Array) -> Any:
        return function(p, w), (p, w)

    def backward(kept: Any, bars: Any) -> Any:
        p, w = kept
        by_weights, by_points = jax.pure_callback(host_back, shapes(p.shape[0]), p, w, *bars)
        return by_points, by_weights

    function.defvjp(forward, backward)
    return function(points, weights)
