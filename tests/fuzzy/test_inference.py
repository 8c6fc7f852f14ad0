"""The kernels against slow, obvious inference."""

from __future__ import annotations

import itertools
import math
from typing import Any, get_args

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from fuzzy.inference import Controller, compile_system
from fuzzy.kernels import codes
from fuzzy.shapes import Gaussian, Shape, Sigmoid, SShape, Trapezoid, Triangle, ZShape
from fuzzy.system import (
    Aggregation,
    FuzzySystem,
    Implication,
    Inference,
    Input,
    Is,
    NoFire,
    Output,
    Rule,
    RuleBase,
    Sampling,
    SamplingRule,
    Term,
)
from tests import generated, plain, reference, reference_sets, strategies

INF = math.inf

LINEAR = 1e-12
"""Accepted error of closed forms, as a share of the output's range."""

CURVED = 1e-9
"""Accepted error of quadrature, as a share of the output's range."""

DRASTIC = 1e-5
"""Accepted error of the drastic norms: it is rounding that decides where a sigmoid is 1, or 0."""

METHODS = {
    "clipped": {"implication": "min", "aggregation": "max", "ordered": True},
    "envelope of clipped sets": {"implication": "min", "aggregation": "max"},
    "envelope of scaled sets": {"implication": "product", "aggregation": "max"},
    "sum of clipped sets": {"implication": "min", "aggregation": "sum"},
    "sum of scaled sets": {"implication": "product", "aggregation": "sum"},
}


def accepted(output: Output, tolerance: float) -> float:
    """Return the accepted error: a share of the range, and the last bits of numbers far from zero."""
    return tolerance * (output.high - output.low) + 8 * math.ulp(max(abs(output.low), abs(output.high)))


def check(controller: Controller, inputs: list[float], tolerance: float) -> None:
    """Compare firing strengths, and the outputs that follow from them, with the definitions."""
    system = controller.system
    trace = controller.explain(*inputs)
    for found, wanted in zip(trace.strength, reference.firing_strengths(system, *inputs), strict=True):
        assert abs(found - float(wanted)) <= 1e-14, (system, inputs)
    wanted = reference_sets.infer(system, *inputs, strengths=trace.strength.tolist())
    for output, value in zip(system.outputs, wanted, strict=True):
        found = trace.outputs[output.name]
        assert found.fired == (value is not None), (system, inputs)
        if value is None:
            assert math.isnan(found.value), (system, inputs)
        else:
            assert abs(found.value - float(value)) <= accepted(output, tolerance), (system, inputs, float(value))


def check_many(systems, seed: int, tolerance: float, calls: int = 2) -> set[int]:
    """Check each system at several inputs and return the methods that were used."""
    random = np.random.default_rng(seed)
    methods: set[int] = set()
    for system in systems:
        controller = compile_system(system)
        methods |= set(controller.tables.outputs.method.tolist())
        for _ in range(calls):
            check(controller, generated.inputs_for(random, system), tolerance)
    return methods


@pytest.mark.parametrize(
    ("method", "code"),
    list(zip(METHODS, (codes.CLIPPED, codes.ENVELOPE, codes.ENVELOPE, codes.SEPARATE, codes.SEPARATE), strict=True)),
)
def test_closed_forms_are_exact(method, code):
    assert code in check_many(generated.systems(300, code, **METHODS[method]), code, LINEAR)


@pytest.mark.parametrize("aggregation", ["max", "sum"])
def test_curved_sets_are_integrated(aggregation):
    methods = check_many(generated.systems(80, 6, curved=True, aggregation=aggregation), 6, CURVED)
    assert codes.QUADRATURE in methods


@settings(max_examples=80)
@given(strategies.systems(is_exact=True, has_gaussians=False), st.data())
def test_any_linear_system_is_exact(system, data):
    check(_undefined_is_nan(system), _inside(system, data), LINEAR)


