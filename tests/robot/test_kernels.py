"""How kernels are compiled."""

from __future__ import annotations

from pathlib import Path

import pytest

import robot

ROOT = Path(robot.__file__).parent
COMPILED = [
    *sorted((ROOT / "kernels").glob("[a-z]*.py")),
    ROOT / "controllers" / "base.py",
    ROOT / "controllers" / "fuzzy.py",
]


@pytest.mark.parametrize("path", COMPILED, ids=lambda path: path.name)
def test_a_change_in_any_compiled_module_renews_the_cache(path: Path) -> None:
    """The cache's name carries a digest of all sources that speak of ``fuzzy.kernels``; see fuzzy/kernels/jit.py."""
    assert b"fuzzy.kernels" in path.read_bytes()
