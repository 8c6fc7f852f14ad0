"""Design › Membership without a browser: terms and variables through the widgets."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

import pytest

from app import guard
from app.state import AppState, DesignChanged, Edit, Selected, Setup, SetupChanged, Undo
from app.views.membership.points import shape_thumbs
from fuzzy import edits, shapes
from fuzzy.formats import save
from fuzzy.rules import all_rules
from fuzzy.shapes import Gaussian, Linear, Singleton, Trapezoid, Triangle
from fuzzy.system import Input, Output
from tests.app.test_views import DIAGONAL, Screen, finished, frame_of, simulated, strengths


@pytest.fixture(scope="module")
def one_screen(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Screen]:
    folder = tmp_path_factory.mktemp("membership")
    save(DIAGONAL, folder / "mine.yaml")
    server = guard.start_server(port=0)
    yield Screen(server, folder, DIAGONAL)
    server.stop()


@pytest.fixture
def screen(one_screen: Screen) -> Screen:
    one_screen.open(DIAGONAL)
    one_screen.dispatch(
        DesignChanged({"is_symmetric": False, "stretches": False}),
        Selected({"variable": "e", "term": "Z", "drag": "partition"}),
    )
    return one_screen


def variable(state: AppState, name: str) -> Input | Output:
    return next(v for v in (*state.document.inputs, *state.document.outputs) if v.name == name)


def names(state: AppState, name: str = "e") -> list[str]:
    return [term.name for term in variable(state, name).terms]


def actions(screen: Screen) -> object:
    """The buttons below the name."""
    return next(h for h in screen.handles().values() if "rename" in getattr(h, "options", ()))


def refusal(state: AppState) -> str:
    assert state.notice is not None
    assert state.notice.is_error
    return state.notice.text


def test_a_term_is_renamed_and_the_rules_follow(screen: Screen) -> None:
    screen.send(screen.find("name"), "zero")
    state = screen.send(actions(screen), "rename")
    assert names(state) == ["NB", "NM", "NS", "zero", "PS", "PM", "PB"]
    assert (state.term, state.design.term_name) == ("zero", None)
    assert len(all_rules(state.document)) == 49
    screen.send(screen.find("name"), "NB")
    assert "has a term 'NB' already" in refusal(screen.send(actions(screen), "rename"))
    assert screen.find("name").value == "NB", "what was written stays"
    for name in ("", " ", "x" * 200, "bell \x07"):
        screen.send(screen.find("name"), name)
        state = screen.send(actions(screen), "rename")
        assert refusal(state).startswith("Refused: the term's name")
        assert names(state)[3] == "zero"
    screen.dispatch(Selected({"term": "PB"}))
    assert screen.find("name").value == "PB"


def test_terms_are_added_moved_and_removed_with_their_rules(screen: Screen) -> None:
    state = screen.send(actions(screen), "add")
    assert names(state) == ["NB", "NM", "NS", "Z", "Z 2", "PS", "PM", "PB"]
    assert state.term == "Z 2"
    state = screen.send(actions(screen), "▸")
    assert names(state)[4:6] == ["PS", "Z 2"]
    for _ in range(9):
        state = screen.send(actions(screen), "◂")
    assert names(state)[0] == "Z 2"
    state = screen.send(actions(screen), "remove")
    assert names(state) == names(screen.store.state)
    assert len(all_rules(state.document)) == 49
    screen.dispatch(Selected({"term": "NB"}))
    state = screen.send(actions(screen), "remove")
    assert state.past[-1].label == "e: remove NB, and 7 rules with it"
    assert len(all_rules(state.document)) == 42
    screen.dispatch(Undo())
    assert len(all_rules(screen.store.state.document)) == 49


def test_the_last_term_cannot_be_removed(screen: Screen) -> None:
    screen.open(edits.space_terms(DIAGONAL, "e", 1))
    assert "0 terms: valid are 1 to 64" in refusal(screen.send(actions(screen), "remove"))


def test_numbers_are_exact_and_what_is_shown_rounded_stays(screen: Screen) -> None:
    values = screen.find("a · b · c")
    screen.dispatch(Selected({"drag": "free"}))
    assert values.value == pytest.approx((-1 / 3, 0.0, 1 / 3))
    state = screen.send(values, (-0.333, 0.0, 0.333))
    assert state.document is DIAGONAL
    state = screen.send(values, (-0.5, 0.0, 0.333))
    assert variable(state, "e").terms[3].shape == Triangle(-0.5, 0.0, 1 / 3)
    state = screen.send(values, (0.5, 0.0, 0.333))
    assert "is not in order" in refusal(state)
    assert values.value == pytest.approx((-0.5, 0.0, 1 / 3))
    for wrong in (math.nan, math.inf, 1e300):
        assert refusal(screen.send(values, (wrong, 0.0, 0.333))).startswith("Refused: the parameter")
    screen.dispatch(Selected({"term": "NB"}))
    assert screen.find("b · c").value == pytest.approx((-1.0, -2 / 3))
    assert screen.send(values, (0.0, 0.0, 0.0)).document is state.document, "sent for another shape"


def test_sides_are_opened_and_closed(screen: Screen) -> None:
    ends = screen.find("open · not")
    screen.dispatch(Selected({"term": "NB"}))
    assert tuple(ends.options) == ("● −∞", "not")
    state = screen.send(ends, "● −∞")
    assert shapes.parameters(variable(state, "e").terms[0].shape) == pytest.approx((-4 / 3, -1.0, -2 / 3))
    assert tuple(ends.options) == ("−∞", "+∞", "not")
    state = screen.send(ends, "−∞")
    assert state.document == DIAGONAL
    assert "the trait is" in refusal(screen.send(ends, "+17"))
    screen.dispatch(Edit("gauss", partial(edits.set_shape_kind, variable="e", term="NB", kind="gaussian")))
    assert tuple(ends.options) == ("not",)
    state = screen.send(ends, "not")
    assert variable(state, "e").terms[0].complement
    assert tuple(ends.options) == ("● not",)
    state = screen.send(screen.find("height"), 0.5)
    assert variable(state, "e").terms[0].height == 0.5
    assert refusal(screen.send(screen.find("height"), 1.5)).startswith("Refused: the height")


def test_a_term_of_an_output_may_be_a_function(screen: Screen) -> None:
    screen.dispatch(Selected({"variable": "T", "term": "LR"}))
    assert "valid defuzzifiers are weighted_average" in refusal(screen.send(screen.find("shape"), "linear"))
    screen.send(screen.find("space them as"), "singleton")
    screen.dispatch(Edit("Sugeno", partial(edits.set_inference, defuzzifier="weighted_average")))
    state = screen.send(screen.find("shape"), "linear")
    assert variable(state, "T").terms[-1].shape == Linear((0.0, 0.0), 85.0)
    state = screen.send(screen.find("c1 · c2 · constant"), (1.0, 0.0, 80.0))
    assert variable(state, "T").terms[-1].shape == Linear((1.0, 0.0), 80.0)
    assert variable(screen.send(screen.find("shape"), "singleton"), "T").terms[-1].shape == Singleton(80.0)
    screen.dispatch(Selected({"variable": "e"}))
    assert "valid" in refusal(screen.send(screen.find("shape"), "linear"))


def test_symmetric_editing_moves_the_opposite_term(screen: Screen) -> None:
    screen.send(screen.find("drag"), "symmetric")
    screen.dispatch(Selected({"term": "PS"}))
    state = screen.send(screen.find("a · b · c"), (0.0, 0.2, 0.667))
    assert variable(state, "e").terms[4].shape.b == 0.2  # type: ignore[union-attr]
    assert variable(state, "e").terms[2].shape.b == -0.2  # type: ignore[union-attr]
    state = screen.send(screen.find("shape"), "gaussian")
    assert isinstance(variable(state, "e").terms[2].shape, Gaussian)
    assert state.past[-1].label == "e PS: gaussian, and its mirror"
    screen.dispatch(Undo(), Undo())
    assert screen.store.state.document == DIAGONAL
    screen.send(screen.find("drag"), "● symmetric")
    assert not screen.store.state.design.is_symmetric


def test_range_unit_and_name_of_a_variable(screen: Screen) -> None:
    state = screen.send(screen.find("range"), (-1.0, 2.0))
    assert (variable(state, "e").high, variable(state, "e").terms) == (2.0, DIAGONAL.inputs[0].terms)
    screen.dispatch(Undo())
    screen.send(screen.find("stretch terms"), True)
    state = screen.send(screen.find("range"), (-2.0, 2.0))
    assert shapes.parameters(variable(state, "e").terms[4].shape) == pytest.approx((0.0, 2 / 3, 4 / 3))
    assert "valid is low < high" in refusal(screen.send(screen.find("range"), (2.0, 2.0)))
    state = screen.send(screen.find("unit"), "m")
    assert variable(state, "e").unit == "m"
    screen.send(screen.find("variable name"), "error")
    renaming = next(h for h in screen.handles().values() if "rename variable" in getattr(h, "options", ()))
    state = screen.send(renaming, "rename variable")
    assert (state.variable, state.term, state.document.inputs[0].name) == ("error", "Z", "error")
    assert edits.rule_table(state.document).rows == "error"
    screen.send(screen.find("variable name"), "T")
    assert "the name 'T' is used already" in refusal(screen.send(renaming, "rename variable"))


def test_a_variable_gets_another_number_of_terms(screen: Screen) -> None:
    screen.send(screen.find("even terms"), 5)
    state = screen.send(screen.find("space them as"), "triangle")
    assert names(state) == ["NB", "NS", "Z", "PS", "PB"]
    assert len(all_rules(state.document)) == 35
    assert state.design.count is None
    assert screen.find("even terms").value == 5
    for count in (0, 65):
        text = refusal(screen.send(screen.find("even terms"), count))
        assert text == f"Refused: the number of terms is {count}; valid is a number from 1 to 64."
    state = screen.send(screen.find("space them as"), "trapezoid")
    assert all(isinstance(term.shape, Trapezoid) for term in variable(state, "e").terms)


def test_the_live_value_is_a_line_over_the_chart_and_in_the_legend(screen: Screen) -> None:
    run = simulated(DIAGONAL)
    screen.dispatch(finished(DIAGONAL))
    view = screen.view("MembershipView")
    screen.show(frame_of(run, 60, strengths(DIAGONAL, run, 60)))
    assert 'id="now"' in view._cursor.content
    assert f"now e = {run.inputs[60, 0, 0]:.3f}" in view._legend.content
    screen.dispatch(Selected({"variable": "T"}))
    screen.show(frame_of(run, 60, strengths(DIAGONAL, run, 60)))
    assert view._cursor.content == "", "the output is no input"


def test_each_variable_has_the_gain_that_stands_at_it(screen: Screen) -> None:
    screen.dispatch(SetupChanged({"controller": "fuzzy_flc"}))
    screen.dispatch(finished(DIAGONAL))
    view = screen.view("GainView")
    for name, gain in (("e", "ge"), ("de", "gc"), ("T", "gu")):
        screen.dispatch(Selected({"variable": name}))
        assert view._factor.label == f"{gain.upper()} ×"
        state = screen.send(view._factor, 2.5)
        assert getattr(state.setup, gain) == 2.5
        assert f"{gain.upper()} = " in view._text.content
        assert "the gain's factor" in refusal(screen.send(view._factor, 7.0))
        screen.dispatch(SetupChanged({gain: 1.0}))
    setup = Setup(controller="pid")
    screen.dispatch(SetupChanged({"controller": "pid"}), finished(DIAGONAL, setup))
    assert not view._factor.visible
    assert view._text.content == ""
    screen.dispatch(SetupChanged({"controller": "fuzzy_flc"}))


@pytest.mark.parametrize("kind", [shapes.kind(shape) for shape in shapes.SHAPES])
def test_every_shape_is_drawn_and_all_its_thumbs_can_be_dragged(screen: Screen, kind: str) -> None:
    screen.dispatch(Selected({"drag": "free", "term": "PS"}))
    state = screen.send(screen.find("shape"), kind)
    term = variable(state, "e").terms[4]
    assert shapes.kind(term.shape) == kind
    assert shape_thumbs("PS", term.shape)
    for number in range(len(screen.view("PointsView")._slider.value)):
        slider = screen.view("PointsView")._slider
        values = list(slider.value)
        if number >= len(values):
            break  # a point that was moved out of the chart
        values[number] = min(values[number] + 0.01, slider.max)
        before = screen.store.state.document
        after = screen.send(screen.view("PointsView")._slider, values)
        assert after.document is not before or after.notice is not None
        assert after.notice is None or after.notice.text.startswith("Not done: ")
