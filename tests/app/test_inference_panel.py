"""Design › Inference without a browser: every option has its words, and chosen inputs are explained."""

from __future__ import annotations

import time
from collections.abc import Iterator
from functools import partial
from typing import get_args

import msgspec
import pytest

import fuzzy
from app import guard
from app.state import AppState, DesignChanged, Edit, Selected
from app.views.inference import formulas, operators
from fuzzy import edits
from fuzzy.formats import save
from fuzzy.system import Inference, NoFire, Sampling, SamplingRule
from tests.app.test_views import DIAGONAL, PILTAN, Screen, frame_of, simulated, strengths, three_inputs


@pytest.fixture(scope="module")
def one_screen(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Screen]:
    folder = tmp_path_factory.mktemp("inference")
    save(DIAGONAL, folder / "mine.yaml")
    server = guard.start_server(port=0)
    yield Screen(server, folder, DIAGONAL)
    server.stop()


@pytest.fixture
def screen(one_screen: Screen) -> Screen:
    one_screen.open(DIAGONAL)
    one_screen.dispatch(DesignChanged({"probe": None}))
    return one_screen


def explanation(screen: Screen) -> object:
    return next(view for view in screen.views if type(view).__name__ == "ExplainView")


def steps(screen: Screen, wanted: str) -> str:
    """Return the explanation as soon as it says something: it is computed beside the event loop."""
    deadline = time.monotonic() + 60
    while wanted not in (text := explanation(screen)._steps.content):  # type: ignore[attr-defined]
        assert time.monotonic() < deadline, text
        time.sleep(0.01)
    return text


def has_error(state: AppState) -> bool:
    return state.notice is not None and state.notice.is_error


@pytest.mark.parametrize("field", operators._OPERATORS)
def test_every_operator_is_offered_with_a_formula_of_its_own(screen: Screen, field: str) -> None:
    label, options = operators._OPERATORS[field]
    assert options == tuple(screen.find(label).options)
    written = {tuple(formulas.lines(msgspec.structs.replace(Inference(), **{field: option}))) for option in options}
    assert len(written) == len(options)
    for option, line in zip(options, written, strict=True):
        assert "_" not in "".join(line), f"{option} has no formula"
        assert "{" not in "".join(line)


@pytest.mark.parametrize("name", operators._COMPOSITIONS)
def test_every_composition_can_be_chosen_and_computes(screen: Screen, name: str) -> None:
    state = screen.send(screen.find("composition"), name)
    assert not has_error(state)
    assert screen.find("composition").value == name
    assert fuzzy.compile_system(state.document).batch([[0.3, 1.0]]).shape == (1, 1)


def test_another_pair_of_operators_is_no_named_composition(screen: Screen) -> None:
    screen.send(screen.find("aggregation"), "einstein_sum")
    assert screen.find("composition").value == "other"
    before = screen.store.state
    assert screen.send(screen.find("composition"), "other") is before


def test_any_sampling_can_be_chosen(screen: Screen) -> None:
    rule, points = screen.find("samples"), screen.find("points")
    assert not rule.visible
    screen.send(screen.find("resolution"), "other samples")
    assert (rule.visible, rule.value, points.value) == (True, "midpoints", 200)
    for wanted in get_args(SamplingRule):
        state = screen.send(rule, wanted)
        assert state.document.inference.resolution == Sampling(200, wanted)
    state = screen.send(points, 13)
    assert state.document.inference.resolution == Sampling(13, get_args(SamplingRule)[-1])
    screen.send(rule, "endpoints")
    assert screen.find("resolution").value == "13 levels, with both ends"
    for wrong in (1, 100_001):
        assert has_error(screen.send(points, wrong))
    assert screen.send(screen.find("resolution"), "exact").document == DIAGONAL


def test_policies_of_every_variable(screen: Screen) -> None:
    state = screen.send(screen.find("de out of range"), "reject")
    assert [variable.out_of_range for variable in state.document.inputs] == ["clamp", "reject"]
    state = screen.send(screen.find("T if no rule"), "hold")
    assert state.document.outputs[0].no_fire == NoFire("hold")
    assert not screen.find("T default").visible
    screen.send(screen.find("T if no rule"), "default")
    state = screen.send(screen.find("T default"), 12.5)
    assert state.document.outputs[0].no_fire == NoFire("default", 12.5)
    state = screen.send(screen.find("T default"), 86.0)
    assert state.document.outputs[0].no_fire == NoFire("default", 86.0)
    assert has_error(screen.send(screen.find("T default"), 1e13))
    screen.dispatch(Edit("rename", partial(edits.rename_variable, variable="de", name="rate")))
    assert screen.find("rate out of range").value == "reject"


def test_chosen_inputs_are_explained_step_by_step(screen: Screen) -> None:
    which = screen.find("explain")
    run = simulated(DIAGONAL)
    screen.show(frame_of(run, 60, strengths(DIAGONAL, run, 60)))
    state = screen.send(which, "chosen inputs")
    assert state.design.probe is not None
    screen.dispatch(DesignChanged({"probe": (0.0, 0.0)}))
    screen.send(screen.find("e · de"), (0.2, -1.0))
    value = float(fuzzy.compile_system(DIAGONAL).batch([[0.2, -1.0]])[0, 0])
    assert "for the chosen inputs" in steps(screen, f"T = {value:.3f}")
    screen.dispatch(Edit("paint", partial(edits.set_cell, row="Z", column="Z", consequent="LR")))
    value = float(fuzzy.compile_system(screen.store.state.document).batch([[0.2, -1.0]])[0, 0])
    steps(screen, f"T = {value:.3f}")
    screen.show(frame_of(run, 60, strengths(DIAGONAL, run, 60)))
    assert "chosen inputs" in steps(screen, "T = "), "the moving arm does not take their place"
    for wrong in ((float("nan"), 0.0), (1e300, 0.0)):
        assert has_error(screen.send(screen.find("e · de"), wrong))
    assert screen.send(which, "the moment shown").design.probe is None


def test_inputs_that_are_refused_say_so(screen: Screen) -> None:
    screen.dispatch(Edit("reject", partial(edits.set_out_of_range, variable="e", policy="reject")))
    screen.dispatch(DesignChanged({"probe": (7.0, 0.0)}))
    assert "is refused" in steps(screen, "valid: -1 to 1")


def test_systems_that_cannot_move_the_arm_are_explained_too(screen: Screen) -> None:
    screen.open(three_inputs())
    screen.send(screen.find("explain"), "chosen inputs")
    screen.send(screen.find("e · de · x"), (0.1, 0.2, 0.5))
    steps(screen, "x = 0.500")
    screen.open(PILTAN)
    assert screen.store.state.design.probe is None, "it has other inputs"
    screen.dispatch(Selected({"variable": "T"}))
