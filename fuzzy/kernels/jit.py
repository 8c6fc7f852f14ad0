"""The one decorator with which every numerical kernel of this project is compiled.

Numba's own cache looks at the file of the decorated function alone: a change in a kernel that it calls leaves the
old machine code in use. Here the cache folder's name carries a digest of all kernel sources instead, so that a
changed kernel is always compiled anew, and an unchanged one never.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import os
import shutil
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numba
from numba.core import config

Kernel = Callable[..., Any]
"""Numba chooses the types of arguments and results when a kernel is called; a type checker cannot."""

JIT: bool = not cast("Any", config).DISABLE_JIT
"""False under NUMBA_DISABLE_JIT=1, with which kernels run as plain Python to be examined."""

PROTOTYPE = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_int64, ctypes.c_int64)
"""The C type of an addressed kernel."""

_COMPILING = threading.Lock()

_KEPT_CACHES = 4
"""Caches of earlier sources that stay on disk, for switching between branches."""


def kernel(function: Kernel) -> Kernel:
    """Compile ``function`` with numba on its first call, or load it from the cache.

    Kernels release the interpreter lock, raise nothing, and follow IEEE 754 on division by zero; whoever calls them
    has validated the arguments.
    """
    return _compile(function, nogil=True)


def borrowing_kernel(function: Kernel) -> Kernel:
    """Compile a kernel that only works on the arrays it is given: one that allocates does not compile.

    Numba counts references to every array that a function receives or looks up. For kernels that neither allocate nor
    keep an array this is wasted, and often most of the running time; without the memory runtime nothing is counted.
    Such kernels may call only their like.
    """
    return _compile(function, nogil=True, _nrt=False)


def locking_kernel(function: Kernel) -> Kernel:
    """Like ``borrowing_kernel``, but keeps the interpreter lock: for calls that share one workspace between threads."""
    return _compile(function, nogil=False, _nrt=False)


def inlined_kernel(function: Kernel) -> Kernel:
    """Like ``borrowing_kernel``, always made part of its caller: for functions that only give names."""
    return _compile(function, nogil=True, _nrt=False, forceinline=True)


def parallel_kernel(function: Kernel) -> Kernel:
    """Like ``kernel``, with ``numba.prange`` loops spread over the processor's cores."""
    return _compile(function, nogil=True, parallel=True)


def compiled_for(function: Kernel, *arguments: object) -> Kernel:
    """Return a kernel compiled for the types of these arguments.

    To call it takes a third of the time of calling the kernel itself, since numba does not look at the arguments:
    numbers are converted to these types, anything else raises a TypeError or a ValueError.
    """
    if not JIT:
        return function
    dispatcher: Any = function
    signature = tuple(numba.typeof(argument) for argument in arguments)
    with _COMPILING:
        if signature not in dispatcher.overloads:
            dispatcher.compile(signature)
    return dispatcher.overloads[signature].entry_point


class AddressedKernel:
    """A kernel that others call by its address, so that they need not be compiled together with it.

    It is compiled, or loaded from the cache, when its address is first asked for: a system pays only for what it uses.
    """

    def __init__(self, function: Callable[[int, int], float]) -> None:
        self.function = function

    @functools.cached_property
    def address(self) -> int:
        """Address of the machine code: ``double f(int64, int64)``."""
        return int(self._callback.address) if JIT else ctypes.cast(self._callback, ctypes.c_void_p).value or 0

    @functools.cached_property
    def _callback(self) -> Any:
        if not JIT:
            return PROTOTYPE(self.function)
        options: Any = {"cache": True, "error_model": "numpy", "_nrt": False}
        return _in_cache_folder(self.function, numba.cfunc("float64(int64, int64)", **options))


def addressed_kernel(function: Callable[[int, int], float]) -> AddressedKernel:
    """Make a kernel f(address of a compiled system, number) -> float that is called by its own address."""
    return AddressedKernel(function)


def _compile(function: Kernel, **options: Any) -> Kernel:
    return _in_cache_folder(function, numba.njit(cache=True, error_model="numpy", **options))


def _in_cache_folder(function: Kernel, decorate: Callable[[Kernel], Any]) -> Any:
    if os.environ.get("NUMBA_CACHE_DIR"):
        return decorate(function)
    # Numba reads the folder when a function is decorated: other packages' functions keep their own.
    settings: Any = config
    previous = settings.CACHE_DIR
    settings.CACHE_DIR = str(_cache_folder(function.__module__.partition(".")[0]))
    try:
        return decorate(function)
    finally:
        settings.CACHE_DIR = previous


@functools.cache
def _cache_folder(package: str) -> Path:
    """Return the cache folder for the present sources of ``package`` and of this package, on which it builds."""
    digest = hashlib.sha256(f"{numba.__version__} {sys.version}".encode())
    for root in sorted({_package_root(package), _package_root(__name__.partition(".")[0])}):
        for source in sorted(root.rglob("*.py")):
            text = source.read_bytes()
            if b"fuzzy.kernels" in text:  # kernels, and what they are decorated with
                digest.update(text)
    folder = cache_root() / f"{package}-{digest.hexdigest()[:16]}"
    if not folder.exists():
        _prune(package)
    return folder


def cache_root() -> Path:
    """Return the folder that holds the compiled kernels of this user."""
    base = os.environ.get("XDG_CACHE_HOME") or (
        os.environ.get("LOCALAPPDATA") if sys.platform == "win32" else "~/.cache"
    )
    return Path(base or "~").expanduser() / "fuzzy-workbench" / "kernels"


def _package_root(package: str) -> Path:
    return Path(cast("str", sys.modules[package].__file__)).parent


def _prune(package: str) -> None:
    """Delete all but the newest caches of ``package``."""
    if not cache_root().is_dir():
        return
    caches = sorted(cache_root().glob(f"{package}-*"), key=lambda folder: folder.stat().st_mtime, reverse=True)
    for stale in caches[_KEPT_CACHES - 1 :]:
        shutil.rmtree(stale, ignore_errors=True)