@settings(max_examples=50)
@given(strategies.systems(is_exact=True), st.data())
def test_any_system_is_accurate(system, data):
    check(_undefined_is_nan(system), _inside(system, data), CURVED)


def _undefined_is_nan(system: FuzzySystem) -> Controller:
    return compile_system(replace(system, outputs=tuple(replace(o, no_fire=NoFire("nan")) for o in system.outputs)))


def _inside(system: FuzzySystem, data: st.DataObject) -> list[float]:
    return [data.draw(st.floats(variable.low, variable.high)) for variable in system.inputs]


@pytest.mark.parametrize("implication", sorted(reference_sets.STRAIGHT_IMPLICATIONS))
@pytest.mark.parametrize("aggregation", sorted(reference_sets.STRAIGHT_AGGREGATIONS))
def test_operators_that_keep_lines_straight_are_exact(implication, aggregation):
    operators = {"implication": implication, "aggregation": aggregation}
    seed = 11
    for defuzzifier in ("centroid", "bisector", *reference_sets.MAXIMA):
        systems = generated.systems(6, seed, varied=True, defuzzifier=defuzzifier, **operators)
        # Where a plateau ends beside a nearly level side, the place of that end is known less well.
        check_many(systems, seed, LINEAR if defuzzifier == "centroid" else 20 * LINEAR, calls=1)
        seed += 1


@pytest.mark.parametrize("aggregation", get_args(Aggregation))
@pytest.mark.parametrize("implication", get_args(Implication))
def test_all_operators_over_curved_sets_are_integrated(implication, aggregation):
    operators = {"implication": implication, "aggregation": aggregation}
    is_drastic = implication == "drastic_product" or aggregation == "drastic_sum"
    for seed, defuzzifier in enumerate(("centroid", "bisector")):
        systems = generated.systems(4, seed, curved=True, varied=True, defuzzifier=defuzzifier, **operators)
        check_many(systems, seed, DRASTIC if is_drastic else CURVED, calls=1)


@pytest.mark.parametrize("defuzzifier", ["centroid", "bisector", "mom"])
@pytest.mark.parametrize(
    "sets", [(Sigmoid(4.0, -1.3), Sigmoid(4.0, 1.3)), (ZShape(1.3, 6.7), SShape(1.3, 6.7))], ids=["sigmoids", "s and z"]
)
def test_a_partition_that_fires_fully_is_1_everywhere_under_the_nilpotent_maximum(sets, defuzzifier):
    """Its degrees add up to 1 but for rounding, which must neither decide what the set is nor keep dividing it."""
    system = single_input(*((1.0, shape) for shape in sets), aggregation="nilpotent_maximum", defuzzifier=defuzzifier)
    assert compile_system(system)(0.5) == pytest.approx(4.0, abs=8e-9)


@pytest.mark.parametrize(
    ("rule", "defuzzifier"),
    [
        *itertools.product(get_args(SamplingRule), ("centroid", "center_of_sums", *reference_sets.MAXIMA)),
        ("polygon", "bisector"),
    ],
)
@pytest.mark.parametrize("curved", [False, True])
def test_samples_are_what_numpy_computes(rule, defuzzifier, curved):
    random = np.random.default_rng(7)
    for system in generated.systems(30, 7, curved=curved, varied=True, defuzzifier=defuzzifier):
        points = int(random.integers(2, 300))
        sampled = replace(system, inference=replace(system.inference, resolution=Sampling(points, rule)))
        trace = compile_system(sampled).explain(*generated.inputs_for(random, system))
        for output in system.outputs:
            conclusions = reference.conclusions_of(reference.all_rules(sampled), trace.strength.tolist(), output)
            wanted = reference_sets.sampled_with_numpy(sampled, output, conclusions)
            found = trace.outputs[output.name]
            assert found.fired == (wanted is not None)
            if wanted is not None:
                # Left ends are added up step by step, as the engine does that is followed there.
                rounding = points * math.ulp(max(abs(output.low), abs(output.high)))
                wanted = min(max(wanted, output.low), output.high)  # a sample in single precision may lie outside
                assert abs(found.value - wanted) <= accepted(output, 1e-12) + rounding


