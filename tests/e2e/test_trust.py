"""In a real Chromium: hostile names are text, a killed workbench gives its work back, nobody is overwritten unasked."""

from __future__ import annotations

import os
import shutil
import urllib.parse
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Page, expect

from fuzzy import edits
from fuzzy.formats import load, save
from fuzzy.system import RuleTable
from tests.e2e.harness import LOAD_TIMEOUT_MS, ROOT, Workbench, running_workbench
from tests.e2e.panels import photograph

ANSWER_MS = 30_000
IMAGE = '<img src=x onerror="window.taken=1">'
SCRIPT = "</style><script>window.taken=1</script>"
TABS = ("Membership", "Inference", "Files", "Metrics", "Why", "Plots", "Rules")


def hostile_folder(place: Path) -> Path:
    """Return a copy of the rule bases in which the names of the opened one would be markup."""
    folder = Path(shutil.copytree(ROOT / "rulebases", place / "rulebases"))
    system = load(folder / "diagonal.yaml")
    for variable, term in (("e", "NB"), ("de", "Z"), ("T", "LL")):
        system = edits.rename_term(system, variable, term, IMAGE)
        system = edits.rename_variable(system, variable, f"{variable}{SCRIPT}")
    save(edits.set_notes(edits.set_name(system, IMAGE), SCRIPT), folder / "diagonal.yaml")
    return folder


def table(workbench: Workbench) -> RuleTable:
    found = load(workbench.folder / "diagonal.yaml").rules.table
    assert found is not None
    return found


def journals() -> list[Path]:
    place = Path(os.environ["XDG_STATE_HOME"]) / "fuzzy-workbench" / "journals"
    return list(place.glob("[!.]*.journal"))


def test_hostile_names_and_a_killed_workbench(tmp_path: Path, new_page: Callable[[str], Page]) -> None:
    folder = hostile_folder(tmp_path)
    others = set(journals())  # of sessions that other tests killed
    with running_workbench(folder) as first:
        page = new_page(first.url)
        said: list[str] = []
        page.on("console", lambda message: said.append(message.text))
        page.set_default_timeout(ANSWER_MS)
        for name in TABS:
            page.get_by_role("tab", name=name, exact=True).click()
            expect(page.get_by_role("tab", name=name, exact=True)).to_have_attribute("aria-selected", "true")
        cell = page.locator("#cell0-0")
        expect(cell).to_have_text(IMAGE)
        assert page.evaluate("window.taken") is None
        assert page.locator("img[src=x]").count() == 0

        # Escaping is the first line; were it missing somewhere, the page would still run nothing.
        page.evaluate(
            """html => {
                const place = document.createElement("div");
                place.innerHTML = html;
                document.body.append(place);
            }""",
            IMAGE,
        )
        page.wait_for_function("() => document.querySelector('img[src=x]').complete")
        assert page.evaluate("window.taken") is None
        assert any("Content Security Policy" in text for text in said)

        page.locator("#brush6").click()
        term = page.locator("#brush6").inner_text()
        cell.click()
        expect(cell).to_have_text(term)
        page.wait_for_timeout(1000)
        assert len(set(journals()) - others) == 1
        first.process.kill()
        first.process.wait()
    assert table(first).cells[0][0] == IMAGE

    # The page tries again by itself until there is a workbench under its address.
    with running_workbench(folder, port=urllib.parse.urlsplit(first.url).port) as second:
        expect(page.get_by_text("Unsaved work was found")).to_be_visible(timeout=LOAD_TIMEOUT_MS)
        page.get_by_role("button", name="Recover it").click()
        expect(page.get_by_text("Unsaved work was found")).to_have_count(0)
        expect(cell).to_have_text(term)
        page.wait_for_function("window.fuzzyWorkbench")
        photograph(page, "reconnected")
        page.keyboard.press("Control+z")
        expect(cell).to_have_text(IMAGE)
        page.keyboard.press("Control+Shift+Z")
        expect(cell).to_have_text(term)

        theirs = edits.set_notes(load(folder / "diagonal.yaml"), "theirs")
        save(theirs, folder / "diagonal.yaml")
        expect(page.get_by_text("The file has changed on disk")).to_be_visible()
        page.get_by_role("button", name="Save mine over it").click()
        expect(page.get_by_text("The file has changed on disk")).to_have_count(0)
        assert table(second).cells[0][0] == term
        assert "theirs" in (folder / "diagonal.yaml.bak").read_text(encoding="utf-8")
        assert "Traceback" not in second.log.read_text(errors="replace")
    assert set(journals()) <= others
