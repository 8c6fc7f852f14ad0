"""The real workbench in a process of its own, and a real Chromium that looks at it."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from tests.e2e.browser import MISSING, find_chromium
from tests.e2e.harness import (
    FLAGS,
    HIDE_SOFTWARE_RENDERER,
    LOAD_TIMEOUT_MS,
    ROOT,
    Workbench,
    running_workbench,
    settle,
    wait_until_ready,
)

SHOTS = Path(__file__).parent / "shots"


@pytest.fixture
def rulebases(tmp_path: Path) -> Path:
    """A copy of the shipped rule bases that a test may change."""
    return Path(shutil.copytree(ROOT / "rulebases", tmp_path / "rulebases"))


@pytest.fixture
def workbench(rulebases: Path) -> Iterator[Workbench]:
    """A workbench of this test's own."""
    with running_workbench(rulebases) as started:
        yield started


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """One Chromium for all browser tests, gone before the others; where there is none they fail, never skipped."""
    executable = find_chromium()
    if executable is None:
        pytest.fail(MISSING, pytrace=False)
    with sync_playwright() as playwright:
        launched = playwright.chromium.launch(executable_path=executable, args=list(FLAGS))
        yield launched
        launched.close()


@pytest.fixture
def new_page(browser: Browser) -> Iterator[Callable[[str], Page]]:
    """Return a function that opens an address in a window of its own and waits for the first elements."""
    with contextlib.ExitStack() as windows:

        def open_page(url: str) -> Page:
            context = windows.enter_context(
                contextlib.closing(browser.new_context(viewport={"width": 1600, "height": 900}))
            )
            context.add_init_script(HIDE_SOFTWARE_RENDERER)
            context.set_default_timeout(30_000)
            page = context.new_page()
            page.goto(url, wait_until="domcontentloaded", timeout=LOAD_TIMEOUT_MS)
            wait_until_ready(page)
            return page

        yield open_page


@pytest.fixture
def page(workbench: Workbench, new_page: Callable[[str], Page]) -> Page:
    """The page of this test's workbench, loaded."""
    return new_page(workbench.url)


@pytest.fixture
def shot(page: Page) -> Callable[[str], Path]:
    """Return a function that photographs the page into ``tests/e2e/shots`` and returns the picture's path."""

    def take(name: str) -> Path:
        SHOTS.mkdir(exist_ok=True)
        path = SHOTS / f"{name}.png"
        settle(page)
        page.screenshot(path=path, timeout=LOAD_TIMEOUT_MS)
        return path

    return take


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    """Add what the workbench printed to the report of a failed browser test."""
    report = yield
    started = getattr(item, "funcargs", {}).get("workbench")
    if report.failed and isinstance(started, Workbench):  # pyright: ignore[reportAttributeAccessIssue]
        text = started.log.read_text(errors="replace")
        report.sections.append(("workbench", text[-10_000:]))  # pyright: ignore[reportAttributeAccessIssue]
    return report


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark everything in this folder as a browser test."""
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.browser)
