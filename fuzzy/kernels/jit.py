"""The one decorator with which every numerical kernel of this project is compiled.

Numba's own cache looks at the file of the decorated function alone: a change in a kernel that it calls leaves the
old machine code in use. Here the cache folder's name carries a digest of all kernel sources instead, so that a
changed kernel is always compiled anew, and an unchanged one never.
"""

from __future__ import annotations

import functools
import hashlib
import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numba
from numba.core import config

Kernel = Callable[..., Any]
"""Numba chooses the types of arguments and results when a kernel is called; a type checker cannot."""

_KEPT_CACHES = 4
"""Caches of earlier sources that stay on disk, for switching between branches."""


def kernel(function: Kernel) -> Kernel:
    """Compile ``function`` with numba on its first call, or load it from the cache.

    Kernels release the interpreter lock, raise nothing, and follow IEEE 754 on division by zero; whoever calls them
    has validated the arguments.
    """
    return _compile(function, nogil=True)


def locking_kernel(function: Kernel) -> Kernel:
    """Like ``kernel``, but keeps the interpreter lock: for short calls that share one workspace between threads."""
    return _compile(function, nogil=False)


def inlined_kernel(function: Kernel) -> Kernel:
    """Like ``kernel``, always made part of its caller: for functions that only give names to what is there."""
    return _compile(function, nogil=True, forceinline=True)


def parallel_kernel(function: Kernel) -> Kernel:
    """Like ``kernel``, with ``numba.prange`` loops spread over the processor's cores."""
    return _compile(function, nogil=True, parallel=True)


def _compile(function: Kernel, **options: Any) -> Kernel:
    decorate: Any = numba.njit(cache=True, error_model="numpy", **options)
    if os.environ.get("NUMBA_CACHE_DIR"):
        return cast("Kernel", decorate(function))
    # Numba reads the folder when a function is decorated: other packages' functions keep their own.
    settings: Any = config
    previous = settings.CACHE_DIR
    settings.CACHE_DIR = str(_cache_folder(function.__module__.partition(".")[0]))
    try:
        return cast("Kernel", decorate(function))
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
