"""The workbench starts, shows itself to its own page only, and ends."""

from __future__ import annotations

import signal
import subprocess
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page

from tests.e2e.harness import Workbench, running_workbench

TOKEN = "0123456789abcdef-XYZ"


def ended(workbench: Workbench, number: signal.Signals) -> str:
    """Return what a workbench printed that was asked to end, and did."""
    workbench.process.send_signal(number)
    try:
        assert workbench.process.wait(timeout=10) == 0
    except subprocess.TimeoutExpired:
        pytest.fail(f"{number.name} does not end it")
    return workbench.log.read_text(errors="replace")


def test_the_address_is_printed_and_a_term_signal_ends_it(rulebases: Path) -> None:
    with running_workbench(rulebases) as workbench:
        printed = ended(workbench, signal.SIGTERM)
    assert f"Fuzzy workbench: {workbench.url}  (Ctrl+C ends it)" in printed
    assert "unsaved" not in printed
    assert "Traceback" not in printed


def test_with_a_token_the_page_opens_from_the_printed_address_only_and_an_interrupt_ends_it(
    rulebases: Path, new_page: Callable[[str], Page]
) -> None:
    with running_workbench(rulebases, "--token", TOKEN) as workbench:
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(workbench.url, timeout=10)
        page = new_page(f"{workbench.url}/?token={TOKEN}")
        assert TOKEN not in page.url
        assert page.locator("canvas").count() >= 1
        printed = ended(workbench, signal.SIGINT)
    assert "unsaved" not in printed
    assert "Traceback" not in printed
