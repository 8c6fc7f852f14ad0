"""The guide's tutorial, done by hand in a real Chromium: from an empty table to a controller, with the guide's figures.

The pictures are those of docs/guide.md; ``make screenshot`` copies them there.
"""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import FloatRect, Page, expect

from fuzzy.check import check
from fuzzy.formats import load
from tests.e2e.harness import ROOT, Workbench
from tests.e2e.panels import choose, choose_tab, column, field, fold, photograph, press, until

pytestmark = pytest.mark.usefixtures("nothing_went_wrong")

GUIDE = (ROOT / "docs" / "guide.md").read_text(encoding="utf-8")
DESIGN: FloatRect = {"x": 0, "y": 28, "width": 384, "height": 540}
RESPONSE: FloatRect = {"x": 1216, "y": 464, "width": 384, "height": 436}
STUDY_MS = 180_000
"""100 arms take seconds on an idle machine."""


def figures(page: Page, overshoot: str, settling: str) -> None:
    """Wait until the metrics show what the guide says at this step."""
    expected = {"overshoot": overshoot, "settling_time": settling}
    until(lambda: column(page, "now"), lambda now: expected.items() <= now.items(), f"{expected}")
    assert f"{overshoot} % overshoot, {settling} s settling time" in GUIDE, "the guide tells other figures"


def paint(page: Page, brush: int, cell: str) -> None:
    page.locator(f"#brush{brush}").click()
    expect(page.locator(f"#brush{brush}")).to_have_css("outline-style", "solid")
    page.locator(f"#cell{cell}").click()
    expect(page.locator(f"#cell{cell}")).to_have_text(page.locator(f"#brush{brush}").inner_text())


def test_a_working_table_from_an_empty_one(page: Page, workbench: Workbench) -> None:
    choose_tab(page, "Metrics")
    choose_tab(page, "Files")
    press(page, "5 × 5")
    expect(page.get_by_text("not saved")).to_be_visible()
    choose_tab(page, "Rules")
    expect(page.locator('[id^="cell"]')).to_have_count(25)
    figures(page, "≈ 0", "0.524")
    photograph(page, "guide-empty", DESIGN)

    for number in range(5):  # the middle column: push towards the target
        paint(page, number, f"{number}-2")
    figures(page, "1.13", "0.448")
    photograph(page, "guide-column", DESIGN)
    choose_tab(page, "Why")
    expect(page.get_by_text("e is PS and de is Z → PS").last).to_be_visible()
    expect(page.get_by_text("Tried: with Z it overshoots by 0 %, settling 0.523 s.")).to_be_visible()
    choose_tab(page, "Metrics")

    for number in (0, 1, 3, 4):  # the middle row: brake
        paint(page, number, f"2-{number}")
    figures(page, "0", "0.585")

    press(page, "diagonal")
    expect(page.get_by_text("no rule for")).to_have_count(0)
    figures(page, "0", "0.592")
    photograph(page, "guide-table", DESIGN)

    choose_tab(page, "Membership")
    page.get_by_role("button", name=re.compile("^(● )?e$")).locator("visible=true").first.click()
    press(page, "symmetric")
    press(page, "PS")
    peak = field(page, "a · b · c").nth(1)
    expect(peak).to_have_value("0.5")
    peak.fill("0.2")
    peak.press("Enter")
    figures(page, "0", "0.485")
    photograph(page, "guide-membership", {**DESIGN, "height": 480})
    photograph(page, "guide-metrics", RESPONSE)
    press(page, "● symmetric")

    frequency = field(page, "ωn [rad/s]").first
    frequency.fill("217")
    frequency.press("Enter")
    fold(page, "Robustness")
    press(page, "1000")
    press(page, "Study robustness")
    expect(page.get_by_text("% done")).to_be_visible()
    press(page, "Cancel the study")
    press(page, "50")
    press(page, "Study robustness")
    found = page.locator("#robust-overshoot-law-50")
    expect(found).to_be_visible(timeout=STUDY_MS)
    values = {who: page.locator(f"#robust-overshoot-{who}-50").inner_text() for who in ("law", "pid")}
    assert f"{values['law']} % at the median, PID {values['pid']} %" in GUIDE
    found.scroll_into_view_if_needed()
    photograph(page, "guide-robustness", RESPONSE)
    fold(page, "Robustness")
    frequency.fill("12")
    frequency.press("Enter")
    figures(page, "0", "0.485")

    choose_tab(page, "Files")
    field(page, "new name").fill("mine5")
    field(page, "new name").press("Tab")
    press(page, "Save under the new name")
    expect(page.get_by_text("Saved mine5.yaml.")).to_be_visible()
    assert check(load(workbench.folder / "mine5.yaml")) == []
    choose(page, "open", "diagonal.yaml")
    choose_tab(page, "Rules")
    expect(page.locator('[id^="cell"]')).to_have_count(49)
