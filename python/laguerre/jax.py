"""Volumes and centroids of restricted cells as differentiable functions, for JAX."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ._cells import Cells, Diagram


def cells(points: Any, weights: Any = None, **options: Any) -> tuple[jax.Array, jax.Array]:
    """Volumes, (N,), and centroids, (N, 3), of the cells of points, (N, 3), with weights, (N,); differentiable (backwards, once) with respect to both,
    under ``jit`` and ``vmap``, too.

    ``options`` are those of :class:`laguerre.Diagram`. They are computed in double precision on the host or by OpenCL, whatever the arrays' kind.
    Centroids of empty cells are NaN, and without a gradient.
    """
    points = jnp.asarray(points)
    kind = points.dtype
    by_radii = options.pop("radii", None)
    if by_radii is not None:
        if weights is not None:
            raise ValueError("weights and radii: give one of them")
        weights = jnp.square(jnp.asarray(by_radii))
    weights = jnp.zeros(points.shape[0], kind) if weights is None else jnp.asarray(weights)

    def shapes(n: int) -> tuple[jax.ShapeDtypeStruct, jax.ShapeDtypeStruct]:
        return jax.ShapeDtypeStruct((n,), kind), jax.ShapeDtypeStruct((n, 3), kind)

    def evaluated(p: Any, w: Any, **what: bool) -> Cells:
        return Diagram(np.asarray(p), np.asarray(w), **options).cells(**what)

    def host(p: Any, w: Any) -> Any:
        found = evaluated(p, w)
        return found.volume.astype(kind), found.centroid.astype(kind)

    def host_back(p: Any, w: Any, volume: Any, centroid: Any) -> Any:
        by_points, by_weights = evaluated(p, w, facet_second_moments=True).pullback(np.asarray(volume), np.asarray(centroid))
        return by_weights.astype(kind), by_points.astype(kind)

    @jax.custom_vjp
    def function(p: jax.Array, w: jax.Array) -> Any:
        return jax.pure_callback(host, shapes(p.shape[0]), p, w, vmap_method="sequential")

    def forward(p: jax.Array, w: jax.Array) -> Any:
        return function(p, w), (p, w)

    def backward(kept: Any, bars: Any) -> Any:
        p, w = kept
        by_weights, by_points = jax.pure_callback(host_back, shapes(p.shape[0]), p, w, *bars, vmap_method="sequential")
        return by_points, by_weights.astype(w.dtype)

    function.defvjp(forward, backward)
    return function(points, weights)
