"""What is written in Rust: arrays in C order in, dictionaries of arrays out."""

import os
from collections.abc import Callable
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Backend",
    "Domain",
    "Geometry",
    "__version__",
    "devices",
    "evaluate",
    "fluid",
    "integrate",
    "jacobian",
    "lloyd",
    "page",
    "pull_back",
    "pull_back_cells",
    "save",
    "scene",
    "transport",
    "write",
]

__version__: str

@final
class Backend:
    def __new__(cls, name: str = "auto", devices: list[int] | None = None, precision: str = "f64", threads: int | None = None) -> Backend: ...
    @property
    def name(self) -> str: ...
    @property
    def device(self) -> str: ...
    @property
    def precision(self) -> str: ...
    @property
    def threads(self) -> int: ...

@final
class Domain:
    def __new__(cls, vertices: NDArray[np.float64], triangles: NDArray[np.uint32], orient: bool) -> Domain: ...
    @staticmethod
    def load(path: str | os.PathLike[str], orient: bool) -> Domain: ...
    @staticmethod
    def image(values: NDArray[np.float64], shape: tuple[int, ...], lo: list[float], hi: list[float]) -> Domain: ...
    @staticmethod
    def tetrahedra(
        vertices: NDArray[np.float64], tetrahedra: NDArray[np.uint32], values: NDArray[np.float64]
    ) -> Domain: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def triangles(self) -> NDArray[np.uint32]: ...
    @property
    def volume(self) -> float: ...
    @property
    def area(self) -> float: ...
    @property
    def centroid(self) -> NDArray[np.float64]: ...
    @property
    def bounds(self) -> tuple[list[float], list[float]]: ...
    @property
    def notes(self) -> list[str]: ...

@final
class Geometry:
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]: ...

def devices() -> list[tuple[str, str, bool, str | None]]: ...
def evaluate(
    backend: Backend,
    points: NDArray[np.float64],
    weights: NDArray[np.float64] | None,
    container: Any,
    facets: bool,
    laplacian: bool,
    second_moments: bool,
    facet_second_moments: bool,
    geometry: bool,
    solids: bool,
    polynomial: Any,
    epsilon: float | None,
) -> dict[str, Any]: ...
def integrate(
    backend: Backend,
    points: NDArray[np.float64],
    weights: NDArray[np.float64] | None,
    container: Any,
    function: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    degree: int,
    columns: int,
    epsilon: float | None,
) -> dict[str, Any]: ...
def jacobian(
    backend: Backend,
    points: NDArray[np.float64],
    weights: NDArray[np.float64] | None,
    container: Any,
    cells: dict[str, Any],
    of: str,
    by: str,
) -> tuple[NDArray[np.uint64], NDArray[np.uint32], NDArray[np.float64]]: ...
def lloyd(
    backend: Backend,
    points: NDArray[np.float64],
    weights: NDArray[np.float64] | None,
    container: Any,
    density: Any,
    method: str,
    iterations: int,
    tolerance: float,
    callback: Callable[[dict[str, Any]], Any] | None,
) -> dict[str, Any]: ...
def transport(
    backend: Backend,
    points: NDArray[np.float64],
    weights: NDArray[np.float64] | None,
    container: Any,
    masses: NDArray[np.float64] | None,
    density: Any,
    iterations: int,
    tolerance: float,
    normalize: bool,
    facets: bool,
    callback: Callable[[dict[str, Any]], Any] | None,
) -> dict[str, Any]: ...
def pull_back_cells(
    backend: Backend,
    points: NDArray[np.float64],
    weights: NDArray[np.float64] | None,
    container: Any,
    cells: dict[str, Any],
    by_masses: NDArray[np.float64],
    by_centroids: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
def pull_back(
    backend: Backend,
    points: NDArray[np.float64],
    weights: NDArray[np.float64],
    container: Any,
    density: Any,
    by_weights: NDArray[np.float64] | None,
    by_centroids: NDArray[np.float64] | None,
    by_cost: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
def fluid(
    backend: Backend,
    points: NDArray[np.float64],
    container: Any,
    velocities: NDArray[np.float64],
    densities: NDArray[np.float64],
    epsilon: float | None,
    viscosity: float,
    gravity: list[float],
    shake: tuple[list[float], float, float] | None,
    time_step: float | None,
    before: Any,
    steps: int,
    callback: Callable[[dict[str, Any]], Any] | None,
) -> dict[str, Any]: ...
def scene(name: str, count: int, centers: NDArray[np.float64] | None, container: Any, gravity: float | None) -> dict[str, Any]: ...
def save(
    backend: Backend,
    points: NDArray[np.float64],
    weights: NDArray[np.float64] | None,
    container: Any,
    cells: dict[str, Any],
    of_facets: bool,
    path: str | os.PathLike[str],
) -> None: ...
def write(path: str | os.PathLike[str], bytes: NDArray[np.uint8]) -> None: ...
def page(
    backend: Backend,
    container: Any,
    states: list[tuple[str, NDArray[np.float64], NDArray[np.float64] | None, NDArray[np.float64] | None]],
    has_speeds: bool,
    curve: tuple[str, list[float]] | None,
    title: str,
    path: str | os.PathLike[str],
) -> None: ...
