"""The workbench starts, shows itself to its own page only, and ends."""

from __future__ import annotations

import signal
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page

from tests.e2e.harness import Workbench, running_workbench

TOKEN = "0123456789abcdef-XYZ"


def test_the_page_opens_without_an_error(workbench: Workbench, new_page: Callable[[str], Page]) -> None:
    page = new_page(workbench.url)
    assert page.locator("canvas").count() >= 1
    assert workbench.process.poll() is None
    assert "Traceback" not in workbench.log.read_text(errors="replace")


def test_the_address_is_printed(workbench: Workbench, new_page: Callable[[str], Page]) -> None:
    new_page(workbench.url)
    assert f"Fuzzy workbench: {workbench.url}  (Ctrl+C ends it)" in workbench.log.read_text(errors="replace")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_it_ends_when_it_is_asked_to(workbench: Workbench, number: signal.Signals) -> None:
    workbench.process.send_signal(number)
    assert workbench.process.wait(timeout=10) == 0
    assert "unsaved" not in workbench.log.read_text(errors="replace")
    assert "Traceback" not in workbench.log.read_text(errors="replace")


def test_with_a_token_the_page_opens_from_the_printed_address_only(
    rulebases: Path, new_page: Callable[[str], Page]
) -> None:
    with running_workbench(rulebases, "--token", TOKEN) as workbench:
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(workbench.url, timeout=10)
        page = new_page(f"{workbench.url}/?token={TOKEN}")
        assert TOKEN not in page.url
        assert page.locator("canvas").count() >= 1
