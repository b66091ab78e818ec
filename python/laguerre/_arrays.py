"""Arrays in: what is taken, and what is said of what is not."""

from __future__ import annotations

import contextlib
import operator
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def numbers(values: Any, what: str, shape: tuple[int | None, ...]) -> NDArray[np.float64]:
    """``values`` as doubles in C order, not to be written to: a copy, or what they are where nobody can write to it. ``None`` in ``shape`` is any length."""
    found = _array(values, what)
    if found.dtype.kind not in "fiu":
        raise ValueError(f"{what}: real numbers are needed, these are {found.dtype}")
    if found.ndim != len(shape) or any(n is not None and n != m for n, m in zip(shape, found.shape)):
        wanted = ", ".join("N" if n is None else str(n) for n in shape) + ("," if len(shape) == 1 else "")
        raise ValueError(f"{what}: an array of shape ({wanted}) is needed, this has {found.shape}")
    if found.dtype == float and found.dtype.isnative and found.flags.c_contiguous and found.flags.aligned and _is_constant(found):
        return found
    return frozen(np.array(found, dtype=float, order="C"))


def indices(values: Any, what: str, corners: int) -> NDArray[np.uint32]:
    """Rows of so many indices."""
    found = _array(values, what)
    if found.ndim != 2 or found.shape[1] != corners:
        raise ValueError(f"{what}: an array of shape (T, {corners}) is needed, this has {found.shape}")
    if found.dtype.kind not in "iu":
        raise ValueError(f"{what}: integers are needed, these are {found.dtype}")
    if found.size and (found.min() < 0 or found.max() >= 2**32):
        raise ValueError(f"{what}: an index is negative or beyond 32 bits")
    return np.ascontiguousarray(found, dtype=np.uint32)


class ReadOnly:
    """What has arrays that others read later: copies of it, and what is pickled, have them read-only, too."""

    def __setstate__(self, state: dict[str, Any]) -> None:
        for value in state.values():
            freeze(value)
        self.__dict__.update(state)


def freeze(value: Any) -> Any:
    """The same, with its arrays not to be written to: others read them later."""
    if isinstance(value, np.ndarray):
        frozen(value)
    elif isinstance(value, dict):
        for one in value.values():
            freeze(one)
    return value


def whole(number: Any, what: str, wanted: str = "a whole number from 0", least: int = 0, most: int = 2**63 - 1) -> int:
    """An integer within bounds."""
    if not isinstance(number, (bool, np.bool_)):
        with contextlib.suppress(TypeError):
            found = operator.index(number)
            if least <= found <= most:
                return found
    raise ValueError(f"{what}: {wanted} is needed, this is {number!r}")


def real(number: Any, what: str) -> float:
    """A double."""
    if not isinstance(number, (bool, np.bool_, str, bytes)):
        with contextlib.suppress(TypeError, ValueError, OverflowError):
            return float(number)
    raise ValueError(f"{what}: a number is needed, this is {number!r}")


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """The same array, not to be written to: others read it later."""
    array.flags.writeable = False
    return array


def _is_constant(array: NDArray[Any]) -> bool:
    """Whether neither it nor any array that it is a view of can be written to, and its memory is NumPy's, of bytes, or of a result: others' may be written to by them."""
    found: Any = array
    while isinstance(found, np.ndarray):
        if found.flags.writeable:
            return False
        found = found.base
    return found is None or isinstance(found, bytes) or type(found).__name__ == "PySliceContainer"


def _array(values: Any, what: str) -> NDArray[Any]:
    if np.ma.is_masked(values):
        raise ValueError(f"{what}: some are masked; leave them out")
    if not isinstance(values, np.ndarray) and hasattr(values, "__dlpack__"):
        try:
            return np.from_dlpack(values)
        except (BufferError, RuntimeError, TypeError) as error:
            advice = "detach it and bring it to the host, or take laguerre.torch or laguerre.jax"
            raise ValueError(f"{what}: {error}: {advice}") from error
    return np.asarray(values)
