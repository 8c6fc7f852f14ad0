"""What a hand does in the panels, and what to wait for."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import FloatRect, Locator, Page, expect

from tests.e2e.harness import LOAD_TIMEOUT_MS, SCENE_PAUSE_MS, settle

ANSWER_MS = 20_000
"""How long a busy machine may take for what takes a tenth of a second."""

Metrics = dict[str, str]


SHOTS = Path(__file__).parent / "shots"


def photograph(page: Page, name: str, part: FloatRect | None = None) -> Path:
    """Photograph a page, or a part of it, into ``tests/e2e/shots`` and return the picture's path."""
    SHOTS.mkdir(exist_ok=True)
    path = SHOTS / f"{name}.png"
    page.evaluate("window.scenePause = 0; window.__viserMutable.requestRender()")
    settle(page)
    page.screenshot(path=path, timeout=LOAD_TIMEOUT_MS, clip=part)
    page.evaluate("pause => window.scenePause = pause", SCENE_PAUSE_MS)
    return path


def press(page: Page, name: str) -> None:
    """Click the first button of a name that can be seen."""
    page.get_by_role("button", name=name, exact=True).locator("visible=true").first.click()


def field(page: Page, label: str) -> Locator:
    """Return the field of text or the fields of numbers beside a label; viser names only the first of several."""
    row = f"xpath=//label[normalize-space()='{label}']/ancestor::div[.//input][1]//input"
    return page.locator(row).locator("visible=true")


def fold(page: Page, title: str) -> None:
    """Open or close a folder of the panel Run, or of Metrics."""
    page.get_by_text(title, exact=True).first.click()


def choose_tab(page: Page, name: str) -> None:
    tab = page.get_by_role("tab", name=name, exact=True)
    tab.click()
    expect(tab).to_have_attribute("aria-selected", "true")


def column(page: Page, which: str) -> Metrics:
    """Return what a column of the metrics' table shows: now, before or PID."""
    script = """which => Object.fromEntries(
        [...document.querySelectorAll(`td[id$="-${which}"]`)].map(cell => [cell.id.split("-")[0], cell.textContent]))"""
    found = page.evaluate(script, which)
    assert found, "no metrics in the page"
    return found


def changed(page: Page, before: Metrics) -> Metrics:
    """Wait until other metrics are shown, and return them."""
    return until(lambda: column(page, "now"), lambda now: now != before, "other metrics")


def restored(page: Page, expected: Metrics) -> None:
    """Wait until the metrics are ``expected`` again."""
    until(lambda: column(page, "now"), lambda now: now == expected, f"the metrics {expected}")


def until(look: Callable[[], Metrics], holds: Callable[[Metrics], bool], what: str) -> Metrics:
    deadline = time.monotonic() + ANSWER_MS / 1000
    while True:
        found = look()
        if holds(found):
            return found
        if time.monotonic() > deadline:
            pytest.fail(f"waited for {what}, found {found}")
        time.sleep(0.03)


def simulated_time(page: Page) -> float:
    """Return the time that the Run panel shows."""
    text = page.get_by_text(re.compile(r"t = \d+\.\d+ s")).first.inner_text()
    found = re.search(r"t = (\d+\.\d+) s", text)
    assert found, text
    return float(found[1])


def wait_for_motion(page: Page) -> None:
    start = simulated_time(page)
    until(lambda: {"t": f"{simulated_time(page)}"}, lambda t: float(t["t"]) != start, "the arm to move")


def put_arm_at(page: Page, seconds: str) -> None:
    """Show the run at a time, standing still."""
    field = page.get_by_role("textbox").and_(page.locator("input[inputmode=decimal]"))
    beside = page.get_by_role("slider").locator("xpath=ancestor::div[.//input[@inputmode='decimal']][1]").locator(field)

    def typed() -> Metrics:
        # While the arm moves, the field is rewritten thirty times a second: the first typing may only stop it.
        # The arm that moves passes this time, too.
        if (
            not page.get_by_text(re.compile(r"replay of .* t = ")).first.is_visible()
            or f"{simulated_time(page):g}" != f"{float(seconds):g}"
        ):
            beside.first.fill(seconds)
            beside.first.press("Enter")
            settle(page, 10)
            return {"t": ""}
        return {"t": f"{simulated_time(page):g}"}

    until(typed, lambda t: t["t"] == f"{float(seconds):g}", f"t = {seconds} s")
    beside.first.evaluate("field => field.blur()")


def play_live(page: Page) -> None:
    choose(page, "source", "live simulation")
    start = simulated_time(page)
    page.get_by_role("button", name="play / pause").click()
    until(lambda: {"t": f"{simulated_time(page)}"}, lambda t: float(t["t"]) != start, "the arm to move")


def choose(page: Page, label: str, option: str) -> None:
    """Choose an option of a dropdown."""
    field = page.get_by_role("combobox", name=label, exact=True)
    field.click()
    page.get_by_role("option", name=option, exact=True).locator("visible=true").click()
    expect(field).to_have_value(option)
