"""Kernels twice more: as plain Python, and compiled with every index checked.

Compiled kernels do not notice an index outside an array, and numba may understand a line otherwise than Python does.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import msgspec
import numpy as np
import pytest

from fuzzy.kernels import jit

ROOT = Path(__file__).parents[1]


def figures(**switches: str) -> list[list[float]]:
    """Return what ``kernel_figures.py`` prints with these switches of numba."""
    command = [sys.executable, "-m", "tests.kernel_figures"]
    environment = os.environ | switches
    environment.pop("NUMBA_CACHE_DIR", None)  # it would put checked and unchecked code into one place
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode(errors="replace")[-5000:]
    return msgspec.json.decode(done.stdout, type=list[list[float]])


@pytest.fixture(scope="module")
def expected() -> list[list[float]]:
    return figures()


@pytest.mark.parametrize("switch", ["NUMBA_DISABLE_JIT", "NUMBA_BOUNDSCHECK"])
def test_plain_and_checked_kernels_agree_with_the_compiled_ones(switch: str, expected: list[list[float]]) -> None:
    # Numba's cache does not tell checked from unchecked code: a place of its own keeps them apart. It stays, beside the
    # other kernels, since unchanged kernels would be compiled there with every run.
    found = figures(**{switch: "1", "XDG_CACHE_HOME": str(jit.cache_root().parent / "checked")})
    assert len(found) == len(expected)
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9)
