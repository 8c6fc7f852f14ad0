"""Several browsers on one workbench, and what belongs to each alone: tabs by key, help, the tour, a narrow window."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.e2e.harness import (
    HIDE_SOFTWARE_RENDERER,
    LOAD_TIMEOUT_MS,
    SELDOM_DRAWN,
    Workbench,
    look_at,
    wait_until_ready,
)
from tests.e2e.panels import ANSWER_MS, choose, choose_tab, column, field, photograph, restored, simulated_time, until

pytestmark = pytest.mark.usefixtures("nothing_went_wrong")


@pytest.fixture(scope="module")
def visitor(workbench: Workbench, page: Page, browser: Browser) -> Iterator[Page]:
    """A second browser, which has never been here."""
    assert page.url
    with contextlib.closing(browser.new_context(viewport={"width": 1366, "height": 768})) as context:
        context.add_init_script(HIDE_SOFTWARE_RENDERER + SELDOM_DRAWN)
        context.set_default_timeout(ANSWER_MS)
        yield look_at(context, workbench.url)


def test_the_first_visit_begins_with_a_tour_that_blocks_nothing(visitor: Page, page: Page) -> None:
    card = visitor.get_by_role("region", name="Tour")
    expect(card).to_contain_text("1 of 5")
    photograph(visitor, "tour")
    expect(page.get_by_role("region", name="Tour")).to_have_count(0)
    canvas, box = visitor.locator("canvas").first.bounding_box(), card.bounding_box()
    assert canvas is not None
    assert box is not None
    assert canvas["x"] <= box["x"] < box["x"] + box["width"] <= canvas["x"] + canvas["width"], "it lies on the scene"

    choose_tab(visitor, "Membership")  # the panels can be used meanwhile
    for step, tab in ((2, "Rules"), (3, "Rules"), (4, "Plots"), (5, "Files")):
        card.get_by_role("button", name="Next").click()
        expect(card).to_contain_text(f"{step} of 5")
        expect(visitor.get_by_role("tab", name=tab, exact=True)).to_have_attribute("aria-selected", "true")
    photograph(visitor, "tour-end")
    card.get_by_role("button", name="Back").click()
    expect(card).to_contain_text("4 of 5")
    card.get_by_role("button", name="Skip").click()
    expect(card).to_have_count(0)
    expect(visitor.locator("#fw-tour-frame")).to_have_count(0)


def test_digits_choose_tabs_in_one_browser_alone(visitor: Page, page: Page) -> None:
    choose_tab(page, "Rules")
    for key, tab in zip(
        "2341567", ("Membership", "Inference", "Files", "Rules", "Plots", "Metrics", "Why"), strict=True
    ):
        visitor.keyboard.press(key)
        expect(visitor.get_by_role("tab", name=tab, exact=True)).to_have_attribute("aria-selected", "true")
    expect(page.get_by_role("tab", name="Rules", exact=True)).to_have_attribute("aria-selected", "true")


def test_help_lists_keys_gestures_and_panels_and_leads_to_the_tour(visitor: Page, page: Page) -> None:
    window = visitor.get_by_role("dialog", name="Help")
    visitor.keyboard.press("?")
    for text in ("Ctrl+S", "Shift + drag the arm", "Membership", "play or pause"):
        expect(window).to_contain_text(text)
    photograph(visitor, "help")
    expect(page.get_by_role("dialog", name="Help")).to_have_count(0)
    window.get_by_role("button", name="Show the tour").click()
    expect(window).to_have_count(0)
    card = visitor.get_by_role("region", name="Tour")
    expect(card).to_contain_text("1 of 5")
    visitor.keyboard.press("Escape")
    expect(card).to_have_count(0)


def test_keys_work_in_a_dropdown_and_in_a_field_too(visitor: Page, page: Page, workbench: Workbench) -> None:
    choose_tab(page, "Metrics")
    first = column(page, "now")
    choose_tab(visitor, "Inference")
    choose(visitor, "composition", "Sum-Product")
    expect(visitor.get_by_role("combobox", name="implication", exact=True)).to_have_value("product")
    visitor.keyboard.press("Control+z")
    expect(visitor.get_by_role("combobox", name="implication", exact=True)).to_have_value("min")
    restored(page, first)

    choose_tab(visitor, "Files")
    title = field(visitor, "title")
    was = title.input_value()
    title.fill("a title")
    visitor.keyboard.press("Control+s")
    expect(visitor.get_by_text("Saved diagonal.yaml.")).to_be_visible()
    assert "name: a title" in (workbench.folder / "diagonal.yaml").read_text(encoding="utf-8")
    title.fill(was)
    visitor.keyboard.press("Control+s")
    expect(visitor.get_by_text("Saved diagonal.yaml.")).to_be_visible()


def test_two_browsers_see_one_document_and_one_arm(visitor: Page, page: Page) -> None:
    other = visitor
    choose_tab(other, "Rules")
    choose_tab(page, "Rules")
    page.locator("#brush6").click()
    page.locator("#cell0-0").click()
    for one in (page, other):
        expect(one.locator("#cell0-0")).to_have_text("LR")
    other.locator("#cell0-1").click()
    for one in (page, other):
        expect(one.locator("#cell0-1")).to_have_text("LR")
    other.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    for one in (page, other):
        expect(one.locator("#cell0-0")).to_have_text("LL")
        expect(one.locator("#cell0-1")).to_have_text("LL")
    before = simulated_time(other)
    until(lambda: {"t": f"{simulated_time(other)}"}, lambda t: float(t["t"]) != before, "the arm to move there too")


def test_the_tour_is_over_at_the_next_visit_and_a_phone_has_the_arm_above_the_panels(visitor: Page) -> None:
    visitor.set_viewport_size({"width": 390, "height": 844})
    visitor.reload(wait_until="domcontentloaded", timeout=LOAD_TIMEOUT_MS)
    wait_until_ready(visitor)
    visitor.wait_for_function("window.fuzzyWorkbench")
    button = visitor.get_by_role("button", name="play / pause")
    expect(button).to_be_visible()
    box = button.bounding_box()
    assert box is not None
    assert box["y"] > 844 / 2
    assert box["x"] < 390 / 2, "the sheet is as wide as the window"
    before = simulated_time(visitor)
    until(lambda: {"t": f"{simulated_time(visitor)}"}, lambda t: float(t["t"]) != before, "the arm to move")
    expect(visitor.get_by_role("region", name="Tour")).to_have_count(0)
    photograph(visitor, "phone")
    button.click()
    expect(visitor.get_by_text("paused")).to_be_visible()
    button.click()
