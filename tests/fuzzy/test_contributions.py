"""How far each rule moved the output: shares that add up, symmetric, and 0 for who does nothing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from fuzzy import compile_system, edits
from fuzzy.analysis import OTHERS, contributions, shares
from fuzzy.errors import InvalidInputError
from fuzzy.formats import load
from fuzzy.rules import all_rules
from fuzzy.shapes import Triangle
from fuzzy.system import FuzzySystem, Input, Is, NoFire, Output, Rule, RuleBase, Term

DIAGONAL = load(Path(__file__).parents[2] / "rulebases" / "diagonal.yaml")
CONTROLLER = compile_system(DIAGONAL)
PLACE = st.tuples(st.floats(-1.5, 1.5), st.floats(-9.0, 9.0))


@given(PLACE)
def test_the_shares_add_up_to_the_output(place: tuple[float, float]) -> None:
    found = contributions(CONTROLLER, place)
    assert found.base == 0.0
    assert found.value == pytest.approx(CONTROLLER.batch([place])[0, 0])
    assert sum(one.moved for one in found.rules) == pytest.approx(found.value, abs=1e-9)
    trace = CONTROLLER.explain(*place)
    assert {one.number for one in found.rules} == {fired.number for fired in trace.rules}
    for one in found.rules:
        assert one.strength == trace.strength[one.number]
        assert one.rule == all_rules(DIAGONAL)[one.number]


@given(PLACE)
def test_an_odd_table_gives_odd_shares(place: tuple[float, float]) -> None:
    one = contributions(CONTROLLER, place)
    other = contributions(CONTROLLER, (-place[0], -place[1]))
    np.testing.assert_allclose(
        sorted(rule.moved for rule in one.rules), sorted(-rule.moved for rule in other.rules), atol=1e-9
    )


def overlapping(aggregation: str = "max") -> FuzzySystem:
    """Two rules with the same consequent and one that pulls the other way."""
    always = Triangle(-1.0, 0.0, 1.0)
    e = Input("e", -1.0, 1.0, (Term("a", always), Term("b", always), Term("c", always)))
    terms = (Term("left", Triangle(-2.0, -1.0, 0.0)), Term("right", Triangle(0.0, 1.0, 2.0)))
    output = Output("u", -2.0, 2.0, terms, "", NoFire("default", 0.5))
    listed = tuple(
        Rule(Is("e", name), (Is("u", term),)) for name, term in zip("abc", ("left", "left", "right"), strict=True)
    )
    system = FuzzySystem("three", (e,), (output,), RuleBase(list=listed))
    return replace(system, inference=replace(system.inference, aggregation=aggregation))


def test_rules_that_do_the_same_share_alike_and_the_base_is_the_default() -> None:
    found = contributions(compile_system(overlapping()), [0.0])
    by_number = {one.number: one.moved for one in found.rules}
    assert found.base == 0.5
    assert found.value == pytest.approx(0.0)
    assert by_number[0] == pytest.approx(by_number[1])
    # By hand: orders of a, b (left, -1) and c (right, 1); alone -1 and 1, together 0, from 0.5.
    assert by_number[2] == pytest.approx((0.5 + 0.5 + 1.0 + 1.0 + 1.0 + 1.0) / 6)
    assert sum(by_number.values()) == pytest.approx(-0.5)


def test_weaker_rules_than_the_strongest_count_together() -> None:
    system = DIAGONAL
    for variable in ("e", "de"):
        for term in ("NB", "NM", "NS", "Z", "PS", "PM", "PB") if variable == "e" else ():
            system = edits.set_shape_kind(system, variable, term, "gaussian")
    found = contributions(compile_system(system), (0.1, 0.5))
    others = [one for one in found.rules if one.number == OTHERS]
    assert len(others) == 1
    assert others[0].rule is None
    assert len(found.rules) == 7
    assert sum(one.moved for one in found.rules) == pytest.approx(found.value - found.base, abs=1e-9)


def test_where_no_rule_fires_nothing_is_shared() -> None:
    found = contributions(compile_system(edits.clear_table(DIAGONAL)), (0.2, 0.3))
    assert found.rules == ()
    assert found.value == found.base


def test_the_shares_of_many_places_are_the_weighted_sum() -> None:
    x = np.random.default_rng(1).uniform(-1, 1, (20, 2)) * [1.0, 6.0]
    weights = np.linspace(-1.0, 2.0, 20)
    found = shares(CONTROLLER, x, weights)
    expected = np.zeros(len(all_rules(DIAGONAL)))
    for row, weight in zip(x, weights, strict=True):
        for one in contributions(CONTROLLER, row).rules:
            expected[one.number] += weight * one.moved
    np.testing.assert_allclose(found.moved, expected, atol=1e-9)
    np.testing.assert_allclose(found.value, CONTROLLER.batch(x)[:, 0], atol=1e-9)


def test_the_next_inference_is_not_disturbed() -> None:
    before = CONTROLLER(0.3, -1.0)
    contributions(CONTROLLER, (0.9, 5.0))
    assert CONTROLLER(0.3, -1.0) == before


@pytest.mark.parametrize("x", [(np.nan, 0.0), (0.0,), (0.0, 0.0, 0.0)])
def test_what_cannot_be_used_is_refused(x: tuple[float, ...]) -> None:
    with pytest.raises(InvalidInputError):
        contributions(CONTROLLER, x)
