"""The panels on the right and the scene in a real Chromium: baselines, why, files, tiles."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.harness import settle
from tests.e2e.panels import choose, choose_tab, column, fold, press, put_arm_at, restored, simulated_time, until

pytestmark = pytest.mark.usefixtures("nothing_went_wrong")


def canvas_middle(page: Page) -> tuple[float, float]:
    """Return the middle of what the panels leave of the scene, where a camera looks."""
    box = page.locator("canvas").first.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def test_a_spoilt_cell_is_named_and_cured_by_a_press(page: Page, shot: Callable[[str], Path]) -> None:
    choose_tab(page, "Rules")
    first = column(page, "now")
    page.locator("#brush6").click()
    page.locator("#cell3-3").click()
    expect(page.locator("#cell3-3")).to_have_text("LR")
    choose_tab(page, "Why")
    expect(page.get_by_text("overshoots by 3.6 %")).to_be_visible()
    expect(page.get_by_text(re.compile("Look at"))).to_contain_text("e is Z and de is Z → LR")
    expect(page.get_by_text("Tried: with Z")).to_be_visible()
    put_arm_at(page, "0.16")
    expect(page.get_by_text(re.compile("At t = 0.16 s s1 has"))).to_be_visible()
    shot("why")
    press(page, "Try it")
    expect(page.locator("#cell3-3")).to_have_text("Z")
    expect(page.get_by_text("s1 does not overshoot.")).to_be_visible()
    choose_tab(page, "Metrics")
    restored(page, first)
    choose(page, "source", "live simulation")
    press(page, "play / pause")


def test_a_baseline_stays_beside_the_run_in_table_and_charts(page: Page, shot: Callable[[str], Path]) -> None:
    choose_tab(page, "Metrics")
    kept = column(page, "now")
    fold(page, "Baselines")
    press(page, "Keep as baseline")
    expect(page.locator("#overshoot-kept1")).to_have_count(1)
    choose(page, "controller", "pid · independent PID")
    now = until(lambda: column(page, "now"), lambda now: now == column(page, "PID"), "PID's own metrics")
    assert column(page, "kept1") == kept != now
    choose_tab(page, "Plots")
    for name in ("error", "forces", "V"):
        press(page, name)
    expect(page.get_by_text("Lyapunov function V of the law")).to_be_visible()
    expect(page.get_by_text("┄ diagonal fuzzy_flc").first).to_be_visible()
    shot("baselines")
    for name in ("● error", "● forces", "● V"):
        press(page, name)
    choose(page, "controller", "fuzzy_flc · linearization + rules")
    choose_tab(page, "Metrics")
    restored(page, kept)
    choose_tab(page, "Rules")
    cell = page.locator("#cell3-3")
    was = cell.inner_text()
    page.locator("#brush6").click()
    cell.click()
    expect(cell).to_have_text("LR")
    press(page, "1")
    expect(cell).to_have_text(was)
    expect(page.get_by_text("rules of baseline")).to_be_visible()
    page.get_by_role("button", name="1", exact=True).locator("visible=true").last.click()
    expect(page.locator("#overshoot-kept1")).to_have_count(0)
    fold(page, "Baselines")


def test_steps_go_to_and_fro_by_ten_milliseconds(page: Page) -> None:
    put_arm_at(page, "0.5")
    for name, expected in [("▸", 0.51), ("▸", 0.52), ("◂", 0.51)]:
        press(page, name)
        until(lambda: {"t": f"{simulated_time(page):g}"}, lambda t, e=expected: t["t"] == f"{e:g}", f"t = {expected}")
    choose(page, "source", "live simulation")
    press(page, "play / pause")


def test_a_click_on_a_tile_of_the_board_paints_it(page: Page, shot: Callable[[str], Path]) -> None:
    choose_tab(page, "Rules")
    page.locator("#brush0").click()
    fold(page, "View")
    press(page, "board")
    settle(page, 10)
    shot("board")
    # The camera looks at the middle of the board.
    page.mouse.click(*canvas_middle(page))
    expect(page.locator("#cell3-3")).to_have_text("LL")
    page.keyboard.press("Control+z")
    expect(page.locator("#cell3-3")).to_have_text("Z")
    press(page, "all")
    fold(page, "View")


def test_a_run_is_downloaded_as_csv_and_as_a_page_that_plays(page: Page, tmp_path: Path) -> None:
    fold(page, "Save")
    with page.expect_download() as waiting:
        press(page, "CSV")
    path = tmp_path / waiting.value.suggested_filename
    waiting.value.save_as(path)
    assert path.name == "diagonal-fuzzy_flc-step.csv"
    rows = np.loadtxt(path, delimiter=",", skiprows=1)
    assert len(rows) == 3001
    with page.expect_download() as waiting:
        press(page, "HTML")
    replay = tmp_path / "replay.html"
    waiting.value.save_as(replay)
    assert replay.stat().st_size > 500_000
    fold(page, "Save")
