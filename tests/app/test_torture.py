"""A quick share of ``make torture``: sessions that are killed lose nothing."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs POSIX")
def test_killed_sessions_lose_nothing(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.torture", "8"]
    done = subprocess.run(command, cwd=Path(__file__).parents[2], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "8 sessions killed" in done.stdout
