"""Outputs that are weighted values: Sugeno, Tsukamoto, height, singletons; and what may not be one."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzy.errors import InvalidSystemError
from fuzzy.inference import compile_system
from fuzzy.shapes import Concave, Gaussian, Linear, Ramp, Shape, Sigmoid, Singleton, SShape, Trapezoid, Triangle, ZShape
from fuzzy.system import Defuzzifier, FuzzySystem, Inference, Input, Is, Or, Output, Rule, RuleBase, Term
from fuzzy.validation import validate

INF = math.inf

X = Input("x", 0.0, 10.0, (Term("low", Ramp(10.0, 0.0)), Term("high", Ramp(0.0, 10.0))))
Y = Input("y", -1.0, 1.0, (Term("any", Trapezoid(-INF, -1.0, 1.0, INF)),))


def system(low: Shape, high: Shape, defuzzifier: Defuzzifier, aggregation: str = "sum") -> FuzzySystem:
    """Return "low → low, high → high, low or high → high" over [0, 4]."""
    output = Output("z", 0.0, 4.0, (Term("low", low), Term("high", high)))
    rules = (
        Rule(Is("x", "low"), (Is("z", "low"),)),
        Rule(Is("x", "high"), (Is("z", "high"),)),
        Rule(Or((Is("x", "low"), Is("x", "high"))), (Is("z", "high"),), 0.5),
    )
    inference = Inference(defuzzifier=defuzzifier, aggregation=aggregation)  # type: ignore[arg-type]
    return FuzzySystem("weighted", (X, Y), (output,), RuleBase(None, rules), inference)


@given(st.floats(0.0, 10.0), st.floats(-1.0, 1.0))
def test_sugeno_of_order_one_is_the_weighted_average_of_the_functions(x, y):
    z = (2.0 * x - y + 1.0, -0.5 * x + 3.0 * y)
    controller = compile_system(system(Linear((2.0, -1.0), 1.0), Linear((-0.5, 3.0), 0.0), "weighted_average"))
    w = (1 - x / 10, x / 10, 0.5 * max(x / 10, 1 - x / 10))
    wanted = (w[0] * z[0] + (w[1] + w[2]) * z[1]) / sum(w)
    assert controller(x, y) == pytest.approx(wanted, abs=1e-12)


@given(st.floats(0.0, 10.0))
def test_a_term_counts_once_under_max_and_for_every_rule_under_sum(x):
    w = (1 - x / 10, x / 10, 0.5 * max(x / 10, 1 - x / 10))
    for aggregation, high in (("sum", w[1] + w[2]), ("max", max(w[1], w[2]))):
        average = compile_system(system(Singleton(1.0), Singleton(3.0), "weighted_average", aggregation))
        assert average(x, 0.0) == pytest.approx((w[0] + 3 * high) / (w[0] + high), abs=1e-12)
        total = compile_system(system(Singleton(1.0), Singleton(3.0), "weighted_sum", aggregation))
        assert total(x, 0.0) == pytest.approx(w[0] + 3 * high, abs=1e-12)
        # IEC 61131-7: the centre of gravity of singletons is the same average.
        centroid = compile_system(system(Singleton(1.0), Singleton(3.0), "centroid", aggregation))
        assert centroid(x, 0.0) == average(x, 0.0)


@pytest.mark.parametrize(
    ("rising", "inverse"),
    [
        (Ramp(0.0, 4.0), lambda w: 4.0 * w),
        (SShape(0.0, 4.0), lambda w: 4.0 * math.sqrt(w / 2) if w <= 0.5 else 4.0 - 4.0 * math.sqrt((1 - w) / 2)),
        (Sigmoid(2.0, 3.0), lambda w: min(max(2.0 + math.log(w / (1 - w)) / 3.0, 0.0), 4.0) if w < 1 else 4.0),
        (Concave(1.0, 4.0), lambda w: max(7.0 - 3.0 / w, 0.0)),
        (Triangle(1.0, 3.0, INF), lambda w: 1.0 + 2.0 * w),
    ],
)
@pytest.mark.parametrize("strength", [0.1, 0.25, 0.5, 0.9, 1.0])
def test_tsukamoto_takes_the_place_of_the_degree(rising, inverse, strength):
    output = Output("z", 0.0, 4.0, (Term("up", rising),))
    rules = (Rule(Is("y", "any"), (Is("z", "up"),), strength),)
    inference = Inference(defuzzifier="weighted_average")
    controller = compile_system(FuzzySystem("tsukamoto", (Y,), (output,), RuleBase(None, rules), inference))
    assert controller(0.0) == pytest.approx(inverse(strength), abs=1e-7)  # flat tops give half the digits


def test_height_weighs_the_middles_of_the_tops():
    shapes = Trapezoid(0.0, 0.0, 1.0, 2.0), Gaussian(3.0, 0.5)
    controller = compile_system(system(*shapes, "height"))
    w = (0.7, 0.3, 0.5 * 0.7)
    assert controller(3.0, 0.0) == pytest.approx((w[0] * 0.5 + (w[1] + w[2]) * 3.0) / sum(w), abs=1e-12)


def test_functions_may_leave_the_range_and_read_inputs_within_theirs():
    controller = compile_system(system(Linear((100.0, 0.0), 0.0), Linear((100.0, 0.0), 0.0), "weighted_average"))
    assert controller(99.0, 0.0) == pytest.approx(1000.0)
    assert np.isclose(controller.batch([[5.0, 0.0]]), 500.0)


@pytest.mark.parametrize(
    ("shape", "defuzzifier", "message"),
    [
        (Triangle(0.0, 1.0, 2.0), "weighted_average", "valid are singleton and linear"),
        (Gaussian(2.0, 1.0), "weighted_sum", "valid are singleton and linear"),
        (Linear((1.0, 0.0), 0.0), "centroid", "a linear function is no set"),
        (Linear((1.0, 0.0), 0.0), "height", "a linear function is no set"),
        (Linear((1.0,), 0.0), "weighted_average", "1 coefficients: valid are 2, one for each input"),
        (Triangle(5.0, 6.0, 7.0), "centroid", "the set has no area"),
        (ZShape(5.0, 6.0), "weighted_average", "valid are singleton and linear"),
    ],
)
def test_terms_without_the_value_that_is_asked_for_are_refused(shape, defuzzifier, message):
    with pytest.raises(InvalidSystemError, match=message):
        validate(system(shape, Ramp(0.0, 4.0) if "weighted" in defuzzifier else Triangle(0, 1, 2), defuzzifier))


def test_singletons_alone_have_no_bisector():
    with pytest.raises(InvalidSystemError, match="singletons have no area for bisector: valid are centroid"):
        validate(system(Singleton(1.0), Singleton(2.0), "bisector"))
