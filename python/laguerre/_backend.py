"""Where cells are computed. A backend is opened once, and kept: it has threads, and on a device compiled kernels."""

from __future__ import annotations

import os
import threading
from typing import Any, NamedTuple

from . import _laguerre
from ._arrays import whole

Backend = _laguerre.Backend


class Device(NamedTuple):
    """An OpenCL device."""

    name: str
    platform: str
    is_gpu: bool
    unusable: str | None
    """Why it cannot be used, if so."""


def devices() -> list[Device]:
    """The OpenCL devices of this machine, in the order of their numbers; none where there is no OpenCL."""
    return [Device(*found) for found in _laguerre.devices()]


_opened: dict[Any, Backend] = {}
_lock = threading.Lock()


def opened(backend: Any, devices: list[int] | None, precision: str, threads: int | None) -> Backend:
    """The backend of these options, opened if need be."""
    if isinstance(backend, Backend):
        if (devices, precision, threads) != (None, "f64", None):
            raise ValueError("devices, precision, threads: an open backend has its own")
        return backend
    if not isinstance(backend, str):
        raise ValueError(f"backend {backend!r}: 'auto', 'cpu', 'ocl' or a laguerre.Backend is needed")
    if threads is not None:
        threads = whole(threads, "threads", "a whole number from 1", 1)
    if devices is not None:
        if not isinstance(devices, (list, tuple)):
            raise ValueError(f"devices: a list of their numbers is needed, as [0]; this is {devices!r}")
        devices = [whole(number, "devices", "a number from 0, as laguerre.devices() counts them,", most=2**31) for number in devices]
    # A process that was forked opens its own.
    key = (os.getpid(), backend, None if devices is None else tuple(devices), precision, threads)
    with _lock:
        if key not in _opened:
            _opened[key] = Backend(backend, devices, precision, threads)
        return _opened[key]
