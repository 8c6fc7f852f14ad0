"""The whole workbench in a real Chromium: what a hand does in the panels, the arm answers.

One workbench and one page serve these tests and others. Every test starts from what it finds and compares with that.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from fuzzy.formats import load
from fuzzy.system import RuleTable
from tests.e2e.harness import Workbench, settle
from tests.e2e.panels import (
    ANSWER_MS,
    changed,
    choose,
    choose_tab,
    column,
    play_live,
    put_arm_at,
    restored,
    simulated_time,
    until,
    wait_for_motion,
)

pytestmark = pytest.mark.usefixtures("nothing_went_wrong")


def table_on_disk(workbench: Workbench) -> RuleTable:
    table = load(workbench.folder / "diagonal.yaml").rules.table
    assert table is not None
    return table


def brush_other_than(page: Page, cell: Locator) -> str:
    """Choose a brush whose term a cell does not show, and return the term."""
    present = cell.inner_text()
    number = 6 if present != "LR" else 5
    brush = page.locator(f"#brush{number}")
    brush.click()
    expect(brush).to_have_css("outline-style", "solid")
    return brush.inner_text()


def test_the_first_page(page: Page, shot: Callable[[str], Path]) -> None:
    choose_tab(page, "Plots")
    expect(page.locator('[id^="cell"]')).to_have_count(49)
    expect(page.locator("#cell0-0")).to_have_text("LL")
    wait_for_motion(page)
    put_arm_at(page, "0.16")
    page.get_by_role("button", name="play / pause").scroll_into_view_if_needed()
    picture = shot("workbench")
    assert picture.stat().st_size > 50_000
    play_live(page)


def test_painting_a_cell_changes_the_metrics_and_undo_restores_them(page: Page, shot: Callable[[str], Path]) -> None:
    choose_tab(page, "Rules")
    choose_tab(page, "Metrics")
    first = column(page, "now")
    cell = page.locator("#cell3-3")
    was = cell.inner_text()
    term = brush_other_than(page, cell)
    cell.click()
    expect(cell).to_have_text(term)
    painted = changed(page, first)
    assert column(page, "before") == first
    shot("rules")

    page.keyboard.press("Control+z")
    expect(cell).to_have_text(was)
    restored(page, first)
    page.keyboard.press("Control+Shift+Z")
    expect(cell).to_have_text(term)
    restored(page, painted)
    page.keyboard.press("Control+z")
    restored(page, first)


def test_saving_writes_the_new_term(page: Page, workbench: Workbench, shot: Callable[[str], Path]) -> None:
    choose_tab(page, "Rules")
    cell = page.locator("#cell1-6")
    before = table_on_disk(workbench)
    term = brush_other_than(page, cell)
    assert before.cells[1][6] != term
    cell.click()
    expect(cell).to_have_text(term)
    choose_tab(page, "Files")
    expect(page.get_by_text("not saved")).to_be_visible()
    shot("files")
    page.keyboard.press("Control+s")
    expect(page.get_by_text("Saved diagonal.yaml.")).to_be_visible()
    expect(page.get_by_text("not saved")).to_have_count(0)
    after = table_on_disk(workbench)
    assert after.cells[1][6] == term
    assert after.cells[1][:6] == before.cells[1][:6]
    assert (*after.cells[:1], *after.cells[2:]) == (*before.cells[:1], *before.cells[2:])


def test_a_download_comes_back_as_an_upload_and_the_history_leads_anywhere(
    page: Page, tmp_path: Path, shot: Callable[[str], Path]
) -> None:
    choose_tab(page, "Rules")
    brush_other_than(page, page.locator("#cell0-6"))
    page.locator("#cell0-6").click()
    choose_tab(page, "Files")
    with page.expect_download() as download:
        page.get_by_role("button", name=".fis", exact=True).click()
    path = tmp_path / download.value.suggested_filename
    download.value.save_as(path)
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Upload a file").click()
    chooser.value.set_files(path)
    take = page.get_by_role("button", name="replace the document")
    expect(take).to_be_visible(timeout=ANSWER_MS)
    shot("upload")
    take.click()
    expect(page.locator("#step0")).to_have_text(f"import {path.name}")
    expect(take).to_have_count(0)
    page.locator("#step2").click()
    expect(page.locator("#step1")).to_have_css("opacity", "1")
    expect(page.get_by_text("2 steps back.")).to_be_visible()


def test_dragging_a_point_changes_the_metrics_while_the_arm_moves(page: Page, shot: Callable[[str], Path]) -> None:
    choose_tab(page, "Membership")
    choose_tab(page, "Metrics")
    first = column(page, "now")
    thumb = page.locator(".multi-slider-thumb").nth(4)
    box = thumb.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    for step in range(1, 9):
        page.mouse.move(x - 3 * step, y)
    during = changed(page, first)
    wait_for_motion(page)
    shot("membership")
    page.mouse.up()
    moved = thumb.bounding_box()
    assert moved is not None
    assert moved["x"] == pytest.approx(box["x"] - 24, abs=3), "the thumb stays where the hand left it"
    assert during != first
    page.keyboard.press("Control+z")
    restored(page, first)
    expect(page.get_by_text(re.compile("Undone: e: drag"))).to_be_visible()


def test_the_chart_of_another_variable_has_its_own_axis_and_its_thumbs_stand_under_its_peaks(page: Page) -> None:
    choose_tab(page, "Membership")
    page.get_by_role("button", name="T", exact=True).locator("visible=true").click()
    places = """values => {
        const charts = Object.values(window.__viserTestpoints?.uplots ?? {}).map(entry => entry.chart);
        const chart = charts.find(chart => chart.scales.x.min < -100 && chart.over.getBoundingClientRect().width > 0);
        if (!chart) return [];
        const left = chart.over.getBoundingClientRect().left;
        return values.map(value => left + chart.valToPos(value, "x"));
    }"""
    peaks = [-85 + 170 / 6 * n for n in range(7)]
    deadline = time.monotonic() + ANSWER_MS / 1000
    while len(expected := page.evaluate(places, peaks)) < len(peaks):
        assert time.monotonic() < deadline, "no chart shows the range of T"
        time.sleep(0.05)
    boxes = [thumb.bounding_box() for thumb in page.locator(".multi-slider-thumb").all()]
    assert [box["x"] + box["width"] / 2 for box in boxes if box] == pytest.approx(expected, abs=3)


def test_the_live_value_is_a_line_in_the_chart_and_a_new_term_keeps_the_rules(
    page: Page, shot: Callable[[str], Path]
) -> None:
    choose_tab(page, "Membership")
    page.get_by_role("button", name="de", exact=True).locator("visible=true").click()
    expect(page.locator("#now")).to_be_visible()
    places = """() => {
        const line = document.getElementById("now").getBoundingClientRect();
        const charts = Object.values(window.__viserTestpoints?.uplots ?? {}).map(entry => entry.chart);
        const boxes = charts.map(chart => chart.over.getBoundingClientRect());
        const x = line.left + 1, y = line.top + 20;
        const found = boxes.find(b => b.left - 3 <= x && x <= b.right + 3 && b.top - 3 <= y && y <= b.bottom + 3);
        return [[line.top, line.bottom], found && [found.top, found.bottom]];
    }"""
    deadline = time.monotonic() + ANSWER_MS / 1000
    while (found := page.evaluate(places))[1] is None:
        assert time.monotonic() < deadline, "the line is in no chart"
        time.sleep(0.05)
    line, chart = found
    assert chart == pytest.approx(line, abs=3)

    page.get_by_role("button", name="add", exact=True).locator("visible=true").click()
    expect(page.get_by_text("de: add Z 2 · Ctrl+Z")).to_be_visible()
    shot("terms")
    choose_tab(page, "Rules")
    expect(page.locator('[id^="cell"]')).to_have_count(56)
    page.keyboard.press("Control+z")
    expect(page.locator('[id^="cell"]')).to_have_count(49)


def test_a_rule_is_written_as_text_and_a_finding_frames_its_cell(page: Page, shot: Callable[[str], Path]) -> None:
    choose_tab(page, "Rules")
    text = page.locator("textarea").locator("visible=true").first
    text.fill("if e is NB or de is XX then T is LL")
    expect(page.get_by_text("column 21")).to_be_visible()
    text.fill("if e is NB or de is FR then T is LL with 0.2")
    expect(page.get_by_text("column 21")).to_have_count(0)
    page.get_by_role("button", name="add", exact=True).locator("visible=true").click()
    expect(page.locator("#rule0")).to_have_text(re.compile("if e is NB or de is FR then T is LL with 0.2"))
    page.get_by_role("button", name="clear", exact=True).click()
    page.locator(".fw-r", has_text="no rule for 'e is NM'").click()
    expect(page.locator("#cell1-0")).to_have_css("outline-color", "rgb(255, 215, 94)")
    shot("findings")
    for _ in range(2):
        page.keyboard.press("Control+z")
    expect(page.locator("#rule0")).to_have_count(0)
    expect(page.locator("#cell0-0")).to_have_text("LL")


def test_another_composition_and_another_resolution_change_the_metrics(page: Page, shot: Callable[[str], Path]) -> None:
    choose_tab(page, "Inference")
    choose_tab(page, "Metrics")
    first = column(page, "now")
    choose(page, "composition", "Sum-Product")
    composed = changed(page, first)
    expect(page.get_by_role("combobox", name="implication", exact=True)).to_have_value("product")
    expect(page.get_by_role("combobox", name="aggregation", exact=True)).to_have_value("sum")
    shot("inference")
    choose(page, "resolution", "13 levels, with both ends")
    changed(page, composed)
    choose_tab(page, "Inference")  # keys belong to the text field of a dropdown while it has the focus
    for expected in (composed, first):
        page.keyboard.press("Control+z")
        restored(page, expected)
    expect(page.get_by_role("combobox", name="resolution", exact=True)).to_have_value("exact")


def test_pause_stands_still_scrubbing_replays_and_play_goes_on(page: Page) -> None:
    wait_for_motion(page)
    button = page.get_by_role("button", name="play / pause")
    button.click()
    expect(page.get_by_text(re.compile("paused"))).to_be_visible()
    settle(page)
    still = simulated_time(page)
    settle(page, 20)
    assert simulated_time(page) == still
    button.click()
    wait_for_motion(page)

    thumb = page.get_by_role("slider").first
    track = thumb.locator("xpath=..").bounding_box()
    assert track is not None
    page.mouse.click(track["x"] + track["width"] / 2, track["y"] + track["height"] / 2)
    expect(page.get_by_text(re.compile(r"replay of .* t = "))).to_be_visible()
    middle = until(lambda: {"t": f"{simulated_time(page)}"}, lambda t: 1.3 < float(t["t"]) < 1.7, "the middle")
    settle(page, 10)
    assert simulated_time(page) == float(middle["t"])
    expect(thumb).to_have_attribute("aria-valuenow", re.compile(rf"{float(middle['t']):g}"))
    button.click()
    wait_for_motion(page)
    choose(page, "source", "live simulation")
    wait_for_motion(page)


def test_the_metrics_beside_those_before_and_of_pid(page: Page, shot: Callable[[str], Path]) -> None:
    choose_tab(page, "Rules")
    choose_tab(page, "Metrics")
    assert set(column(page, "now")) == set(column(page, "PID"))
    assert column(page, "now") != column(page, "PID")
    choose(page, "controller", "pid · independent PID")
    until(lambda: column(page, "now"), lambda now: now == column(page, "PID"), "PID's own metrics")
    choose(page, "controller", "fuzzy_flc · linearization + rules")
    until(lambda: column(page, "now"), lambda now: now != column(page, "PID"), "the fuzzy controller's metrics")
    shot("metrics")
