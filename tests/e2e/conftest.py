"""The real workbench in a process of its own, and a real Chromium that looks at it."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Page, expect, sync_playwright

from tests.e2e.browser import MISSING, find_chromium
from tests.e2e.harness import (
    FLAGS,
    HIDE_SOFTWARE_RENDERER,
    LOAD_TIMEOUT_MS,
    ROOT,
    SELDOM_DRAWN,
    TOUR_SEEN,
    Workbench,
    look_at,
    running_workbench,
)
from tests.e2e.panels import ANSWER_MS, choose_tab, photograph

expect.set_options(timeout=ANSWER_MS)


def new_context(browser: Browser) -> BrowserContext:
    """Return a window of a usual size in a browser that has been here before."""
    context = browser.new_context(viewport={"width": 1600, "height": 900}, accept_downloads=True)
    context.add_init_script(HIDE_SOFTWARE_RENDERER + SELDOM_DRAWN + TOUR_SEEN)
    context.set_default_timeout(ANSWER_MS)
    return context


@pytest.fixture
def rulebases(tmp_path: Path) -> Path:
    """A copy of the shipped rule bases that a test may change."""
    return Path(shutil.copytree(ROOT / "rulebases", tmp_path / "rulebases"))


@pytest.fixture(scope="package")
def workbench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Workbench]:
    """The workbench that the tests share; every one starts from what it finds, and leaves it as it was."""
    folder = Path(shutil.copytree(ROOT / "rulebases", tmp_path_factory.mktemp("workbench") / "rulebases"))
    with running_workbench(folder) as started:
        yield started


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """One Chromium for all browser tests, gone before the others; where there is none they fail, never skipped."""
    executable = find_chromium()
    if executable is None:
        pytest.fail(MISSING, pytrace=False)
    with sync_playwright() as playwright:
        launched = playwright.chromium.launch(executable_path=executable, args=[*FLAGS, "--disable-gpu-compositing"])
        yield launched
        launched.close()


@pytest.fixture(scope="package")
def complaints() -> list[str]:
    """What the shared page complained about: exceptions, and errors on its console."""
    return []


@pytest.fixture(scope="package")
def page(workbench: Workbench, browser: Browser, complaints: list[str]) -> Iterator[Page]:
    """The page that the tests share, its first run finished."""

    def hear(message: ConsoleMessage) -> None:
        # Viser's page says so when a chart is replaced while its last update is still on the way: nothing is lost.
        if message.type == "error" and "Tried to update non-existent component" not in message.text:
            complaints.append(message.text)

    with contextlib.closing(new_context(browser)) as context:
        context.on("console", hear)
        context.on("weberror", lambda error: complaints.append(str(error.error)))
        opened = look_at(context, workbench.url)
        choose_tab(opened, "Metrics")
        # A first start compiles the kernels.
        expect(opened.locator("#overshoot-now")).to_have_count(1, timeout=2 * LOAD_TIMEOUT_MS)
        yield opened


@pytest.fixture
def nothing_went_wrong(workbench: Workbench, page: Page, complaints: list[str]) -> Iterator[None]:
    """Fail a test that made the shared page or workbench complain."""
    assert page.url
    yield
    assert complaints == []
    assert workbench.process.poll() is None
    printed = workbench.log.read_text(errors="replace")
    for word in ("Traceback", "left out", "refused", "never sends"):
        assert word not in printed


@pytest.fixture
def new_page(browser: Browser) -> Iterator[Callable[[str], Page]]:
    """Return a function that opens an address in a window of its own and waits for the first elements."""
    with contextlib.ExitStack() as windows:
        yield lambda url: look_at(windows.enter_context(contextlib.closing(new_context(browser))), url)


@pytest.fixture
def shot(page: Page) -> Callable[[str], Path]:
    """Return a function that photographs the shared page into ``tests/e2e/shots``; see :func:`photograph`."""
    return lambda name: photograph(page, name)


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
