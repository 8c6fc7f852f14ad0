"""Design › Rules without a browser: slices, lists, findings and fills, through the widgets."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Iterator

import msgspec
import numpy as np
import pytest
import viser
from viser import _messages

import fuzzy
from app import guard
from app.state import AppState, DesignChanged, Opened, Selected
from fuzzy import edits
from fuzzy.edits import Grid
from fuzzy.formats import save
from fuzzy.language import format_rule, parse_rule
from fuzzy.rules import all_rules
from fuzzy.shapes import Singleton, Triangle
from fuzzy.system import FuzzySystem, Input, Is, RuleBase, Term
from tests.app.test_views import DIAGONAL, PILTAN, STAMP, Screen, finished, frame_of, simulated, strengths

LISTED = edits.dissolve_table(PILTAN)
RULE = "if e is NB or de is not FR then T is LL with 0.5"


@pytest.fixture(scope="module")
def one_screen(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Screen]:
    folder = tmp_path_factory.mktemp("rules")
    save(DIAGONAL, folder / "mine.yaml")
    server = guard.start_server(port=0)
    yield Screen(server, folder, DIAGONAL)
    server.stop()


@pytest.fixture
def screen(one_screen: Screen) -> Screen:
    one_screen.open(DIAGONAL)
    one_screen.dispatch(DesignChanged({"grid": None, "rule": None, "rule_text": None, "page": 0, "gains": None}))
    return one_screen


def three_inputs() -> FuzzySystem:
    third = Input("x", 0.0, 1.0, (Term("low", Triangle(-1, 0, 1)), Term("high", Triangle(0, 1, 2))))
    system = msgspec.structs.replace(DIAGONAL, inputs=(*DIAGONAL.inputs, third), rules=RuleBase())
    rules = (
        "if e is NB and de is FL and x is low then T is LL with 0.5",
        "if e is NB and de is FL and x is high then T is LR",
    )
    return msgspec.structs.replace(system, rules=RuleBase(None, tuple(parse_rule(text, system) for text in rules)))


def has_no_error(state: AppState) -> bool:
    return state.notice is None or not state.notice.is_error


def style(screen: Screen) -> str:
    """Return the style sheets that the panel now has."""
    return "".join(
        handle.content
        for handle in (
            screen.view("RulesView")._glow,
            screen.view("RuleListView")._glow,
            screen.view("RulesView")._table,
        )
    )


def test_a_list_is_painted_as_a_grid_and_becomes_a_table(screen: Screen) -> None:
    screen.open(LISTED)
    screen.send(screen.find("brush LL"), True)
    state = screen.send(screen.find("Z, Z"), True)
    assert edits.grid_cells(state.document, Grid("e", "de", "T"))[3][3] == "LL"
    assert len(state.document.rules.list) == 49
    state = screen.send(screen.view("RuleListView")._form, "turn the list into a table")
    assert edits.rule_table(state.document).cells[3][3] == "LL"
    assert state.document.rules.list == ()
    state = screen.send(screen.view("RuleListView")._form, "turn the table into a list")
    assert state.document.rules.table is None
    assert len(state.document.rules.list) == 49
    assert has_no_error(screen.send(screen.view("RuleListView")._form, "turn the list into a table"))


def test_rules_are_written_added_weighed_replaced_and_deleted(screen: Screen) -> None:
    panel = screen.view("RuleListView")
    screen.send(panel._text, "if e is NB or de is XX then")
    assert "column 21" in panel._error.content
    assert "unknown term of &#x27;de&#x27;: &#x27;XX&#x27;" in panel._error.content
    refused = screen.send(panel._actions, "add")
    assert refused.document is screen.store.state.document
    assert refused.notice is not None
    assert refused.notice.is_error
    assert panel._text.value == "if e is NB or de is XX then", "what was written stays"

    screen.send(panel._text, RULE)
    state = screen.send(panel._actions, "add")
    assert [format_rule(rule) for rule in state.document.rules.list] == [RULE]
    assert (state.design.rule, panel._weight.visible, panel._weight.value) == (0, True, 0.5)
    state = screen.send(panel._weight, 0.25)
    assert state.document.rules.list[0].weight == 0.25
    screen.send(panel._text, "if e is Z then T is Z")
    state = screen.send(panel._actions, "replace")
    assert format_rule(state.document.rules.list[0]) == "if e is Z then T is Z"
    state = screen.send(panel._actions, "delete")
    assert state.document == DIAGONAL
    nothing = screen.send(panel._actions, "delete")
    assert nothing.notice is not None
    assert nothing.notice.text.startswith("Refused: no rule is chosen to delete")


@pytest.mark.parametrize("text", ["x" * 5000, "\ud800"])
def test_a_text_that_cannot_be_one_is_refused(screen: Screen, text: object) -> None:
    state = screen.send(screen.view("RuleListView")._text, text)
    assert state.design.rule_text is None
    assert not has_no_error(state)
    assert screen.view("RuleListView")._text.value == ""


def test_a_long_list_is_turned_page_by_page(screen: Screen) -> None:
    screen.open(LISTED)
    panel = screen.view("RuleListView")
    assert "1 to 8 of 49" in panel._head.content
    for _ in range(9):
        screen.send(panel._pages, "›")
    assert "49 to 49 of 49" in panel._head.content
    state = screen.send(screen.find("rule 1 of the page"), True)
    assert state.design.rule == 48
    assert panel._text.value == format_rule(LISTED.rules.list[48])
    assert screen.send(screen.find("rule 2 of the page"), True).design.rule == 48, "there is no such rule"
    screen.send(panel._pages, "‹")
    assert "41 to 48 of 49" in panel._head.content


def test_a_third_input_is_a_slice(screen: Screen) -> None:
    state = screen.open(three_inputs())
    assert state.design.grid == Grid("e", "de", "T", (Is("x", "low"),))
    state = screen.send(screen.find("x is"), "high")
    assert edits.grid_cells(state.document, state.design.grid or Grid("", "", ""))[0][0] == "LR"
    screen.send(screen.find("brush SL"), True)
    state = screen.send(screen.find("NB, FL"), True)
    assert format_rule(state.document.rules.list[1]) == "if e is NB and de is FL and x is high then T is SL"
    state = screen.send(screen.find("rows"), "x")
    assert state.design.grid == Grid("x", "de", "T")
    state = screen.send(screen.find("columns"), "x")
    assert state.design.grid == Grid("de", "x", "T"), "the two change places"
    for label, value in (("rows", "nothing"), ("e is", "XX"), ("output", "e")):
        assert not has_no_error(screen.send(screen.find(label), value))
    screen.open(DIAGONAL)
    assert not screen.view("AxesView")._place.visible


def test_the_table_is_filled_from_gains(screen: Screen) -> None:
    gains = screen.find("Kp · Kd")
    assert gains.value == pytest.approx((85.0, 85 / 6))
    screen.open(edits.clear_table(DIAGONAL))
    assert screen.send(screen.find("pattern"), "PD").document == DIAGONAL
    screen.send(gains, (0.0, 100.0))
    state = screen.send(screen.find("pattern"), "PD")
    assert set(edits.rule_table(state.document).cells) == {("LL", "LL", "LL", "Z", "LR", "LR", "LR")}
    for value in ((float("nan"), 1.0), (1.0, 1e300), (1.0,)):
        refused = screen.send(gains, value)
        assert refused.design.gains == (0.0, 100.0)
        assert not has_no_error(refused)
        assert gains.value == (0.0, 100.0)


def test_a_finding_selects_its_culprit(screen: Screen) -> None:
    rule = parse_rule("if e is NB and de is FL then T is LR", DIAGONAL)
    document = edits.set_cell(edits.add_rule(DIAGONAL, rule), 3, 3, "LR")
    document = edits.add_term(document, "T", "spare", Triangle(0.0, 1.0, 2.0))
    screen.open(document)
    state = screen.dispatch(finished(document))
    found = {finding.path: n for n, finding in enumerate(state.findings)}

    def press(path: str) -> AppState:
        return screen.send(screen.find(f"finding {found[path] + 1}"), True)

    state = press("rules.table.cells.Z[3]")
    assert (3, 3) in state.design.marked
    screen.show(frame_of(simulated(DIAGONAL), 60, None))
    assert "#cell3-3{outline" in style(screen)
    assert press("rules.list[0]").design.rule == 0
    state = press("outputs.T.terms.spare")
    assert (state.variable, state.term) == ("T", "spare")
    assert screen.send(screen.find("finding 24"), True) is state, "there are not so many"


def test_rules_of_the_list_glow_and_silent_cells_are_hatched(screen: Screen) -> None:
    screen.open(LISTED)
    event = finished(LISTED)
    screen.dispatch(event)
    run = event.result.run
    strength = strengths(LISTED, run, 60)
    assert strength is not None
    screen.show(frame_of(run, 60, strength))
    firing = np.flatnonzero(strength.round(2) > 0)
    page = int(firing[0]) // 8
    screen.dispatch(DesignChanged({"page": page}))
    screen.show(frame_of(run, 60, strength))
    assert f"#rule{firing[0]}{{background:linear-gradient" in style(screen)
    assert f"#cell{firing[0] // 7}-{firing[0] % 7}{{box-shadow" in style(screen)
    silent = np.flatnonzero(run.activity.max(axis=0) <= 0.0)
    assert f"#cell{silent[0] // 7}-{silent[0] % 7}{{background-image" in style(screen)


@pytest.mark.parametrize("count", [1, 8, 9, 49, 256])
def test_brushes_stand_in_the_order_of_their_values_in_lines_that_can_be_read(screen: Screen, count: int) -> None:
    values = np.random.default_rng(count).permutation(np.linspace(-80.0, 80.0, count))
    terms = tuple(Term(f"c{n}", Singleton(float(value))) for n, value in enumerate(values))
    output = msgspec.structs.replace(DIAGONAL.outputs[0], terms=terms)
    screen.open(msgspec.structs.replace(DIAGONAL, outputs=(output,), rules=RuleBase()))
    view = screen.view("RulesView")
    brushes = re.findall(r'<label for="([^"]+)" id="brush(\d+)".*?>([^<]+)</label>', view._brush.content)
    buttons = {button._impl.uuid: button.label for button in screen.handles().values()}
    assert [name for *_, name in brushes] == [*(f"c{n}" for n in np.argsort(values)), "none"]
    for target, number, name in brushes:
        assert buttons[target] == ("brush no rule" if name == "none" else f"brush {name}")
        assert int(number) == (count if name == "none" else int(name[1:]))
    columns = re.search(r"grid-template-columns:repeat\((\d+),", view._brush.content)
    assert columns is not None
    assert int(columns[1]) <= 9, "narrower than the panel can show"
    assert screen.send(screen.find("brush c0"), True).brush == "c0"
    assert "#brush0{outline" in view._chosen_brush.content


def test_buttons_fit_the_table_when_another_is_opened_before_they_are_all_there(screen: Screen) -> None:
    large = edits.space_terms(edits.space_terms(DIAGONAL, "e", 20), "de", 20)
    labels = {handle.label for handle in screen.handles().values() if isinstance(handle, viser.GuiButtonHandle)}

    async def change_mind() -> None:
        screen.store.dispatch(Opened(large, "large.yaml", STAMP, ()))
        view = screen.view("RulesView")
        while len(view._cell_buttons.ids) < 60:  # noqa: ASYNC110
            await asyncio.sleep(0)
        view._paint(0)
        assert screen.store.state.document is large, "the page still shows the other table"
        screen.store.dispatch(Opened(DIAGONAL, "mine.yaml", STAMP, ()))

    screen.in_turns(change_mind)
    now = {handle.label for handle in screen.handles().values() if isinstance(handle, viser.GuiButtonHandle)}
    assert now == labels
    assert len(screen.view("RulesView")._cell_buttons.ids) == 49
    screen.dispatch(Selected({"brush": "LR"}))
    assert screen.send(screen.find("NB, FL"), True).document != DIAGONAL


def test_a_table_that_is_too_large_is_not_drawn_and_nothing_breaks(screen: Screen) -> None:
    large = edits.space_terms(edits.space_terms(DIAGONAL, "e", 64), "de", 64)
    screen.sent.clear()
    state = screen.open(large)
    assert len(all_rules(state.document)) == 4096
    assert "too many terms" in screen.view("RulesView")._table.content
    assert sum(isinstance(message, _messages.GuiButtonMessage) for message in screen.sent) == 0
    screen.dispatch(Selected({"brush": "LL"}))
    assert screen.send(screen.view("RulesView")._fill, "clear").document is state.document
    screen.dispatch(DesignChanged({"page": 3}))
    assert fuzzy.check(state.document) is not None