@pytest.mark.parametrize("exponent", [-3.0, -9.0, -17.0, -100.0, -154.0, -300.0, -307.0, -310.0])
@pytest.mark.parametrize("method", METHODS)
def test_tiny_firing_strengths_keep_all_digits(method, exponent):
    random = np.random.default_rng(8)
    for system in generated.systems(20, 8, **METHODS[method]):
        rules = tuple(
            replace(rule, weight=float(random.uniform(0.5, 2.0) * 10.0**exponent)) for rule in system.rules.list
        )
        controller = compile_system(replace(system, rules=RuleBase(None, rules)))
        check(controller, generated.inputs_for(random, system), LINEAR)


@pytest.mark.parametrize("aggregation", ["max", "sum"])
@pytest.mark.parametrize("exponent", [-3.0, -9.0, -17.0, -100.0, -300.0, -310.0])
def test_tiny_firing_strengths_of_curved_sets_keep_their_digits(aggregation, exponent):
    random = np.random.default_rng(9)
    for system in generated.systems(15, 9, curved=True, aggregation=aggregation):
        rules = tuple(
            replace(rule, weight=float(random.uniform(0.5, 2.0) * 10.0**exponent)) for rule in system.rules.list
        )
        controller = compile_system(replace(system, rules=RuleBase(None, rules)))
        check(controller, generated.inputs_for(random, system), CURVED)


def single_input(*rules: tuple[float, Shape], **operators) -> FuzzySystem:
    """Return a system that fires each consequent with the given strength, on the range [0, 8]."""
    full = Input("x", 0.0, 1.0, (Term("any", Trapezoid(-INF, 0.0, 1.0, INF)),))
    terms = tuple(Term(f"t{i}", shape) for i, (_, shape) in enumerate(rules))
    listed = tuple(Rule(Is("x", "any"), (Is("y", f"t{i}"),), strength) for i, (strength, _) in enumerate(rules))
    output = Output("y", 0.0, 8.0, terms, no_fire=NoFire("nan"))
    return FuzzySystem("one", (full,), (output,), RuleBase(None, listed), Inference(**operators))


@pytest.mark.parametrize(
    ("rules", "operators", "wanted"),
    [
        # By hand: a rectangle, a right triangle, and what lies outside the range counts for nothing.
        ([(1.0, Trapezoid(2.0, 2.0, 4.0, 4.0))], {}, 3.0),
        ([(1.0, Triangle(0.0, 0.0, 6.0))], {}, 2.0),
        ([(1.0, Triangle(2.0, 8.0, 8.0))], {}, 6.0),
        ([(1.0, Triangle(-6.0, 0.0, 6.0))], {}, 2.0),
        ([(0.5, Trapezoid(-INF, 4.0, 4.0, 4.0))], {}, 2.0),
        ([(0.5, Triangle(6.0, 6.0, INF))], {}, 7.0),
        # Clipped at 1/2: a square of 3 x 1/2 and a triangle of 3 x 1/2: (1.5 · 1.5 + 0.75 · 4) / 2.25.
        ([(0.5, Triangle(0.0, 0.0, 6.0))], {}, 7.0 / 3.0),
        ([(0.5, Triangle(0.0, 0.0, 6.0))], {"implication": "product"}, 2.0),
        # The same set twice: the union is the set; the sum counts it twice, here with another strength.
        ([(0.5, Triangle(0.0, 0.0, 6.0)), (1.0, Triangle(0.0, 0.0, 6.0))], {}, 2.0),
        ([(0.5, Triangle(0.0, 0.0, 6.0)), (1.0, Triangle(0.0, 0.0, 6.0))], {"aggregation": "sum"}, 2.0 + 1.0 / 7.0),
        # Two rectangles that overlap on [2, 4]: (4 · 2 + 2 · 5) / 6 as a union, (4 · 2 + 4 · 4) / 8 as a sum.
        ([(1.0, Trapezoid(0.0, 0.0, 4.0, 4.0)), (1.0, Trapezoid(2.0, 2.0, 6.0, 6.0))], {}, 3.0),
        ([(1.0, Trapezoid(0.0, 0.0, 4.0, 4.0)), (0.5, Trapezoid(4.0, 4.0, 8.0, 8.0))], {}, 10.0 / 3.0),
        ([(1.0, Gaussian(3.0, 0.1))], {}, 3.0),
        ([(1e-300, Gaussian(3.0, 1e-6))], {}, 3.0),
        ([(0.0, Triangle(0.0, 0.0, 6.0))], {}, None),
    ],
)
def test_centroids_by_hand(rules, operators, wanted):
    output = compile_system(single_input(*rules, **operators)).explain(0.5).outputs["y"]
    assert output.fired == (wanted is not None)
    if wanted is not None:
        assert output.value == pytest.approx(wanted, abs=1e-11)


