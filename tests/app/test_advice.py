"""Advice on an overshoot: it names the rule that causes it, and what it promises comes true."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import fuzzy
from app import experiment
from app.runner import result_of
from app.runner.advice import advise
from app.state import Advised, Result, RunFinished, Setup, initial, update
from fuzzy import edits
from fuzzy.analysis import culprits, stepped
from fuzzy.formats import load
from fuzzy.rules import all_rules
from fuzzy.system import FuzzySystem
from robot import controllers
from robot.diagnosis import overshoots

DIAGONAL = load(Path(__file__).parents[2] / "rulebases" / "diagonal.yaml")
SPOILT = edits.set_cell(DIAGONAL, row="Z", column="Z", consequent="LR")


def ran(document: FuzzySystem, setup: Setup) -> Result:
    return result_of(experiment.prepare(setup, fuzzy.compile_system(document)))


def test_a_response_without_overshoot_needs_no_advice() -> None:
    assert advise(Setup(), ran(DIAGONAL, Setup()), lambda: False) == ()


@pytest.mark.parametrize("setup", [Setup(), Setup(bend=0.1, extension=-0.02), Setup(controller="fuzzy_pid")])
def test_the_spoilt_cell_is_found_and_the_promise_comes_true(setup: Setup) -> None:
    result = ran(SPOILT, setup)
    advice = advise(setup, result, lambda: False)
    assert advice
    percents = [one.percent for one in advice]
    assert percents == sorted(percents, reverse=True)
    upwards = [one for one in advice if one.push > 0]
    assert upwards, "a cell that pushes up makes those overshoot that go up"
    for one in upwards:
        assert one.rule == all_rules(SPOILT)[24]
        assert one.term is not None
        cured = edits.set_cell(SPOILT, row="Z", column="Z", consequent=one.term)
        name = result.run.arm.coordinates[one.coordinate]
        assert result.metrics.overshoot[name] == pytest.approx(one.percent)
        assert ran(cured, setup).metrics.overshoot[name] == pytest.approx(one.after)
        assert one.after < one.percent
        assert one.start < one.peak


def test_a_law_without_rules_gets_no_advice_and_something_newer_ends_the_search() -> None:
    setup = Setup(controller="pid")
    assert advise(setup, ran(SPOILT, setup), lambda: False) == ()
    assert advise(Setup(), ran(SPOILT, Setup()), lambda: True) is None


def test_the_culprits_are_those_that_pushed_before_those_that_braked() -> None:
    result = ran(SPOILT, Setup())
    controller = controllers.inference_of(result.run.controller)
    assert controller is not None
    worst = overshoots(result.run)[0]
    found = culprits(controller, result.run.inputs[worst.first : worst.peak, worst.coordinate], worst.direction)
    pushes = [push for _, push in found]
    assert found[0][0] == 24
    assert pushes[0] == max(pushes)
    assert min(pushes) < 0.0
    turned = culprits(controller, result.run.inputs[worst.first : worst.peak, worst.coordinate], -worst.direction)
    assert dict(turned)[24] == pytest.approx(-pushes[0])


def test_a_step_of_a_consequent_ends_at_the_last_term() -> None:
    number = 24
    for steps, term in [(1, "SR"), (-1, "SL"), (3, "LR")]:
        found = stepped(DIAGONAL, number, steps)
        assert found is not None
        assert found[1] == term
        assert edits.rule_table(found[0]).cells[3][3] == term
    assert stepped(DIAGONAL, number, 4) is None
    assert stepped(edits.dissolve_table(DIAGONAL), number, 1) is None


def test_advice_on_another_run_than_the_present_one_is_dropped() -> None:
    result, late = ran(SPOILT, Setup()), ran(DIAGONAL, Setup())
    state = update(initial(SPOILT), RunFinished(SPOILT, Setup(), result, result))
    assert state.runs.advice is None
    assert update(state, Advised(late, ())).runs.advice is None
    told = update(state, Advised(result, ()))
    assert told.runs.advice == ()
    assert update(told, RunFinished(SPOILT, Setup(), late, late)).runs.advice is None


def test_overshoots_are_those_of_the_metrics() -> None:
    result = ran(SPOILT, Setup(extension=-0.02))
    for one in overshoots(result.run):
        name = result.run.arm.coordinates[one.coordinate]
        assert result.metrics.overshoot[name] == pytest.approx(one.percent)
        y = (result.run.q[:, one.coordinate] - result.run.start[one.coordinate]) * one.direction
        assert np.all(np.diff(y[one.first : one.peak]) > 0.0)
    assert overshoots(ran(SPOILT, Setup(scenario="sinus")).run) == ()