@pytest.mark.parametrize("operators", [{}, {"implication": "product"}, {"aggregation": "sum"}])
def test_the_reference_agrees_with_adaptive_quadrature_of_mpmath(operators):
    rules = [(0.4, Gaussian(3.0, 0.7)), (0.9, Gaussian(4.0, 0.5)), (0.6, Triangle(3.0, 6.0, 7.0))]
    system = single_input(*rules, **operators)
    conclusions = [(mpmath.mpf(strength), plain.term(shape)) for strength, shape in rules]
    places = reference_sets.bends(system, system.outputs[0], conclusions)
    area = mpmath.quad(lambda u: reference.aggregated(system, conclusions, u, mpmath.mpf), places)
    moment = mpmath.quad(lambda u: u * reference.aggregated(system, conclusions, u, mpmath.mpf), places)
    found: Any = reference_sets.infer(system, 0.5)[0]
    assert float(found) == pytest.approx(float(mpmath.fdiv(moment, area)), abs=1e-13)


@pytest.mark.parametrize("shift", [10.7, 1e6])
def test_a_narrow_range_far_from_zero_is_as_good(shift):
    # Between the places where the sets cross there are few numbers, or none.
    width = 1e-8 * shift
    values = []
    for low, unit in ((0.0, 1.0), (shift, width)):
        system = single_input(
            (0.9, Gaussian(low + 0.2 * unit, 0.1 * unit)), (0.8, Gaussian(low + 0.8 * unit, 0.2 * unit))
        )
        system = replace(system, outputs=(replace(system.outputs[0], low=low, high=low + unit),))
        values.append((compile_system(system).explain(0.5).outputs["y"].value - low) / unit)
    assert values[1] == pytest.approx(values[0], abs=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_a_mirrored_system_gives_the_mirrored_output(method):
    random = np.random.default_rng(10)
    for system in generated.systems(40, 10, **METHODS[method]):
        mirrored = compile_system(replace(system, outputs=tuple(map(_mirrored, system.outputs))))
        inputs = generated.inputs_for(random, system)
        one, other = compile_system(system).explain(*inputs), mirrored.explain(*inputs)
        for output in system.outputs:
            value = one.outputs[output.name].value
            assert other.outputs[output.name].value == pytest.approx(-value, abs=accepted(output, LINEAR), nan_ok=True)


def _mirrored(output: Output) -> Output:
    terms = []
    for term in output.terms:
        match term.shape:
            case Triangle(a=a, b=b, c=c):
                terms.append(Term(term.name, Triangle(-c, -b, -a)))
            case Trapezoid(a=a, b=b, c=c, d=d):
                terms.append(Term(term.name, Trapezoid(-d, -c, -b, -a)))
    return replace(output, low=-output.high, high=-output.low, terms=tuple(terms))
